"""What forces within limits do at most, in numbers of right triangles, and doubles beside rationals."""

from fractions import Fraction

import numpy as np
import pytest

from proofs import bent, everything, planar
from regrasp.verification.placed import placements
from regrasp.verification.placed.clear_boxes import clear_boxes
from regrasp.verification.placed.cubic import CubicEdges
from regrasp.verification.placed.forces.limited import (
    most_less_half_square,
    most_work,
    others_limits,
    roughly_excluded,
)
from regrasp.verification.placed.groups import Groups
from regrasp.verification.placed.straight import StraightEdges
from regrasp.verification.placed.whole_sets import ties_of, works

pytestmark = pytest.mark.oracle

SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])


def exactly(of, *numbers):
    return of(*(None if x is None else Fraction(x) for x in numbers))


@pytest.mark.parametrize(
    ("a", "c", "mu", "least", "cap", "limit", "most"),
    [
        (4, 3, 1, 0, None, 2, 10), (4, 3, "5/12", 0, None, 2, "126/13"), (4, 3, 1, 0, 1, 2, 7),
        (4, 3, 1, "12/5", None, "5/2", "117/10"), (-4, 3, 1, 2, 9, "5/2", "-7/2"), (4, 3, 1, 0, 5, None, 35),
        (-4, 3, 1, 2, 9, None, -2), (0, 0, 1, 1, 2, 3, 0),
    ],
)  # fmt: skip
def test_the_most_work(a, c, mu, least, cap, limit, most) -> None:
    found = exactly(most_work, a, c, mu, least, cap, limit)
    assert 0 <= found - Fraction(most) < 1e-20


@pytest.mark.parametrize(
    ("a", "c", "mu", "least", "limit", "most"),
    [
        (4, 3, 1, 0, 9, "25/2"), (4, 3, 1, 0, 2, 8), (0, 5, "3/4", 0, 9, "9/2"),
        (0, 5, "3/4", 3, 9, "135/32"), (0, 5, "3/4", "5/2", 9, "575/128"),
        (0, 5, "3/4", 0, 2, 4), (-4, 3, 1, 2, "5/2", "-53/8"),
    ],
)  # fmt: skip
def test_the_most_less_half_the_square(a, c, mu, least, limit, most) -> None:
    found = exactly(most_less_half_square, a, c, mu, least, limit)
    assert 0 <= found - Fraction(most) < 1e-20


@pytest.mark.parametrize("least", [0.0, 4.0])
@pytest.mark.parametrize(("norm", "more"), [("largest", 0.0), ("sum", 3.0), ("squares", 4.5)])
def test_doubt_of_two_fingers_within_limits(norm, more, least) -> None:
    node = (everything([[0, 0, 1.0]], 2), (0, 0), 0, (0, 1.0, 0))
    size = "normal" if norm == "sum" else "force"
    proof = planar(
        SQUARE, [(0, -1, 0)], [node], size=size, norm=norm, bound=3.0, min_normal=least, max_force=9.0
    )
    room = 1e-3 * 2 * max(3, least) * 1.5
    for factor, good in (1 - 1e-9, False), (1 + 1e-9, True):
        work = np.array([more + (room + 1e-13 * {"sum": 3, "squares": 9, "largest": 0}[norm]) * factor])
        asked = {"sum": 1, "squares": 1, "largest": 0}[norm]

        def most(of, asked=asked, told=[0]) -> np.ndarray:  # noqa: B006
            told[0] += 1  # what only limits allow at first is out of reach
            return np.full((1, 2), 1e9 if asked and told[0] == 1 else 0.0)

        assert roughly_excluded(proof, work, np.array([1e-3]), most).tolist() == [good]


def test_limits_that_a_proof_counts_on_are_asked_for() -> None:
    node = (everything([[0, 0, 1.0]], 1), (0, 0), 0, (0, 1.0, 0))
    proof = planar(SQUARE, [(0, -1, 0)], [node])
    asked = planar(SQUARE, [(0, -1, 0)], [node], max_force=2.0, min_normal=0.5)
    for largest, least, good in (None, 0.0, True), (2.0, 0.5, True), (1.9, 0.5, False), (2.0, 0.6, False):
        proof.max_force, proof.min_normal = largest, least
        assert (others_limits(asked, proof, False) == []) == good
        assert (others_limits(asked, proof, True) == []) == (largest is None)


def test_twists_of_groups_of_sides_by_any_length(monkeypatch) -> None:
    sides = np.array([[0, 0, 0.5], [0, 0.5, 1.0]])
    node = (everything(sides, 1), (0, 0), 0, (0, 0, 0))
    for speed in 0.5, 2.0:
        for work, good in (1 - 1e-9, False), (1 + 1e-9, True):
            proof = planar(SQUARE, [(0.25, -work, 0)], [node], size="force", norm="largest", sides=sides)
            proof.friction, proof.bound = 0.0, 1.0
            proof.movers, proof.motions = np.array([[0, 0]]), np.array([[0, speed, 0, 0, 0]])
            assert clear_boxes(proof, StraightEdges(proof)).tolist() == [good]
            with monkeypatch.context() as alone:
                alone.setattr(placements, "is_plain", lambda *_: False)
                assert (placements.check_proof(proof) == []) == good


@pytest.mark.parametrize(("fingers", "curved"), [(2, False), (3, False), (2, True)])
def test_doubles_judge_all_loads_as_rationals_do(fingers, curved) -> None:
    rng = np.random.default_rng(fingers)
    for friction in (0.5,) if curved else (0.0, 0.5, 4.0):
        node = (everything([[0, 0, 1.0]], fingers), (0, 0), -2, (0, 0, 0))
        loads = rng.normal(size=(3, 3))
        proof = planar(SQUARE, loads, [node], size="force", norm="largest", friction=friction)
        proof.centre_of_mass = np.array([1.5, 2.25])
        if curved:
            proof.control = bent(SQUARE)
            proof.control[:, 1:3] += 0.2 * rng.normal(size=(4, 2, 2))
        edges = CubicEdges(proof) if curved else StraightEdges(proof)
        groups = Groups(proof, edges)
        on = [(int(e), Fraction(1, 4), Fraction(3, 8)) for e in rng.integers(4, size=fingers)]
        hulls = [edges.hull(*at) for at in on]
        row = np.append(-loads, 0.1 * rng.normal(size=2 * ties_of(fingers)))
        work, done = works(row.tolist(), loads.tolist(), hulls, lambda i, u: edges.most_along(*on[i], [u]))  # noqa: B023
        for factor, good in (1 - 1e-9, True), (1 + 1e-9, False):
            proof.bound = float(work / done) * factor
            groups.bound = Fraction(proof.bound)
            assert groups._roughly(row, [[at] for at in on])[0] == good
            assert groups._holds(row.tolist(), on, hulls) == good


@pytest.mark.parametrize(("fingers", "cuts"), [(1, 8), (2, 8), (3, 4), (4, 2), (5, 1)])
def test_stretches_of_curves_are_cut_while_corners_are_few(fingers, cuts) -> None:
    """4 points each: 64 corners of three fingers, 64 times as many with four parts of each."""
    control = np.array([[[0.0, 0], [1, 0], [2, 0.5], [3, 1.5]]])
    node = (everything([[0, 0, 1.0]], fingers), (0, 0), -2, (0, 0, 0))
    proof = planar(control[:, 0], [(0, -1, 0)], [node], control=control)
    groups = Groups(proof, CubicEdges(proof))
    stretch = (0, Fraction(0), Fraction(1))
    parts = groups._cut(stretch, [[stretch]] * fingers)
    assert parts == [(0, Fraction(i, cuts), Fraction(i + 1, cuts)) for i in range(cuts)]


def test_parts_of_velocities_on_a_bend() -> None:
    """From tangent (4, 3) to (3, 4): of (-7, 1) the most along a normal and across one is at an end."""
    control = np.cumsum([(0.0, 0), (4, 3), (3.5, 3.5), (3, 4)], axis=0)[None]
    node = (everything([[0, 0, 1.0]], 1), (0, 0), 0, (0, 0, 0))
    edges = CubicEdges(planar(control[:, 0], [(0, -1, 0)], [node], control=control))
    for v, ahead, aside in (
        ((-7, 1), 6.2, 5), ((7, -1), -5, 5), ((4, 3), 0, 5), ((3, 4), 1.4, 5), ((-4, 3), 5, 1.4),
    ):  # fmt: skip
        found = edges.parts(0, Fraction(0), Fraction(1), [Fraction(v[0]), Fraction(v[1]), Fraction(0)])
        for a, c in found:
            assert (float(a), float(c)) == pytest.approx((float(ahead), float(aside)), abs=1e-12), v
