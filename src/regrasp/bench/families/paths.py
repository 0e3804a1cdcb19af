"""Forces over time: as many unknowns as instants."""

from collections.abc import Iterator
from math import inf

import numpy as np

from regrasp.bench.families.grasps import planar
from regrasp.bench.families.truth import certified
from regrasp.bench.problems.problem import BenchProblem, Family, Known, Truth, Verdict
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.path_program import PathTask, path_program
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.solving import force_unit
from regrasp.programs import Program

_INSTANTS = (10, 30, 100, 300, 1000, 3000, 10_000)
# The bent path is solved once for its reference; beyond this many instants that takes too long to repeat.
_MOST_BENT = 1000


def _task(grasp: Grasp, load: Wrench, instants: int, swing: float) -> PathTask:
    """From the least effort to the widest margin; the load swings by a fraction of itself."""
    start, end = (choose_state(grasp, load, objective).forces for objective in ("effort", "force"))
    times = np.linspace(0, 1, instants)
    loads = load.vector * (1 + swing * np.sin(2 * np.pi * times))[:, None]
    n = len(grasp)
    return PathTask(
        grasp=grasp, times=times, loads=loads, start=start, end=end,
        active=np.ones((instants, n), dtype=bool), phases=times, frictions=grasp.frictions,
        limits=np.full(n, inf), rates=np.full(n, inf), least_normals=np.zeros(n),
        stays=np.ones(n, dtype=bool), unit=force_unit(grasp, load),
    )  # fmt: skip


def _in_forces(program: Program, origin: Array) -> tuple[Program, float]:
    """The program in x + origin, the forces themselves, and what its objective is more at x = 0."""
    constant = float(0.5 * origin @ (program.P @ origin) - program.q @ origin)
    moved = Program(
        program.P, program.q - program.P @ origin, program.A, program.b + program.A @ origin, program.blocks
    )
    return moved, -constant


def _problems() -> Iterator[BenchProblem]:
    for number, instants in enumerate(_INSTANTS):
        grasp, load = planar(np.random.default_rng([3, number]), 3)
        straight = _task(grasp, load, instants, 0.0)
        origin = straight.reference[1:-1].ravel() / straight.unit
        program, optimum = _in_forces(path_program(straight, "change"), origin)
        known = Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, optimum, 1e-9)
        yield BenchProblem(f"paths/straight/{instants:05d}", "paths", program, known)
        if instants <= _MOST_BENT:
            bent = path_program(_task(grasp, load, instants, 0.05), "change")
            yield BenchProblem(f"paths/bent/{instants:05d}", "paths", bent, certified(bent))


PATHS = Family(
    "paths",
    "the forces of three planar fingers from one state to another, at 10 to 10,000 instants",
    "sum |f_k+1 - f_k|^2 / ds_k subject to equilibrium and cones at every instant; under a constant load the "
    "straight path of Eq. 1-3 is the answer, under one that swings it bends",
    _problems,
)
