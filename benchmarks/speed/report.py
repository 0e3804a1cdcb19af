"""What a benchmark found: rows, the machine they were measured on, JSON and a Markdown section."""

import json
import os
import platform
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from datetime import date
from enum import Enum
from importlib.metadata import version
from math import log
from pathlib import Path
from statistics import median
from typing import Any

from timing import Comparison


class Measure(Enum):
    """How a row is read; the value is how its number is written."""

    TIMES = "{:.3g}x the time"
    FASTER = "{:.3g}x faster"
    RATE = "{:.3g} of the rate"
    SLOPE = "log-log slope {:.3g}"
    SECONDS = "{:.3g} s"
    PERCENT = "{:.3g} %"
    BYTES = "{:.3g} bytes"
    GIB = "{:.3g} GiB"


@dataclass(frozen=True)
class Row:
    """One comparison; ``goal`` is None where a number is given for information.

    ours, theirs: median seconds per item. value: the median of the rounds' ratios; value_of_best: of the
    best times. limit: what limits a missed goal.
    """

    key: str
    what: str
    against: str
    measure: str
    ours: float
    theirs: float
    value: float
    value_of_best: float
    goal: float | None
    met: bool | None
    limit: str

    @classmethod
    def of(
        cls,
        key: str,
        what: str,
        against: str,
        found: Comparison,
        measure: Measure,
        goal: float | None = None,
        limit: str = "",
    ) -> "Row":
        """The row of a comparison; the goal is the most for ``TIMES`` and the least for the others."""
        value, best = found.ratio, found.ratio_of_best
        if measure in (Measure.FASTER, Measure.RATE):
            value, best = 1 / value, 1 / best
        met = None if goal is None else (value <= goal if measure is Measure.TIMES else value >= goal)
        ours, theirs = median(found.ours), median(found.theirs)
        return cls(key, what, against, measure.name, ours, theirs, value, best, goal, met, limit)

    @classmethod
    def growth(cls, key: str, what: str, found: Comparison, larger: float, goal: float, limit: str) -> "Row":
        """How the cost grows from their size to ours, ``larger`` times as large: 1 is linear."""
        value, best = (log(ratio) / log(larger) for ratio in (found.ratio, found.ratio_of_best))
        ours, theirs = median(found.ours), median(found.theirs)
        measure = Measure.SLOPE.name
        return cls(key, what, "itself", measure, ours, theirs, value, best, goal, value <= goal, limit)

    @classmethod
    def alone(
        cls, key: str, what: str, value: float, measure: Measure, goal: float | None = None, limit: str = ""
    ) -> "Row":
        """A number that is compared with nothing but the most it may be, if anything."""
        met = None if goal is None else value <= goal
        return cls(key, what, "", measure.name, value, value, value, value, goal, met, limit)

    def cells(self) -> tuple[str, ...]:
        """The row as text, one cell per column of ``COLUMNS``."""
        written = Measure[self.measure].value.format
        goal, verdict = "", ""
        if self.goal is not None:
            bound = "at least" if self.measure in ("FASTER", "RATE") else "at most"
            goal, verdict = f"{bound} {written(self.goal)}", "yes" if self.met else "**no**"
        times = (_seconds(self.ours), _seconds(self.theirs)) if self.against else ("", "")
        return (
            self.what,
            self.against,
            *times,
            written(self.value),
            written(self.value_of_best),
            goal,
            verdict,
        )


COLUMNS = ("what", "against", "ours", "theirs", "median ratio", "ratio of best", "goal", "met")


@dataclass(frozen=True)
class Report:
    """Rows with what one needs to know to judge them."""

    name: str
    quick: bool
    rows: tuple[Row, ...]
    environment: dict[str, Any]

    @classmethod
    def of(cls, name: str, quick: bool, rows: Iterable[Row], packages: Iterable[str]) -> "Report":
        """Measure the rows, then describe the machine and the packages used."""
        before = os.getloadavg()[0]
        measured = tuple(rows)
        environment = {
            "date": date.today().isoformat(),
            "processor": _processor(),
            "cores": os.cpu_count(),
            "system": f"{platform.system()} {platform.machine()}",
            "python": platform.python_version(),
            "versions": {package: version(package) for package in packages},
            "load_average": {"before": round(before, 2), "after": round(os.getloadavg()[0], 2)},
        }
        return cls(name, quick, measured, environment)

    def markdown(self) -> str:
        """A table with its circumstances below it."""
        lines = ["| " + " | ".join(COLUMNS) + " |", "|---|---|--:|--:|--:|--:|--:|---|"]
        lines += ["| " + " | ".join(row.cells()) + " |" for row in self.rows]
        e = self.environment
        versions = ", ".join(f"{name} {number}" for name, number in e["versions"].items())
        load = e["load_average"]
        lines += [
            "",
            f"Measured on {e['date']}: {e['processor']}, {e['cores']} cores, {e['system']}, "
            f"Python {e['python']}, {versions}; "
            f"load average {load['before']} before and {load['after']} after.",
        ]
        limits: dict[str, list[str]] = {}
        for row in self.rows:
            if row.met is False:
                limits.setdefault(row.limit, []).append(f"*{row.what}*")
        missed = [
            f"- {'; '.join(what)} {'misses its goal' if len(what) == 1 else 'miss their goals'}: {limit}"
            for limit, what in limits.items()
        ]
        return "\n".join([*lines, "", *missed] if missed else lines)

    def write(self, folder: Path) -> None:
        """``folder/results/<name>.json``, and the table between its markers in ``folder/README.md``."""
        results = folder / "results"
        results.mkdir(parents=True, exist_ok=True)
        text = json.dumps(asdict(self), indent=2, allow_nan=False) + "\n"
        (results / f"{self.name}.json").write_text(text, encoding="utf-8")
        readme = folder / "README.md"
        page = readme.read_text(encoding="utf-8") if readme.exists() else ""
        readme.write_text(_with_section(page, self.name, self.markdown()), encoding="utf-8")


def _with_section(page: str, name: str, section: str) -> str:
    """The page with ``section`` in place of what stood between the markers of that name, or at its end."""
    begin, end = f"<!-- {name}: generated, do not edit -->", f"<!-- end of {name} -->"
    block = f"{begin}\n{section}\n{end}"
    if begin not in page:
        return f"{page}{block}\n"
    head, rest = page.split(begin, 1)
    return head + block + rest.split(end, 1)[1]


def _seconds(value: float) -> str:
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value / 1e-9:.3g} ns"


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
