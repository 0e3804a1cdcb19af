"""The ends of an equilibrium locus as linear programs: the cross-check of its closed form.

    minimise -+ f_1.u   subject to   G f + w_ext = 0,   f_i inside its cone

with u the unit vector from P_1 to P_2. ``EquilibriumLocus(grasp, load)`` is LS_B; ``EquilibriumLocus.given``
is LS_A, where the third finger's wrench is a part of the load.
"""

from dataclasses import replace
from math import inf
from typing import Literal

import numpy as np
from scipy import sparse

from regrasp.errors import SolverFailed
from regrasp.mechanics.checks import choice
from regrasp.planning.states.choosing import DEFAULT_BACKEND
from regrasp.planning.states.objectives import EFFORT
from regrasp.planning.states.program import state_program
from regrasp.planning.states.solving import force_unit
from regrasp.planning.states.two_fingers import EquilibriumLocus
from regrasp.programs import Program, Status, solve


def locus_program(locus: EquilibriumLocus, end: Literal["lo", "hi"]) -> Program:
    """The program whose least value is lo, or -hi, of the squeeze; forces in units of the load, or 1 N."""
    choice(end, "end", ("lo", "hi"))
    grasp = locus.grasp
    held = state_program(grasp, locus.load, EFFORT, grasp.frictions.tolist(), [inf, inf], _unit(locus))
    q = np.zeros(4)
    q[:2] = locus.direction if end == "lo" else -locus.direction
    return replace(held, P=sparse.csc_matrix((4, 4)), q=q)


def solved_interval(locus: EquilibriumLocus, backend: str = DEFAULT_BACKEND) -> tuple[float, float]:
    """``locus.interval`` by a back end that takes linear programs: (lo, hi) [N], (inf, -inf) if empty.

    Infinite ends and empty loci are believed on a certificate only; raises ``SolverFailed`` without one.
    """
    ends = {}
    for end, sign in (("lo", 1.0), ("hi", -1.0)):
        program = locus_program(locus, "lo" if end == "lo" else "hi")
        answer = solve(program, backend)
        if answer.status is Status.INFEASIBLE:
            return inf, -inf
        if answer.status not in (Status.SOLVED, Status.UNBOUNDED):
            raise SolverFailed(f"{backend}: {answer.status.advice}", program, answer)
        unbounded = answer.status is Status.UNBOUNDED
        ends[end] = sign * (-inf if unbounded else answer.objective * _unit(locus))
    return ends["lo"], ends["hi"]


def _unit(locus: EquilibriumLocus) -> float:
    return force_unit(locus.grasp, locus.load) or 1.0
