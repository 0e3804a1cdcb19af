"""Proofs about placements on outlines, made by hand: judged to the last digit, and every part counts."""

from fractions import Fraction
from math import inf, nan

import numpy as np
import pytest

import regrasp as rg
from proofs import (
    SHAPES,
    everything,
    limit,
    most_work,
    planar,
    planar_points,
    random_planar,
)  # fmt: skip
from regrasp.verification.placed.placements import check_proof
from regrasp.verification.placed.straight import StraightEdges

pytestmark = pytest.mark.oracle

KINDS = [(size, norm) for size in ("normal", "force") for norm in ("sum", "squares", "largest")]


def said(proof) -> str:
    return "; ".join(rg.verify(proof).violations)


def proven(proof) -> Fraction:
    return limit(proof, planar_points(proof))


@pytest.mark.parametrize(("size", "norm"), KINDS)
def test_a_bound_is_proven_to_its_last_digit(size, norm) -> None:
    rng, seen = np.random.default_rng(0), 0
    for k in range(8):
        proof = random_planar(rng, size, norm, splits=k % 4)
        most = float(proven(proof))
        if not most > 0:
            continue
        seen += 1
        for factor, good in (
            (0.0, True),
            (0.999, True),
            (1 - 2.0**-51, True),
            (1 + 2.0**-51, False),
            (2, False),
        ):
            proof.bound = most * factor
            found = said(proof)
            assert (found == "") == good, (k, factor)
            assert good or "does not exclude it" in found
        verdict = rg.verify(proof)
        assert verdict.excluded == int((proof.children[:, 1] == 0).sum())
        assert verdict.bound == proof.bound
    assert seen > 3


@pytest.mark.parametrize("size", ["normal", "force"])
def test_two_twists_prove_a_bound_to_its_last_digit(size) -> None:
    """Of some boxes, in any order; each with the load of its own."""
    rng, seen = np.random.default_rng(8), 0
    for k in range(8):
        proof = random_planar(rng, size, "largest", splits=k % 3)
        boxes = rng.permutation(len(proof.children))[: 1 + k % 3]
        proof.pairs = np.array([[box, rng.integers(2)] for box in boxes])
        proof.seconds = rng.integers(-4, 5, size=(len(boxes), 3)) * 0.5
        most = float(proven(proof))
        if not most > 0:
            continue
        seen += 1
        for factor, good in (0.999, True), (1 - 2.0**-50, True), (1 + 2.0**-50, False), (2, False):
            proof.bound = most * factor
            assert (said(proof) == "") == good, (k, factor)
        proof.bound = most / 2
        leaf = next((row for row, box in enumerate(boxes) if not proof.children[box, 1]), None)
        for load in () if leaf is None else (-1, 2):
            proof.pairs[leaf, 1] = load
            assert "has no load" in said(proof)
    assert seen > 3


def test_scales_of_twists_and_of_lengths_do_not_count() -> None:
    rng = np.random.default_rng(1)
    proof = random_planar(rng, "force", "squares", 2)
    most = float(proven(proof))
    for scale in (1e-300, 2.0**-500, 1e-60, 1e60, 2.0**500):
        for factor, good in (1 - 1e-12, True), (1 + 1e-12, False):
            proof.bound, kept = most * factor, proof.twists
            proof.twists = kept * scale
            assert (said(proof) == "") == good, scale
            proof.twists = kept


def test_a_twist_without_work_excludes_nothing() -> None:
    """All of a triangle's forces push away from a corner side: sigma is 0 there, and work decides."""
    vertices, sides = SHAPES[1], np.array([[0, 0, 1.0]])
    root = everything(sides, 2)
    for load, good in (((0, 1, 0), True), ((0, -1, 0), False), ((1, 0, 0), False)):
        nodes = [(root, (0, 0), 0, (0.0, -1.0, 0.0))]  # the floor pushes up, against the twist
        proof = planar(vertices, [load], nodes, sides=sides, friction=0.5, bound=1e6)
        assert (said(proof) == "") == good


def test_fingers_that_are_too_near_need_no_twist() -> None:
    vertices = SHAPES[0]
    for sides, far in (
        ([[0, 0, 0.5], [1, 1, 2.0]], np.hypot(4, 1)),  # of all four pairs of ends the farthest
        ([[0, 0.25, 0.5], [1, 1, 2.0]], np.hypot(3, 1)),
        ([[1, 1, 2.0], [2, 2, 2.5]], np.hypot(1.5, 1)),
        ([[1, 1, 2.0], [5, 5, 6.0]], np.hypot(4, 3)),
    ):
        left, right = ((k, k, float(side[1]), float(side[2])) for k, side in enumerate(sides))
        nodes = [(everything(sides, 2), (1, 3), 0, (0, 0, 0)), ([left, left], (0, 0), 0, (0, 0, 0))]
        nodes += [([left, right], (0, 0), -1, (0, 0, 0)), ([right, right], (0, 0), 0, (0, 0, 0))]
        proof = planar(vertices, [[0, -1, 0]], nodes, sides=np.array(sides))
        for least, good in (far * (1 + 1e-12), True), (far * (1 - 1e-12), False):
            proof.min_distance = least
            assert said(proof) == ("" if good else "proof: fingers of box 2 may be far enough apart"), sides
    sides = np.array([[0, 0, 0.5]])
    alone = planar(vertices, [[0, -1, 0]], [(everything(sides, 2), (0, 0), -1, (0, 0, 0))], sides=sides)
    for least, good in (2 * (1 + 1e-12), True), (2.0, False):  # on one side, 2 long
        alone.min_distance = least
        assert (said(alone) == "") == good
    sides = np.array([[0, 0, 0.5], [1, 1, 2.0]])
    whole = planar(vertices, [[0, -1, 0]], [(everything(sides, 2), (0, 0), -1, (0, 0, 0))], sides=sides)
    whole.min_distance = 1e9  # arcs of several sides are not measured
    assert "may be far enough apart" in said(whole)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"vertices": np.zeros((3, 3))}, "vertices must have shape (3, 2)"),
        ({"centre_of_mass": np.zeros(3)}, "centre_of_mass must have shape (2,)"),
        ({"sides": np.zeros((1, 2))}, "sides must have shape (1, 3)"),
        ({"loads": np.zeros((1, 6))}, "loads must have shape (1, 3)"),
        ({"arcs": np.zeros((2, 1, 2), dtype=int)}, "arcs must have shape (1, 1, 2)"),
        ({"ends": np.zeros((1, 2, 2))}, "ends must have shape (1, 1, 2)"),
        ({"number": np.zeros(2, dtype=int)}, "number must have shape (1,)"),
        ({"twists": np.zeros((1, 6))}, "twists must have shape (1, 3)"),
        ({"control": np.zeros((2, 4, 2))}, "control must have shape (3, 4, 2)"),
        ({"loads": np.zeros((0, 3))}, "are needed"),
        ({"friction": -0.1}, "are needed"),
        ({"friction": nan}, "are needed"),
        ({"bound": inf}, "must be finite"),
        ({"bound": nan}, "must be finite"),
        ({"twists": np.array([[0, nan, 0]])}, "must be finite"),
        ({"loads": np.array([[0, inf, 0]])}, "must be finite"),
        ({"min_distance": -1e-300}, "min_distance must be 0 or more"),
        ({"min_distance": inf}, "min_distance must be 0 or more"),
        ({"min_distance": nan}, "min_distance must be 0 or more"),
        ({"size": "moment"}, "has no meaning"),
        ({"rings": np.array([0, 2])}, "rings must begin at vertices, three or more apart"),
        ({"rings": np.array([1])}, "rings must begin at vertices, three or more apart"),
        ({"fingers": 0, "arcs": np.zeros((1, 0, 2), dtype=int), "ends": np.zeros((1, 0, 2))}, "are needed"),
        ({"norm": "least"}, "has no meaning"),
        ({"pairs": np.zeros((0, 2), dtype=int)}, "second twists go with their boxes"),
        ({"pairs": np.zeros((0, 2), dtype=int), "norm": "largest"}, "second twists go with their boxes"),
        ({"pairs": np.zeros((1, 3), dtype=int), "seconds": np.zeros((1, 3)), "norm": "largest"},
         "pairs must have shape (1, 2)"),
        ({"pairs": np.zeros((1, 2), dtype=int), "seconds": np.zeros((1, 2)), "norm": "largest"},
         "seconds must have shape (1, 3)"),
        ({"pairs": np.zeros((0, 2), dtype=int), "seconds": np.zeros((0, 3)), "norm": "largest",
          "control": np.zeros((3, 4, 2))}, "a largest force and straight"),
        ({"rings": np.array([[0], [4]])}, "rings must begin"),
        ({"rings": np.array([], dtype=int)}, "rings must begin"),
        ({"pairs": np.zeros((0, 2), dtype=int), "seconds": np.zeros((0, 3))}, "a largest force and straight"),
        ({"sides": np.array([[3, 3, 4.0]])}, "side 0 is no stretch"),
        ({"sides": np.array([[-1, -1, 0.0]])}, "side 0 is no stretch"),
        ({"sides": np.array([[0, -0.25, 1.0]])}, "side 0 is no stretch"),
        ({"sides": np.array([[0, 0.0, 1.25]])}, "side 0 is no stretch"),
        ({"sides": np.array([[0, 0.5, 0.5]])}, "side 0 is no stretch"),
        ({"sides": np.array([[0, 0.75, 0.5]])}, "side 0 is no stretch"),
        ({"sides": np.array([[0.5, 0.0, 1.0]])}, "side 0 is no stretch"),
        ({"sides": np.array([[-0.5, 0.0, 1.0]])}, "side 0 is no stretch"),
        ({"sides": np.array([[0, 0.25, 1.0]])}, "box 0 must give every finger the whole"),
        ({"sides": np.array([[0, 0.0, 0.75]])}, "box 0 must give every finger the whole"),
    ],
)  # fmt: skip
def test_proofs_of_no_form(changes, words) -> None:
    sides = np.array([[0, 0, 1.0]])
    node = (everything(sides, 1), (0, 0), 0, (0.0, 1.0, 0.0))
    proof = planar(SHAPES[1], [[0, -1, 0]], [node], sides=sides, bound=0.5)
    assert said(proof) == ""
    for name, value in changes.items():
        setattr(proof, name, value)
    assert words in said(proof)


def test_rings_of_three_or_more() -> None:
    vertices = [[0, 0], [4, 0], [4, 4], [0, 4], [1, 1], [1, 3], [3, 1]]
    node = (everything([[0, 0, 1.0]], 1), (0, 0), 0, (0.0, 1.0, 0.0))
    for rings, good in (
        ([0, 4], True), ([0], True), ([0, 3], True), ([0, 5], False), ([0, 2], False), ([1, 4], False),
        ([4, 0], False), ([0, 4, 4], False),
    ):  # fmt: skip
        proof = planar(vertices, [[0, -1, 0]], [node], sides=np.array([[0, 0, 1.0]]), rings=np.array(rings))
        assert (said(proof) == "") == good, rings
        proof.control = np.zeros((7, 4, 2))
        assert "rings must begin" in said(proof)


@pytest.mark.parametrize("empty", ["children", "sides"])
def test_proofs_without_boxes_or_sides(empty) -> None:
    node = (everything([[0, 0, 1.0]], 1), (0, 0), 0, (0.0, 1.0, 0.0))
    proof = planar(SHAPES[1], [[0, -1, 0]], [node], sides=np.array([[0, 0, 1.0]]))
    names = [empty] if empty == "sides" else ["children", "arcs", "ends", "number", "twists"]
    for name in names:
        setattr(proof, name, getattr(proof, name)[:0])
    assert "boxes, fingers, sides, loads and friction are needed" in said(proof)


def test_sides_come_one_after_the_other() -> None:
    node = ([(0, 1, 0.0, 1.0)], (0, 0), 0, (0.0, 1.0, 0.0))
    for (first, second), good in (((0.5, 0.5), True), ((0.25, 0.5), True), ((0.5, 0.25), False)):
        sides = np.array([[0, 0, first], [0, second, 1.0]])
        found = said(planar(SHAPES[1], [[0, -1, 0]], [node], sides=sides, bound=0.5))
        assert (found == "") == good
        assert good or "side 1 does not come after the one before" in found


def test_numbers_that_overflow_are_none_to_compute_with() -> None:
    node = (everything([[0, 0, 1.0]], 1), (0, 0), 0, (0.0, 1.0, 0.0))
    proof = planar([[0, 0], [0, 0], [1, 1]], [[0, -1, 0]], [node], sides=np.array([[0, 0, 1.0]]), bound=0.5)
    assert said(proof) == "proof: its numbers are none to compute with"  # a side of no length


def test_straight_edges_in_doubles_are_those_in_rationals() -> None:
    rng = np.random.default_rng(6)
    for k in range(60):
        proof = random_planar(rng, ("normal", "force")[k % 2], "sum", 0)
        edges, edge = StraightEdges(proof), int(rng.integers(len(proof.vertices)))
        y = rng.normal(size=3)
        lo, hi = np.sort(rng.random(2))
        exact = edges.most(edge, Fraction(lo), Fraction(hi), [Fraction(x) for x in y])
        rough = edges.roughly(np.array([edge]), np.array([lo]), np.array([hi]), np.array([y], float))[0]
        assert rough == pytest.approx(float(exact), rel=1e-12, abs=1e-12)
        most = max(most_work(proof, y, *_place(proof, edge, t)) for t in (lo, hi))
        assert float(exact) == pytest.approx(most, rel=1e-5, abs=1e-9)


def _place(proof, edge: int, t: float):
    p, q = (proof.vertices[i % len(proof.vertices)] for i in (edge, edge + 1))
    return p + t * (q - p) - proof.centre_of_mass, [p[1] - q[1], q[0] - p[0]]


def test_numbers_at_the_end_of_doubles_are_no_warning(recwarn) -> None:
    node = (everything([[0, 0, 1.0]], 1), (0, 0), 0, (0.0, 1.0, 0.0))
    for far in 1e308, 1e200, 1e-200:
        sides = np.array([[0, 0, 1.0], [0, 5, 7.0], [0, 9, 12.0]])
        corners = far * np.array([[0, 0], [1, 0], [1, 1]])
        assert said(planar(corners, [[0, -1, 0]], [node], sides=sides[:1])) == ""
        found = rg.verify(planar(corners, [[0, -1, 0]], [node], sides=sides)).violations
        assert found == ("proof: side 1 is no stretch of an edge",)  # and no line for each
    assert not len(recwarn)


def test_numbers_of_other_types_are_none_to_compute_with() -> None:
    """Refused before, or in words by the check alone."""
    node = (everything([[0, 0, 1.0]], 1), (0, 0), 0, (0.0, 1.0, 0.0))
    for name, value in (
        ("arcs", np.zeros((1, 1, 2))), ("number", np.zeros(1)), ("fingers", 1.0),
        ("vertices", np.array([["a", "b"]] * 3)),
    ):  # fmt: skip
        proof = planar(SHAPES[1], [[0, -1, 0]], [node], sides=np.array([[0, 0, 1.0]]), bound=0.5)
        setattr(proof, name, value)
        assert check_proof(proof) == ["proof: its numbers are none to compute with"]
        with pytest.raises(rg.InvalidInput, match=f"{name} of a plan must be"):
            rg.verify(proof)
