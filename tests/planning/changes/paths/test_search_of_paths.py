"""What the search of a path makes of answers: near or off, proven or not, whoever solves."""

from dataclasses import replace
from math import inf, nan
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
import regrasp.planning.changes.path_search as searched
from feet import FEET, PAIR, on_feet, planned, task
from regrasp.errors import SolverFailed
from regrasp.planning.changes.path_search import planned_path
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.refusals.asking import asking_only
from regrasp.programs import Status, solve

pytestmark = pytest.mark.contract

LOW = {"lean": 0.5, "least_normals": np.array([0.0, 0.7501])}
"""The second foot has 0.75 N in the middle, and is to have more."""


def squeezed(most: float, **changes):
    """A pair that squeezes by 3 N at both ends and carries 1 N each."""
    held = np.array([[most, 1.0], [-most, 1.0]])
    return replace(task(grasp=PAIR), start=held, end=held, **changes)


def by_kind(monkeypatch, **spoilt) -> list[str]:
    """Answers to the programs of some objectives are changed; returns which were asked, in order.

    Programs with demands let go are "free" or "loose", without least normals or linear limits.
    """
    asked, kinds, made = [], {}, searched.path_program

    def noted(given, objective, **options):
        program = made(given, objective, **options)
        let_go = "free" if demanded and not (given.least_normals > 0).any() else objective
        kinds[id(program)] = "loose" if ruled and given.row_bounds is None else let_go
        return program

    def answered(program, backend, *, throw=True):
        kind = kinds[id(program)]
        asked.append(kind)
        change = spoilt.get(kind)
        return solve(program, backend, throw=throw) if change is None else change(program, throw)

    demanded, ruled = spoilt.pop("demanded", False), spoilt.pop("ruled", False)
    monkeypatch.setattr(searched, "path_program", noted)
    monkeypatch.setattr(searched, "solve", answered)
    return asked


def says(status, last: float = 0.0):
    """An answer with this status, whose last value is this."""

    def answer(program, throw):
        value = np.zeros(program.q.size)
        value[-1] = last
        return SimpleNamespace(program=program, status=status, value=value)

    return answer


def fails(program, throw):
    if throw:
        raise SolverFailed("no luck", program, None)
    return SimpleNamespace(program=program, status=Status.FAILED, value=np.full(program.q.size, nan))


# --- by the band of the program ---


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(
    ("size", "off", "near"),
    [(100.0, 5e-4, True), (100.0, 5e-3, False), (1e-2, 5e-6, True), (1e-2, 5e-5, False)],
)
def test_a_banded_answer_counts_where_balance_hardly_moves_it(size, off, near, way, monkeypatch) -> None:
    """By a hundred-thousandth of the forces, or of their unit of 1 N; feet may hang as well."""
    feet = on_feet(way)
    push = np.full((2, 2), size * way) * [0, 1]
    asked = task(grasp=feet)
    asked = replace(asked, loads=way * size * asked.loads, start=push, end=push)
    banded = np.array([push] * 3)
    banded[1, 0, 1] += off
    monkeypatch.setattr(searched, "least_change", lambda _: banded)
    found = planned_path(asked, "change", Criteria("angle"), "clarabel")
    assert found.method == ("time-banded" if near else "clarabel")
    assert found.forces[:, 0, 1] == pytest.approx(size * way, rel=1e-6)


@pytest.mark.parametrize(("rate", "kept"), [(2.0, True), (1.9, False), (1.0, False)])
def test_a_banded_answer_keeps_its_rates(rate, kept, monkeypatch) -> None:
    """A squeeze of half a newton comes and goes within a quarter of a second each."""
    banded = np.ones((3, 2, 2)) * [0, 1]
    banded[1, :, 0] = 0.5, -0.5
    monkeypatch.setattr(searched, "least_change", lambda _: banded)
    found = planned_path(
        task(rates=np.full(2, rate), frictions=np.ones(2)), "change", Criteria("angle"), "clarabel"
    )
    assert (found.method == "time-banded") == kept
    assert found.forces[2, 0, 0] == pytest.approx(0.5 if kept else 0.0, abs=1e-6)


# --- the best, and of these the one of least change ---


def test_of_least_peaks_the_one_of_least_change_is_taken() -> None:
    """The squeeze follows the phase down to none in the middle, be its margins less than they could be."""
    asked = task(lean=0.5, phases=np.array([0, 0.02, 0.5, 0.98, 1.0]))
    ends = np.array([[0.4, 1.0], [-0.4, 1.0]])
    path = planned(replace(asked, start=ends, end=ends), "peak")
    assert path[:, 0, 0] == pytest.approx([0.4, 0.384, 0.0, 0.384, 0.4], abs=3e-3)


@pytest.mark.parametrize(
    ("limits", "largest"),
    [((inf, inf), 3 * 5**0.5), ((50.0, inf), 3 * 5**0.5), ((inf, 50.0), 3 * 5**0.5), ((40.0, 50.0), 40.0)],
)
def test_without_limits_of_all_a_peak_limits_the_squeeze(limits, largest) -> None:
    """To three times the least that holds, sqrt(5) N; limits of all fingers are taken at their word."""
    path = planned(squeezed(100.0, limits=np.array(limits)), "force")
    assert np.linalg.norm(path[1:-1], axis=-1).max() == pytest.approx(largest, rel=1e-5)


def test_a_margin_of_none_is_a_margin() -> None:
    """Two newtons of squeeze at both ends are just enough for 1 N each."""
    path = planned(squeezed(2.0, limits=np.full(2, 50.0)), "force")
    assert (0.5 * path[:, 0, 0] - path[:, 0, 1] >= -1e-6).all()
    with asking_only():
        assert planned(squeezed(2.0, limits=np.full(2, 50.0)), "force").shape == (5, 2, 2)


def test_what_no_solver_finds_a_second_time_is_said(monkeypatch) -> None:
    by_kind(monkeypatch, change=says(Status.STOPPED))
    with pytest.raises(SolverFailed, match="no path of least change among the best for peak"):
        planned(task(), "peak")


# --- only asked whether ---


@pytest.mark.parametrize("objective", ["change", "effort", "force"])
def test_asked_only_nothing_is_proven(objective, monkeypatch) -> None:
    """Where the load tips over a foot, the widest margin is less than none."""
    monkeypatch.setattr(searched, "infeasible", None)
    limits = np.full(2, 50.0)
    with asking_only():
        assert planned(task(lean=0.5, limits=limits), objective).shape == (5, 2, 2)
        with pytest.raises(rg.Infeasible, match="no path was found at once"):
            planned(task(lean=3.5, limits=limits), objective)


@pytest.mark.parametrize(
    ("room", "at_limit"),
    [(-2e-6, False), (-1.001e-6, False), (-1e-6, True), (0.0, True), (1e-7, True), (nan, False)],
)
def test_what_fails_at_its_limit_is_no_fault_of_a_solver(room, at_limit, monkeypatch) -> None:
    def failing(*given):
        raise SolverFailed("no luck", program, None)

    monkeypatch.setattr(searched, "_planned", failing)
    monkeypatch.setattr(searched, "least_room", lambda *_: room)
    program = object()
    with pytest.raises(
        rg.Infeasible if at_limit else SolverFailed, match="rounding decides" if at_limit else "luck"
    ):
        planned(task())
    with asking_only(), pytest.raises(SolverFailed, match="luck"):
        planned(task())
    program = None
    with pytest.raises(SolverFailed, match="luck"):
        planned(task())


# --- why there is none ---


def test_a_margin_below_none_of_a_solver_that_stopped_proves_nothing(monkeypatch) -> None:
    by_kind(monkeypatch, force=says(Status.STOPPED, -1.0))
    with pytest.raises(SolverFailed, match="stopped before"):
        planned(task(limits=np.full(2, 50.0)), "force")


@pytest.mark.parametrize("objective", ["force", "effort"])
def test_linear_limits_that_stand_in_the_way_are_named(objective) -> None:
    """Two newtons of squeeze hold 1 N each, and linear limits allow less between the ends."""
    ruled = rg.Grasp(c.changed(limits=([[1.0, 0.0]], [9.0])) for c in PAIR)
    for most, good in ((2.01, True), (1.99, False)):
        asked = squeezed(3.0, grasp=ruled, row_bounds=np.array([most, 9.0]), limits=np.full(2, 50.0))
        if good:
            assert planned(asked, objective)[1:-1, 0, 0].max() <= most
        else:
            with pytest.raises(
                rg.Infeasible, match="no path keeps the contacts' linear limits; without them"
            ):
                planned(asked, objective)


def test_where_two_demands_are_each_too_much_no_one_is_to_blame() -> None:
    """One foot at most 1.24 N, which leaves 0.75 N at least: the other at least 0.7501 N."""
    ruled = rg.Grasp([FEET[0].changed(limits=([[1.0, 0.0]], [1.24])), FEET[1]])
    with pytest.raises(rg.Infeasible, match="keeps all of this together: every instant can be held"):
        planned(task(grasp=ruled, row_bounds=np.array([1.24]), **LOW), "effort")


@pytest.mark.parametrize("rates", [inf, 100.0])
def test_a_solver_that_fails_blames_nothing(rates, monkeypatch) -> None:
    """Least normals, linear limits and rates that can be kept are not the reason."""
    ruled = rg.Grasp([FEET[0].changed(limits=([[1.0, 0.0]], [5.0])), FEET[1]])
    given = {
        "least_normals": np.full(2, 0.5),
        "rates": np.full(2, rates),
        "grasp": ruled,
        "row_bounds": np.full(1, 5.0),
    }
    by_kind(monkeypatch, effort=fails)
    with pytest.raises(SolverFailed, match="no luck"):
        planned(task(lean=0.5, **given), "effort")


def test_an_instant_without_a_certificate_counts_where_none_is_needed(monkeypatch) -> None:
    monkeypatch.setattr(searched, "infeasible", lambda *_: rg.Infeasible("no one knows why"))
    with pytest.raises(rg.Infeasible, match=r"at t = 0\.25 s: no one knows why"):
        planned(task(lean=3.5), "effort")
    by_kind(monkeypatch, effort=fails)
    monkeypatch.setattr(searched, "least_room", lambda *_: -1.0)
    with pytest.raises(SolverFailed, match="no luck"):
        planned(task(lean=3.5), "effort")


@pytest.mark.parametrize(
    ("status", "least", "words"),
    [
        (Status.SOLVED, 1 + 2e-6, r"change at 1 times the rate limits"),
        (Status.SOLVED, 1 + 5e-7, "to a millionth"),
        (Status.SOLVED, 1 - 5e-7, "to a millionth"),
        (Status.SOLVED, 1 - 2e-6, "keeps all of this together"),
        (Status.STOPPED, 2.0, "keeps all of this together"),
        (Status.STOPPED, 1.0, "keeps all of this together"),
    ],
)
def test_rates_are_to_blame_within_a_millionth(status, least, words, monkeypatch) -> None:
    by_kind(monkeypatch, effort=says(Status.INFEASIBLE), rate=says(status, least))
    with pytest.raises(rg.Infeasible, match=words):
        planned(task(rates=np.full(2, 9.0)), "effort")


def test_reasons_do_not_wait_for_a_solver_that_fails(monkeypatch) -> None:
    asked = by_kind(monkeypatch, rate=fails, free=fails, demanded=True)
    with pytest.raises(rg.Infeasible, match="keeps all of this together"):
        planned(task(rates=np.full(2, 9.0), **LOW), "effort")
    assert asked == ["effort", "rate", "free"]
    ruled = rg.Grasp([FEET[0].changed(limits=([[1.0, 0.0]], [1.24])), FEET[1]])
    by_kind(monkeypatch, loose=fails, ruled=True)
    with pytest.raises(rg.Infeasible, match="keeps all of this together"):
        planned(task(lean=0.5, grasp=ruled, row_bounds=np.full(1, 1.24)), "effort")


def test_least_normals_of_all_fingers_are_let_go() -> None:
    with pytest.raises(
        rg.Infeasible, match=r"every normal force at 0\.7501 or more; without min_normal there is"
    ):
        planned(task(lean=0.5, least_normals=np.array([0.1, 0.7501])), "effort")
