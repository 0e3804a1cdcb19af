"""The report of a run: ``report.md`` with its pictures, ``report.html`` alone, ``failures.csv``."""

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from regrasp.bench.judging.judgement import CERTIFICATE
from regrasp.bench.problems.problem import Verdict
from regrasp.bench.problems.settings import SETTINGS, right_within
from regrasp.bench.reporting.closeness import closeness
from regrasp.bench.reporting.contests import Contest, contests
from regrasp.bench.reporting.document import Block, Heading, Paragraph, Picture, Points, Table, markdown
from regrasp.bench.reporting.growth import growths
from regrasp.bench.reporting.limitations import LIMITATIONS
from regrasp.bench.reporting.means import SHIFT
from regrasp.bench.reporting.outcomes import Outcome, cold, outcomes
from regrasp.bench.reporting.page import page
from regrasp.bench.reporting.profiles import ratios
from regrasp.bench.reporting.tables import (
    certificate_table,
    closeness_table,
    contest_table,
    failure_table,
    family_table,
    growth_table,
    origin_table,
    parts_table,
    seconds,
    summary_table,
    warmth_table,
)
from regrasp.bench.reporting.warmth import warmths
from regrasp.bench.running.store import read_rows, read_run, times_compare
from regrasp.disk.staging import whole_folder
from regrasp.errors import InvalidInput

PAGE, TEXT, FAILURES = "report.html", "report.md", "failures.csv"
_COLUMNS = (
    "problem", "family", "solver", "version", "settings", "mode", "verdict", "truth", "optimum", "status",
    "said", "why", "objective", "distance", "primal_residual", "dual_residual", "gap", "certificate_residual",
    "iterations", "total_time",
)  # fmt: skip


_NOT_TIMED = (
    "Times are not comparable: solves shared a machine, or came from several. Columns of times say so, ranks "
    "do not heed them, and profiles, growth with size and updates are left out; right and wrong are as ever."
)


def write_report(folder: Path) -> list[Path]:
    """Write the report of the rows in ``folder`` into it; returns the files.

    Raises ``InvalidInput`` for a folder without rows.
    """
    folder = Path(folder)
    found, run = outcomes(read_rows(folder)), read_run(folder)
    if not found:
        raise InvalidInput(f"{folder} has no row yet; fill it with  regrasp bench -o {folder}")
    blocks = list(_blocks(found, run))
    with whole_folder(folder) as staged:
        (staged / TEXT).write_text(markdown(blocks), encoding="utf-8")
        (staged / PAGE).write_text(page(blocks), encoding="utf-8")
        for block in blocks:
            if isinstance(block, Picture):
                (staged / block.name).write_text(block.svg, encoding="utf-8")
        _write_failures(staged / FAILURES, found)
        names = sorted(path.name for path in staged.iterdir())
    return [folder / name for name in names]


def _failures(found: Sequence[Outcome]) -> list[Outcome]:
    return [outcome for outcome in found if not outcome.is_right]


def _write_failures(path: Path, found: Sequence[Outcome]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(_COLUMNS)
        for outcome in _failures(found):
            table.writerow([getattr(outcome.row, name) for name in _COLUMNS])


def _blocks(found: list[Outcome], run: dict[str, Any]) -> Iterator[Block]:
    from regrasp.plots.surveys.solvers import solver_looks

    looks = solver_looks({outcome.row.solver for outcome in found})
    yield Heading("Solvers on contact-force problems", 1)
    yield from _opening(found)
    timed = times_compare(run)
    if not timed:
        yield Paragraph(_NOT_TIMED)
    all_contests = contests(found, timed=timed)
    yield from _summary_blocks(all_contests)
    yield from _contest_blocks(all_contests, looks)
    settings = sorted({outcome.row.settings for outcome in found}, key=SETTINGS.index)
    yield from _truth_blocks(found, settings, looks)
    if timed:
        yield from _growth_blocks(found, settings, looks)
        yield from _warm_blocks(found)
    yield from _certificate_blocks(found)
    yield Heading("Failures")
    yield from _failure_blocks(found)
    yield Heading("Machine and versions")
    yield from _machine_blocks(found, run)
    yield Heading("Limitations")
    yield Points(LIMITATIONS)


def _opening(found: list[Outcome]) -> Iterator[Block]:
    first = list({outcome.row.problem: outcome for outcome in cold(found)}.values())
    solvers = {outcome.row.solver for outcome in found}
    yield Paragraph(
        f"{_counted(len(first), 'problem')}, {_counted(len(solvers), 'solver')}, "
        f"{_counted(len(found), 'solve')} with their repeats taken "
        "together. Solvers are ranked by their right answers, then by the fewest wrong ones, and only then "
        "by time: a wrong answer is never fast. Whether an answer is right is judged by residuals computed "
        "here and by what is known of the problem; where that is known from says this table."
    )
    yield origin_table(first)


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def _summary_blocks(all_contests: list[Contest]) -> Iterator[Block]:
    if any(not contest.is_alone for contest in all_contests):
        yield Heading("In short")
        yield Paragraph(
            "The solvers with the most right answers, and the one that is most often the fastest with a "
            "right one."
        )
        yield summary_table(all_contests)


def _contest_blocks(all_contests: list[Contest], looks: Any) -> Iterator[Block]:
    from regrasp.plots.surveys.solvers import plot_profiles, svg

    if not all_contests:
        yield Paragraph("No problem was given to every solver, so none are compared.")
        return
    limit = max(
        outcome.row.time_limit for c in all_contests for o in c.outcomes.values() for outcome in o.values()
    )
    yield Heading("How to read the tables")
    yield Points(
        [
            "right: correct within ten times the accuracy asked for, in every repeat; at default settings, "
            "where none is asked for, within 1e-2, which is ten times the loosest that a solver asks of "
            "itself. by family: the mean of the shares of right answers in each family, which does not "
            "weigh families by their size. verdict only: the solver says rightly that there is a solution, "
            "or that there is none, whatever its numbers are. wrong: an answer that is not right. not shown: "
            "a claim that nothing proves, such as that there is no solution, without a certificate. "
            "no answer: it said so, raised an error, crashed or ran out of time or memory. not taken: a kind "
            "of problem that the solver does not claim to solve.",
            f"mean time: shifted geometric mean over all problems with a shift of {seconds(SHIFT)}; answers "
            f"that are not right count at the time limit, {seconds(limit)}. mean, shared: over the problems "
            "that every solver of the table answers rightly.",
            "fastest, within 2x, within 10x: the share of all problems answered rightly in that many times "
            "the time of the fastest right answer. The picture shows it for every factor (performance "
            "profiles of Dolan and More).",
        ]
    )
    for contest in all_contests:
        within = right_within(contest.settings)
        yield Heading(contest.title)
        left = f" Left out: {contest.left_out}, not given to all." if contest.left_out else ""
        yield Paragraph(f"{len(contest.problems)} problems; right means to {within:g}.{left}")
        yield contest_table(contest)
        if contest.is_alone:
            yield Paragraph("One solver alone: nothing to compare it with.")
        elif contest.timed:
            rising = ratios(contest)
            ax = plot_profiles({solver: rising[solver] for solver in contest.ranking}, looks)
            words = f"Performance profiles: {contest.title}"
            yield Picture(f"profile-{contest.slug}.svg", words, svg(ax))
        yield Paragraph("Right answers by family, of the number in brackets:")
        yield family_table(contest)
        yield Paragraph(
            "Medians over the right answers, as far as solvers tell the parts of their time apart. Build is "
            "what qpsolvers and cvxpy do to the data; of the others it happens before the clock starts:"
        )
        yield parts_table(contest)


def _truth_blocks(found: list[Outcome], settings: list[str], looks: Any) -> Iterator[Block]:
    from regrasp.plots.surveys.solvers import plot_distances, svg

    yield Heading("Accuracy against the truth")
    yield Paragraph(
        "Distance of the objective from the optimum where a closed form or a publication tells it, no "
        "other solver: relative, infinite where no answer came or one that breaks the constraints. Each "
        "solver over the problems it was given."
    )
    for name in settings:
        near = closeness(found, name)
        if near:
            yield Heading(f"At {name} settings", 3)
            yield closeness_table(near)
            ax = plot_distances({s: c.distances for s, c in near.items()}, looks)
            yield Picture(f"distance-{name}.svg", f"Distances from known optima, {name} settings", svg(ax))


def _growth_blocks(found: list[Outcome], settings: list[str], looks: Any) -> Iterator[Block]:
    from regrasp.plots.surveys.solvers import plot_growth, svg

    name = "mid" if "mid" in settings else settings[0]
    grown = growths(found, name)
    if not grown:
        return
    yield Heading("Growth with size")
    yield Paragraph(
        f"Right answers at {name} settings. slope: of log time over log entries of A, 1 is linear. largest: "
        "unknowns of the largest problem answered rightly. MiB: memory that this one took. In the pictures "
        "the problems between one power of two and the next are one point, and pale lines grow linearly."
    )
    yield growth_table(grown)
    for family, by_solver in grown.items():
        ax = plot_growth({s: (g.sizes, g.times) for s, g in by_solver.items()}, looks)
        yield Picture(f"growth-{family}.svg", f"Time over size, family {family}, {name} settings", svg(ax))


def _warm_blocks(found: list[Outcome]) -> Iterator[Block]:
    warm = warmths(found)
    if warm:
        yield Heading("Another right side")
        yield Paragraph(
            "The load turns slowly: the same matrices, another right side. updated: the solver that has "
            "solved the problem before is given the new right side, and starts from what it has. Medians "
            "over the problems answered rightly both ways."
        )
        yield warmth_table(warm)


def _certificate_blocks(found: list[Outcome]) -> Iterator[Block]:
    claims = [o for o in cold(found) if o.row.verdict == Verdict.INFEASIBLE.value]
    if claims:
        yield Heading("Certificates")
        yield Paragraph(
            "Problems without solution: how often a solver says so, how often it hands out a certificate, "
            f"and how often that proves it by our arithmetic, to {CERTIFICATE:g}. Above, a verdict counts as "
            "right only where it is proven: anybody can say that there is no solution."
        )
        yield certificate_table(claims)


def _failure_blocks(found: list[Outcome]) -> Iterator[Block]:
    failures = _failures(found)
    if not failures:
        yield Paragraph("None.")
        return
    yield Paragraph(f"{len(failures)} of {len(found)}, each with its numbers in `{FAILURES}`. By kind:")
    yield failure_table(failures)


def _asked(found: list[Outcome]) -> dict[str, Any]:
    return {
        "settings": ", ".join(sorted({outcome.row.settings for outcome in found}, key=SETTINGS.index)),
        "repeats": max(outcome.repeats for outcome in found),
        "unknowns of the largest problem": max(outcome.row.unknowns for outcome in found),
    }


def _machine_blocks(found: list[Outcome], run: dict[str, Any]) -> Iterator[Block]:
    machine, solvers = run.get("machine", {}), run.get("solvers", {})
    others = {key: value for key, value in run.items() if key not in ("machine", "solvers")}
    facts = {**machine, **others, **_asked(found)}
    yield Table(["", "value"], [[key.replace("_", " "), _fact(key, value)] for key, value in facts.items()])
    yield Table(["solver", "version"], [[name, str(version)] for name, version in solvers.items()])


def _fact(key: str, value: Any) -> str:
    if key.startswith("memory") and isinstance(value, int):
        return f"{value / 2**30:.1f} GiB" if value else "none"
    return f"{value:g} s" if key == "time_limit" else str(value)
