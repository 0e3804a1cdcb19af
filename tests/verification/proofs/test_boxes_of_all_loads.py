"""Boxes that all loads exclude together, forces tied by equal stiffness, by hand."""

import numpy as np
import pytest

import regrasp as rg
from proofs import everything, planar

pytestmark = pytest.mark.oracle

UP, DOWN = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)
SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
TURNS = [(1, 0), (4, 3), (3, 4)]


def said(proof) -> str:
    return "; ".join(rg.verify(proof).violations)


def tied(rows, *, numbers=(-2,), fingers=2, **changes):
    """Fingers on the floor that answer two loads of 1 by equal stiffness; more numbers are of parts."""
    sides = np.array([[0, 0, 1.0]])
    (arc,) = everything(sides, 1)
    nodes = [([arc] * fingers, (0, 0), numbers[0], UP)]
    if len(numbers) == 2:
        parts = (0, 0, 0.0, 0.5), (0, 0, 0.5, 1.0)
        nodes = [([arc], (1, 2), 0, UP)]
        nodes += [([part], (0, 0), number, UP) for part, number in zip(parts, numbers, strict=True)]
    given = {"size": "force", "norm": "largest", "friction": 1.0, "sides": sides}
    return planar(SQUARE, [DOWN, DOWN], nodes, **given | {"tied": np.array(rows, dtype=float)} | changes)


@pytest.mark.parametrize(
    ("row", "limit"),
    [
        ([*UP, *UP, 0], 1 / 2),  # 2 of work, 4 by forces of 1
        ([0, 2, 0, *UP, 0], 1 / 2),
        ([*DOWN, 0, 2, 0, 0], 1 / 4),
        ([*UP, *UP, 3 / 16], 2 / 5),  # along (+-3/4, 1) where they are farthest apart
        ([*UP, *UP, 1 / 2], 2**0.5 / 6),  # along (+-2, 1), beyond the cones
        ([0, 0, 0, *UP, 3 / 16], 1 / (2.5 + 0.75 * 2**0.5)),
    ],
)
def test_loads_together_prove_a_bound_to_its_last_digits(row, limit) -> None:
    for scale in 1.0, 1e-9:
        proof = tied([np.multiply(row, scale)])
        for factor, good in (0, True), (-1, True), (1 - 1e-14, True), (1 + 1e-14, False), (2, False):
            proof.bound = limit * factor
            assert said(proof) == ("" if good else "proof: the duals of box 0 do not exclude it")


def test_bounds_that_are_just_reached_are_proven() -> None:
    """Along (4, 1), beyond cones of 3/4, a force of 1 does 16/5: 4 of them 64/5, for 2 of work."""
    for bound, good in (5 / 32, True), (5 / 32 + 2.0**-54, False):
        found = said(tied([[4, 1, 0, 4, 1, 0, 0]], friction=0.75, bound=bound))
        assert found == ("" if good else "proof: the duals of box 0 do not exclude it")


def test_duals_without_work_exclude_nothing() -> None:
    for row, bound, good in (
        (np.zeros(7), 1e-300, False), (np.zeros(7), 0.0, True), ([*DOWN, *DOWN, 0], 1e-300, False),
        ([*DOWN, *DOWN, 0], 0.0, True), ([1, 0, 0, 1, 0, 0, 0], 1e-300, False),
    ):  # fmt: skip
        assert (said(tied([row], bound=bound)) == "") == good


def test_rows_of_all_loads_are_those_of_their_boxes() -> None:
    good, worse = [*UP, *UP], [0, -1, 0, *UP]
    for rows, numbers, words in (
        ([good, worse], (-2, -2), ""), ([worse, good], (-3, -3), ""), ([good, good], (-2, -3), ""),
        ([worse, good], (-2, -3), "duals of box 1 do"), ([worse, good], (-3, -2), "duals of box 2 do"),
        ([good], (-2, -3), "box 2 has no load"), ([good], (-3, -2), "box 1 has no load"),
        ([good], (-2, 0), ""), ([worse], (0, 1), ""), ([good], (-2, 2), "box 2 has no load"),
        ([good], (-2, -1), "box 2 may be far enough"),
    ):  # fmt: skip
        found = said(tied(rows, numbers=numbers, bound=0.999))
        assert words in found
        assert bool(words) == bool(found), (numbers, found)
    assert "box 0 has no load" in said(tied([], tied=None, bound=0.5))
    assert said(tied([[*UP, *UP, 0]], numbers=(0,), bound=0.49)) == ""


def test_rows_of_all_loads_are_of_one_side_each() -> None:
    sides = np.array([[0, 0, 0.5], [0, 0.5, 1.0]])
    node = (everything(sides, 1), (0, 0), -2, UP)
    proof = planar(SQUARE, [DOWN, DOWN], [node], size="force", norm="largest", sides=sides, bound=1e-9)
    proof.tied = np.array([[*UP, *UP]])
    assert said(proof) == "proof: a finger of box 0 has more than one side"
    root, low, high = everything(sides, 2), (0, 0, 0.0, 0.5), (1, 1, 0.5, 1.0)
    nodes = [(root, (1, 2), 0, UP), ([low, root[1]], (0, 0), -2, UP), ([high, root[1]], (0, 0), 0, UP)]
    proof = planar(SQUARE, [DOWN, DOWN], nodes, size="force", norm="largest", sides=sides, bound=1e-9)
    proof.tied = np.array([[*UP, *UP, 0.0]])
    assert said(proof) == "proof: a finger of box 1 has more than one side"


@pytest.mark.parametrize(
    ("columns", "fingers", "loads"), [(6, 1, 2), (3, 1, 1), (7, 2, 2), (3, 2, 1), (11, 2, 3), (12, 3, 2)]
)
def test_rows_have_twists_of_loads_and_ties_of_all_but_one(columns, fingers, loads) -> None:
    for count in columns - 1, columns, columns + 1:
        proof = tied([np.zeros(count)], numbers=(0,), fingers=fingers, bound=0.1)
        proof.loads = np.array([DOWN] * loads)
        assert (said(proof) == "") == (count == columns)
        assert count == columns or f"tied must have shape (1, {columns})" in said(proof)
    for changes in {"size": "normal"}, {"norm": "sum"}, {"size": "normal", "norm": "sum"}:
        assert "tied for a largest force alone" in said(tied([[*UP, *UP, 0]], **changes))


def test_rows_of_all_loads_on_a_curve() -> None:
    """Edge 1 turns from (1, 0) by (6, 5) to (3, 4); half of it is bounded by its own normals."""
    curve = np.cumsum([(4, 0), *TURNS], axis=0).astype(float)
    other = [curve[0], curve[0], curve[0], curve[0]]
    for half, v, limit in (
        ((1, 1.0, 1.5), (-4, 3), 25 * 61**0.5 / 38), ((1, 1.5, 2.0), (-3, 4), 24 * 61**0.5 / 39),
        ((1, 1.0, 2.0), (-4, 3), 5.0), ((1, 1.5, 2.0), (-4, 3), 5.0),
    ):  # fmt: skip
        sides = np.array([half])
        node = (everything(sides, 1), (0, 0), -2, UP)
        control = np.array([other, curve])
        proof = planar(control[:, 0], [(4.0, -3, 0)], [node], sides=sides, control=control)
        proof.size, proof.norm, proof.friction, proof.tied = "force", "largest", 0.0, np.array([[*v, 0.0]])
        for factor, good in (1 - 1e-12, True), (1 + 1e-12, False):
            proof.bound = limit * factor
            assert (said(proof) == "") == good, (half, v)
