"""Which boxes doubles decide, and sets that grasps stand as a whole, by hand."""

from fractions import Fraction
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

import regrasp as rg
from proofs import limit, planar_points, random_planar
from regrasp.verification.placed import clear_boxes as of_boxes
from regrasp.verification.placed.clear_boxes import clear_boxes
from regrasp.verification.placed.cubic import CubicEdges
from regrasp.verification.placed.straight import StraightEdges
from regrasp.verification.placed.whole_sets import answer_alike, makes_ball

pytestmark = pytest.mark.oracle

KINDS = [(size, norm) for size in ("normal", "force") for norm in ("sum", "squares", "largest")]


def clear(proof) -> list[bool]:
    return clear_boxes(proof, StraightEdges(proof)).tolist()


@pytest.mark.parametrize(("size", "norm"), KINDS)
def test_doubles_decide_what_is_beyond_rounding(size, norm) -> None:
    rng, seen = np.random.default_rng(3), 0
    for _ in range(8):
        proof = random_planar(rng, size, norm, splits=0)
        most = float(limit(proof, planar_points(proof)))
        if not most > 0:
            continue
        seen += 1
        for factor, good in (
            (1e-3, True),
            (1 - 1e-11, True),
            (1 - 2e-14, False),
            (1 + 1e-14, False),
            (2, False),
        ):
            proof.bound = most * factor
            assert clear(proof) == [good], factor
        proof.bound, twists = most / 2, proof.twists
        for scale, good in (1e-100, True), (1e100, True), (1e-145, False), (1e-170, False):
            proof.twists = twists * scale
            assert clear(proof) == [good], scale
    assert seen > 3


@pytest.mark.parametrize("bound", [1e-6, 0.5, 1e6])
@pytest.mark.parametrize("size", ["normal", "force", "margin"])
@pytest.mark.parametrize("bent", [False, True])
def test_doubt_is_a_part_of_all_terms(size, bound, bent) -> None:
    """1e-13 of what the load does, of what a force may do at the farthest place, and of the bound."""
    rng, seen = np.random.default_rng(9), set()
    for k in range(6):
        norm = "largest" if size == "margin" else ("sum", "squares", "largest")[k % 3]
        proof = random_planar(rng, size, norm, splits=0, twists=np.zeros((1, 3)))
        proof.bound, mu = bound, max(proof.friction, 0.25)
        if size == "margin":
            proof.friction, proof.margin = mu, 0.1 * proof.bound * mu / (1 + mu)
        y = np.float_power(10, rng.integers(-3, 4, size=3)) * rng.choice([-1, 1], size=3)
        proof.twists[0] = y
        if bent:
            p, q = proof.vertices, np.roll(proof.vertices, -1, axis=0)
            proof.control = np.stack([p, (2 * p + q) / 3, (p + 2 * q) / 3, q], axis=1)
        edges, most = CubicEdges(proof) if bent else StraightEdges(proof), []
        for (first, last), ends in zip(proof.arcs[0].tolist(), proof.ends[0].tolist(), strict=True):
            places = [[e, a, b] for e, a, b in proof.sides[first : last + 1].tolist()]
            places[0][1], places[-1][2] = ends
            stretches = [(int(e), Fraction(a - e), Fraction(b - e)) for e, a, b in places]
            most.append(float(max(edges.most(*at, [Fraction(x) for x in y]) for at in stretches)))
        reach = np.hypot(*np.abs(proof.vertices).max(axis=0)) + np.hypot(*proof.centre_of_mass)
        room = 1e-13 * (abs(y[0]) + abs(y[1]) + abs(y[2]) * reach) * (1 + proof.friction)
        dual = {"sum": np.max, "largest": np.sum, "squares": lambda a: np.sqrt((a**2).sum())}[norm]
        if size == "margin":
            done = sum(most) + len(most) * 4 * proof.bound * room
        else:
            done = proof.bound * dual(np.maximum(most, 0) + room) * (1 + 1e-13)
        if not done > 100 * room * max(proof.bound, 1):
            continue
        for axis in range(3):  # by a load along one axis, and by one most of which cancels
            for other in 0.0, 3.0:
                load = np.zeros(3)
                load[axis], load[axis - 1] = -1 / y[axis] * (1 + other), other / y[axis - 1]
                lost = 1e-13 * (1 + 2 * other)
                for factor, good in (1 + 1e-14, True), (1 - 1e-14, False):
                    proof.loads[0] = load * (done / (1 - lost) * factor)
                    assert clear_boxes(proof, edges).tolist() == [good], (k, axis, other, factor)
                    seen.add(norm)
    assert len(seen) == (1 if size == "margin" else 3)


def test_boxes_of_no_form_are_not_clear(monkeypatch) -> None:
    rng, seen = np.random.default_rng(5), 0
    while seen < 6:
        proof = random_planar(rng, "normal", "sum", splits=3)
        most = float(limit(proof, planar_points(proof)))
        if not most > 0 or len(proof.loads) < 2:
            continue
        seen += 1
        proof.bound = most / 2
        leaves = (proof.children[:, 1] == 0).tolist()
        assert clear(proof) == leaves
        for at_once in (1, 2, 3, 7):
            monkeypatch.setattr(of_boxes, "_AT_ONCE", at_once)
            assert clear(proof) == leaves
        monkeypatch.undo()
        box = leaves.index(True)
        without = [good and k != box for k, good in enumerate(leaves)]
        first, last = proof.arcs[box, -1].tolist()
        for name, at, value in (
            ("number", box, -1), ("number", box, -2), ("number", box, len(proof.loads)),
            ("arcs", (box, -1), (first, len(proof.sides))), ("arcs", (box, -1), (-1, last)),
            ("arcs", (box, -1), (last + 1, last)), ("children", (box, 1), 1),
        ):  # fmt: skip
            kept = getattr(proof, name)
            other = kept.copy()
            other[at] = value
            setattr(proof, name, other)
            assert clear(proof) == without, (name, value)
            setattr(proof, name, kept)


@pytest.mark.parametrize(("limit", "length"), [(1.0, 1.0), (3.0, 1.0), (1.0, 4.0)])
def test_balls_whose_radius_is_a_root_of_a_fraction(limit, length) -> None:
    """Eight forces along the axes, torques +-c: h = 2 max(|u1|, c |u3|) + 2 max(|u2|, c |u3|).

    On u = (c, c, 1) it is 4 c / sqrt(1 + 2 c^2), the least for c = 1/2, and on u = (1, 0, 0) it is 2.
    Two fingers facing each other with mu = 1 make the ball of sqrt(2/3): u = (2, 1, 1).
    """
    for c, square in (0.5, Fraction(8, 3)), (1.0, Fraction(4)):
        eight = [
            rg.Contact([-x * length - z, s * x * c * length], [x, 0], 0.0)
            for x in (1, -1)
            for s, z in ((1, 0), (-1, 0))
        ]
        eight += [
            rg.Contact([s * y * c * length, -y * length], [0, y], 0.0) for y in (1, -1) for s in (1, -1)
        ]
        _judge(rg.Grasp(eight), limit, length, square)
    assert makes_ball(rg.Grasp(eight), limit, length, Fraction(2 * limit))
    two = rg.Grasp([rg.Contact([-length, 0], [1, 0], 1.0), rg.Contact([length, 0], [-1, 0], 1.0)])
    _judge(two, limit, length, Fraction(2, 3))
    assert not makes_ball(two.subset([0]), limit, length, Fraction(1, 10**9))


def _judge(grasp, limit, length, square) -> None:
    radius = Fraction(float(square) ** 0.5 * limit)
    assert makes_ball(grasp, limit, length, radius * (1 - Fraction(1, 2**50)))
    assert not makes_ball(grasp, limit, length, radius * (1 + Fraction(1, 2**50)))


@pytest.mark.parametrize("length", [1.0, 1e-6, 1e6])
@pytest.mark.parametrize("force", [1.0, 1e-6, 1e6])
def test_answers_are_those_of_springs_at_the_limit(length, force) -> None:
    """A squeeze along the axis x of two fingers at equal heights is what no twist makes."""
    places = length * np.array([[1.0, 0.25], [-1.0, 0.25], [0.0, -2.0]])
    first = force * np.array([[-4.0, 1], [4.0, 1], [0, 1]])
    field = np.stack([-places[:, 1], places[:, 0]], axis=1)
    moved = first + force * (np.array([0.3, -0.2]) + 0.5 * field / length)
    squeeze = np.array([[1.0, 0], [-1.0, 0], [0, 0]])

    def alike(*forces) -> bool:
        return answer_alike(
            tuple(SimpleNamespace(grasp=SimpleNamespace(positions=places), forces=f) for f in forces)
        )

    assert alike(first, first)
    assert alike(first, moved)
    assert alike(first, moved, first, moved)
    most = np.abs(moved).max()
    for part, good in (0.9e-9, True), (1.1e-9, False):
        off = moved + part * most * squeeze
        assert alike(first, off) == alike(first, moved, off) == alike(first, off, moved) == good
        assert alike(first, moved - part * most * squeeze) == good
    places[:] = 0  # all at one point
    assert alike(first, first + force)
    assert not alike(first, first + force * squeeze)


@pytest.mark.parametrize("mirrored", [1.0, -1.0])
@pytest.mark.parametrize("turn", [0.0, 0.7, 2.0, 4.0])
def test_balls_within_the_hull_of_all_sums(turn, mirrored) -> None:
    """As near as the nearest facet of the hull of sums of corners, turned or mirrored."""
    places = ([-1, 0.2], [1.0, 0], 0.7), ([1, 0], [-1, 0.1], 0.5), ([0.1, 1], [0.1, -1.0], 0.6)
    turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]) @ np.diag([1, mirrored])
    grasp = rg.Grasp(rg.Contact(turned @ p, turned @ n, mu) for p, n, mu in places)
    corners = []
    for c in grasp:
        forces = [c.normal + way * c.friction * np.array([-c.normal[1], c.normal[0]]) for way in (1, -1)]
        torques = [c.position[0] * f[1] - c.position[1] * f[0] for f in forces]
        corners.append(
            [np.zeros(3), *(2 * np.array([*f, m / 1.5]) for f, m in zip(forces, torques, strict=True))]
        )
    radius = -ConvexHull([sum(few) for few in product(*corners)]).equations[:, -1].max()
    assert radius > 0.1
    for off, good in (-1e-9, True), (1e-9, False):
        assert makes_ball(grasp, 2.0, 1.5, Fraction(radius * (1 + off))) == good


def test_springs_of_fingers_far_from_the_centre_and_at_it() -> None:
    """No force by itself is what one motion makes of three fingers."""
    for places in ([[0, 0], [1e8, 0.0], [0, 1e8]], [[0, 0], [1e-8, 0], [0, 1e-8]]):
        here = np.array(places)
        first = np.ones((3, 2))
        twist = first + 0.5 + np.stack([-here[:, 1], here[:, 0]], axis=1) / np.abs(here).max()
        states = [SimpleNamespace(grasp=SimpleNamespace(positions=here), forces=f) for f in (first, twist)]
        assert answer_alike(tuple(states))
        for at in np.ndindex(3, 2):  # no one force by itself is moved by springs
            states[1].forces = twist.copy()
            states[1].forces[at] += 1e-6
            assert not answer_alike(tuple(states))
            assert not answer_alike(tuple(states[::-1]))
            states[1].forces[at] -= 2e-6
            assert not answer_alike(tuple(states))


@pytest.mark.parametrize("way", [1, -1])
def test_answers_are_judged_by_the_largest_number_of_either_sign(way) -> None:
    """Of three fingers in line what no motion makes is (1, -2, 1) across it."""
    places = np.array([[-1.0, 0], [0, 0], [1, 0]])
    first = way * np.array([[0, 1.0], [0, -5], [0, 1]])
    for part, good in (0.9e-9, True), (1.1e-9, False):
        for side in (1, -1):
            off = first + side * part * 5 / 2 * np.array([[0, 1], [0, -2], [0, 1]])
            states = [
                SimpleNamespace(grasp=SimpleNamespace(positions=places), forces=f) for f in (first, off)
            ]
            assert answer_alike(tuple(states)) == good, (part, side)
