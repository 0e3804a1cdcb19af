"""Grasps in space: exact cones of second order, and inner pyramids in their place."""

from collections.abc import Iterator
from math import inf, pi

import numpy as np

from regrasp.bench.families.grasps import in_space
from regrasp.bench.families.truth import certified
from regrasp.bench.problems.problem import BenchProblem, Family, Known, Truth, Verdict
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.program import state_program
from regrasp.planning.states.solving import force_unit

_COUNTS = (4, 5, 6, 8, 16, 32, 64, 128, 256, 512)
_FACETS = (4, 8, 16, 32)
_PYRAMID_COUNTS = (4, 8, 32, 128, 512)
# Lobo et al. 1998; Vanderbei's grasp_nonconvex: best known value.
_NOSE_CONE = 0.49108896


def nose_cone(count: int = 5, friction: float = 0.3) -> tuple[Grasp, Wrench]:
    """The grasp of Lobo, Vandenberghe, Boyd and Lebret 1998, under a unit force down."""
    contacts = []
    for j in range(1, count + 1):
        x, y = 0.3 + np.cos(2 * pi * j / count), np.sin(2 * pi * j / count)
        contacts.append(Contact([x, y, x * x + y * y], [-2 * x, -2 * y, 1], friction))
    return Grasp(contacts), Wrench([0, 0, -1.0])


def _cones() -> Iterator[BenchProblem]:
    grasp, load = nose_cone()
    program = state_program(grasp, load, "peak_normal", grasp.frictions.tolist(), [inf] * 5, 1.0)
    known = Known(Verdict.SOLVABLE, Truth.PUBLISHED, _NOSE_CONE, 2e-8, scale=0.0)
    yield BenchProblem("space-cones/nose-cone", "space-cones", program, known)
    for number, count in enumerate(_COUNTS):
        grasp, load = in_space(np.random.default_rng([5, number]), count)
        for objective in ("effort", "peak_normal", "peak"):
            program = state_program(
                grasp, load, objective, grasp.frictions.tolist(), [inf] * count, force_unit(grasp, load)
            )
            name = f"space-cones/{objective}/{count:03d}"
            yield BenchProblem(name, "space-cones", program, certified(program, 0.0))


def _pyramids() -> Iterator[BenchProblem]:
    for number, count in enumerate(_PYRAMID_COUNTS):
        grasp, load = in_space(np.random.default_rng([6, number]), count)
        for facets in _FACETS:
            for objective in ("effort", "peak_normal"):
                program = state_program(
                    grasp, load, objective, grasp.frictions.tolist(), [inf] * count, force_unit(grasp, load),
                    facets,
                )  # fmt: skip
                name = f"space-pyramids/{objective}/{count:03d}-{facets:02d}"
                yield BenchProblem(name, "space-pyramids", program, certified(program, 0.0))


SPACE_CONES = Family(
    "space-cones",
    "grasps in space of 4 to 512 fingers with exact friction cones; the nose-cone grasp of Lobo et al. 1998",
    "effort, peak normal force and peak force subject to G f = -w and |f_t| <= mu f_n (second order)",
    _cones,
)
SPACE_PYRAMIDS = Family(
    "space-pyramids",
    "grasps in space of 4 to 512 fingers with inner friction pyramids of 4 to 32 facets",
    "effort and peak normal force subject to G f = -w and the facets of every pyramid (QP)",
    _pyramids,
)
