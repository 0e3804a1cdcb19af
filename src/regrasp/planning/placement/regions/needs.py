"""The limit on forces of regions, from what the grasp itself needs."""

import numpy as np

from regrasp.errors import Infeasible, InvalidInput

PEAK_RATIO = 3.0
"""Default limit on every force, as a multiple of the least largest force of the grasp as it is."""
LESS = 1e-6
"""Of widths and of friction, given up so that forces at the corners exist for solvers, too."""


def limit_of(least: float, given: float | None) -> float:
    """Of forces, where a grasp needs ``least``."""
    if not least < np.inf:
        raise Infeasible(
            "the grasp itself holds the loads not at all, or on a knife's edge, with a millionth of its "
            "friction kept back"
        )
    if given is None and least == 0.0:
        raise InvalidInput("no force follows from a zero load: give max_force")
    limit = PEAK_RATIO * least if given is None else given * (1 - LESS)
    if least > limit:
        raise Infeasible(f"the grasp itself needs a force of {least:.6g} N, above max_force {limit:.6g} N")
    return limit
