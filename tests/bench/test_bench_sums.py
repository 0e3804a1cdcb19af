"""Sums of a benchmark checked by hand: means, verdicts before speed, profiles, growth, counts."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench_toys import LIMIT, WRONG, row
from regrasp.bench.reporting.closeness import closeness
from regrasp.bench.reporting.contests import contests
from regrasp.bench.reporting.growth import growths
from regrasp.bench.reporting.means import SHIFT, shifted_geometric_mean
from regrasp.bench.reporting.outcomes import Kind, outcomes
from regrasp.bench.reporting.profiles import ratios, share_within
from regrasp.bench.reporting.tables import (
    certificate_table,
    closeness_table,
    contest_table,
    failure_table,
    growth_table,
    percent,
    seconds,
)
from regrasp.bench.reporting.warmth import warmths
from regrasp.bench.running.result import WARM
from regrasp.errors import InvalidInput
from regrasp.plots.surveys.solvers import plot_growth, solver_looks

pytestmark = pytest.mark.oracle

TIMED_OUT = {"status": "timeout", "correct": False, "why": "no answer", "distance": None, "total_time": None}


def test_a_shifted_geometric_mean_by_hand():
    assert shifted_geometric_mean([3.0, 8.0], 1.0) == pytest.approx(5.0)  # sqrt(4 9) - 1
    assert pytest.approx(1e-5) == SHIFT
    assert shifted_geometric_mean([4e-5] * 7) == pytest.approx(4e-5, rel=1e-12)
    for wrong in ([], [-1.0]):
        with pytest.raises(InvalidInput, match="times of at least 0"):
            shifted_geometric_mean(wrong)
    with pytest.raises(InvalidInput, match="positive shift"):
        shifted_geometric_mean([1.0], 0.0)


TIMES = st.lists(st.floats(1e-7, 1e3), min_size=1, max_size=20)


@given(TIMES, st.floats(1e-7, 1e3), st.floats(1e-3, 1e6))
def test_a_mean_lies_between_and_scales_with_its_unit(times, shift, unit):
    mean = shifted_geometric_mean(times, shift)
    assert min(times) * (1 - 1e-6) - 1e-9 * shift <= mean <= max(times) * (1 + 1e-6) + 1e-9 * shift
    other = shifted_geometric_mean([unit * time for time in times], unit * shift)
    assert other == pytest.approx(unit * mean, rel=1e-6, abs=1e-9 * unit * shift)


def test_repeats_count_once_and_all_of_them_must_be_right():
    rows = [row(1, "s", time, repeat=k) for k, time in enumerate((1e-5, 9e-5, 2e-5))]
    (found,) = outcomes(rows)
    assert (found.kind, found.time, found.charged) == (Kind.RIGHT, 2e-5, 2e-5)
    (found,) = outcomes([*rows, row(1, "s", 1e-5, repeat=3, **WRONG)])
    assert (found.kind, found.distance, found.charged) == (Kind.WRONG, 0.5, LIMIT)
    assert found.row.why == WRONG["why"]
    (found,) = outcomes([*rows, row(1, "s", repeat=3, **TIMED_OUT), row(1, "s", 1e-5, repeat=4, **WRONG)])
    assert found.kind is Kind.WRONG  # to be wrong once is worse than to give no answer
    (found,) = outcomes([*rows, row(1, "s", repeat=3, **TIMED_OUT)])
    assert (found.kind, found.time, found.charged) == (Kind.NONE, None, LIMIT)
    (found,) = outcomes([row(1, "s", correct=None)])
    assert (found.kind, found.charged) == (Kind.UNJUDGED, LIMIT)


@pytest.mark.parametrize(
    ("status", "verdict", "right"),
    [
        ("found", "solvable", True),
        ("found", "infeasible", False),
        ("infeasible", "infeasible", True),
        ("infeasible", "solvable", False),
        ("unbounded", "solvable", False),
        ("failed", "infeasible", False),
        ("timeout", "solvable", False),
        ("found", "unknown", False),
    ],
)
def test_a_verdict_is_right_where_it_is_true(status, verdict, right):
    (found,) = outcomes([row(1, "s", status=status, verdict=verdict)])
    assert found.has_right_verdict is right


def test_a_fast_wrong_answer_never_ranks_above_a_slow_right_one():
    rows = [row(n, "slow", 9.9) for n in range(4)]
    rows += [row(n, "liar", 1e-6, **(WRONG if n == 0 else {})) for n in range(4)]
    rows += [row(n, "shy", 1e-6, **(TIMED_OUT if n == 0 else {})) for n in range(4)]
    (contest,) = contests(outcomes(rows))
    assert contest.ranking == ["slow", "shy", "liar"]
    assert contest.mean("liar") == contest.mean("shy") < contest.mean("slow")
    assert contest.shared == ["a/1", "a/2", "a/3"]
    table = contest_table(contest)
    assert [line[0] for line in table.rows] == contest.ranking
    cells = dict(zip(table.header, table.rows[2], strict=True))
    assert (cells["right"], cells["wrong"], cells["no answer"]) == ("75.0 %", "1", "0")
    assert cells["fastest"] == "75 %"
    cells = dict(zip(table.header, table.rows[0], strict=True))
    assert (cells["right"], cells["within 10x"], cells["mean time"]) == ("100.0 %", "25 %", "9.9 s")


def test_solvers_meet_on_the_problems_all_were_given():
    rows = [row(n, "a") for n in range(5)] + [row(n, "b") for n in range(3)]
    rows += [row(9, "a", cones="second-order 1x3")]
    quadratic, conic = contests(outcomes(rows))
    assert (quadratic.problems, quadratic.left_out) == (["a/0", "a/1", "a/2"], 2)
    assert (conic.is_conic, list(conic.outcomes)) == (True, ["a"])
    assert contests(outcomes([row(1, "a"), row(2, "b")])) == []
    warm = [replace(r, mode=WARM) for r in rows]
    assert contests(outcomes(warm)) == []


def test_settings_do_not_mix_and_come_from_loose_to_tight():
    rows = [row(1, "a", settings=name) for name in ("high", "low", "default", "mid")]
    assert [contest.settings for contest in contests(outcomes(rows))] == ["default", "low", "mid", "high"]


def test_performance_profiles_by_hand():
    times = {"a": (1.0, 2.0, None, None), "b": (2.0, 1.0, 3.0, None)}
    rows = [
        row(n, solver, time, **({} if time else TIMED_OUT))
        for solver, there in times.items()
        for n, time in enumerate(there)
    ]
    (contest,) = contests(outcomes(rows))
    found = ratios(contest)
    assert found["a"].tolist() == [1, 2, inf, inf]
    assert found["b"].tolist() == [1, 1, 2, inf]  # a/3 is solved by none and counts all the same
    assert [share_within(found["a"], factor) for factor in (1, 1.9, 2, 1e9)] == [0.25, 0.25, 0.5, 0.5]
    assert share_within(found["b"], 1) == 0.5


def test_the_slope_of_growth_is_the_exponent():
    sizes = (10, 100, 1000, 1000)
    rows = [row(n, "cubic", 1e-9 * size**1.5, nonzeros=size, unknowns=size) for n, size in enumerate(sizes)]
    rows += [row(9, "cubic", nonzeros=10_000, unknowns=9999, **WRONG)]
    rows += [row(n, "narrow", nonzeros=size) for n, size in enumerate((10, 20, 30))]
    found = growths(outcomes(rows), "mid")
    assert found["a"]["cubic"].slope == pytest.approx(1.5)
    assert found["a"]["cubic"].sizes == (10, 100, 1000)
    assert found["a"]["cubic"].largest == 1000  # of those answered rightly
    assert found["a"]["narrow"].slope is None
    assert growth_table(found).rows[0] == ["cubic", "1.50", "1000", "1.0"]
    assert growths(outcomes(rows), "high") == {}
    assert growths(outcomes(row(n, "s") for n in range(3)), "mid") == {}  # all of one size


def test_distances_are_of_closed_forms_only():
    rows = [row(n, "s", distance=10.0 ** -(3 + n)) for n in range(3)]
    rows += [row(3, "s", **TIMED_OUT)]
    rows += [row(4, "s", truth="reference solve, certified by its duality gap", distance=0.9)]
    found = closeness(outcomes(rows), "mid")["s"]
    assert found.distances == (1e-5, 1e-4, 1e-3, inf)
    assert (found.answered, found.share(0.5), found.share(0.75), found.share(1)) == (3, 1e-4, 1e-3, inf)
    (line,) = closeness_table({"s": found}).rows
    assert line == ["s", "3 of 4", "1.0e-04", "no answer", "1.0e-03"]
    broken = closeness(outcomes([row(1, "s", distance=0.0, primal_residual=0.5)]), "mid")["s"]
    assert broken.distances == (inf,)


def test_certificates_are_counted_apart_from_verdicts():
    claims = ["infeasible", "infeasible", "infeasible", "failed", "found"]
    rows = [
        row(n, "s", verdict="infeasible", status=status, certificate_residual=residual)
        for n, (status, residual) in enumerate(zip(claims, [1e-6, 0.3, None, None, None], strict=True))
    ]
    table = certificate_table(outcomes(rows))
    assert table.rows == [["s", "mid", "5", "3", "2", "1", "3.0e-01"]]


def test_warm_starts_are_compared_with_cold_ones_of_the_same_problem():
    rows = [row(n, "s", 4e-4) for n in range(3)]
    rows += [row(n, "s", 1e-4, mode=WARM) for n in range(2)] + [row(2, "s", 1e-4, mode=WARM, **WRONG)]
    found = warmths(outcomes(rows))["mid", "s"]
    assert (found.cold, found.warm, found.ratio) == (4e-4, 1e-4, 0.25)
    assert (found.right, found.given) == (2, 3)
    assert warmths(outcomes(rows[:3])) == {}


def test_growth_is_drawn_by_octaves():
    looks = solver_looks({"clarabel", "cvxpy:CLARABEL", "scs"})
    assert looks["clarabel"]["color"] == looks["cvxpy:CLARABEL"]["color"] != looks["scs"]["color"]
    ax = plot_growth({"scs": ([16, 31, 32, 200], [1e-3, 4e-3, 5e-3, 1e-2])}, looks)
    (line,) = [line for line in ax.get_lines() if line.get_label() == "scs"]
    assert line.get_xdata() == pytest.approx([np.sqrt(16 * 31), 32, 200])
    assert line.get_ydata() == pytest.approx([2e-3, 5e-3, 1e-2])


@pytest.mark.parametrize(
    ("time", "shown"),
    [(5.04e-5, "50.4 µs"), (9.9996e-4, "1 ms"), (0.0123, "12.3 ms"), (1.0, "1 s"), (61.23, "61.2 s")],
)
def test_times_have_units_that_suit_them(time, shown):
    assert seconds(time) == shown


def test_almost_all_is_not_all():
    assert percent(9999, 10_000) == "99.9 %"
    assert percent(3, 3) == "100.0 %"


def test_failures_are_counted_by_kind_and_family():
    rows = [row(n, "s", **WRONG) for n in range(2)]
    rows += [row(9, "s", family="b", **WRONG), row(4, "s", **TIMED_OUT)]
    lines = failure_table(outcomes(rows)).rows
    assert lines == [["s", "mid", WRONG["why"], "a 2, b 1", "3"], ["s", "mid", "timeout", "a 1", "1"]]
