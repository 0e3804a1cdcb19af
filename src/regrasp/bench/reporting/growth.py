"""How the time of a solver grows with the size of a problem."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from math import exp, log
from statistics import fmean, linear_regression

from regrasp.bench.reporting.outcomes import Outcome, cold

SPAN = 10.0
"""Families whose largest problem has so many times the entries of the smallest have a growth to speak of."""


@dataclass(frozen=True)
class Growth:
    """Times of one solver over a family.

    sizes: non-zero entries of A, rising. times: geometric means over the right answers of that size [s].
    largest: unknowns of the largest problem answered rightly. memory: of that one, see ``Row`` [bytes].
    """

    sizes: tuple[int, ...]
    times: tuple[float, ...]
    largest: int
    memory: int | None

    @property
    def slope(self) -> float | None:
        """Of log time over log size by least squares; None where the sizes span less than ``SPAN``."""
        if self.sizes[-1] < SPAN * self.sizes[0] or len(self.sizes) < 3:
            return None
        return linear_regression([log(n) for n in self.sizes], [log(t) for t in self.times]).slope


def growths(found: Iterable[Outcome], settings: str) -> dict[str, dict[str, Growth]]:
    """By family, then by solver; families that hardly vary in size and solvers never right left out."""
    families: dict[str, dict[str, list[Outcome]]] = defaultdict(lambda: defaultdict(list))
    sizes: dict[str, set[int]] = defaultdict(set)
    for outcome in cold(found):
        row = outcome.row
        if row.settings != settings:
            continue
        sizes[row.family].add(row.nonzeros)
        if outcome.is_right and outcome.time:
            families[row.family][row.solver].append(outcome)
    return {
        family: {solver: _growth(right) for solver, right in sorted(by_solver.items())}
        for family, by_solver in families.items()
        if max(sizes[family]) >= SPAN * min(sizes[family])
    }


def _growth(right: list[Outcome]) -> Growth:
    logs: dict[int, list[float]] = defaultdict(list)
    for outcome in right:
        logs[outcome.row.nonzeros].append(log(outcome.time or 1.0))
    sizes = tuple(sorted(logs))
    largest = max(right, key=lambda outcome: outcome.row.unknowns).row
    return Growth(sizes, tuple(exp(fmean(logs[n])) for n in sizes), largest.unknowns, largest.memory)
