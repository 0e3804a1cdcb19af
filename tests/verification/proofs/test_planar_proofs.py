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
    said_of_changes,
    tree_changes,
)  # fmt: skip
from regrasp.verification.placed.straight import StraightEdges

pytestmark = pytest.mark.oracle

KINDS = [(size, norm) for size in ("normal", "force") for norm in ("sum", "squares", "largest")]


WORDS = (
    "box 0 must give every finger the whole", "is not covered by", "is split into boxes that are not there",
    "some boxes belong to no other", "may be far enough apart", "does not exclude it", "has no load",
)  # fmt: skip


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


def test_every_part_of_a_tree_counts() -> None:
    rng = np.random.default_rng(3)
    seen = set()
    for _ in range(30):
        proof = random_planar(rng, "normal", "sum", splits=3, bound=1e-9)
        if proven(proof) < 1e-6:
            continue
        assert said(proof) == ""
        parents = np.flatnonzero(proof.children[:, 1])
        n, k = len(proof.children), proof.fingers
        box, finger = int(rng.integers(n)), int(rng.integers(k))
        last = n - 1
        changes = [
            ("ends", (box, finger, 0), 1e-9), ("ends", (box, finger, 1), -1e-9),
            ("arcs", (box, finger, 1), 1), ("arcs", (box, finger, 0), -1),
            *tree_changes(proof, parents, last),
        ]  # fmt: skip
        for found in said_of_changes(proof, changes, said):
            seen.update(words for words in WORDS if words in found)
    assert seen == set(WORDS)


def test_children_share_out_fingers_of_one_arc() -> None:
    """Two fingers on two sides: left and left, left and right, right and right; nothing else is a cover."""
    vertices, sides = SHAPES[1], np.array([[0, 0, 1.0], [2, 2, 3.0]])
    left, right = (0, 0, 0.0, 1.0), (1, 1, 2.0, 3.0)
    root, twist = everything(sides, 2), (0.0, 1.0, 0.0)

    def told(*inside) -> str:
        nodes = [(root, (1, len(inside)), 0, twist)]
        nodes += [(list(arcs), (0, 0), 0, twist) for arcs in inside]
        return said(planar(vertices, [[0, -1, 0]], nodes, sides=sides, bound=1e-9))

    assert told((left, left), (left, right), (right, right)) == ""
    for wrong in (
        [(left, left), (right, right)],
        [(left, left), (right, left), (right, right)],
        [(right, right), (left, right), (left, left)],
        [(left, left), (left, right), (left, right)],
        [(left, left), (left, left), (right, right)],
        [(left, left), (left, right), (right, right), (right, right)],
        [(left, root[1]), (right, root[1]), (right, root[1])],
        [(root[0], root[1])] * 3,
        [(left, left)],
    ):
        assert "is not covered by the boxes it is split into" in told(*wrong), wrong
    assert told((left, root[1]), (right, root[1])) == ""  # one of two alike: the other is still anywhere
    empty, all_again = (0, -1, 0.0, 3.0), (0, 1, 0.0, 3.0)  # before the first side
    nodes = [
        (everything(sides, 1), (1, 2), 0, twist),
        ([empty], (0, 0), 0, twist),
        ([all_again], (0, 0), 0, twist),
    ]
    assert "is not covered" in said(planar(vertices, [[0, -1, 0]], nodes, sides=sides, bound=1e-9))
    short = (0, 0, 0.0, 0.5)
    for a, b in ((short, right), (left, (1, 1, 2.25, 3.0)), ((0, 1, 0.0, 3.0), right), (left, left)):
        assert "is not covered" in told((a, a), (a, b), (b, b))


def test_fingers_on_different_arcs_are_not_shared_out_together() -> None:
    sides = np.array([[0, 0, 1.0], [1, 1, 2.0], [2, 2, 3.0]])
    root, left = everything(sides, 2), (0, 1, 0.0, 2.0)
    right, a, b = (2, 2, 2.0, 3.0), (0, 0, 0.0, 1.0), (1, 1, 1.0, 2.0)

    def told(whole, *inside) -> str:
        parts = [(left, left), (left, right), (right, right)]
        at = parts.index(whole)
        nodes = [(root, (1, 3), 0, (0.0, 1.0, 0.0))]
        nodes += [
            (p, (4, len(inside)) if k == at else (0, 0), 0, (0.0, 1.0, 0.0)) for k, p in enumerate(parts)
        ]
        nodes += [(p, (0, 0), 0, (0.0, 1.0, 0.0)) for p in inside]
        return said(planar(SHAPES[1], [[0, -1, 0]], nodes, sides=sides))

    assert told((left, right), (a, right), (b, right)) == ""
    assert told((left, left), (a, a), (a, b), (b, b)) == ""
    assert "is not covered" in told((left, right), (a, a), (a, b), (b, b))
    assert "is not covered" in told((left, right), (a, right), (a, right))
    assert "is not covered" in told((left, left), (left, left))


def test_arcs_go_on_with_the_next_side() -> None:
    sides, twist = np.array([[0, 0, 1.0], [1, 1, 2.0], [2, 2, 3.0]]), (0.0, 1.0, 0.0)
    for left, right, good in (
        ((0, 0, 0.0, 1.0), (1, 2, 1.0, 3.0), True), ((0, 1, 0.0, 2.0), (2, 2, 2.0, 3.0), True),
        ((0, 0, 0.0, 1.0), (2, 2, 1.0, 3.0), False), ((0, 0, 0.0, 1.0), (2, 2, 2.0, 3.0), False),
        ((0, 0, 0.0, 1.0), (1, 2, 1.5, 3.0), False), ((0, 0, 0.0, 0.5), (1, 2, 1.0, 3.0), False),
        ((0, 1, 0.0, 1.0), (2, 2, 2.0, 3.0), False), ((0, 2, 0.0, 3.0), (2, 2, 2.0, 3.0), False),
        ((0, 0, 0.5, 1.0), (1, 2, 1.0, 3.0), False), ((0, 0, 0.0, 1.0), (1, 2, 1.0, 2.5), False),
        ((1, 1, 0.0, 2.0), (2, 2, 2.0, 3.0), False), ((0, 0, 0.0, 1.0), (1, 1, 1.0, 3.0), False),
    ):  # fmt: skip
        nodes = [(everything(sides, 1), (1, 2), 0, twist), *(([x], (0, 0), 0, twist) for x in (left, right))]
        found = said(planar(SHAPES[1], [[0, -1, 0]], nodes, sides=sides))
        assert (found == "") == good, (left, right)
    for first in -1, -2, 0, 2:  # the last boxes again, box 0, or beyond all
        nodes[0] = (everything(sides, 1), (first, 2), 0, twist)
        assert "boxes that are not there" in said(planar(SHAPES[1], [[0, -1, 0]], nodes, sides=sides))


def test_halves_of_one_side_meet() -> None:
    vertices, sides, twist = SHAPES[1], np.array([[0, 0, 1.0]]), (0.0, 1.0, 0.0)
    for (a, b), good in (
        ((0.5, 0.5), True), ((0.25, 0.25), True), ((0.5, 0.625), False), ((0.625, 0.5), False),
        ((0.0, 0.0), False), ((1.0, 1.0), False),
    ):  # fmt: skip
        nodes = [(everything(sides, 1), (1, 2), 0, twist)]
        nodes += [([(0, 0, 0.0, a)], (0, 0), 0, twist), ([(0, 0, b, 1.0)], (0, 0), 0, twist)]
        found = said(planar(vertices, [[0, -1, 0]], nodes, sides=sides, bound=1e-9))
        assert (found == "") == good, (a, b)


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
        ({"pairs": np.zeros((0, 2), dtype=int), "seconds": np.zeros((0, 3))}, "a largest force and straight"),
        ({"sides": np.array([[3, 3, 4.0]])}, "side 0 is no stretch"),
        ({"sides": np.array([[-1, -1, 0.0]])}, "side 0 is no stretch"),
        ({"sides": np.array([[0, -0.25, 1.0]])}, "side 0 is no stretch"),
        ({"sides": np.array([[0, 0.0, 1.25]])}, "side 0 is no stretch"),
        ({"sides": np.array([[0, 0.5, 0.5]])}, "side 0 is no stretch"),
        ({"sides": np.array([[0, 0.75, 0.5]])}, "side 0 is no stretch"),
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
    assert "none to compute with" in said(proof)  # a side of no length


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
