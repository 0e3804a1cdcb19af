"""The report of a benchmark: sums checked by hand, correctness before speed, a page that stands alone."""

import csv
import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from math import inf
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from documents import executed
from places import ROOT
from regrasp.bench.families import FAMILIES
from regrasp.bench.reporting.closeness import closeness
from regrasp.bench.reporting.contests import contests
from regrasp.bench.reporting.document import Heading, Paragraph, Table, markdown
from regrasp.bench.reporting.growth import growths
from regrasp.bench.reporting.limitations import LIMITATIONS
from regrasp.bench.reporting.means import SHIFT, shifted_geometric_mean
from regrasp.bench.reporting.outcomes import Kind, outcomes
from regrasp.bench.reporting.page import page
from regrasp.bench.reporting.profiles import ratios, share_within
from regrasp.bench.reporting.report import write_report
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
from regrasp.bench.running.result import WARM, Row
from regrasp.bench.running.store import read_rows
from regrasp.errors import InvalidInput
from regrasp.plots.surveys.solvers import plot_growth, solver_looks

pytestmark = pytest.mark.oracle

DOCS = ROOT / "docs"
LIMIT = 10.0
RIGHT = Row(
    problem="a/1", family="a", digest="0", solver="quick", settings="mid", mode="cold", repeat=0, version="1",
    verdict="solvable", truth="closed form", optimum=1.0, unknowns=4, rows=7, nonzeros=16,
    cones="zero 3, non-negative 4", status="found", said="solved", correct=True, why="near", objective=1.0,
    distance=1e-9, primal_residual=1e-10, dual_residual=None, gap=None, absolute_primal_residual=None,
    absolute_dual_residual=None, absolute_gap=None, certificate_residual=None, iterations=5, build_time=1e-5,
    setup_time=None, solve_time=3e-5, total_time=5e-5, memory=2**20, time_limit=LIMIT, machine="here",
)  # fmt: skip
TIMED_OUT = {"status": "timeout", "correct": False, "why": "no answer", "distance": None, "total_time": None}
WRONG = {"correct": False, "why": "farther than 1e-05 from the known optimum", "distance": 0.5}


def row(problem: int, solver: str, time: float | None = 5e-5, **changes: object) -> Row:
    return replace(RIGHT, **{"problem": f"a/{problem}", "solver": solver, "total_time": time} | changes)


# -- sums ------------------------------------------------------------------------------------------------


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


# -- contests --------------------------------------------------------------------------------------------


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


# -- growth, truth, warm starts ----------------------------------------------------------------------------


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


# -- words -------------------------------------------------------------------------------------------------


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


class Tags(HTMLParser):
    """Tags of a page, those still open, and what it refers to."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.links: list[str] = []
        self.counts: dict[str, int] = {}

    def handle_starttag(self, tag, attrs):
        self.counts[tag] = self.counts.get(tag, 0) + 1
        self.links += [value for name, value in attrs if name in ("src", "href")]
        if tag not in ("meta", "img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_what_solvers_say_cannot_break_the_page():
    blocks = [Heading("<b>", 1), Paragraph("a `x < y` & b"), Table(["<td>", "n"], [["a|b\nc", "<script>"]])]
    shown = page(blocks)
    tags = Tags()
    tags.feed(shown)
    assert not tags.open
    assert "script" not in tags.counts
    assert "<code>x &lt; y</code> &amp; b" in shown
    assert r"| a\|b c | <script> |" in markdown(blocks)


# -- whole reports -----------------------------------------------------------------------------------------

RUN = {
    "machine": {"processor": "a processor", "cores": 2, "memory": 8 * 2**30, "python": "3.11"},
    "time_limit": LIMIT, "memory_limit": 0, "jobs": 1, "solvers": {"quick": "1.0", "slow": "2.0"},
}  # fmt: skip


def written(folder: Path, rows: list[Row], **run: object) -> list[Path]:
    folder.mkdir(exist_ok=True)
    (folder / "rows.jsonl").write_text("".join(r.line() + "\n" for r in rows))
    (folder / "run.json").write_text(json.dumps(RUN | run))
    return write_report(folder)


def many() -> list[Row]:
    sizes = np.geomspace(10, 10_000, 8).astype(int)
    rows = [
        row(n, solver, factor * size * 1e-6, nonzeros=int(size), settings=settings)
        for solver, factor in (("quick", 1), ("slow", 7))
        for settings in ("default", "mid")
        for n, size in enumerate(sizes)
    ]
    rows += [row(20, solver, family="b", status="infeasible", **WRONG) for solver in ("quick", "slow")]
    return rows + [row(n, "quick", 1e-6, mode=WARM) for n in range(8)]


def test_a_report_has_every_part_and_its_page_stands_alone(tmp_path):
    files = {path.name: path for path in written(tmp_path / "run", many())}
    assert files.keys() == {
        "report.md", "report.html", "failures.csv", "profile-quadratic-default.svg",
        "profile-quadratic-mid.svg", "distance-default.svg", "distance-mid.svg", "growth-a.svg",
    }  # fmt: skip
    text = files["report.md"].read_text(encoding="utf-8")
    headings = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert headings == [
        "In short", "How to read the tables", "Quadratic programs, default settings",
        "Quadratic programs, mid settings", "Accuracy against the truth", "Growth with size",
        "Another right side", "Failures", "Machine and versions", "Limitations",
    ]  # fmt: skip
    assert all(limitation in text for limitation in LIMITATIONS)
    assert "| memory | 8.0 GiB |" in text
    assert "| slow | 2.0 |" in text
    for picture in re.findall(r"!\[[^]]+\]\(([^)]+)\)", text):
        ElementTree.parse(files[picture])
    tags = Tags()
    shown = files["report.html"].read_text(encoding="utf-8")
    tags.feed(shown)
    assert not tags.open
    assert tags.counts["img"] == sum(name.endswith(".svg") for name in files)
    assert all(link.startswith(("data:image/svg+xml;base64,", "#part-")) for link in tags.links)
    assert all(f'id="{link[1:]}"' in shown for link in tags.links if link.startswith("#"))
    assert "script" not in tags.counts


def test_failures_are_data(tmp_path):
    written(tmp_path / "run", many())
    with (tmp_path / "run" / "failures.csv").open(encoding="utf-8", newline="") as file:
        failures = list(csv.DictReader(file))
    assert [(line["problem"], line["solver"], line["why"]) for line in failures] == [
        ("a/20", "quick", WRONG["why"]), ("a/20", "slow", WRONG["why"])
    ]  # fmt: skip
    assert float(failures[0]["distance"]) == 0.5


def test_a_report_is_the_same_again_and_replaces_itself(tmp_path):
    before = {path.name: path.read_bytes() for path in written(tmp_path / "run", many())}
    after = {path.name: path.read_bytes() for path in write_report(tmp_path / "run")}
    assert before == after
    assert len(read_rows(tmp_path / "run")) == len(many())  # the rows are still there


def test_times_that_do_not_compare_are_marked_and_rank_nobody(tmp_path):
    written(tmp_path / "run", many(), times="not comparable")
    text = (tmp_path / "run" / "report.md").read_text(encoding="utf-8")
    assert "Times are not comparable: solves shared a machine" in text
    assert "| mean time (not comparable) |" in text
    assert "| build (not comparable) | set-up (not comparable) |" in text
    for absent in ("fastest |", "within 2x |", "## Growth", "## Another right side", "profile-"):
        assert absent not in text.replace("most often fastest |", "")
    assert [c.ranking for c in contests(outcomes(timed_apart()), timed=False)] == [["a", "z"]]
    assert [c.ranking for c in contests(outcomes(timed_apart()))] == [["z", "a"]]


def timed_apart() -> list[Row]:
    return [row(1, "z", 1e-6), row(1, "a", 1e-3)]


def test_a_report_of_little_says_what_is_missing(tmp_path):
    written(tmp_path / "one", [row(1, "a"), row(2, "b")], jobs=2)
    text = (tmp_path / "one" / "report.md").read_text(encoding="utf-8")
    assert "No problem was given to every solver" in text
    assert "Times are not comparable: solves shared a machine" in text
    assert "## Growth" not in text
    assert "## Failures\n\nNone.\n" in text
    with pytest.raises(InvalidInput, match="has no row yet"):
        written(tmp_path / "none", [])
    with pytest.raises(InvalidInput, match=r"has no rows\.jsonl"):
        write_report(tmp_path / "missing")


# -- pages of the documentation ------------------------------------------------------------------------------


def test_the_page_on_the_benchmark_names_every_family():
    text = (DOCS / "solver-benchmark.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `([\w-]+)` \|", text, re.MULTILINE) == list(FAMILIES)


def test_the_worked_example_of_a_solver_is_measured(tmp_path):
    path = DOCS / "add-a-solver.md"
    code, _, _ = executed(path)[0]
    text = path.read_text(encoding="utf-8")
    module = re.search(r"This module, `(\w+)\.py`", text)[1]
    announced = re.search(r"```toml\n(.*?)```", text, re.DOTALL)[1]
    entry = re.search(r'entry-points\."([\w.]+)"\]\n(\w+) = "(\w+:\w+)"', announced)
    site = tmp_path / "site"
    info = site / "slsqp_regrasp-1.0.dist-info"
    info.mkdir(parents=True)
    (site / f"{module}.py").write_text(code)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: slsqp-regrasp\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[{entry[1]}]\n{entry[2]} = {entry[3]}\n")
    command = [sys.executable, "-m", "regrasp", "bench", "--solver", entry[2], "--solver", "clarabel",
               "--family", "states", "--quick", "-o", str(tmp_path / "results")]  # fmt: skip
    paths = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(
        command, env=os.environ | {"PYTHONPATH": paths}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    rows = [r for r in read_rows(tmp_path / "results") if r.solver == "slsqp"]
    assert {r.version for r in rows} == {"1.0"}
    assert len(rows) >= 16  # the quadratic ones
    assert sum(r.correct is True for r in rows) >= 0.9 * len(rows)
    write_report(tmp_path / "results")
    assert "| slsqp |" in (tmp_path / "results" / "report.md").read_text(encoding="utf-8")
