"""What came of each problem for each solver: the rows of all repeats taken together."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from statistics import median

from regrasp.bench.problems.problem import Truth, Verdict
from regrasp.bench.running.result import COLD, Row
from regrasp.programs.answer import Claim

PARTS = ("build_time", "setup_time", "solve_time")
_EXACT = (Truth.CLOSED_FORM.value, Truth.PUBLISHED.value)


class Kind(Enum):
    """How an outcome counts; the value is how reports call it."""

    RIGHT = "right"
    WRONG = "wrong"
    NONE = "no answer"
    REFUSED = "not taken"
    UNJUDGED = "not judged"


@dataclass(frozen=True, eq=False)
class Outcome:
    """All repeats of one solve.

    row: of the repeat that counts, the worst one. kind: right if every repeat is. time: median around the
    whole call [s], or None where some repeat never came back. parts: medians of build, set-up and solve, None
    where the solver does not tell them. distance: the largest from the known optimum. repeats: how many.
    """

    row: Row
    kind: Kind
    time: float | None
    parts: tuple[float | None, ...]
    distance: float | None
    repeats: int

    @property
    def is_right(self) -> bool:
        """Whether every repeat is right."""
        return self.kind is Kind.RIGHT

    @property
    def has_right_verdict(self) -> bool:
        """Whether the solver says rightly that the problem has a solution, or that it has none."""
        right = {Claim.FOUND.value: Verdict.SOLVABLE.value, Claim.INFEASIBLE.value: Verdict.INFEASIBLE.value}
        return right.get(self.row.status) == self.row.verdict

    @property
    def charged(self) -> float:
        """The time [s] if the answer is right, and the time limit if not."""
        limit = self.row.time_limit
        return limit if self.time is None or not self.is_right else min(self.time, limit)

    @property
    def is_conic(self) -> bool:
        """Whether the problem has second-order cones, so that QP solvers cannot take it."""
        return "second-order" in self.row.cones

    @property
    def knows_exactly(self) -> bool:
        """Whether the optimum is a formula's or a published one, and no other solver's."""
        return self.row.truth in _EXACT and self.row.verdict == Verdict.SOLVABLE.value


def outcomes(rows: Iterable[Row]) -> list[Outcome]:
    """The outcome of each problem, solver, settings and mode."""
    together: dict[tuple[str, ...], list[Row]] = defaultdict(list)
    for row in rows:
        together[row.problem, row.solver, row.settings, row.mode].append(row)
    return [_outcome(repeats) for repeats in together.values()]


def cold(found: Iterable[Outcome]) -> list[Outcome]:
    """Those of solvers that had seen nothing like the problem before."""
    return [outcome for outcome in found if outcome.row.mode == COLD]


def _outcome(repeats: list[Row]) -> Outcome:
    kinds = [_kind(row) for row in repeats]
    order = (Kind.WRONG, Kind.NONE, Kind.REFUSED, Kind.UNJUDGED, Kind.RIGHT)
    worst = next(kind for kind in order if kind in kinds)
    times = [row.total_time for row in repeats if row.total_time is not None]
    distances = [row.distance for row in repeats if row.distance is not None]
    return Outcome(
        row=repeats[kinds.index(worst)],
        kind=worst,
        time=median(times) if len(times) == len(repeats) else None,
        parts=tuple(_median([getattr(row, part) for row in repeats]) for part in PARTS),
        distance=max(distances, default=None),
        repeats=len(repeats),
    )


def _median(times: list[float | None]) -> float | None:
    told = [time for time in times if time is not None]
    return median(told) if told else None


def _kind(row: Row) -> Kind:
    if row.status == Claim.REFUSED.value:
        return Kind.REFUSED
    if row.status not in (Claim.FOUND.value, Claim.INFEASIBLE.value, Claim.UNBOUNDED.value):
        return Kind.NONE
    return {True: Kind.RIGHT, False: Kind.WRONG, None: Kind.UNJUDGED}[row.correct]
