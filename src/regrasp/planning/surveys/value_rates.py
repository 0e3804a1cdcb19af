"""How the best value of a choice of forces moves: the rules that lead from programs to objectives.

Two objectives are no program but a level m that one reaches: v(m, p), the optimum of ``force`` over cones
narrowed to m, is zero there, so dm/dp = -(dv/dp) / (dv/dm), both from the same duals.

Force limits that ``peak_ratio`` sets move with the least peak force: their share is the rate by those limits
times ``peak_ratio`` times the rates of the peak, a program of its own.
"""

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.state import GraspState
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.narrowing import LEVEL_TOLERANCE, Narrowing
from regrasp.planning.states.objectives import FORCE, PEAK, ConvexObjective, LevelObjective
from regrasp.planning.surveys.envelope import PARAMETERS, Setting, optimum_rates


def value_rates(state: GraspState, criteria: Criteria, limits: Array) -> Array:
    """Derivatives (4n + 3,) of the best value, in the order of ``PARAMETERS``, then of the load.

    state: the best one, in a grasp whose friction is what planning may use. limits: (n,) [N] of its choice.
    """
    grasp, load, objective = state.grasp, state.load, criteria.objective
    unit = float(state.magnitudes.max())
    setting = Setting(grasp, load, grasp.frictions, limits)
    n = len(grasp)
    if objective == FORCE and not grasp.frictions.all():
        return np.zeros(4 * n + 3)  # the distance of a force to the boundary of a ray is zero, whatever else
    if isinstance(objective, LevelObjective):
        rates = _level_rates(state, setting, objective, unit)
    elif isinstance(objective, ConvexObjective):
        sign = -1 if objective.maximise else 1
        rates = sign * objective.scale(unit) * optimum_rates(setting, objective, unit)
    else:
        raise InvalidInput(f"rates are known of convex and of level objectives, got {objective!s}")
    own = np.array(criteria.limits(grasp))
    follows = limits < own
    if follows.any():
        by_limit = rates[3 * n : 4 * n]
        share = criteria.peak_ratio * by_limit[follows].sum()
        by_limit[follows] = 0.0
        of_peak = unit * optimum_rates(Setting(grasp, load, grasp.frictions, own), PEAK, unit)
        rates = rates + share * of_peak
    return rates


def _level_rates(state: GraspState, setting: Setting, objective: LevelObjective, unit: float) -> Array:
    """Rates of the angle margin or the friction use; fingers whose cones are gone at that level are idle."""
    grasp, n = setting.grasp, len(setting.grasp)
    narrowing = Narrowing(grasp, objective, setting.frictions.tolist())
    # A little below the level found, so that no cone in use has shrunk to a ray.
    level = narrowing.level(state.forces) - LEVEL_TOLERANCE
    cones = narrowing.narrowed(level)
    used, narrowed, whole = list(cones), np.array(list(cones.values())), setting.frictions[list(cones)]
    some = Setting(grasp.subset(used), setting.load, narrowed, setting.limits[used])
    weights = np.maximum((state.forces * grasp.normals).sum(axis=1), 0.0)[used] / unit
    of_margin = optimum_rates(some, FORCE, unit, weights)
    by_friction = of_margin[: len(used)].copy()
    rise, slope = objective.slopes(whole, narrowed, level)
    of_margin[: len(used)] *= rise
    fall = float(by_friction @ slope)
    rates = np.zeros(4 * n + 3)
    places = [k * n + i for k in range(len(PARAMETERS)) for i in used] + [4 * n, 4 * n + 1, 4 * n + 2]
    # fall is -dv/dm; what is small where the level is high falls with it.
    rates[places] = of_margin / fall * (1.0 if objective.maximise else -1.0)
    return rates
