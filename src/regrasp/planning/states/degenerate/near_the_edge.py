"""The best forces where a solver fails next to the edge, and how much better the best can be, at most.

Cones and limits a little wider leave room for a solver. What it finds there bounds what can be found here;
its forces, moved into the cones, are nearly the best.
"""

from collections.abc import Iterator
from contextlib import suppress
from math import inf

import numpy as np

from regrasp.errors import SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.planning.states.degenerate.flat_minima import polished
from regrasp.planning.states.objectives import Bound, ConvexObjective
from regrasp.planning.states.solving import Chooser, Found
from regrasp.programs import Status

_WIDER = (1e-8, 1e-6, 1e-4)


def best_near_the_edge(
    chooser: Chooser, objective: ConvexObjective, held: Array, frictions: list[float], limits: list[float]
) -> Found:
    """``held``, or better forces (n, w); the gap is infinite where no wider cones have an answer."""
    best, cost, bound = held, _cost(chooser, objective, held, frictions), -inf
    for forces, least in _wider(chooser, objective, frictions, limits):
        bound = max(bound, least)
        settled = chooser.settled(forces, frictions, limits)
        costs = inf if settled is None else _cost(chooser, objective, settled, frictions)
        if settled is not None and costs < cost:
            best, cost = settled, costs
        if cost - bound <= _WIDER[0] * abs(cost):
            break
    best = polished(chooser, objective, best, frictions, limits)
    return Found(best, max(_cost(chooser, objective, best, frictions) - bound, 0.0))


def _wider(
    chooser: Chooser, objective: ConvexObjective, frictions: list[float], limits: list[float]
) -> Iterator[tuple[Array, float]]:
    """Forces within wider cones, and a cost that none undercut there."""
    for wider in _WIDER:
        with suppress(SolverFailed):
            answer = chooser.solved(objective, frictions, limits, slack=-wider)
            if answer.status is Status.SOLVED:
                least = (answer.objective - answer.absolute_gap) * objective.scale(chooser.unit)
                yield chooser.wanted(answer), least


def _cost(chooser: Chooser, objective: ConvexObjective, forces: Array, frictions: list[float]) -> float:
    """What a program minimises, in the objective's unit."""
    x, mu, cones = forces / chooser.unit, np.array(frictions), chooser.grasp.cones
    along = cones.normal(x)
    if objective.bound is Bound.NONE:
        squares, linear = objective.squares(chooser.grasp), objective.linear(chooser.grasp, chooser.unit)
        cost = 0.0 if squares is None else float((squares[:, None] * x**2).sum())
        cost += 0.0 if linear is None else float((linear * x).sum())
    elif objective.bound is Bound.MARGIN:
        across = np.linalg.norm(x - along[:, None] * cones.normals, axis=1)
        depth = ((mu * along - across) / np.sqrt(1 + mu**2))[mu > 0]
        cost = -float(depth.min(initial=inf)) if depth.size else 0.0
    else:
        cost = float((np.sqrt((x**2).sum(axis=1)) if objective.bound is Bound.FORCE else along).max())
    return cost * objective.scale(chooser.unit)
