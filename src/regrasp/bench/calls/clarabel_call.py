"""Clarabel, called directly."""

from time import perf_counter
from typing import Any

import clarabel
import numpy as np

from regrasp.bench.answer import Answer
from regrasp.programs.program import Array, Block, Cone, Program

# "Almost" verdicts are not verdicts.
_CLAIMS = {"Solved": "found", "PrimalInfeasible": "infeasible", "DualInfeasible": "unbounded"}


class Session:
    """A program set up in Clarabel; an update keeps the scaling and the symbolic factorisation."""

    def __init__(self, program: Program, **options: Any) -> None:
        started = perf_counter()
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        for key, value in options.items():
            setattr(settings, key, value)
        cones = [cone for block in program.blocks for cone in _cones(block)]
        built = perf_counter()
        # Of P, both of whose triangles are given, it takes the upper one.
        self._solver = clarabel.DefaultSolver(program.P, program.q, program.A, program.b, cones, settings)
        self._build, self._setup = built - started, perf_counter() - built

    def update(self, b: Array) -> None:
        """Another right side (m,)."""
        started = perf_counter()
        self._solver.update(b=b)
        self._build, self._setup = 0.0, perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        answer = self._solver.solve()
        took = perf_counter() - started
        said = str(answer.status)
        return Answer(
            _CLAIMS.get(said, "failed"),
            np.array(answer.x),
            np.array(answer.z),
            answer.iterations,
            said,
            self._build,
            self._setup,
            took,
        )


def _cones(block: Block) -> list[Any]:
    if block.cone is Cone.ZERO:
        return [clarabel.ZeroConeT(block.rows)]
    if block.cone is Cone.NONNEGATIVE:
        return [clarabel.NonnegativeConeT(block.rows)]
    return [clarabel.SecondOrderConeT(block.size)] * block.count
