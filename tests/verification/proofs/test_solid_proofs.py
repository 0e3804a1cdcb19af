"""Proofs about placements on meshes, made by hand: judged to the last digit, and every part counts."""

from math import inf, nan

import numpy as np
import pytest

import regrasp as rg
from proofs import Patches, limit, said_of_changes, solid, tree_changes

pytestmark = pytest.mark.oracle

# Two faces of a box and a slope of 3, 4, 5: corners and inward normals without rounding.
CORNERS = [
    [[0, 0, 0], [2, 0, 0], [2, 3, 0]], [[0, 0, 0], [2, 3, 0], [0, 3, 0]], [[0, 0, 1], [0, 2, 4], [0, 0, 4]],
    [[3, 0, 0], [3, 4, 0], [0, 0, 4]],
]  # fmt: skip
NORMALS = [[0, 0, 1.0], [0, 0, 1.0], [1.0, 0, 0], [-0.8, 0, -0.6]]
KINDS = [(size, norm) for size in ("normal", "force") for norm in ("sum", "squares", "largest")]
WORDS = (
    "box 0 must give every finger the whole", "is not covered by", "the boxes are no tree",
    "may be far enough apart", "does not exclude it", "a box has no load",
)  # fmt: skip


def said(proof) -> str:
    return "; ".join(rg.verify(proof).violations)


def random_proof(rng, size, norm, splits, **changes):
    patches = Patches.of(4, rng, halvings=int(rng.integers(3)))
    loads = rng.integers(-3, 4, size=(2, 6)) + np.array([0, 0, 0.5, 0, 0, 0])
    nodes = patches.tree(rng, int(rng.integers(1, 4)), loads, splits)
    friction = float(rng.choice([0, 0.25, 1, 3]))
    given = {"friction": friction, "size": size, "norm": norm} | changes
    proof = solid(CORNERS, NORMALS, loads, patches, nodes, **given)
    most = limit(proof, lambda box, f: patches.corners(int(proof.boxes[box][f]), CORNERS, NORMALS))
    return proof, float(most)


@pytest.mark.parametrize(("size", "norm"), KINDS)
def test_a_bound_is_proven_to_its_last_digit(size, norm) -> None:
    rng, seen = np.random.default_rng(0), 0
    for k in range(6):
        proof, most = random_proof(rng, size, norm, splits=k % 5)
        if not most > 0:
            continue
        seen += 1
        for factor, good in (
            (0.0, True), (0.999, True), (1 - 2.0**-51, True), (1 + 2.0**-51, False), (2, False),
        ):  # fmt: skip
            proof.bound = most * factor
            found = said(proof)
            assert (found == "") == good, (k, factor)
            assert good or "does not exclude it" in found
        verdict = rg.verify(proof)
        assert verdict.excluded == int((proof.children[:, 1] == 0).sum())
    assert seen > 2


def test_scales_of_twists_do_not_count() -> None:
    rng = np.random.default_rng(1)
    proof, most = random_proof(rng, "force", "squares", 2)
    assert most > 0
    kept = proof.twists
    for scale in (1e-300, 1e-145, 2.0**-400, 1e60, 2.0**400):
        for factor, good in (1 - 1e-12, True), (1 + 1e-12, False):
            proof.bound, proof.twists = most * factor, kept * scale
            assert (said(proof) == "") == good, scale


def test_every_part_of_a_tree_counts() -> None:
    rng, seen = np.random.default_rng(2), set()
    for _ in range(20):
        proof, most = random_proof(rng, "normal", "sum", splits=3, bound=1e-9)
        if most < 1e-6:
            continue
        assert said(proof) == ""
        n, k = proof.boxes.shape
        parents, box, finger, last = np.flatnonzero(proof.children[:, 1]), *rng.integers((n, k)), n - 1
        changes = [
            ("boxes", (box, finger), 1), ("boxes", (box, finger), -1), ("children", (parents[-1], 0), 1),
            *tree_changes(proof, parents, last),
        ]  # fmt: skip
        for found in said_of_changes(proof, changes, said):
            seen.update(words for words in WORDS if words in found)
    assert seen == set(WORDS)


def test_fingers_that_are_too_near_need_no_twist() -> None:
    """Triangles of 0 and 2: the farthest pair of corners is (2, 0, 0) and (0, 2, 4), or (2, 3, 0) itself."""
    none = [-1] * 3
    patches = Patches([(0, 4), (0, 1), (1, 3), (1, 1), (2, 2), (2, 1), (3, 1)],
                      [[1, 2, -1], none, [3, 4, -1], none, [5, 6, -1], none, none])  # fmt: skip
    floor, wall = 1, 5
    far = max(np.linalg.norm(np.subtract(p, q)) for p in CORNERS[0] for q in CORNERS[2])
    nodes = [([0, 0], (1, 3), 0, [0] * 6), ([1, 1], (0, 0), 0, [0] * 6), ([1, 2], (4, 2), 0, [0] * 6),
             ([2, 2], (0, 0), 0, [0] * 6), ([1, 3], (0, 0), 0, [0] * 6), ([1, 4], (6, 2), 0, [0] * 6),
             ([floor, wall], (0, 0), -1, [0] * 6), ([1, 6], (0, 0), 0, [0] * 6)]  # fmt: skip
    proof = solid(CORNERS, NORMALS, [[0, 0, -1, 0, 0, 0]], patches, nodes)
    for least, good in (far * (1 + 1e-9), True), (far * (1 - 1e-9), False):
        proof.min_distance = least
        assert said(proof) == ("" if good else "proof: fingers of box 6 may be far enough apart")


def one_triangle(halves, spans=((0, 1),), corners=CORNERS[:1], normals=NORMALS[:1], **changes):
    nodes = [([0], (0, 0), 0, [0, 0, 1.0, 0, 0, 0])]
    return solid(corners, normals, [[0, 0, -1, 0, 0, 0]], Patches(list(spans), halves), nodes, **changes)


@pytest.mark.parametrize(
    ("spans", "halves", "words"),
    [
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [-1] * 3, [-1] * 3], ""),
        ([(0, 1), (0, 1), (1, 1)], [[-1] * 3] * 3, "patch 0 must be the whole surface"),
        ([(1, 1), (0, 1), (1, 1)], [[-1] * 3] * 3, "patch 0 must be the whole surface"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [-1] * 3], "patch 0 must be the whole surface"),
        ([(0, 2), (0, 1), (1, 2)], [[1, 2, -1], [-1] * 3, [-1] * 3], "do not cover it"),
        ([(0, 2), (0, 1), (0, 1)], [[1, 2, -1], [-1] * 3, [-1] * 3], "do not cover it"),
        ([(0, 2), (1, 1), (0, 1)], [[1, 2, -1], [-1] * 3, [-1] * 3], "do not cover it"),
        ([(0, 2), (0, 2), (2, 0)], [[1, 2, -1], [-1] * 3, [-1] * 3], "patch 2 is no group of triangles"),
        ([(0, 2), (0, 0), (0, 2)], [[1, 2, -1], [-1] * 3, [-1] * 3], "patch 1 is no group of triangles"),
        ([(0, 2), (1, 1), (1, 1)], [[1, 2, -1], [-1] * 3, [-1] * 3], "do not cover it"),
        ([(0, 2), (0, 1), (1, 1)], [[3, 2, -1], [-1] * 3, [3, 4, 0], [-1] * 3, [-1] * 3], "patch 0 has no"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 3, -1], [3, 4, 0], [-1] * 3, [-1] * 3, [-1] * 3], "patch 0 has no"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [4, 3, 0], [-1] * 3, [-1] * 3, [-1] * 3], ""),
        ([(0, 1)], [[1, 2, 0], [4, 1, 0], *[[-1] * 3] * 3], "patch 1 has no"),
        ([(0, 1)], [[1, 2, 0], [1, 4, 0], *[[-1] * 3] * 3], "patch 1 has no"),
        ([(0, 2), (0, 1), (2, 1)], [[-1] * 3] * 3, "patch 2 is no group of triangles"),
        ([(0, 2), (0, 1), (1, 2)], [[-1] * 3] * 3, "patch 2 is no group of triangles"),
        ([(0, 2), (0, 1), (-1, 1)], [[-1] * 3] * 3, "patch 2 is no group of triangles"),
        ([(0, 2), (0, 1), (1, 0)], [[-1] * 3] * 3, "patch 2 is no group of triangles"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 1, -1], [-1] * 3, [-1] * 3], "patch 0 has no two halves"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 3, -1], [-1] * 3, [-1] * 3], "patch 0 has no two halves"),
        ([(0, 2), (0, 1), (1, 1)], [[0, 2, -1], [-1] * 3, [-1] * 3], "patch 0 has no two halves"),
        ([(0, 2), (0, 1), (1, 1)], [[1, -1, -1], [-1] * 3, [-1] * 3], "patch 0 has no two halves"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [-1] * 3, [-1] * 3, [-1] * 3], "patch 3 is a half of none"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [3, 4, 0], [-1] * 3, [-1] * 3, [-1] * 3], ""),
        (
            [(0, 2), (0, 1), (1, 1)],
            [[1, 2, -1], *[[3, 4, 0]] * 2, *[[-1] * 3] * 2],
            "patch 2 is another's",
        ),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [3, 4, 0], [5, 3, 0], *[[-1] * 3] * 3], "2 is another's"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [3, 4, 0], [4, 5, 0], *[[-1] * 3] * 3], "2 is another's"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [3, 4, 0], [5, 6, 0], *[[-1] * 3] * 4], ""),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [3, 4, 2], [-1] * 3, [-1] * 3, [-1] * 3], ""),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [3, 4, 3], [-1] * 3, [-1] * 3, [-1] * 3], "patch 1 has no"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [3, 4, -1], [-1] * 3, [-1] * 3, [-1] * 3], "patch 1 has no"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [2, 3, 0], [-1] * 3, [-1] * 3, [-1] * 3], "patch 1 has no"),
        ([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [3, 2, 0], [-1] * 3, [-1] * 3, [-1] * 3], "patch 1 has no"),
    ],
)
def test_patches_are_halved_so_that_nothing_is_lost(spans, halves, words) -> None:
    many = 1 if spans == [(0, 1)] else 2
    found = said(one_triangle(halves, spans, CORNERS[:many], NORMALS[:many], bound=1e-9))
    assert words in found
    assert bool(words) == bool(found)


def test_halves_of_triangles_are_where_they_are_said_to_be() -> None:
    """The work along a turn about an edge is largest at the third corner: which half has which?"""
    rng = np.random.default_rng(5)
    for edge in range(3):
        patches = Patches([(0, 1)], [[1, 2, edge], [3, 4, (edge + 1) % 3], *[[-1] * 3] * 3])
        for patch in (1, 2, 3, 4):
            corners = patches.corners(patch, CORNERS[:1], NORMALS[:1])
            for _ in range(4):
                y = [*rng.normal(size=2), 1.0, *rng.normal(size=3)]
                nodes = [([0], (1, 2), 0, y), ([1], (3, 2), 0, y), ([2], (0, 0), 0, y), ([3], (0, 0), 0, y),
                         ([4], (0, 0), 0, y)]  # fmt: skip
                if patch == 1:
                    nodes = [([0], (1, 2), 0, y), ([1], (0, 0), 0, y), ([2], (0, 0), 0, y)]
                proof = solid(CORNERS[:1], NORMALS[:1], [[0, 0, -1, 0, 0, 0]], patches, nodes)
                most = limit(
                    proof,
                    lambda b, f, p=proof, q=patches: q.corners(int(p.boxes[b][f]), CORNERS[:1], NORMALS[:1]),
                )
                if most > 0:
                    proof.bound = float(most) * (1 - 2.0**-51)
                    assert said(proof) == "", (edge, patch, corners)
                    proof.bound = float(most) * (1 + 2.0**-51)
                    assert "does not exclude" in said(proof)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"corners": np.zeros((1, 3, 2))}, "shapes"), ({"normals": np.zeros((1, 2))}, "shapes"),
        ({"loads": np.zeros((1, 3))}, "shapes"), ({"spans": np.zeros((1, 3), int)}, "shapes"),
        ({"halves": np.zeros((1, 2), int)}, "shapes"), ({"boxes": np.zeros((1, 2), int)}, "shapes"),
        ({"number": np.zeros(2, int)}, "shapes"), ({"twists": np.zeros((1, 3))}, "shapes"),
        ({"loads": np.zeros((0, 6))}, "shapes"), ({"fingers": 2}, "shapes"),
        ({"loads": np.full((1, 6), nan)}, "must be finite"),
        ({"twists": np.full((1, 6), inf)}, "must be finite"),
        ({"corners": np.full((1, 3, 3), nan)}, "must be finite"), ({"bound": nan}, "must be finite"),
        ({"loads": np.array([[0, 0, -1.0, 0, nan, 0]])}, "must be finite"),
        ({"twists": np.array([[0, 0, 1.0, 0, nan, 0]])}, "must be finite"),
        ({"normals": np.array([[0, nan, 1.0]])}, "must be finite"),
        ({"bound": inf}, "must be finite"), ({"friction": -1e-300}, "friction 0 or more"),
        ({"friction": inf}, "friction 0 or more"), ({"friction": nan}, "friction 0 or more"),
        ({"size": "x"}, "no meaning"), ({"norm": "x"}, "no meaning"),
        ({"min_distance": -1e-300}, "must be 0 or more"), ({"min_distance": inf}, "must be 0 or more"),
        ({"min_distance": nan}, "must be 0 or more"), ({"bound": -1e-300}, "must be 0 or more"),
        ({"normals": np.array([[0, 0, 1 + 2e-12]])}, "of length 1"),
        ({"normals": np.array([[0, 0, 1 - 2e-12]])}, "of length 1"),
        ({"boxes": np.zeros((1, 0), int), "fingers": 0}, "shapes"),
        ({"boxes": np.zeros((0, 1), int), "children": np.zeros((0, 2), int), "number": np.zeros(0, int),
          "twists": np.zeros((0, 6))}, "shapes"),
        ({"spans": np.zeros((0, 2), int)}, "patch 0 must be the whole"),
        ({"corners": np.zeros((0, 3, 3)), "normals": np.zeros((0, 3))}, "whole surface"),
        ({"boxes": np.array([[1]])}, "box 0 must give"), ({"boxes": np.array([[-1]])}, "box 0 must give"),
    ],
)  # fmt: skip
def test_proofs_of_no_form(changes, words) -> None:
    proof = one_triangle([[-1] * 3], bound=0.5)
    assert said(proof) == ""
    for name, value in changes.items():
        setattr(proof, name, value)
    assert words in said(proof)


def test_children_share_out_fingers_of_one_patch() -> None:
    patches = Patches([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [-1] * 3, [-1] * 3])

    def told(*inside, fingers=2) -> str:
        twist = [0, 0, 1.0, 0, 0, 0]
        nodes = [([0] * fingers, (1, len(inside)), 0, twist)]
        nodes += [(list(some), (0, 0), 0, twist) for some in inside]
        load = [[0, 0, -1, 0, 0, 0]]
        return said(solid(CORNERS[:2], NORMALS[:2], load, patches, nodes, bound=1e-9))

    assert told((1, 1), (1, 2), (2, 2)) == ""
    assert told((1, 0), (2, 0)) == ""  # one of two alike: the other is still anywhere
    assert told((1, 1, 1), (1, 1, 2), (1, 2, 2), (2, 2, 2), fingers=3) == ""
    for wrong in (
        [(1, 1), (2, 2)], [(2, 2), (1, 2), (1, 1)], [(1, 1), (2, 1), (2, 2)], [(1, 1), (1, 2), (1, 2)],
        [(1, 1), (1, 1), (2, 2)], [(1, 0), (2, 0), (2, 0)], [(0, 0)] * 3, [(1, 1)], [(0, 0)],
        [(1, 1), (1, 2), (2, 0)], [(0, 1), (1, 2), (2, 2)],
    ):  # fmt: skip
        assert "is not covered by the boxes it is split into" in told(*wrong), wrong


def test_boxes_that_are_not_there_take_no_memory() -> None:
    patches = Patches([(0, 2), (0, 1), (1, 1)], [[1, 2, -1], [-1] * 3, [-1] * 3])
    for first, count in (
        (1, 10**10), (1, 2**62), (2**62, 2**62), (10**12, 2), (1, -3), (0, 4), (-1, 5), (-(2**62), 3),
    ):  # fmt: skip
        nodes = [([0, 0], (first, count), 0, [0.0] * 6)]
        nodes += [(list(some), (0, 0), 0, [0.0] * 6) for some in ((1, 1), (1, 2), (2, 2))]
        proof = solid(CORNERS[:2], NORMALS[:2], [[0, 0, -1, 0, 0, 0]], patches, nodes)
        assert said(proof) == "proof: the boxes are no tree", (first, count)


def test_boxes_are_of_patches_that_are_there() -> None:
    rng, seen = np.random.default_rng(4), 0
    while seen < 3:
        proof, most = random_proof(rng, "normal", "sum", splits=1, bound=1e-9)
        if most < 1e-6 or len(proof.boxes) < 2:
            continue
        seen += 1
        for patch in (-1, len(proof.halves), 10**6):
            proof.boxes[-1, -1] = patch
            assert "all boxes patches" in said(proof)
