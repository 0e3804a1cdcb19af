"""How the best value of a choice of forces moves: the rules that lead from programs to objectives.

Two objectives are no program but a level m that one reaches: v(m, p), the optimum of ``force`` over cones
narrowed to m, is zero there, so dm/dp = -(dv/dp) / (dv/dm), both from the same duals.

Force limits that ``peak_ratio`` sets move with the least peak force: their share is the rate by those limits
times ``peak_ratio`` times the rates of the peak, a program of its own.
"""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.state import GraspState
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.narrowing import LEVEL_TOLERANCE, Narrowing
from regrasp.planning.surveys.envelope import PARAMETERS, Setting, optimum_rates


def value_rates(state: GraspState, criteria: Criteria, limits: Array) -> Array:
    """Derivatives (4n + 3,) of the best value, in the order of ``PARAMETERS``, then of the load.

    state: the best one, in a grasp whose friction is what planning may use. limits: (n,) [N] of its choice.
    """
    grasp, load, objective = state.grasp, state.load, criteria.objective
    unit = float(state.magnitudes.max())
    setting = Setting(grasp, load, grasp.frictions, limits)
    n = len(grasp)
    if objective == "force" and not grasp.frictions.all():
        return np.zeros(4 * n + 3)  # the distance of a force to the boundary of a ray is zero, whatever else
    if objective in ("angle", "friction_use"):
        rates = _level_rates(state, setting, objective, unit)
    elif objective == "effort":
        rates = unit**2 * optimum_rates(setting, objective, unit)
    else:
        rates = (-unit if objective == "force" else unit) * optimum_rates(setting, objective, unit)
    own = np.array(criteria.limits(grasp))
    follows = limits < own
    if follows.any():
        by_limit = rates[3 * n : 4 * n]
        share = criteria.peak_ratio * by_limit[follows].sum()
        by_limit[follows] = 0.0
        of_peak = unit * optimum_rates(Setting(grasp, load, grasp.frictions, own), "peak", unit)
        rates = rates + share * of_peak
    return rates


def _level_rates(state: GraspState, setting: Setting, objective: str, unit: float) -> Array:
    """Rates of the angle margin or the friction use; fingers whose cones are gone at that level are idle."""
    grasp, n = setting.grasp, len(setting.grasp)
    narrowing = Narrowing(grasp, objective, setting.frictions.tolist())
    # A little below the level found, so that no cone in use has shrunk to a ray.
    level = narrowing.level(state.forces) - LEVEL_TOLERANCE
    cones = narrowing.narrowed(level)
    used, narrowed, whole = list(cones), np.array(list(cones.values())), setting.frictions[list(cones)]
    some = Setting(grasp.subset(used), setting.load, narrowed, setting.limits[used])
    weights = np.maximum((state.forces * grasp.normals).sum(axis=1), 0.0)[used] / unit
    of_margin = optimum_rates(some, "force", unit, weights)
    by_friction = of_margin[: len(used)].copy()
    if objective == "angle":  # tan(atan mu - m)
        slope = 1 + narrowed**2
        of_margin[: len(used)] *= slope / (1 + whole**2)
        fall = float(by_friction @ slope)
    else:  # mu (1 - m)
        of_margin[: len(used)] *= 1 - level
        fall = float(by_friction @ whole)
    rates = np.zeros(4 * n + 3)
    places = [k * n + i for k in range(len(PARAMETERS)) for i in used] + [4 * n, 4 * n + 1, 4 * n + 2]
    # fall is -dv/dm; friction use is 1 - m.
    rates[places] = of_margin / fall * (1.0 if objective == "angle" else -1.0)
    return rates
