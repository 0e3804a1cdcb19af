"""Boxes of several straight sides that twists of all loads exclude together, by hand; and such a proof."""

from dataclasses import replace

import numpy as np
import pytest

import regrasp as rg
from proofs import everything, planar
from regrasp.verification.placed.placements import _Checked

pytestmark = pytest.mark.oracle

SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
# the floor in two halves, as two sides
HALVES = ((0, 0, 0.5), (0, 0.5, 1.0))
LOADS = np.array([[0, -1, -0.5], [0, -1, -3.5]])
# about (2, 0), up on the side of the load: 3/2 of work each, and at x = 2 + d a finger does |d| along the one
# that lifts there: 2 at the ends, where only one of the twists counts
ABOUT = [[0, 2, -1, 0, 0], [0, -2, 1, 0, 0]]
LIMIT = (1.5 + 1.5) / 2.0
EXCLUDED = "proof: the twists of box 0 do not exclude it"


def said(proof) -> str:
    return "; ".join(rg.verify(proof).violations)


def joined(motions=ABOUT, movers=((0, 0), (0, 1)), *, sides=HALVES, **changes):
    """One finger on two sides, under two loads."""
    nodes = [(everything(sides, 1), (0, 0), 0, (0.0, 0.0, 0.0))]
    given = {"size": "force", "norm": "largest", "friction": 0.0, "sides": np.array(sides), "bound": 1.0}
    more = {"movers": np.array(movers), "motions": np.array(motions, dtype=float)}
    return planar(SQUARE, LOADS, nodes, **given | more | changes)


def test_the_limit_is_that_of_work_over_the_most_at_one_place() -> None:
    """One load alone proves 3/4: its twist does 3/2, and 2 by a finger at the end."""
    for scale in 1.0, 1e-9, 1e9:
        proof = joined(np.multiply(ABOUT, scale))
        for factor, good in (0.5, True), (1 - 1e-14, True), (1.0, False), (1 + 1e-12, False):
            proof.bound = LIMIT * factor
            assert said(proof) == ("" if good else EXCLUDED)
    for load in 0, 1:
        for bound, good in (0.7499, True), (0.7501, False):
            assert (said(joined([ABOUT[load]], [(0, load)], bound=bound)) == "") == good


def test_doubles_and_rationals_find_the_same() -> None:
    for motions in ABOUT, ABOUT[::-1], np.multiply(ABOUT, 0.9), np.multiply(ABOUT, [[1], [0.3]]):
        for times, clear in (1, True), (101, False):  # doubles lose a little of each in a sum
            judged = _Checked(joined([*motions] * times, [(0, 0), (0, 1)] * times))
            good = judged._moved(0, judged._arcs(0)) == []
            assert (judged.violations() == []) == good
            assert judged.clear.tolist() == [clear and good]


def test_each_number_counts() -> None:
    bound = LIMIT * (1 - 1e-9)
    assert said(joined(bound=bound)) == ""
    for row in range(2):
        for column, by in ((1, 1e-3), (1, -1e-3), (2, 1e-3 * (2 * row - 1)), (2, -1e-3)):
            motions = np.array(ABOUT, dtype=float)
            motions[row, column] += by
            assert said(joined(motions, bound=bound)) == EXCLUDED
    assert said(joined(bound=bound, movers=((0, 1), (0, 0)))) == EXCLUDED
    assert said(joined(bound=bound, movers=((0, 0), (0, 0)))) == EXCLUDED


def test_they_stay() -> None:
    """What moves with a finger is affine along an edge, in several stretches, too: not on several edges."""
    floor_and_wall = ((0, 0, 1.0), (1, 1, 2.0))
    assert said(joined(bound=0.1, sides=floor_and_wall)) == ""
    for column in 3, 4:
        motions = np.array(ABOUT, dtype=float)
        motions[0, column] = 1e-9
        assert said(joined(motions, bound=0.1)) == ""
        assert said(joined(motions, bound=0.1, sides=floor_and_wall)) == EXCLUDED


def test_sides_of_other_normals_count_with_their_own() -> None:
    """On the floor and the wall right of it a finger pushes up or to the left."""
    sides = ((0, 0, 1.0), (1, 1, 2.0))
    for motion, limit in (
        ([0, 1, 0, 0, 0], 1.0),  # up: 1 of work, 1 on the floor, 0 on the wall
        ([-1, 1, 0, 0, 0], 1.0),
        ([-2, 1, 0, 0, 0], 0.5),  # 2 on the wall
    ):
        for factor, good in (1 - 1e-12, True), (1 + 1e-12, False):
            proof = joined([motion], [(0, 0)], sides=sides, bound=limit * factor)
            assert (said(proof) == "") == good


def test_of_a_margin_no_force_may_be_none() -> None:
    """Forces of at most 2 that keep 0.6 from the edges of a cone of 3/4: at least 1 along the normal."""
    given = {"size": "margin", "friction": 0.75, "bound": 2.0}
    up = [[0, -1, 0, 0, 0]] * 2  # downward: the loads do 2, forces -1 each at most
    for loads, good in (((0, 0.9), True), ((0, 1.0), False), ((0, 1.1), False)):
        pushed = np.array([[*loads, 0.0], [*loads, 0.0]])  # to be taken up by forces of less than 1
        proof = joined(np.multiply(up, -1), margin=0.6, **given)
        proof.loads = -pushed
        back = joined(up, margin=0.6, **given)
        back.loads = -pushed
        assert said(proof) == EXCLUDED
        assert (said(back) == "") == good


def test_a_search_finds_them_and_each_is_needed() -> None:
    shape = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
    loads = rg.LoadSet.hull([rg.Wrench([0, -1], 0.2), rg.Wrench([0.9, 0.3]), rg.Wrench([-0.3, 1], -0.2)])
    for objective, fingers in ("force", 3), ("friction_use", 2):
        chosen = rg.choose_grasp(
            shape, fingers, loads, friction=0.4, objective=objective, max_force=3, tolerance=1e-2
        )
        proof = chosen.certificate
        assert proof.movers is not None
        assert proof.motions is not None
        boxes = np.unique(proof.movers[:, 0])
        several = boxes[(proof.arcs[boxes, :, 0] < proof.arcs[boxes, :, 1]).any(axis=1)]
        assert len(several) > 3
        assert rg.verify(type(proof).from_dict(proof.to_dict())).ok
        for box in several[:: max(len(several) // 3, 1)]:
            rows = proof.movers[:, 0] != box
            assert not rg.verify(replace(proof, movers=proof.movers[rows], motions=proof.motions[rows])).ok
            turned = np.where(rows[:, None], proof.motions, -proof.motions)
            assert not rg.verify(replace(proof, motions=turned)).ok


def test_near_the_largest_margin_what_is_asked_is_excluded_at_once() -> None:
    """The best is within 3 % of the top, sqrt(0.8) N, so that nothing there is to be proven on the way."""
    angle = np.arange(12) * np.pi / 6
    shape = rg.Outline(np.column_stack([2 * np.cos(angle), np.sin(angle)]))
    chosen = rg.choose_grasp(shape, 3, rg.Wrench([0, -1], 0.1), friction=0.5, objective="force", max_force=2)
    assert 1 < np.sqrt(0.8) / chosen.value < 1.03
    assert chosen.gap <= 1e-3
    assert rg.verify(chosen).ok
