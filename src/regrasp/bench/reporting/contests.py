"""Solvers side by side: the same problems at the same settings, and who comes first."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from statistics import fmean

from regrasp.bench.problems.settings import SETTINGS
from regrasp.bench.reporting.means import shifted_geometric_mean
from regrasp.bench.reporting.outcomes import Kind, Outcome, cold


@dataclass(frozen=True, eq=False)
class Contest:
    """Problems of one class, quadratic or of second order, that every solver in it was given.

    outcomes: by solver, then by problem; each solver has the same problems. left_out: problems that only some
    of them were given, because the run was ended or asked for less. timed: whether their times compare.
    """

    settings: str
    is_conic: bool
    outcomes: dict[str, dict[str, Outcome]]
    left_out: int
    timed: bool = True

    @property
    def title(self) -> str:
        """For headings."""
        return f"{'Second-order' if self.is_conic else 'Quadratic'} programs, {self.settings} settings"

    @property
    def slug(self) -> str:
        """For names of files."""
        return f"{'second-order' if self.is_conic else 'quadratic'}-{self.settings}"

    @property
    def problems(self) -> list[str]:
        """Names of the problems."""
        return list(next(iter(self.outcomes.values()), {}))

    @property
    def is_alone(self) -> bool:
        """Whether there is one solver only, so that ranks and comparisons say nothing."""
        return len(self.outcomes) < 2

    def count(self, solver: str, kind: Kind) -> int:
        """How many outcomes of a solver are of a kind."""
        return sum(outcome.kind is kind for outcome in self.outcomes[solver].values())

    def by_family(self, solver: str) -> float:
        """The mean over the families of the share of right answers in each."""
        families: dict[str, list[bool]] = defaultdict(list)
        for outcome in self.outcomes[solver].values():
            families[outcome.row.family].append(outcome.is_right)
        return fmean(fmean(right) for right in families.values())

    def mean(self, solver: str) -> float:
        """Shifted geometric mean of the times, an answer that is not right counted at the time limit [s]."""
        return shifted_geometric_mean(outcome.charged for outcome in self.outcomes[solver].values())

    @property
    def ranking(self) -> list[str]:
        """Solvers by the number of right answers, then of wrong ones, and only then by times that compare."""
        return sorted(
            self.outcomes,
            key=lambda solver: (
                -self.count(solver, Kind.RIGHT),
                self.count(solver, Kind.WRONG),
                self.mean(solver) if self.timed else 0.0,
                solver,
            ),
        )

    @property
    def shared(self) -> list[str]:
        """Problems that every solver answers rightly."""
        return [
            problem
            for problem in self.problems
            if all(there[problem].is_right for there in self.outcomes.values())
        ]


def contests(found: Iterable[Outcome], *, timed: bool = True) -> list[Contest]:
    """One for each settings and class of problems with cold solves."""
    groups: dict[tuple[str, bool], dict[str, dict[str, Outcome]]] = defaultdict(lambda: defaultdict(dict))
    for outcome in cold(found):
        row = outcome.row
        groups[row.settings, outcome.is_conic][row.solver][row.problem] = outcome
    result = []
    for (settings, is_conic), by_solver in sorted(
        groups.items(), key=lambda g: (SETTINGS.index(g[0][0]), g[0][1])
    ):
        every = set().union(*by_solver.values())
        shared = every.intersection(*by_solver.values())
        kept = {
            solver: {problem: there[problem] for problem in sorted(shared)}
            for solver, there in sorted(by_solver.items())
        }
        if shared:
            result.append(Contest(settings, is_conic, kept, len(every) - len(shared), timed))
    return result
