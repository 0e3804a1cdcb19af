"""A load that turns slowly: the same matrices, another right side, again and again."""

from collections.abc import Iterator
from dataclasses import replace
from math import inf

import numpy as np

from regrasp.bench.families.grasps import planar
from regrasp.bench.families.states import state_problem
from regrasp.bench.problems.problem import BenchProblem, Family
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.program import state_program
from regrasp.planning.states.solving import force_unit

_STEPS = 40
_TURN = 0.01


def _problems() -> Iterator[BenchProblem]:
    for count in (2, 3, 6):
        grasp, load = planar(np.random.default_rng([9, count]), count)
        unit = force_unit(grasp, load)
        before: str | None = None
        first = state_program(grasp, load, "effort", grasp.frictions.tolist(), [inf] * count, unit)
        for step in range(_STEPS):
            turned = Wrench(load.rotated(_TURN * step).force, float(load.torque[0]))
            name = f"warm/effort/{count}-{step:02d}"
            problem = state_problem("warm", name, grasp, turned, "effort")
            b = first.b.copy()
            b[:3] = problem.program.b[:3] * (force_unit(grasp, turned) / unit)
            optimum = problem.known.optimum
            if optimum is not None:
                optimum *= (force_unit(grasp, turned) / unit) ** 2
            known = replace(problem.known, optimum=optimum)
            yield BenchProblem(name, "warm", replace(first, b=b), known, before)
            before = name


WARM = Family(
    "warm",
    "planar grasps under a load that turns by 0.01 rad from one problem to the next",
    "effort subject to G f = -w(k) and the friction cones (QP); only the right side changes",
    _problems,
)
