"""Paths through instants where one condition alone decides, and what is said where it cannot be kept."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest

import regrasp as rg
import regrasp.planning.changes.path_search as searched
from feet import FEET, planned, task
from paper import GRASP, STATE
from regrasp.errors import SolverFailed
from regrasp.planning.changes.path_program import path_program
from regrasp.planning.changes.path_search import _balanced, _breach, _kept
from regrasp.programs import solve

pytestmark = pytest.mark.contract


def test_the_reference_goes_straight_from_end_to_end() -> None:
    asked = task((1, 1), (3, 2), phases=np.array([0, 0.1, 0.5, 0.9, 1.0]))
    assert asked.reference[:, 0, 1] == pytest.approx([1, 1.2, 2, 2.8, 3])
    assert asked.reference[:, 1, 1] == pytest.approx([1, 1.1, 1.5, 1.9, 2])
    idle = task(active=np.array([[True, True], [True, False], [True, False], [True, True], [True, True]]))
    assert idle.reference[1:3, 1].tolist() == [[0, 0]] * 2


@pytest.mark.parametrize("duration", [0.1, 1.0, 20.0])
def test_effort_counts_each_instant_by_its_share_of_time(duration) -> None:
    """Three instants of shares 1/4, 3/8 and 1/4 of 1 s, whatever a second is."""
    asked = task(times=duration * np.array([0, 0.125, 0.5, 0.875, 1.0]), phases=np.linspace(0, 1, 5))
    program = path_program(asked, "effort")
    assert program.P.diagonal().reshape(3, 4)[:, 0] == pytest.approx([0.5, 0.75, 0.5])


def test_unknowns_are_counted_from_the_reference() -> None:
    """Where nothing bends the path zero is the answer, and keeps every row."""
    asked = task((1, 1), (1, 1), least_normals=np.full(2, 0.25), limits=np.full(2, 3.0))
    for objective in ("change", "effort"):
        program = path_program(asked, objective)
        assert abs(solve(program).value).max() < 1e-6
        s = program.b
        zero, rest = s[: program.blocks[0].rows], s[program.blocks[0].rows :]
        assert abs(zero).max() < 1e-15
        assert rest.min() >= 0
        assert (program.q == 0).all() or objective == "effort"


@pytest.mark.parametrize("facets", [None, 16, 64])
def test_the_least_peak_with_circles_or_polygons(facets) -> None:
    """Leaning by 1/2 puts 1.25 and 0.75 on the feet, and a polygon takes a little more."""
    asked = task(lean=0.5)
    least = solve(path_program(asked, "peak", facets=facets)).value[-1]
    assert 1.25 - 1e-7 <= least <= 1.25 * (1.0 if facets is None else 1 / np.cos(np.pi / facets)) + 1e-7


def test_rates_are_needed_in_proportion() -> None:
    """The lean rises by 0.177 N within a quarter of a second."""
    asked = task((1.0, 1.0), (1.0, 1.0), lean=0.5, rates=np.full(2, 0.25))
    rise = np.abs(np.diff(0.25 * np.sin(np.pi * asked.times))).max() * 4
    with pytest.raises(rg.Infeasible, match=f"change at {rise / 0.25:.4g} times the rate limits"):
        planned(asked)
    for slack, good in (1.001, True), (0.999, False):
        asked = task(lean=0.5, rates=np.full(2, slack * rise))
        if good:
            assert planned(asked).shape == (5, 2, 2)
        else:
            with pytest.raises(rg.Infeasible, match=r"change at 1\.001 times the rate limits"):
                planned(asked)


@pytest.mark.parametrize("who", [0, 1])
@pytest.mark.parametrize(("least", "good"), [(0.7499, True), (0.7501, False)])
def test_one_least_normal_that_stands_in_the_way_is_named(who, least, good) -> None:
    """Leaning to one side leaves 0.75 on the other foot."""
    normals = np.zeros(2)
    normals[who] = least
    asked = task(lean=0.5 if who == 1 else -0.5, least_normals=normals)
    if good:
        assert planned(asked)[:, who, 1].min() >= least
    else:
        with pytest.raises(rg.Infeasible, match=r"no path keeps every normal force at 0\.7501 or more"):
            planned(asked)


def test_what_is_kept_back_is_a_share() -> None:
    bounded = GRASP.replaced("P1", GRASP["P1"].changed(limits=([[1.0, 0.0]], [6.0])))
    for grasp, bounds in ((bounded, np.array([6.0])), (bounded, None), (GRASP, None)):
        n = len(grasp)
        asked = replace(
            task(least_normals=np.zeros(2)), grasp=grasp, row_bounds=bounds, rates=np.full(n, 2.0),
            frictions=np.full(n, 0.3), limits=np.full(n, 8.0), least_normals=np.full(n, 0.5),
        )  # fmt: skip
        kept = _kept(asked, 0.25)
        assert kept.rates == pytest.approx(1.5)
        assert kept.least_normals == pytest.approx(0.625)
        shares = (
            kept.frictions / 0.3,
            kept.limits / 8,
        )  # to a billionth, of the path and the states at its ends
        assert [1 - share for share in np.ravel(shares)] == pytest.approx([1e-9] * 2 * n, rel=1e-6)
        assert kept.row_bounds is None if bounds is None else kept.row_bounds == pytest.approx([4.5])


@pytest.mark.parametrize("condition", ["rate", "normal", "row"])
@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_breach_is_the_largest_share_of_what_is_broken(condition, share) -> None:
    """Pushes of 1 and 1.5 N at the middle instant, 1 N before and after, a quarter of a second apart."""
    forces = np.ones((5, 2, 2)) * [0, 1]
    forces[2, 1, 1] = 1.5
    if condition == "rate":
        found, want = _breach(task(rates=np.array([inf, 2.0 / share])), forces), share - 1
    elif condition == "normal":
        found, want = _breach(task(least_normals=np.array([0.0, share])), forces), 1 - 1 / share
    else:
        limited = rg.Grasp([FEET[0], FEET[1].changed(limits=([[1.0, 0.0]], [1.5 / share]))])
        found, want = _breach(task(grasp=limited, row_bounds=np.array([1.5 / share])), forces), share - 1
    assert found == pytest.approx(want, rel=1e-12)


@pytest.mark.parametrize("at", [0, 1, 2, 3, 4])
def test_linear_limits_are_kept_at_every_instant_between_the_ends(at) -> None:
    forces = np.ones((5, 2, 2)) * [0, 1]
    forces[at, 1, 1] = 1.5
    limited = rg.Grasp([FEET[0], FEET[1].changed(limits=([[1.0, 0.0]], [1.2]))])
    found = _breach(task(grasp=limited, row_bounds=np.array([1.2])), forces)
    assert found == pytest.approx(0.25 if 0 < at < 4 else -1 / 6, rel=1e-12)


def test_only_fingers_in_use_must_press() -> None:
    forces = np.ones((5, 2, 2)) * [0, 1]
    forces[1:3, 1] = 0
    active = np.ones((5, 2), dtype=bool)
    assert _breach(task(least_normals=np.array([0.5, 0.5])), forces) == 1.0
    active[1:3, 1] = False
    assert _breach(task(least_normals=np.array([0.5, 0.5]), active=active), forces) == -1.0


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_instants_out_of_balance_are_each_moved_into_it(unit) -> None:
    """One of two far away, whose rounding must not hide the other; by Newton where a force would pull."""
    asked = task(unit=unit)
    loads = unit * np.array([[0.0, -2.0, 0.0], [0.0, -2e-3, 0.0]])
    forces = unit * np.array([[[0, 1.1], [0, 1.0]], [[0, 1.2e-3], [0, 1e-3]]])
    moved = _balanced(asked, forces, loads, np.arange(2))
    for f, w in zip(moved, loads, strict=True):
        assert abs(FEET.matrix @ f.ravel() + w).max() <= 1e-15 * abs(w).max()
    across = _balanced(asked, unit * np.array([[[5.0, 1.0], [-5.0, 1.0]]]), loads[:1], np.arange(2))
    assert (abs(across[0, :, 0]) <= 0.5 * across[0, :, 1]).all()
    assert abs(FEET.matrix @ across.ravel() + loads[0]).max() <= 1e-9 * unit


def test_the_widest_margin_by_a_solver_of_quadratic_programs() -> None:
    """No straight path: the margin is asked of facets, and any back end may answer."""
    options = {"path_objective": "force", "max_force": 9.0, "instants": 9}
    options["load"] = lambda t: rg.Wrench([-1.5 + t, -3.5])
    plans = [rg.plan_removal(GRASP, "P3", **options, **how) for how in ({}, {"method": "daqp", "facets": 32})]
    assert all(rg.verify(plan).ok for plan in plans)
    margins = [plan.margins(plan.course.times).force[:, :2].min() for plan in plans]
    assert margins[1] == pytest.approx(margins[0], rel=1e-2)


@pytest.mark.parametrize("facets", [None, 360])
def test_limits_do_not_grow_with_the_margin(facets) -> None:
    """Between two fingers, under 2.5 N each, of which 1 N carries."""
    pair = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    held = np.array([[3.0, 1.0], [-3.0, 1.0]])
    asked = task(grasp=pair, start=(0, 0), limits=np.full(2, 2.5))
    asked = replace(asked, start=held, end=held)
    widest = solve(path_program(asked, "force", facets=facets)).value[-1]
    assert widest == pytest.approx(
        (0.5 * np.sqrt(5.25) - 1) / np.sqrt(1.25), rel=1e-6 if facets is None else 2e-3
    )


def test_change_is_asked_of_the_back_end_that_is_named(monkeypatch) -> None:
    monkeypatch.setattr(searched, "least_change", None)
    plan = rg.plan_removal(STATE, "P3", path_objective="change", method="daqp", facets=16, instants=7)
    assert plan.record.path == "daqp"


def test_a_margin_below_none_is_no_path() -> None:
    """The widest margin is less than none where the load tips over a foot, and a certificate says so."""
    for objective in ("force", "effort", "change", "peak"):
        with pytest.raises(rg.Infeasible, match=r"at t = 0\.25 s: no forces") as refused:
            planned(task(lean=3.5, limits=np.full(2, 50.0)), objective)
        assert refused.value.certificate.is_proof


def test_a_proof_stands_where_a_solver_fails(monkeypatch) -> None:
    def failing(program, backend, **options):
        raise SolverFailed("no luck", program, None)

    monkeypatch.setattr(searched, "solve", failing)
    with pytest.raises(rg.Infeasible, match=r"at t = 0\.25 s: no forces"):
        planned(task(lean=3.5), "effort")
    with pytest.raises(SolverFailed, match="no luck"):
        planned(task(lean=0.5), "effort")


def test_what_rounding_breaks_is_kept_back_twice(monkeypatch) -> None:
    breaches, kept = [0.25, 0.125, 0.0], []
    monkeypatch.setattr(searched, "_breach", lambda *_: breaches[len(kept) - 1])
    monkeypatch.setattr(searched, "_kept", lambda asked, slack: kept.append(slack) or asked)
    planned(task(), "effort")
    assert np.diff(kept) == pytest.approx([0.5, 0.25])
    kept.clear()
    breaches[:] = [0.125] * 9
    with pytest.raises(SolverFailed, match=r"breaks a rate or linear limit or a least normal force by 0\.12"):
        planned(task(), "effort")
    assert len(kept) == 4


@pytest.mark.parametrize("size", [1e-8, 1.0, 1e6])
def test_one_foot_balances_no_torque_of_its_own(size) -> None:
    """Both forces are right and the torque is not."""
    feet = rg.Grasp(rg.Contact(size * foot.position, foot.normal, foot.friction) for foot in FEET)
    alone, load = np.array([[[0.0, 2.0]]]), np.array([[0.0, -2.0, 0.5 * size]])
    assert np.isinf(_balanced(task(grasp=feet), alone, load, np.arange(1))).all()
    moved = _balanced(task(), np.array([[[0.0, 1.9]]]), np.array([[0.0, -2.0, 2.0]]), np.arange(1))
    assert moved == pytest.approx(np.array([[[0.0, 2.0]]]), abs=1e-15)


def test_a_rate_of_one_finger_alone_is_to_blame() -> None:
    for who in (0, 1):
        rates = np.full(2, inf)
        rates[who] = 0.25
        with pytest.raises(rg.Infeasible, match=r"times the rate limits"):
            planned(task(lean=0.5, rates=rates))


def test_rates_that_would_do_are_not_to_blame() -> None:
    asked = task(lean=0.5, least_normals=np.array([0.0, 0.7501]), rates=np.full(2, 100.0))
    with pytest.raises(rg.Infeasible, match=r"no path keeps every normal force at 0\.7501 or more"):
        planned(asked)


@pytest.mark.parametrize(
    ("off", "unit", "good"), [(1e-7, 1, True), (1e-4, 1, False), (1e-4, 100, True), (1e-2, 100, False)]
)
def test_an_answer_that_balance_moves_is_no_path(off, unit, good, monkeypatch) -> None:
    """By more than a hundred-thousandth of the forces, or of their unit."""

    def spoilt(program, backend, **options):
        answer = solve(program, backend, **options)
        return replace(answer, value=answer.value + off * 2 / unit * (np.arange(answer.value.size) == 1))

    monkeypatch.setattr(searched, "solve", spoilt)
    if good:
        assert planned(task(unit=unit), "effort").shape == (5, 2, 2)
    else:
        with pytest.raises(SolverFailed, match="no equilibrium inside the cones"):
            planned(task(unit=unit), "effort")


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (1 - 2e-6, "the forces would have to change"),
        (1 - 1e-12, "not proven"),
        (1.0, "not proven"),
        (1 + 1e-9, "not proven"),
        (1 + 1e-5, None),
    ],
)
def test_rates_at_the_least_that_any_path_needs_prove_nothing(factor, words):
    """Within 1 s some force must change by |f^B - f^A|, at that rate throughout."""
    straight = rg.plan_removal(STATE, "P3")
    least = float(np.linalg.norm(straight.end.forces - straight.start.forces, axis=1).max())
    given = {"duration": 1.0, "rate_limit": factor * least}
    if words is None:
        assert rg.verify(rg.plan_removal(STATE, "P3", **given)).ok
    else:
        with pytest.raises(rg.Infeasible, match=words):
            rg.plan_removal(STATE, "P3", **given)
