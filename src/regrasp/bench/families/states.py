"""Forces of planar grasps: one state for one objective."""

from collections.abc import Iterator
from math import inf

import numpy as np

from regrasp.bench.families.grasps import planar
from regrasp.bench.families.truth import certified
from regrasp.bench.problems.problem import BenchProblem, Family, Known, Truth, Verdict
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.program import state_program
from regrasp.planning.states.solving import force_unit

_COUNTS = (2, 2, 2, 2, 3, 4, 6, 8, 16, 32, 64)
_OBJECTIVES = ("effort", "peak_normal", "peak", "force")
# Of ``force``, which is unbounded without: a limit on every force, in loads.
_LIMIT = 10.0


def state_problem(family: str, name: str, grasp: Grasp, load: Wrench, objective: str) -> BenchProblem:
    """The program of a state in units of its load; the closed form knows that of two fingers."""
    unit = force_unit(grasp, load)
    limits = [_LIMIT * unit if objective == "force" else inf] * len(grasp)
    program = state_program(grasp, load, objective, grasp.frictions.tolist(), limits, unit)
    scale = 1.0 if objective == "force" else 0.0  # forces that hold a load are not near zero
    if len(grasp) > 2:
        return BenchProblem(name, family, program, certified(program, scale))
    limit = None if objective != "force" else _LIMIT * unit
    value = choose_state(grasp, load, objective, method="closed-form", max_force=limit, reserve=0.0).value
    optimum = value / (unit**2 if objective == "effort" else unit) * (-1 if objective == "force" else 1)
    known = Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, optimum, 1e-10, scale)
    return BenchProblem(name, family, program, known)


def _problems() -> Iterator[BenchProblem]:
    for number, count in enumerate(_COUNTS):
        grasp, load = planar(np.random.default_rng([1, number]), count)
        for objective in _OBJECTIVES:
            yield state_problem(
                STATES.name, f"{STATES.name}/{objective}/{number:02d}-{count}", grasp, load, objective
            )


STATES = Family(
    "states",
    "planar grasps of 2 to 64 fingers with friction under one load",
    "effort sum |f|^2 and peak normal force (QP), peak force and least distance to the cones (second order), "
    "subject to G f = -w and the friction cones",
    _problems,
)
