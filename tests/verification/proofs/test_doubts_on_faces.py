"""What doubles settle of proofs on meshes, to a tenth of their doubt, and parts of their trees one by one."""

from fractions import Fraction
from math import inf, nextafter
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from proofs import Patches, limit, solid
from regrasp.verification.placed.meshes import surfaces

pytestmark = pytest.mark.oracle

CORNERS = [[[0, 0, 0], [2, 0, 0], [2, 3, 0]], [[3, 0, 0], [3, 4, 0], [0, 0, 4]]]
NORMALS = [[0, 0, 1.0], [-0.8, 0, -0.6]]
KINDS = [(size, norm) for size in ("normal", "force") for norm in ("sum", "squares", "largest")]
UP, DOWN, NONE = [0, 0, 1.0, 0, 0, 0], [0, 0, -1.0, 0, 0, 0], [-1] * 3
TWO = Patches([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], NONE, NONE])
WHOLE = Patches([(0, 1)], [NONE])


def said(proof) -> str:
    return "; ".join(rg.verify(proof).violations)


def flat(nodes, patches=WHOLE, **changes):
    count = patches.spans[0][1]
    loads = changes.pop("loads", [DOWN])
    corners = changes.pop("corners", CORNERS[:1] * count)
    return solid(corners, NORMALS[:1] * count, loads, patches, nodes, **changes)


def test_broken_proofs_on_meshes_are_refused_in_a_line() -> None:
    for name in ("corners", "spans", "boxes", "twists", "fingers"):
        proof = flat([([0], (0, 0), 0, UP)])
        assert surfaces.check_surface_proof(proof) == []
        setattr(proof, name, None)
        (words,) = surfaces.check_surface_proof(proof)
        assert words.startswith("proof: its"), name


def limit_on(proof, patches) -> float:
    return limit(proof, lambda b, f: patches.corners(int(proof.boxes[b][f]), proof.corners, proof.normals))


@pytest.mark.parametrize("reach", [1.0, 1e-3, 1e3])
@pytest.mark.parametrize(("size", "norm"), KINDS)
def test_doubt_is_a_part_of_all_terms(size, norm, reach, monkeypatch) -> None:
    """1e-12 of what the load does, of what a force may do at the farthest place, and of the bound."""
    monkeypatch.setattr(surfaces, "_excluded", lambda *told: False)
    rng, seen = np.random.default_rng(7), 0
    corners, k = reach * np.array(CORNERS, dtype=float), 2
    for mu in (0.0, 0.5, 3.0):
        for turning in (0.1, 10.0):
            y = rng.choice([-1, 1], size=6) * rng.uniform(0.5, 1, size=6)
            y[3:] *= turning / reach
            for other in 0.0, 3.0:  # by a load along one axis, and by one most of which cancels
                load = np.zeros(6)
                load[0], load[4] = -(1 + other) / y[0], other / y[4]
                nodes = [([0] * k, (0, 0), 0, y)]
                proof = solid(corners, NORMALS, [load], TWO, nodes, friction=mu, size=size, norm=norm)
                many = {"sum": 1, "squares": k**0.5, "largest": k}[norm]
                most = 1 / (float(limit_on(proof, TWO)) * many)
                room = 1e-12 * (1 + mu) * (np.linalg.norm(y[:3]) + np.linalg.norm(y[3:]) * 5 * reach)
                done = many * (most + room) * (1 + 1e-12)
                for factor, good in (1 - 1e-13, True), (1 + 1e-13, False):
                    proof.bound = (1 - 1e-12 * (1 + 2 * other)) / done * factor
                    assert (said(proof) == "") == good, (mu, turning, other, factor)
                    seen += 1
    assert seen == 24


@pytest.mark.parametrize("scale", [1e-170, 1e-145, 1e200])
def test_squares_that_doubles_do_not_hold_are_left_to_rationals(scale) -> None:
    """A load as large as the twist is small: the work is of order one, the squares of speeds are none."""
    twist = scale * np.array([1.0, 0, 1, 0, 0, 0])
    for size, most in ("normal", 1.5), ("force", 1.5 / 1.25**0.5):
        proof = flat([([0], (0, 0), 0, twist)], loads=np.array([DOWN]) / scale, size=size)
        for factor, good in (1 - 1e-15, True), (1 + 1e-15, False):
            proof.bound = factor / most / scale
            assert (said(proof) == "") == good, (size, factor)


@pytest.mark.parametrize("scale", [1.0, 1e-170, 1e-145, 1e200])
def test_twists_of_loads_together_exclude_no_more_than_one_of_their_sum(scale) -> None:
    """Two loads, two fingers and two twists one along the other; by doubles or by rationals alone."""
    twist = scale * np.array([1.0, 0, 1, 0, 0, 0])
    for size, most in ("normal", 1.5), ("force", 1.5 / 1.25**0.5):
        for one, other in (1.0, 1.0), (1.0, 3.0):
            loads, given = np.array([DOWN] * 2) / scale, {"size": size, "norm": "largest"}
            proof = flat([([0, 0], (0, 0), -2, UP)], loads=loads, **given)
            proof.together = np.array([[one * twist, other * twist]])
            for factor, good in (1 - 1e-15, True), (1 + 1e-15, False), (2.0, False), (1e-3, True):
                proof.bound = factor / most / 2 / scale
                assert (said(proof) == "") == good, (size, factor)
            proof.together *= 0
            assert said(proof) == "proof: the twists of box 0 do not exclude it"


def test_work_of_a_few_of_the_least_numbers() -> None:
    """Twice 3/2 of them is three; in doubles it would be four."""
    loads = 3 * 5e-324 * np.array([DOWN] * 2)
    proof = flat([([0], (0, 0), -2, UP)], loads=loads, friction=0.0, norm="largest")
    proof.together = 0.5 * np.array([[UP, UP]])
    for proof.bound, good in (2 * 5e-324, True), (3 * 5e-324, False):
        assert (said(proof) == "") == good


def test_corners_beyond_squares_of_doubles_are_refused_in_a_line() -> None:
    for number in -1, 0:
        proof = flat([([0, 0], (0, 0), number, UP)], corners=1e150 * np.array(CORNERS[:1]) / 3)
        proof.min_distance = 1.5e150
        assert said(proof) == ""
        proof.corners *= 1.001
        assert said(proof) == "proof: its corners must be within 1e+150 m"
        proof.corners *= 1e50
        assert said(proof) == "proof: its corners must be within 1e+150 m"
        proof.corners, proof.normals = proof.corners / 1e60, np.array([[0, 0, 1e200]])
        assert said(proof) == "proof: normals must be of length 1"


def test_slow_forces_within_the_cone() -> None:
    proof = flat([([0], (0, 0), 0, [0, 0, 0.5, 0, 0, 0])], size="force")
    for proof.bound, good in (1 - 2.0**-51, True), (1 + 2.0**-51, False):
        assert (said(proof) == "") == good


@pytest.mark.parametrize(("size", "norm"), KINDS)
def test_normals_need_not_be_of_length_one_to_the_last_digit(size, norm) -> None:
    rng, corners = np.random.default_rng(8), np.array(CORNERS[:1], dtype=float)
    for length in (1 - 4e-13, 1 + 4e-13):
        normal = length * np.array([[2.0, -1, 2]]) / 3
        for mu in 0.0, 0.5, 3.0:
            y = [*rng.uniform(-1, 1, size=2), 1.0, *rng.uniform(-0.2, 0.2, size=3)]
            proof = solid(corners, normal, [DOWN], WHOLE, [([0], (0, 0), 0, y)], size=size, norm=norm)
            proof.friction = mu
            most = float(limit_on(proof, WHOLE))
            for factor, good in (1 - 2.0**-51, True), (1 + 2.0**-51, False):
                proof.bound = most * factor
                assert (said(proof) == "") == good, (length, mu)
    proof.normals, proof.bound = np.array([[0, 0, 1.0]]), 0.0
    for off, good in (0.4e-12, True), (0.6e-12, False):
        for sign in -1, 1:
            proof.normals[0, 2] = 1 + sign * off
            assert (said(proof) == "") == good
    two = flat([([0], (0, 0), 0, UP)], TWO)
    two.normals[1, 2] = 1.1
    assert "of length 1" in said(two)


def test_fingers_are_near_where_all_their_places_are() -> None:
    for reach in 1.0, 2.0**-10, 2.0**400:
        corners = reach * np.array([[[1, 1, 0], [5, 1, 0], [1, 4, 0]]])
        proof = flat([([0, 0], (0, 0), -1, UP)], corners=corners, bound=1.0)
        for least, good in (nextafter(5, inf), True), (5, False), (nextafter(5, 0), False):
            proof.min_distance = least * reach
            assert (said(proof) == "") == good
            assert good or "fingers of box 0 may be far enough apart" in said(proof)


def test_each_half_is_where_it_is_said_to_be() -> None:
    """All other boxes are excluded by lifting; the one that is asked by a twist of its own."""
    rng, seen, corners = np.random.default_rng(6), set(), np.array(CORNERS[:1], dtype=float)
    for _ in range(60):
        edge = int(rng.integers(3))
        patches = Patches([(0, 1)], [[1, 2, edge], [3, 4, (edge + 1) % 3], NONE, NONE, NONE])
        nodes = [([0], (1, 2), 0, UP), ([1], (3, 2), 0, UP), *(([p], (0, 0), 0, UP) for p in (2, 3, 4))]
        if rng.random() < 0.5:
            nodes = [([0], (1, 2), 0, UP), ([1], (0, 0), 0, UP), ([2], (0, 0), 0, UP)]
        box = int(rng.integers(2 if len(nodes) > 3 else 1, len(nodes)))
        nodes[box] = (*nodes[box][:3], [0, 0, 1.0, *rng.normal(size=3)])
        proof = solid(corners, NORMALS[:1], [DOWN], patches, nodes, friction=0.0)
        most = float(limit_on(proof, patches))
        if not 0 < most < 1:
            continue
        seen.add((edge, len(nodes), box))
        for factor, good in (1 - 2.0**-51, True), (1 + 2.0**-51, False):
            proof.bound = most * factor
            assert (said(proof) == "") == good, (edge, box)
    assert len(seen) > 9


def test_halves_are_where_doubles_are_not() -> None:
    """A lever of 5 of the least numbers is halved to 5/2, not to 2."""
    corners = 5e-324 * np.array([[[0, 0, 0], [5, 0, 0], [0, 5, 0]]])
    turn = [0, 0, 0, 0, -1e300, 0]  # at x it lifts by that times x
    patches = Patches([(0, 1)], [[1, 2, 0], [3, 4, 2], NONE, NONE, NONE])
    nodes = [([0], (1, 2), 0, UP), ([1], (3, 2), 0, UP), *(([patch], (0, 0), 0, UP) for patch in (2, 3, 4))]
    nodes[3] = (*nodes[3][:3], turn)
    limit = float(Fraction(1e-30) / (Fraction(5e-324) * 5 / 2))
    for count in 1, 2:
        loads = np.array([[0, 0, -1e300, 0, 1e-30, 0]] * count)
        proof = flat(nodes, patches, loads=loads, corners=corners, friction=0.0, norm="largest")
        if count == 2:
            proof.together, proof.number[3] = np.array([[turn] * 2]), -2
        for proof.bound, good in (limit * (1 - 2.0**-51), True), (limit * (1 + 2.0**-51), False):
            assert (said(proof) == "") == good, count


def test_boxes_are_split_as_they_must_be() -> None:
    halves = [[1, 2, -1], [3, 4, 0], [5, 6, 0], *[NONE] * 4]
    patches = Patches(TWO.spans, halves)
    first = [
        ([0, 0], (1, 3), 0, UP),
        ([1, 1], (0, 0), 0, UP),
        ([1, 2], (4, 3), 0, UP),
        ([2, 2], (0, 0), 0, UP),
    ]

    def told(*inside) -> str:
        nodes = [*first, *((list(some), (0, 0), 0, UP) for some in inside)]
        nodes[2] = ([1, 2], (4, len(inside)), 0, UP)
        return said(flat(nodes, patches, bound=1e-9))

    assert told((3, 2), (4, 2)) == told((1, 5), (1, 6)) == ""
    for wrong in (
        [(3, 3), (3, 4), (4, 4)], [(3, 5), (3, 6), (4, 6)], [(3, 2), (4, 5)], [(3, 2), (3, 2)],
        [(1, 2), (4, 2)], [(3, 5), (4, 6)], [(3, 5), (4, 5)],
    ):  # fmt: skip
        assert told(*wrong) == "proof: box 2 is not covered by the boxes it is split into", wrong
    for box in ([0, 1], [1, 0]):
        assert "box 0 must give every finger" in said(flat([(box, (0, 0), 0, UP)], TWO))


def test_a_contact_is_on_a_triangle_with_its_normal() -> None:
    resolution = 2.0**-40
    for reach in 1.0, 1e-3, 1e3:
        corners = reach * np.array([[[1, 0, 0], [5, 0, 0], [1, 3, 0]]])
        proof = flat([([0], (0, 0), 0, UP)], corners=corners)
        out = [([2, 0, 0], [0, -1, 0]), ([3, 1.5, 0], [0.6, 0.8, 0]), ([1, 2, 0], [-1, 0, 0]),
               ([5, 0, 0], [1, 0, 0]), ([1, 3, 0], [0, 1, 0]), ([2, 1, 0], [0, 0, 1]),
               ([2, 1, 0], [0, 0, -1])]  # fmt: skip
        for foot, way in out:
            for part, good in (0.9, True), (1.1, False):
                at = reach * (np.array(foot) + 5 * part * resolution * np.array(way))
                contact = SimpleNamespace(position=at, normal=np.array([0, 0, 1.0]))
                assert surfaces.touches(proof, contact) == good, (foot, way, part)
        for part, good in (0.9, True), (1.1, False):
            contact.position = reach * np.array([2.0, 1, 0])
            contact.normal = np.array([4 * part * resolution, 0, 1.0])
            assert surfaces.touches(proof, contact) == good
