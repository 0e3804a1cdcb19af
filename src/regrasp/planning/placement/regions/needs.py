"""The limit on forces of regions, from what the grasp itself needs."""

import numpy as np

from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import choose_state

PEAK_RATIO = 3.0
"""Default limit on every force, as a multiple of the least largest force of the grasp as it is."""
LESS = 1e-6
"""Of widths and of friction, given up so that forces at the corners exist for solvers, too."""
ON_EDGE = (
    "the grasp holds the loads on a knife's edge: not with a little less friction, or not a little beside "
    "its places; all at once its fingers may be off by nothing, and there are no regions"
)
"""Why a grasp that holds the loads has none."""


def limit_of(least: float, given: float | None, grasp: Grasp, loads: Array) -> float:
    """Of forces, where a grasp needs ``least`` for its loads with a little of its friction kept back."""
    if not least < np.inf:
        free = Grasp(contact.changed(max_force=None) for contact in grasp)
        for vector in loads:
            _refuse_what_is_not_held(free, Wrench.from_vector(vector))
        raise Infeasible(ON_EDGE)
    if given is None and least == 0.0:
        raise InvalidInput("no force follows from a zero load: give max_force")
    limit = PEAK_RATIO * least if given is None else given * (1 - LESS)
    if least > limit:
        asked = limit if given is None else given
        raise Infeasible(f"the grasp itself needs a force of {least:.6g} N, above max_force {asked:.6g} N")
    return limit


def _refuse_what_is_not_held(grasp: Grasp, load: Wrench) -> None:
    try:
        choose_state(grasp, load, "peak")
    except Infeasible:
        raise Infeasible(
            f"the grasp itself does not hold the loads, not {load!r} for one; contact_regions asks by how "
            "much the fingers of a grasp that does may be off"
        ) from None
