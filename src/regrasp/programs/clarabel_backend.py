"""Clarabel, called directly. Imported when used."""

from functools import cache, lru_cache
from threading import local
from time import perf_counter
from typing import Any

import clarabel
import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.programs.blocks import Array, Block, Cone
from regrasp.programs.facts import BACKENDS
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution, Status

# "Almost" verdicts are not verdicts.
_STATUS = {
    "Solved": Status.SOLVED,
    "PrimalInfeasible": Status.INFEASIBLE,
    "DualInfeasible": Status.UNBOUNDED,
}


def solve(program: Program, name: str, **options: Any) -> Solution:
    """Solve with Clarabel; ``options`` are its settings by name."""
    started = perf_counter()
    settings = _settings(**options)
    cones = _cones_of(program.blocks)
    # Of P, both of whose triangles are given, it takes the upper one.
    solver = clarabel.DefaultSolver(program.P, program.q, program.A, program.b, cones, settings)
    built = perf_counter()
    answer = solver.solve()
    solved = perf_counter()
    said = str(answer.status)
    return Solution(
        program,
        name,
        _STATUS.get(said, Status.STOPPED),
        np.array(answer.x),
        np.array(answer.z),
        answer.iterations,
        built - started,
        solved - built,
        said,
    )


_LEAN = (
    "presolve_enable",
    "equilibrate_enable",
    "chordal_decomposition_enable",
    "iterative_refinement_enable",
)
_MOST_KEPT = 64
_LARGEST = 1e50  # unknowns of order one do not end beyond
_memory = local()  # solvers are of the thread that made them


def solved_again(program: Program, entries: Array) -> tuple[Array, Array] | None:
    """Value and duals by a solver kept for this pattern, without the steps that buy nothing there.

    entries: (k,) of A. The answer does not depend on what was asked before. For programs that are quick
    (``Program.is_quick``) and whose places are shared (``Pattern``). NaN where it says that there is
    none; None where it says nothing.
    """
    P, A = program.P, program.A
    solvers: dict[Any, _Kept] = _memory.__dict__.setdefault("solvers", {})
    key = id(A.indices), id(A.indptr), P.nnz, program.blocks
    kept = solvers.get(key)
    if kept is None:
        if len(solvers) >= _MOST_KEPT:
            solvers.clear()
        kept = solvers[key] = _Kept(program)
    return kept.answer(program, entries)


class _Kept:
    """A solver, and the numbers that it has."""

    def __init__(self, program: Program) -> None:
        lean = _settings(**dict.fromkeys(_LEAN, False))
        self.solver = clarabel.DefaultSolver(
            program.P, program.q, program.A, program.b, _cones_of(program.blocks), lean
        )
        # Places that live on: so no other matrix has their address.
        self.places = program.A.indices, program.A.indptr
        self.P, self.q, self.A = program.P, program.q, program.A.data

    def answer(self, program: Program, entries: Array) -> tuple[Array, Array] | None:
        """Value and duals."""
        changed: dict[str, Array] = {"b": program.b}
        if entries is not self.A:
            self.A = changed["A"] = entries
        if program.q is not self.q:
            self.q = changed["q"] = program.q
        if program.P is not self.P:
            self.P = program.P
            if program.P.nnz:
                changed["P"] = program.P.data
        self.solver.update(**changed)
        answer = self.solver.solve()
        said = str(answer.status)
        if said == "PrimalInfeasible":
            return np.full(program.q.size, np.nan), np.array(answer.z)
        if said not in ("Solved", "AlmostSolved"):
            return None
        x, z = np.array(answer.x), np.array(answer.z)
        return (x, z) if np.maximum.reduce(np.abs(x)) < _LARGEST else None


@lru_cache(64)
def _settings(**options: Any) -> Any:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    for key, value in {**BACKENDS["clarabel"].options, **options}.items():
        if not hasattr(settings, key):
            raise InvalidInput(f"Clarabel has no setting {shown(key)}")
        setattr(settings, key, value)
    return settings


@cache
def _cones_of(blocks: tuple[Block, ...]) -> list[Any]:
    cones: list[Any] = []
    for block in blocks:
        if block.cone is Cone.ZERO:
            cones.append(clarabel.ZeroConeT(block.rows))
        elif block.cone is Cone.NONNEGATIVE:
            cones.append(clarabel.NonnegativeConeT(block.rows))
        else:
            cones += [clarabel.SecondOrderConeT(block.size)] * block.count
    return cones
