"""Round sets: finer polytopes where programs lean on their corners, and what these leave open at most."""

from collections.abc import Callable
from math import inf

import numpy as np

from regrasp.errors import SolverFailed
from regrasp.planning.states.withstanding.apexes import Apexes
from regrasp.programs import Program, Status, solve
from regrasp.programs.backends import asked

_CUTS = 3
_WORTH = 0.003
"""Of a factor: what the next cut adds is about half of what the last one did."""


def cut_corners(apexes: Apexes, laid_out: Callable[[], Program], backend: str, by_factor: bool) -> None:
    """Cut corners off for a wider factor, or of a set as it is until forces are found. Nothing is believed.

    laid_out: the program with the corners there are.
    """
    factor = 0.0
    for _ in range(_CUTS):
        answer = asked(laid_out(), backend, {})
        is_found = answer.status is Status.SOLVED
        if (is_found and not by_factor) or not np.isfinite(answer.duals).all():
            return
        if not apexes.cut(answer.duals):
            return
        before, factor = factor, float(answer.value[-1]) if is_found else 0.0
        if by_factor and is_found and factor - before < _WORTH * factor:
            return


def left_open(relaxed: Program, backend: str, factor: float) -> float:
    """How much wider than a factor of a round set another can be, by the program that asks for less."""
    try:
        bound = solve(relaxed, backend)
    except SolverFailed:
        return inf
    if bound.status is not Status.SOLVED:
        return inf
    return max(float(bound.value[-1]) - factor, 0.0) + bound.absolute_gap
