"""How near the answers come to the truth, where a formula or a publication tells it."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, inf

from regrasp.bench.problems.settings import right_within
from regrasp.bench.reporting.outcomes import Outcome, cold
from regrasp.programs.answer import Claim


@dataclass(frozen=True)
class Closeness:
    """Distances of one solver's objectives from the known optima, relative and rising.

    An answer that did not come is infinitely far, and so is one that breaks the constraints.
    """

    distances: tuple[float, ...]

    @property
    def answered(self) -> int:
        """How many came."""
        return sum(distance < inf for distance in self.distances)

    @property
    def worst(self) -> float:
        """The largest of those that came; infinite if none did."""
        return max((distance for distance in self.distances if distance < inf), default=inf)

    def share(self, part: float) -> float:
        """The distance that a part of all problems, between 0 and 1, does not exceed."""
        return self.distances[max(ceil(part * len(self.distances)), 1) - 1]


def closeness(found: Iterable[Outcome], settings: str) -> dict[str, Closeness]:
    """By solver, over the problems whose optimum is known exactly and which it was given."""
    distances: dict[str, list[float]] = defaultdict(list)
    for outcome in cold(found):
        row = outcome.row
        if row.settings == settings and outcome.knows_exactly:
            off, far = row.primal_residual, outcome.distance
            came = row.status == Claim.FOUND.value and off is not None and off <= right_within(settings)
            distances[row.solver].append(far if came and far is not None else inf)
    return {solver: Closeness(tuple(sorted(there))) for solver, there in sorted(distances.items())}
