"""The highest level of a narrowing that forces reach, from below and from above; see ``narrowing``."""

from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from regrasp.errors import SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.planning.states.levels.climbing import climbed
from regrasp.planning.states.levels.depths import NOISE, of_all, of_some, of_those_that_push
from regrasp.planning.states.narrowing import LEVEL_TOLERANCE, Narrowing
from regrasp.planning.states.objectives import FORCE
from regrasp.planning.states.solving import FEASIBLE, Chooser, Found
from regrasp.programs import Status

# Forces miss the cones for sure by a distance to which the residual is at most this.
_SURE = 1e-2
# The best level must be known this well; how well it is known is in the gap.
_UNSURE = 100 * LEVEL_TOLERANCE
# Cones so far from the forces of a solved program, in its units, hold them whatever its tolerance.
_CLEAR = 1e-6


def highest(chooser: Chooser, narrowing: Narrowing, forces: Array, limits: list[float]) -> Found:
    """The forces of the highest level, from ``forces`` upwards; the gap is to a level proven out of reach.

    Of the states within the tolerance, that of the widest force margin is taken. Raises ``SolverFailed``
    where the back end cannot tell what the highest level is.
    """
    lost = narrowing.top
    if chooser.least is None and inf not in limits:
        straight = _along_normals(chooser, narrowing, limits)
        if straight is not None and narrowing.level(straight) > narrowing.level(forces):
            forces = straight
        forces, lost, is_widest = climbed(chooser, narrowing, forces, limits)
        if is_widest:
            forces = _without_noise(chooser, narrowing, forces, limits)
            return Found(forces, max(lost - narrowing.level(forces), 0.0))
    elif narrowing.objective.may_reach_top:  # four contacts and more often need none
        straight = _at_level(chooser, narrowing.narrowed(narrowing.top), limits, None).forces
        forces = forces if straight is None else straight
    held = narrowing.level(forces)
    proven, sure, gained, climbs = lost, lost, inf, True
    while lost - held > LEVEL_TOLERANCE / 2 * (1 + 1e-6):
        middle = (held + lost) / 2
        level = min(held + LEVEL_TOLERANCE / 2, middle) if climbs else middle
        found = _at_level(chooser, narrowing.narrowed(level), limits, forces)
        if found.forces is None:
            lost, climbs = level, True
            proven = level if found.is_proof else proven
            sure = level if found.is_sure else sure
        else:
            # Inside the narrowed cones is the level reached, whatever a margin says that rounding blurs:
            # every step gets on.
            reached = max(narrowing.level(found.forces), level)
            # Steps that do not shrink converge too slowly: halve what is left once, then climb on.
            climbs = not climbs or reached - held < gained / 2
            gained, held, forces = reached - held, reached, found.forces
    if proven > lost:
        proven = _lowest_proof(chooser, narrowing, limits, lost, proven)
    if min(sure, proven) - held > _UNSURE and chooser.least is None:  # of least normal forces the gap tells
        raise SolverFailed(
            f"{chooser.backend} cannot tell the best {narrowing.objective}: a level of {held:.9g} is "
            f"reached, one of {min(sure, proven):.9g} is not, and its answers between are not sound"
        )
    cones = narrowing.narrowed(max(held - LEVEL_TOLERANCE / 2, 0.0))
    widest = _at_level(chooser, cones, limits, None).forces
    if widest is not None:
        forces = widest
    if chooser.least is None:
        forces = _without_noise(chooser, narrowing, forces, limits)
    return Found(forces, max(proven - narrowing.level(forces), 0.0))


def _along_normals(chooser: Chooser, narrowing: Narrowing, limits: list[float]) -> Array | None:
    """Forces of the highest level of all, which many contacts often reach; None if there are none."""
    cones = narrowing.narrowed(narrowing.top)
    if len(cones) <= chooser.vector.size:
        return None
    used, bound = of_some(chooser, cones), [limits[i] for i in cones]
    step = used.depth(list(cones.values()), bound, None)
    if step is None or step.depth < -FEASIBLE:
        return None
    found = used.settled(step.forces, list(cones.values()), bound)
    return None if found is None else of_all(chooser.grasp, cones, found)


def _without_noise(chooser: Chooser, narrowing: Narrowing, forces: Array, limits: list[float]) -> Array:
    """The forces with those that are a solver's noise made zero, where the level stays as good."""
    sizes = abs(forces).max(axis=1)
    used = set(np.flatnonzero(sizes > NOISE * sizes.max()).tolist())
    if len(used) in (0, len(forces)):
        return forces
    level = narrowing.level(forces)
    idle = of_those_that_push(chooser, forces, narrowing.frictions, limits)
    if idle is None or narrowing.level(idle) < level - LEVEL_TOLERANCE / 10:
        cones = narrowing.narrowed(max(level - LEVEL_TOLERANCE / 10, 0.0))
        idle = _at_level(chooser, {i: mu for i, mu in cones.items() if i in used}, limits, None).forces
    if idle is None or narrowing.level(idle) < level - LEVEL_TOLERANCE / 5:
        return forces
    return idle


def _lowest_proof(
    chooser: Chooser, narrowing: Narrowing, limits: list[float], above: float, proven: float
) -> float:
    """The lowest level proven out of reach, to a tenth of what it is above ``above``.

    Nearer the best level rounding hides proofs. They are of whole cones: what pyramids lose is in them.
    """

    def is_lost(step: float) -> bool:
        cones = narrowing.narrowed(above + step)
        return chooser.of(cones).is_lost(list(cones.values()), [limits[i] for i in cones])

    low = step = LEVEL_TOLERANCE
    while above + step < proven and not is_lost(step):
        low, step = step, 64 * step
    step = min(step, proven - above)
    while step > 1.1 * low:
        middle = sqrt(low * step)
        low, step = (low, middle) if is_lost(middle) else (middle, step)
    return above + step


class _Level(NamedTuple):
    """Forces (n, d) of a level, or None; then whether a twist proves it, and whether the answer was sound."""

    forces: Array | None
    is_proof: bool = False
    is_sure: bool = False


def _at_level(chooser: Chooser, cones: dict[int, float], limits: list[float], known: Array | None) -> _Level:
    """Forces inside narrowed cones, other fingers idle.

    The least distance to the edges is widest, measured for each finger by its normal force in ``known``: so
    the level rises most. Without ``known`` forces it is the force margin.
    """
    grasp = chooser.grasp
    idle = [i for i in range(len(grasp)) if i not in cones]
    pressed = chooser.least is not None and any(chooser.least[i] > 0 for i in idle)
    if pressed or (idle and chooser.demand is not None):
        return _Level(None, True, True)  # a finger that must push has no cone left
    used = of_some(chooser, cones)
    frictions, bounds = list(cones.values()), [limits[i] for i in cones]
    weights = None
    if known is not None:
        weights = np.maximum(grasp.cones.normal(known), 0.0)[list(cones)] / chooser.unit
    try:
        answer = used.solved(FORCE, frictions, bounds, weights, quick=False)
    except SolverFailed as failed:
        answer = failed.solution  # whether it is near enough is seen below
    if answer.status is not Status.INFEASIBLE and not answer.value[-1] < -FEASIBLE:
        forces = used.exact(answer, frictions, bounds)
        if forces is None and chooser.least is None:
            forces = of_those_that_push(used, used.wanted(answer), frictions, bounds)
        if forces is not None:
            return _Level(of_all(grasp, cones, forces))
        if answer.status is Status.SOLVED and answer.value[-1] > _CLEAR and chooser.least is None:
            return _Level(None, False, True)  # a solver sees forces, and rounding lets none near them balance
    twist = used.twist_of(answer.duals)
    is_twist = bool(np.isfinite(twist).all() and twist.any())
    if is_twist and used.proves(twist, frictions, bounds):
        return _Level(None, True, True)
    # Within a solver's tolerance of the best level a proof is costly and rare: one above it serves.
    is_near = answer.status is Status.SOLVED and answer.value[-1] >= -FEASIBLE
    if not is_near and used.is_lost(frictions, bounds):
        return _Level(None, True, True)
    if answer.status is Status.INFEASIBLE or answer.residual <= -_SURE * answer.value[-1]:
        return _Level(None, False, True)
    width = used.grasp.width  # point contacts alone have no torques
    forces = None
    if known is not None and chooser.least is None:
        forces = used.nearest(known[list(cones)][:, :width], frictions, bounds)
    return _Level(None if forces is None else of_all(grasp, cones, forces))
