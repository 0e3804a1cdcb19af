"""The report of a benchmark: every part, a page that stands alone, failures as data."""

import csv
import json
import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from bench_toys import LIMIT, WRONG, row
from documents import executed
from places import ROOT
from regrasp.bench.families import FAMILIES
from regrasp.bench.reporting.contests import contests
from regrasp.bench.reporting.document import Heading, Paragraph, Table, markdown
from regrasp.bench.reporting.limitations import LIMITATIONS
from regrasp.bench.reporting.outcomes import outcomes
from regrasp.bench.reporting.page import page
from regrasp.bench.reporting.report import write_report
from regrasp.bench.running.result import WARM, Row
from regrasp.bench.running.store import read_rows
from regrasp.errors import InvalidInput

pytestmark = pytest.mark.oracle

DOCS = ROOT / "docs"


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
