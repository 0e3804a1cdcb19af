"""The families as a test set that qpbenchmark runs (https://github.com/qpsolvers/qpbenchmark).

Its command line takes this file: ``qpbenchmark .../qpbenchmark_set.py run``, for the name of the class is
that of the file. Second-order cones are not for QP solvers, and qpbenchmark knows no right answer to a
problem without solution; both kinds are left out.
"""

from collections.abc import Iterable, Iterator

import qpbenchmark

from regrasp.bench.exchange.npz import split
from regrasp.bench.families import FAMILIES
from regrasp.bench.problems.problem import BenchProblem, Verdict

# As many unknowns as qpbenchmark's own dense subset of Maros and Meszaros has.
_DENSE = 1000


class QpbenchmarkSet(qpbenchmark.TestSet):  # type: ignore[misc]
    """The solvable quadratic programs of the benchmark, or of some families by name.

    most: leaves out problems of more unknowns, or None for all of them. Problems of up to 1000 unknowns come
    dense, and qpbenchmark makes them sparse outside its timing for solvers that need that; larger ones come
    sparse, and solvers of dense problems refuse them.
    """

    def __init__(self, families: Iterable[str] = tuple(FAMILIES), most: int | None = _DENSE) -> None:
        self._families = [FAMILIES[name] for name in families]
        self._most = most
        super().__init__()

    @property
    def title(self) -> str:
        """What reports are called."""
        return "Contact-force test set"

    @property
    def description(self) -> str:
        """What it is made of, for reports."""
        return "Contact forces of grasps. " + " ".join(
            f"{family.name}: {family.origin}." for family in self._families
        )

    @property
    def sparse_only(self) -> bool:
        """No: most problems are small."""
        return False

    def __iter__(self) -> Iterator[qpbenchmark.Problem]:
        """Problems from the smallest to the largest of each family."""
        for family in self._families:
            for problem in family.problems():
                program = problem.program
                if not problem.is_qp or problem.known.verdict is not Verdict.SOLVABLE:
                    continue
                if self._most is not None and program.q.size > self._most:
                    continue
                yield _named(problem)


def _named(problem: BenchProblem) -> qpbenchmark.Problem:
    """The problem in qpbenchmark's letters, its arrays copied: some solvers refuse those of programs."""
    program = problem.program
    G, h, A, b = split(program)
    sparse_one = qpbenchmark.Problem(
        P=program.P.copy(), q=program.q.copy(),
        G=G if h.size else None, h=h if h.size else None,
        A=A if b.size else None, b=b if b.size else None,
        lb=None, ub=None, name=problem.name,
    )  # fmt: skip
    return sparse_one.to_dense() if program.q.size <= _DENSE else sparse_one
