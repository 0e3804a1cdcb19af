"""Steps of searches by hand: points that keep constraints, what slides, knife's edges, circles, loads."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

import regrasp as rg
from placements import BRACKET
from regrasp.planning.placement import sliding
from regrasp.planning.placement.asking import asked_sides, level_of
from regrasp.planning.placement.circles import TurnedSearch, _play
from regrasp.planning.placement.constrained import constraints
from regrasp.planning.placement.constrained.sampled import _POINTS, sampled
from regrasp.planning.placement.knife_edges import on_edges
from regrasp.planning.placement.laws import LAWS, without_rounding
from regrasp.planning.placement.search import Search
from regrasp.verification.placed.curves.circles import play_of

pytestmark = pytest.mark.contract

SLOPES = np.array([[0.3, -1, 0], [-0.3, -1, 0]])
TRIANGLE = rg.Outline([[0, 0], [2, 0], [1, 1.7]])
ROUND = rg.LoadSet.turned(rg.Wrench([0, -1]))


def search_on(shape: rg.Outline, fingers: int, loads=SLOPES, friction: float = 0.5) -> Search:
    sides = asked_sides(shape, 0.0, None, 0.0, False)
    return Search(sides, fingers, friction, np.array(loads, float), LAWS["peak"], 1e-3, 1e-3)


def anywhere(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return np.ones(len(first), bool)


@pytest.mark.parametrize("fingers", [2, 3])
def test_points_that_hold_the_best_first_and_two_of_the_same_sides(
    fingers: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(_POINTS, fingers, 36 // fingers)
    search = search_on(TRIANGLE, fingers, friction=0.35)
    found = sampled(search, anywhere, None)
    norms = [norm for norm, *_ in found]
    assert norms == sorted(norms)
    assert norms[-1] < np.inf
    sides = [tuple(on) for _, on, _ in found]
    assert max(sides.count(few) for few in sides) == 2
    assert not search.interrupted
    for norm, on, u in found:
        assert norm == search.norm_at(on, u)
        assert (np.diff(u) > 0).all()


def test_an_interrupt_among_fewer_fingers_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three fingers are asked about first, then the two that one is put beside."""
    monkeypatch.setitem(_POINTS, 3, 16)
    search, calls = search_on(TRIANGLE, 3), []

    def once(first: np.ndarray, second: np.ndarray) -> np.ndarray:
        calls.append(len(first))
        if len(calls) == 2:
            raise KeyboardInterrupt
        return anywhere(first, second)

    assert sampled(search, once, None)
    assert search.interrupted
    assert len(calls) == 2


def test_the_best_slide_on_and_the_best_is_last(monkeypatch: pytest.MonkeyPatch) -> None:
    """Thirty placements on sides of their own, of which each step makes the worst of its lot the best."""
    seeds = [(float(n), np.array([n, n]), np.zeros(2)) for n in range(30, 0, -1)]
    slid: list[list[float]] = []

    def begin(*_: object) -> list:
        return seeds

    def better(search, placed, value, step, last):
        if not slid or last != slid[-1][0]:
            slid.append([last])
        slid[-1].append(placed[0])
        return (100.0 - placed[0], *placed[1:]) if last == 0.1 else placed

    monkeypatch.setattr(constraints, "sampled", begin)
    monkeypatch.setattr(constraints, "_slid", better)
    kept = constraints.Constraints(None, 0.0, lambda p, q, a: anywhere(p, q), False)
    search = search_on(TRIANGLE, 2)
    found = constraints._begun(search, kept, lambda *_: 0.0)
    (first, *ones), (_, *twos), (_, *threes) = slid
    assert first == 0.1
    assert sorted(ones) == [float(n) for n in range(1, len(ones) + 1)]
    assert len(ones) > len(twos) > len(threes) > 0
    for many in (twos, threes):  # the least of those that the step before made
        assert sorted(many) == [100.0 - n for n in range(len(ones), len(ones) - len(many), -1)]
    assert all(one[0] >= other[0] for one, other in pairwise(found))
    assert found[-1][0] == 1.0


def test_what_is_no_better_does_not_slide(monkeypatch: pytest.MonkeyPatch) -> None:
    search, asked = search_on(TRIANGLE, 2), []

    def flat(places: np.ndarray, u: np.ndarray) -> float:
        asked.append(u.tolist())
        return 1.0

    monkeypatch.setattr(search, "norm_at", flat)
    monkeypatch.setattr(search, "on_points", list)
    search.take([(1.0, np.array([0, 1]), np.array([0.5, 1.5]))])
    sliding.slide_best(search)
    assert len(asked) == 4 * 11  # back and ahead of both, until a step is a ten-thousandth of an edge
    assert search.found[1].tolist() == [0.5, 1.5]


def test_points_are_tried_only_where_they_are_a_part_of_the_work(monkeypatch: pytest.MonkeyPatch) -> None:
    for loads, tried in ((190, True), (210, False)):
        search, calls = search_on(TRIANGLE, 2, np.repeat(SLOPES[:1], loads, axis=0)), []

        def counted(calls=calls) -> list:
            calls.append(1)
            return []

        monkeypatch.setattr(search, "on_points", counted)
        sliding.slide_best(search)
        assert bool(calls) == tried


def test_edges_of_cones_that_meet_the_loads_are_those_of_nearly_all_friction() -> None:
    search = search_on(TRIANGLE, 2, friction=0.35)
    norm, on, u = on_edges(search)[0]
    assert on.tolist() == [0, 0]
    height = -search.sides.points(on, u)[:, 1]
    np.testing.assert_allclose(
        search.sides.points(on, u)[:, 0], [-0.35 * height[0], 0.35 * height[1]], rtol=1e-8
    )
    assert norm == search.norm_at(on, u) < np.inf


@pytest.mark.parametrize("wide", [1.0, 1 + 1e-4])
def test_how_far_from_a_circle_is_what_verify_says(wide: float) -> None:
    angles = 2 * np.pi * np.arange(5) / 5
    around = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    search = search_on(rg.Outline.ellipse(1, wide), 2, around)
    control, play = search.sides.control, _play(search, ROUND)  # type: ignore[attr-defined]
    proof = search.proof(0.0, control, np.zeros(2))
    exact = play_of(proof, [[(Fraction(x), Fraction(y)) for x, y in edge] for edge in control.tolist()])
    assert exact is not None
    assert float(exact[0]) <= play <= float(exact[0]) * (1 + 1e-6) + 2e-12
    turned = TurnedSearch(search, play)
    arcs, ends = turned._boxes[:2]
    first = search.sides.ends[0, 0]
    assert (arcs[0, 0].tolist(), ends[0, 0].tolist()) == ([0, 0], [first, first])
    assert (arcs[0, 1].tolist(), ends[0, 1].tolist()) == ([0, len(control) - 1], [first, len(control)])


def test_what_verify_lets_a_value_be_off_is_nothing() -> None:
    for word, value, kept in (
        ("angle", 1e-9, 0.0),
        ("angle", -1e-9, 0.0),
        ("friction_use", 1.1e-9, 1.1e-9),
        ("force", 1e-12, 1e-12),
    ):
        assert without_rounding(word, value) == kept


def test_forces_a_little_more_than_1e13_times_the_loads_are_refused() -> None:
    for limit, fine in ((1e13, True), (np.nextafter(1e13, np.inf), False)):
        asked = ("force", 0.4, rg.Wrench([0, -1]), float(limit), None, 1.0)
        if fine:
            assert level_of(*asked) is not None
            continue
        with pytest.raises(rg.InvalidInput, match=r"more than 1e\+13 times the loads"):
            level_of(*asked)


def test_loads_around_a_round_set_leave_a_part_of_the_tolerance_to_squares_too() -> None:
    found = rg.choose_grasp(BRACKET, 3, ROUND, friction=0.6, objective="effort", tolerance=0.05)
    assert found.gap <= 0.05
