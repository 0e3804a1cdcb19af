"""Clarabel, called directly. Imported when used."""

from functools import cache, lru_cache
from time import perf_counter
from typing import Any

import clarabel
import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.programs.facts import BACKENDS
from regrasp.programs.program import Block, Cone, Program
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
