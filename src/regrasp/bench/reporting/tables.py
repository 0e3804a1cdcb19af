"""Results of a run as tables of a report."""

from collections import Counter
from collections.abc import Iterable, Sequence
from math import inf
from statistics import median

from regrasp.bench.judging.judgement import is_proof
from regrasp.bench.problems.settings import SETTINGS
from regrasp.bench.reporting.closeness import Closeness
from regrasp.bench.reporting.contests import Contest
from regrasp.bench.reporting.document import Table
from regrasp.bench.reporting.growth import Growth
from regrasp.bench.reporting.means import shifted_geometric_mean
from regrasp.bench.reporting.outcomes import PARTS, Kind, Outcome
from regrasp.bench.reporting.profiles import ratios, share_within
from regrasp.bench.reporting.warmth import Warmth

NOTHING = "–"


def contest_table(contest: Contest) -> Table:
    """Each solver's right answers, verdicts and times, the first in rank on top; one alone has no rank."""
    rising = ratios(contest)
    shared = contest.shared
    rows = []
    for solver in contest.ranking:
        there = contest.outcomes[solver]
        verdicts = [outcome.has_right_verdict for outcome in there.values()]
        times = [there[problem].charged for problem in shared]
        cells = [
            solver,
            percent(contest.count(solver, Kind.RIGHT), len(there)),
            percent(contest.by_family(solver), 1.0),
            percent(sum(verdicts), len(verdicts)),
            *(str(contest.count(solver, kind)) for kind in _NOT_RIGHT),
            seconds(contest.mean(solver)),
        ]
        if contest.timed and not contest.is_alone:
            cells += [
                seconds(shifted_geometric_mean(times)) if times else NOTHING,
                *(f"{100 * share_within(rising[solver], factor):.0f} %" for factor in (1, 2, 10)),
            ]
        rows.append(cells)
    header = ["solver", "right", "by family", "verdict only", *_NOT_RIGHT.values()]
    compared = ["mean, shared", "fastest", "within 2x", "within 10x"]
    alone = contest.is_alone or not contest.timed
    return Table([*header, _marked("mean time", contest), *([] if alone else compared)], rows)


def _marked(column: str, contest: Contest) -> str:
    """The name of a column of times, with a word where they do not compare."""
    return column if contest.timed else f"{column} (not comparable)"


_NOT_RIGHT = {
    Kind.WRONG: "wrong",
    Kind.UNJUDGED: "not shown",
    Kind.NONE: "no answer",
    Kind.REFUSED: "not taken",
}


def summary_table(all_contests: Iterable[Contest]) -> Table:
    """Who is first in each contest of two solvers or more."""
    rows = []
    for contest in all_contests:
        if contest.is_alone:
            continue
        size, most = len(contest.problems), contest.count(contest.ranking[0], Kind.RIGHT)
        first = [solver for solver in contest.ranking if contest.count(solver, Kind.RIGHT) == most > 0]
        shares = {solver: share_within(rising, 1) for solver, rising in ratios(contest).items()}
        fastest = max(contest.ranking, key=shares.__getitem__)
        timed = contest.timed and shares[fastest] > 0
        best = [fastest, f"{100 * shares[fastest]:.0f} %", f"{contest.count(fastest, Kind.RIGHT)} of {size}"]
        rows.append(
            [
                contest.title,
                ", ".join(first) or NOTHING,
                f"{most} of {size}",
                *(best if timed else [NOTHING] * 3),
            ]
        )
    header = ["", "most right", "right answers", "most often fastest", "how often", "its right answers"]
    return Table(header, rows, words=2)


def family_table(contest: Contest) -> Table:
    """Right answers of each solver in each family, of how many."""
    first = next(iter(contest.outcomes.values()))
    families = list(dict.fromkeys(outcome.row.family for outcome in first.values()))
    rows = []
    for solver in contest.ranking:
        there = contest.outcomes[solver].values()
        right = Counter(outcome.row.family for outcome in there if outcome.is_right)
        rows.append([solver, *(str(right[family]) for family in families)])
    sizes = Counter(outcome.row.family for outcome in first.values())
    return Table(["solver", *(f"{family} ({sizes[family]})" for family in families)], rows)


def parts_table(contest: Contest) -> Table:
    """Where the time of each solver's right answers goes."""
    rows = []
    for solver in contest.ranking:
        right = [outcome for outcome in contest.outcomes[solver].values() if outcome.is_right]
        parts = zip(*(outcome.parts for outcome in right), strict=True) if right else [()] * len(PARTS)
        whole = [outcome.time for outcome in right if outcome.time is not None]
        known = [[part for part in times if part is not None] for times in (*parts, whole)]
        counts = [outcome.row.iterations for outcome in right if outcome.row.iterations is not None]
        medians = [seconds(median(times)) if times else NOTHING for times in known]
        rows.append([solver, *medians, f"{median(counts):g}" if counts else NOTHING])
    times = [_marked(column, contest) for column in ("build", "set-up", "solve", "whole call")]
    return Table(["solver", *times, "iterations"], rows)


def growth_table(growths: dict[str, dict[str, Growth]]) -> Table:
    """Slopes of log time over log size and the largest problem answered rightly, for each family."""
    solvers = sorted({solver for by_solver in growths.values() for solver in by_solver})
    rows = []
    for solver in solvers:
        cells = [solver]
        for by_solver in growths.values():
            growth = by_solver.get(solver)
            slope = None if growth is None else growth.slope
            cells += [
                NOTHING if slope is None else f"{slope:.2f}",
                str(growth.largest) if growth else NOTHING,
            ]
            held = None if growth is None else growth.memory
            cells.append(NOTHING if held is None else f"{held / 2**20:.1f}")
        rows.append(cells)
    header = [f"{family}, {what}" for family in growths for what in ("slope", "largest", "MiB")]
    return Table(["solver", *header], rows)


def closeness_table(found: dict[str, Closeness]) -> Table:
    """How far from the known optimum the answers are: half of them, nine tenths, the worst that came."""
    rows = [
        [
            solver,
            f"{there.answered} of {len(there.distances)}",
            *(_distance(distance) for distance in (there.share(0.5), there.share(0.9), there.worst)),
        ]
        for solver, there in sorted(found.items(), key=lambda item: (item[1].share(0.5), item[0]))
    ]
    return Table(["solver", "answered", "median distance", "of nine tenths", "largest answered"], rows)


def warmth_table(found: dict[tuple[str, str], Warmth]) -> Table:
    """Cold and updated solves of each solver."""
    rows = [
        [solver, settings, seconds(w.cold), seconds(w.warm), f"{w.ratio:.2f}", f"{w.right} of {w.given}"]
        for (settings, solver), w in found.items()
    ]
    return Table(["solver", "settings", "cold", "updated", "updated / cold", "updated right"], rows, words=2)


def failure_table(failures: Iterable[Outcome]) -> Table:
    """How many failures of each kind every solver has, and in which families."""
    groups: dict[tuple[str, str, str], Counter[str]] = {}
    for outcome in failures:
        row = outcome.row
        key = (row.solver, row.settings, row.why if outcome.kind is not Kind.NONE else row.status)
        groups.setdefault(key, Counter())[row.family] += 1
    rows = [
        [solver, settings, why, ", ".join(f"{f} {n}" for f, n in families.items()), str(families.total())]
        for (solver, settings, why), families in sorted(groups.items())
    ]
    return Table(["solver", "settings", "what happened", "families", "times"], rows, words=4)


def origin_table(first: Sequence[Outcome]) -> Table:
    """Problems of each family by where their answers are known from."""
    counts: dict[str, Counter[str]] = {}
    sizes: dict[str, list[int]] = {}
    for outcome in first:
        counts.setdefault(outcome.row.family, Counter())[outcome.row.truth] += 1
        sizes.setdefault(outcome.row.family, []).append(outcome.row.unknowns)
    truths = sorted({truth for by_truth in counts.values() for truth in by_truth})
    rows = [
        [family, str(by_truth.total()), f"{min(sizes[family])} to {max(sizes[family])}",
         *(str(by_truth[truth]) for truth in truths)]
        for family, by_truth in counts.items()
    ]  # fmt: skip
    return Table(["family", "problems", "unknowns", *truths], rows)


def certificate_table(claims: Iterable[Outcome]) -> Table:
    """Of each solver and settings: problems without solution, verdicts, certificates, and proofs by these."""
    groups: dict[tuple[str, str], list[Outcome]] = {}
    for outcome in claims:
        groups.setdefault((outcome.row.settings, outcome.row.solver), []).append(outcome)
    rows = []
    for (settings, solver), there in sorted(groups.items(), key=lambda g: (SETTINGS.index(g[0][0]), g[0][1])):
        residuals = [o.row.certificate_residual for o in there if o.has_right_verdict]
        given = [residual for residual in residuals if residual is not None]
        proven = sum(map(is_proof, given))
        counts = (len(there), len(residuals), len(given), proven)
        rows.append([solver, settings, *map(str, counts), f"{max(given):.1e}" if given else NOTHING])
    header = ["solver", "settings", "infeasible", "says so", "with a certificate", "proven", "worst residual"]
    return Table(header, rows, words=2)


def percent(part: float, whole: float) -> str:
    """A share with one digit, never 100.0 % of less than all."""
    share = 100 * part / whole
    return f"{min(share, 99.9) if part < whole else share:.1f} %"


def seconds(time: float) -> str:
    """A time with the unit that suits it, in three digits."""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if time >= 0.9995 * size:
            return f"{time / size:.3g} {unit}"
    return f"{time / 1e-6:.3g} µs"


def _distance(value: float) -> str:
    return "no answer" if value == inf else f"{value:.1e}"
