"""Trees of boxes on outlines: every part counts, and what they are split into covers them."""

import numpy as np
import pytest

import regrasp as rg
from proofs import (
    SHAPES,
    everything,
    limit,
    planar,
    planar_points,
    random_planar,
    said_of_changes,
    tree_changes,
)

pytestmark = pytest.mark.oracle

WORDS = (
    "box 0 must give every finger the whole", "is not covered by", "is split into boxes that are not there",
    "some boxes belong to no other", "may be far enough apart", "does not exclude it", "has no load",
)  # fmt: skip


def said(proof) -> str:
    return "; ".join(rg.verify(proof).violations)


def test_every_part_of_a_tree_counts() -> None:
    rng = np.random.default_rng(3)
    seen = set()
    for _ in range(30):
        proof = random_planar(rng, "normal", "sum", splits=3, bound=1e-9)
        if limit(proof, planar_points(proof)) < 1e-6:
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


def test_parts_that_are_no_arcs_are_no_cover() -> None:
    """Their numbers match, and one of them goes on beyond its end or begins before its beginning."""
    sides, twist = np.array([[0, 0, 1.0], [1, 1, 2.0], [2, 2, 3.0]]), (0.0, 1.0, 0.0)
    for halves, part, inside, good in (
        (1, 0, [(0, 1, 0.0, 2.0), (2, 1, 2.0, 2.0)], False),
        (1, 0, [(0, 0, 0.0, 1.0), (1, 1, 1.0, 2.0)], True),
        (0, 1, [(1, 0, 1.0, 1.0), (1, 2, 1.0, 3.0)], False),
        (0, 1, [(1, 1, 1.0, 2.0), (2, 2, 2.0, 3.0)], True),
        (1, 1, [(2, 1, 2.0, 2.5), (2, 2, 2.5, 3.0)], False),
        (1, 1, [(2, 2, 2.0, 2.5), (1, 2, 2.5, 3.0)], False),
        (0, 0, [(0, 1, 0.0, 0.5), (0, 0, 0.5, 1.0)], False),
        (0, 0, [(0, 0, 0.0, 0.5), (1, 0, 0.5, 1.0)], False),
        (0, 0, [(0, 0, 0.0, 0.5), (0, 0, 0.5, 1.0)], True),
    ):  # fmt: skip
        cut = halves + 1.0
        nodes = [(everything(sides, 1), (1, 2), 0, twist)]
        nodes += [
            ([(0, halves, 0.0, cut)], (0, 0), 0, twist),
            ([(halves + 1, 2, cut, 3.0)], (0, 0), 0, twist),
        ]
        nodes[1 + part] = (nodes[1 + part][0], (3, 2), 0, twist)
        nodes += [([x], (0, 0), 0, twist) for x in inside]
        words = "" if good else f"proof: box {1 + part} is not covered by the boxes it is split into"
        assert said(planar(SHAPES[1], [[0, -1, 0]], nodes, sides=sides)) == words


def test_a_finger_that_stays_is_where_it_was_in_every_part() -> None:
    sides = np.array([[0, 0, 1.0], [2, 2, 3.0]])
    left, right = (0, 0, 0.0, 1.0), (1, 1, 2.0, 3.0)
    root = everything(sides, 2)
    for last, good in (root[1], True), (right, False), (left, False):
        nodes = [(root, (1, 2), 0, (0.0, 1.0, 0.0)), ([left, root[1]], (0, 0), 0, (0.0, 1.0, 0.0))]
        nodes += [([right, last], (0, 0), 0, (0.0, 1.0, 0.0))]
        assert (said(planar(SHAPES[1], [[0, -1, 0]], nodes, sides=sides)) == "") == good


def test_boxes_of_no_other_are_found() -> None:
    sides, twist = np.array([[0, 0, 1.0]]), (0.0, 1.0, 0.0)
    nodes = [(everything(sides, 1), (0, 0), 0, twist)] * 2
    assert said(planar(SHAPES[1], [[0, -1, 0]], nodes, sides=sides)) == "proof: some boxes belong to no other"
    for children in (0, 1), (0, 2), (1, -1), (1, 2), (1, 2**40), (-1, 1), (2, 1):
        nodes[0] = (*nodes[0][:1], children, *nodes[0][2:])
        words = "is not covered" if children == (1, -1) else "boxes that are not there, or not its own"
        assert words in said(planar(SHAPES[1], [[0, -1, 0]], nodes, sides=sides))


def test_the_first_box_that_is_not_excluded_says_enough() -> None:
    """What is touched may leave thousands of boxes open, each to be judged in rationals."""
    rng, seen = np.random.default_rng(9), 0
    while seen < 3:
        proof = random_planar(rng, "normal", "sum", splits=3, bound=1e-9)
        proof.twists = -proof.twists
        if (proof.children[:, 1] == 0).sum() < 3:
            continue
        seen += 1
        assert len(rg.verify(proof).violations) == 1
        assert "does not exclude it" in said(proof)
