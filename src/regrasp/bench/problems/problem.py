"""A problem of the benchmark: a program, where it comes from, and what is known of its answer.

minimise 1/2 x'Px + q'x subject to A x + s = b, s in K.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from hashlib import sha256

from regrasp.programs import Cone, Program


class Verdict(Enum):
    """What holds of a problem; the value is how reports call it."""

    SOLVABLE = "solvable"
    INFEASIBLE = "infeasible"
    UNKNOWN = "unknown"


class Truth(Enum):
    """Where the known answer comes from; the value is how reports call it."""

    CLOSED_FORM = "closed form"
    PUBLISHED = "published"
    PROOF = "exact proof"
    REFERENCE = "reference solve, certified by its duality gap"
    NONE = "nothing"


NEAR_ZERO = 1e-3
"""Part of ``Known.scale`` that an optimum counts as at least: errors relative to nothing say nothing."""


@dataclass(frozen=True)
class Known:
    """What is known of a problem's answer.

    optimum: the least objective, or None. accuracy: to which ``distance`` from it is known: rounding for a
    closed form, the last printed digit of a published number. scale: of an objective that matters where the
    optimum may be near zero: one where the program's data are of order one; zero where it cannot be. Nearer
    to zero than ``NEAR_ZERO`` of it, an optimum counts as that large.
    """

    verdict: Verdict
    truth: Truth
    optimum: float | None = None
    accuracy: float = 1e-12
    scale: float = 1.0

    def distance(self, objective: float) -> float | None:
        """How far an objective is from the optimum, relative to the latter; None if unknown."""
        if self.optimum is None:
            return None
        return abs(objective - self.optimum) / max(NEAR_ZERO * self.scale, abs(self.optimum))


@dataclass(frozen=True, eq=False)
class BenchProblem:
    """One program of a family.

    name: unique and stable, ``family/kind/number``. follows: the name of the problem that a warm-started
    solver has solved just before, with the same P, q and A and another b; None elsewhere.
    """

    name: str
    family: str
    program: Program
    known: Known
    follows: str | None = None

    @property
    def is_qp(self) -> bool:
        """Whether QP solvers can take it: no second-order cone."""
        return not self.program.has_second_order

    @property
    def size(self) -> tuple[int, int, int]:
        """Unknowns, rows, and non-zero entries of A."""
        program = self.program
        return program.q.size, program.b.size, int(program.A.nnz)

    @cached_property
    def digest(self) -> str:
        """Of its numbers and of what is known; another problem under the same name has another one."""
        program, known = self.program, self.known
        digest = sha256(repr((program.blocks, known, program.size)).encode())
        for matrix in (program.P, program.A):
            for part in (matrix.indptr, matrix.indices, matrix.data):
                digest.update(part.tobytes())
        digest.update(program.q.tobytes() + program.b.tobytes())
        return digest.hexdigest()[:16]

    @property
    def cones(self) -> str:
        """The cones in words: ``zero 3, non-negative 8, second-order 4x3``."""
        words = []
        for block in self.program.blocks:
            sized = f"{block.count}x{block.size}" if block.cone is Cone.SECOND_ORDER else str(block.rows)
            words.append(f"{block.cone.value} {sized}")
        return ", ".join(words)


@dataclass(frozen=True)
class Family:
    """Problems of one kind.

    origin: where they come from, in a sentence. formula: what is minimised subject to what. problems: yields
    them, the same at every call, from the smallest to the largest.
    """

    name: str
    origin: str
    formula: str
    problems: Callable[[], Iterator[BenchProblem]]
