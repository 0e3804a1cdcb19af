"""What a run solves: problems, solvers, settings, and what each solve may take."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import isfinite

from regrasp.bench.problems.problem import BenchProblem, Family
from regrasp.bench.problems.settings import check
from regrasp.bench.running import machine
from regrasp.bench.running.result import COLD, WARM, Key, Row
from regrasp.bench.running.solvers import Solver
from regrasp.errors import InvalidInput, shown


@dataclass(frozen=True)
class Limits:
    """What each solve may take, and how many there are.

    repeat: solves of each kind. time_limit: of each solve [s]. memory_limit: addresses of each process
    [bytes], 0 for none, None for half of the machine's memory shared by all. Raises ``InvalidInput`` for
    numbers that make no sense.
    """

    repeat: int = 1
    time_limit: float = 60.0
    memory_limit: int | None = None

    def __post_init__(self) -> None:
        if self.repeat < 1:
            raise InvalidInput(f"repeat must be at least 1, got {self.repeat}")
        if not (isfinite(self.time_limit) and self.time_limit > 0):
            raise InvalidInput(f"the time limit must be a positive number of seconds, got {self.time_limit}")

    def memory_of(self, processes: int) -> int:
        """Addresses each of so many processes may have [bytes], 0 for no limit."""
        if not machine.can_limit_memory():
            if self.memory_limit:
                raise InvalidInput("this system limits no process's memory; leave memory_limit out")
            return 0
        if self.memory_limit is not None:
            return self.memory_limit
        return (machine.memory() or 0) // (2 * processes)


USUAL = Limits()
"""One solve of each kind, a minute each."""


@dataclass(frozen=True, eq=False)
class Job:
    """A problem for a solver; before: what it has solved just before, for a warm solve."""

    problem: BenchProblem
    solver: Solver
    settings: str
    before: BenchProblem | None = None

    def key(self, repeat: int) -> Key:
        """The key of a repeat's row."""
        mode = COLD if self.before is None else WARM
        return Key(self.problem.name, self.solver.name, self.settings, mode, repeat)

    def missing(self, rows: dict[Key, Row], repeat: int) -> list[int]:
        """Repeats without a row; none after one that was lost.

        Raises ``InvalidInput`` for a row of another problem of the same name.
        """
        there = [rows.get(self.key(k)) for k in range(repeat)]
        if any(row is not None and row.digest != self.problem.digest for row in there):
            raise InvalidInput(
                f"there are rows of another problem that is called {self.problem.name} too; "
                "give another folder"
            )
        if any(row is not None and row.is_lost for row in there):
            return []
        return [k for k, row in enumerate(there) if row is None]


def chosen_problems(
    families: dict[str, Family], names: Iterable[str], most: int | None = None
) -> list[BenchProblem]:
    """The problems of the named families, or of all, of at most ``most`` unknowns.

    Raises ``InvalidInput`` for an unknown family and where no problem is left.
    """
    names = list(dict.fromkeys(names))
    for name in names:
        if name not in families:
            raise InvalidInput(f"no family {shown(name)}; there are {', '.join(families)}")
    problems = [p for name in names or families for p in families[name].problems()]
    small = [p for p in problems if most is None or p.size[0] <= most]
    if not small:
        least = min((p.size[0] for p in problems), default=0)
        raise InvalidInput(f"no problem has at most {most} unknowns; the smallest has {least}")
    return small


def planned(
    problems: Sequence[BenchProblem], solvers: Sequence[Solver], settings: Sequence[str]
) -> list[Job]:
    """Every solve to make: family by family, and in it solver by solver, so that a crash costs one import."""
    for name in settings:
        check(name)
    by_name = {problem.name: problem for problem in problems}
    if len(by_name) < len(problems):
        raise InvalidInput("two problems of the benchmark have one name")
    families: dict[str, list[BenchProblem]] = {}
    for problem in problems:
        families.setdefault(problem.family, []).append(problem)
    return [
        Job(problem, solver, name, before)
        for family in families.values()
        for solver in solvers
        for name in dict.fromkeys(settings)
        for problem in family
        if solver.takes_cones or problem.is_qp
        for before in _modes(problem, solver, by_name)
    ]


def _modes(
    problem: BenchProblem, solver: Solver, by_name: dict[str, BenchProblem]
) -> Iterator[BenchProblem | None]:
    yield None
    if problem.follows in by_name and solver.updates:
        yield by_name[problem.follows]
