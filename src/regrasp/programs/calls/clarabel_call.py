"""Clarabel, called directly. An update keeps the scaling and the symbolic factorisation."""

from time import perf_counter
from typing import Any, NamedTuple

import clarabel
import numpy as np

from regrasp.programs.answer import Answer
from regrasp.programs.blocks import Block, Cone
from regrasp.programs.program import Program

# "Almost" verdicts are not verdicts.
_CLAIMS = {"Solved": "found", "PrimalInfeasible": "infeasible", "DualInfeasible": "unbounded"}


class Data(NamedTuple):
    """A program, whose form is Clarabel's own, and its cones. Of P Clarabel takes the upper triangle."""

    program: Program
    cones: list[Any]


def layout(program: Program) -> Data:
    """The program with Clarabel's cones."""
    return Data(program, [cone for block in program.blocks for cone in _cones(block)])


class Session:
    """A program set up in Clarabel."""

    def __init__(self, data: Data, **options: Any) -> None:
        started = perf_counter()
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        for key, value in options.items():
            setattr(settings, key, value)
        program, cones = data
        self._solver = clarabel.DefaultSolver(program.P, program.q, program.A, program.b, cones, settings)
        self._setup = perf_counter() - started

    def update(self, data: Data) -> None:
        """The same program with another right side."""
        started = perf_counter()
        self._solver.update(b=data.program.b)
        self._setup = perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        answer = self._solver.solve()
        took = perf_counter() - started
        said = str(answer.status)
        x, duals = np.array(answer.x), np.array(answer.z)
        claim = _CLAIMS.get(said, "failed")
        return Answer(claim, x, duals, answer.iterations, said, None, self._setup, took)


def _cones(block: Block) -> list[Any]:
    if block.cone is Cone.ZERO:
        return [clarabel.ZeroConeT(block.rows)]
    if block.cone is Cone.NONNEGATIVE:
        return [clarabel.NonnegativeConeT(block.rows)]
    return [clarabel.SecondOrderConeT(block.size)] * block.count
