"""Ends of equilibrium loci: linear programs in four unknowns whose answers a formula tells."""

from collections.abc import Iterator
from math import isfinite

import numpy as np

from regrasp.bench.families.grasps import planar
from regrasp.bench.problems.problem import BenchProblem, Family, Known, Truth, Verdict
from regrasp.planning.states.solving import force_unit
from regrasp.planning.states.two_fingers import EquilibriumLocus
from regrasp.planning.surveys.locus_program import locus_program

_COUNT = 20


def _problems() -> Iterator[BenchProblem]:
    for number in range(_COUNT):
        grasp, load = planar(np.random.default_rng([2, number]), 2)
        locus = EquilibriumLocus(grasp, load)
        unit = force_unit(grasp, load)
        for end, value, sign in (("lo", locus.interval[0], 1.0), ("hi", locus.interval[1], -1.0)):
            if not isfinite(value):
                continue  # without bound: said by few solvers in a way that can be checked
            known = Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, sign * value / unit, 1e-11)
            program = locus_program(locus, "lo" if end == "lo" else "hi")
            yield BenchProblem(f"loci/{end}/{number:02d}", "loci", program, known)


LOCI = Family(
    "loci",
    "the least and the largest squeeze of two planar fingers",
    "minimise or maximise the squeeze f_1.u subject to G f = -w and the friction cones (a linear program)",
    _problems,
)
