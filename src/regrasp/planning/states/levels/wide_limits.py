"""The best forces under limits so wide that rounding hides them.

Programs tell forces apart to about 1e-8 of the largest: where ``peak_ratio`` lets forces be a million times
those that the load takes, the best may not be found, or nothing better than the least. What keeps narrower
limits keeps the wider ones, so the best of those is not lost.
"""

from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np

from regrasp.errors import Infeasible, SolverFailed
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import ChosenForces, Criteria

SURE_RATIO = 1e3
"""Up to this ``peak_ratio`` what is found is taken."""
_LARGEST = 2.0**20  # beyond it angles hardly widen
_NARROWER = 4.0
_KNOWN = 1e-6  # a gap of this [rad or -], or this fraction of a value, is none


def of_wide_limits(
    grasp: Grasp, load: Wrench, criteria: Criteria, choose: Callable[[Criteria], ChosenForces]
) -> ChosenForces:
    """The best forces that ``choose`` finds for criteria; where it is unsure, within narrower limits, too."""
    own, objective, ratio = criteria.limits(grasp), criteria.objective, criteria.peak_ratio
    if not (criteria.unbounded and inf in own and ratio > SURE_RATIO):
        return choose(criteria)
    best, most, bound = None, -inf, inf
    failure: Infeasible | SolverFailed | None = None
    while True:
        try:
            found = choose(replace(criteria, peak_ratio=ratio))
        except (Infeasible, SolverFailed) as error:
            if isinstance(error, Infeasible) and error.certificate is not None:
                raise
            failure = failure or error
        else:
            value = objective.value(GraspState(grasp, load, np.array(found.forces, dtype=float)))
            value = value if objective.maximise else -value
            gap = inf if found.gap is None else found.gap
            bound = value + gap if ratio == criteria.peak_ratio else bound
            if best is None or value > most:
                wider = criteria.peak_ratio / ratio
                limits = zip(own, found.force_limits, strict=True)
                most = value
                best = found._replace(force_limits=tuple(min(mine, used * wider) for mine, used in limits))
            if gap <= _KNOWN * max(1.0, abs(value)):
                break
        if ratio <= SURE_RATIO:
            break
        ratio = max(min(ratio / _NARROWER, _LARGEST), SURE_RATIO)
    if best is None:
        assert failure is not None
        raise failure
    return best._replace(gap=max(bound - most, 0.0))
