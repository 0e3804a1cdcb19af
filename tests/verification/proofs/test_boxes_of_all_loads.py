"""Boxes that all loads exclude together, forces tied by equal stiffness, by hand."""

import numpy as np
import pytest

import regrasp as rg
from proofs import everything, planar
from regrasp.verification.placed import placements

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


def test_every_edge_of_an_arc_counts() -> None:
    """Along (-2, 1) a force of 1 does 3 / sqrt(2) on the floor, and sqrt(5) on the wall, inside its cone."""
    floor, wall = [0, 0, 1.0], [1, 1.0, 2.0]
    for sides, limit in ([floor], 2**0.5 / 3), ([wall], 5**-0.5), ([floor, wall], 5**-0.5):
        given = {"size": "force", "norm": "largest", "friction": 1.0, "sides": np.array(sides)}
        for fingers in 1, 2:
            nodes = [(everything(given["sides"], fingers), (0, 0), -2, UP)]
            proof = planar(SQUARE, [DOWN, DOWN], nodes, **given)
            proof.tied = np.array([[-2, 1, 0, -2, 1, 0] + [0] * (fingers - 1)], dtype=float)
            for factor, good in (1 - 1e-12, True), (1 - 1e-15, True), (1 + 1e-14, False), (2, False):
                proof.bound = limit / fingers * factor
                found = "" if good else "proof: the duals of box 0 do not exclude it"
                assert said(proof) == found, (sides, fingers, factor)


def test_boxes_of_many_corners_are_not_judged() -> None:
    for count in 32, 33:
        at = np.linspace(0, 1, count + 1)
        sides = np.column_stack([np.zeros(count), at[:-1], at[1:]])
        node = (everything(sides, 2), (0, 0), -2, UP)
        proof = planar(SQUARE, [DOWN, DOWN], [node], size="force", norm="largest", sides=sides, bound=0.1)
        proof.tied = np.array([[*UP, *UP, 0.0]])
        many = "proof: box 0 has more than 4096 corners, too many for duals of all loads"
        assert said(proof) == ("" if count == 32 else many)


def test_boxes_of_many_loads_are_refused_before_they_take_memory(monkeypatch) -> None:
    proof = tied([[*UP, *UP, 0.0]], bound=0.1)  # two loads at four corners
    assert "at corners" not in said(proof)
    monkeypatch.setattr(placements, "MOST_AT_CORNERS", 7)
    assert said(proof) == "proof: box 0 has more than 7 loads at corners, too many for duals of all loads"


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


def eighth(lo: float, hi: float, i: int) -> list[np.ndarray]:
    """Unit tangents d(a, a), d(a, b) and d(b, b) of a part of the curve from lo to hi."""
    a, b = (lo + (hi - lo) * n / 8 for n in (i, i + 1))
    (p, q, r), found = np.array(TURNS, dtype=float), []
    for s, t in (a, a), (a, b), (b, b):
        v = (1 - t) * ((1 - s) * p + s * q) + t * ((1 - s) * q + s * r)
        found.append(v / np.hypot(*v))
    return found


def test_rows_of_all_loads_on_a_curve() -> None:
    """Edge 1 turns from (1, 0) by (4, 3) to (3, 4); eighths of a stretch are bounded by their own normals."""
    curve = np.cumsum([(4, 0), *TURNS], axis=0).astype(float)
    other = [curve[0], curve[0], curve[0], curve[0]]
    for *half, v in (
        (1, 1.0, 1.5, (-4, 3)),
        (1, 1.5, 2.0, (-3, 4)),
        (1, 1.0, 2.0, (-4, 3)),
        (1, 1.5, 2.0, (-4, 3)),
    ):
        sides = np.array([half])
        node = (everything(sides, 1), (0, 0), -2, UP)
        control = np.array([other, curve])
        proof = planar(control[:, 0], [(4.0, -3, 0)], [node], sides=sides, control=control)
        proof.size, proof.norm, proof.friction, proof.tied = "force", "largest", 0.0, np.array([[*v, 0.0]])
        normals = [(-y, x) for i in range(8) for x, y in eighth(half[1] - 1, half[2] - 1, i)]
        most = max(x * v[0] + y * v[1] for x, y in normals)
        limit = (3 * v[1] - 4 * v[0]) / most  # no v is between two normals of a part
        for factor, good in (1 - 1e-12, True), (1 + 1e-12, False):
            proof.bound = limit * factor
            assert (said(proof) == "") == good, (half, v)
