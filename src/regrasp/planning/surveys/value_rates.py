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
from regrasp.planning.surveys.envelope import Rates, Setting, optimum_rates


def value_rates(state: GraspState, criteria: Criteria, limits: Array) -> Rates:
    """Derivatives of the best value by each parameter.

    state: the best one, in a grasp whose friction is what planning may use. limits: (n,) [N] of its choice.
    """
    grasp, load, objective = state.grasp, state.load, criteria.objective
    unit = float(state.magnitudes.max())
    setting = Setting(grasp, load, grasp.frictions, limits)
    if objective == FORCE and not grasp.frictions.all():
        return _none(setting)  # the distance of a force to the boundary of a ray is zero, whatever else
    if isinstance(objective, LevelObjective):
        rates = _level_rates(state, setting, objective, unit)
    elif isinstance(objective, ConvexObjective):
        sign = -1 if objective.maximise else 1
        rates = _times(sign * objective.scale(unit), optimum_rates(setting, objective, unit))
    else:
        raise InvalidInput(f"rates are known of convex and of level objectives, got {objective!s}")
    own = np.array(criteria.limits(grasp))
    follows = limits < own
    if follows.any():
        by_limit = rates["limit"]
        share = criteria.peak_ratio * by_limit[follows].sum()
        by_limit[follows] = 0.0
        of_peak = optimum_rates(Setting(grasp, load, grasp.frictions, own), PEAK, unit)
        rates = {name: rate + share * unit * of_peak[name] for name, rate in rates.items()}
    return rates


def _none(setting: Setting) -> Rates:
    return {name: np.zeros(step.shape) for name, step in setting.steps(1.0).items()}


def _times(factor: float, rates: Rates) -> Rates:
    return {name: factor * rate for name, rate in rates.items()}


def _level_rates(state: GraspState, setting: Setting, objective: LevelObjective, unit: float) -> Rates:
    """Rates of the angle margin or the friction use; fingers whose cones are gone at that level are idle."""
    grasp = setting.grasp
    measured = grasp.cones.measured(state.forces)
    narrowing = Narrowing(grasp, objective, setting.frictions.tolist())
    # A little below the level found, so that no cone in use has shrunk to a ray.
    level = narrowing.level(measured) - LEVEL_TOLERANCE
    cones = narrowing.narrowed(level)
    used, narrowed, whole = list(cones), np.array(list(cones.values())), setting.frictions[list(cones)]
    some = Setting(grasp.subset(used), setting.load, narrowed, setting.limits[used])
    weights = np.maximum(grasp.cones.normal(measured), 0.0)[used] / unit
    of_margin = optimum_rates(some, FORCE, unit, weights)
    rise, slope = objective.slopes(whole, narrowed, level)
    fall = float(of_margin["friction"] @ slope)
    of_margin["friction"] = of_margin["friction"] * rise
    # fall is -dv/dm; what is small where the level is high falls with it.
    share = (1.0 if objective.maximise else -1.0) / fall
    rates = _none(setting)
    for name, rate in of_margin.items():
        rates[name][... if name == "load" else used] = share * rate
    return rates
