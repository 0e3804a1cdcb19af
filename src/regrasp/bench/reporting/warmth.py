"""What a solver gains where only the right side of a problem has changed since its last solve."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from statistics import median

from regrasp.bench.reporting.outcomes import Outcome
from regrasp.bench.running.result import COLD, WARM


@dataclass(frozen=True)
class Warmth:
    """Medians over the problems that a solver answers rightly both ways.

    cold, warm: time of a solve [s]. ratio: of a problem's warm time to its cold one. right, given: how many
    warm solves are right, of how many.
    """

    cold: float
    warm: float
    ratio: float
    right: int
    given: int


def warmths(found: Iterable[Outcome]) -> dict[tuple[str, str], Warmth]:
    """By settings and solver; those with nothing right both ways left out."""
    modes: dict[tuple[str, str], dict[str, dict[str, Outcome]]] = defaultdict(lambda: {COLD: {}, WARM: {}})
    for outcome in found:
        row = outcome.row
        modes[row.settings, row.solver][row.mode][row.problem] = outcome
    result = {}
    for key, by_mode in modes.items():
        warm = by_mode[WARM]
        pairs = [
            (before.time, after.time)
            for problem, after in warm.items()
            if (before := by_mode[COLD].get(problem)) and before.is_right and after.is_right
            and before.time and after.time
        ]  # fmt: skip
        if pairs:
            result[key] = Warmth(
                cold=median(before for before, _ in pairs),
                warm=median(after for _, after in pairs),
                ratio=median(after / before for before, after in pairs),
                right=sum(outcome.is_right for outcome in warm.values()),
                given=len(warm),
            )
    return result
