"""Distances to cones in plain NumPy: the oracle of the compiled audit."""

import numpy as np

from regrasp.programs import Cone, Program


def slack(program: Program, x: np.ndarray) -> np.ndarray:
    """s = b - A x, (m,)."""
    return program.b - program.A @ x


def distance_to_cones(program: Program, s: np.ndarray, *, dual: bool = False) -> float:
    """Largest violation of a cone by s (m,), or of a dual cone; zero inside.

    Non-negative and second-order cones are their own duals; the zero cone's is everything.
    """
    worst = 0.0
    for block, rows in program.slices:
        part = s[rows]
        if block.cone is Cone.NONNEGATIVE:
            worst = max(worst, float((-part).max(initial=0.0)))
        elif block.cone is Cone.SECOND_ORDER:
            each = part.reshape(block.count, block.size)
            worst = max(worst, float((np.linalg.norm(each[:, 1:], axis=1) - each[:, 0]).max(initial=0.0)))
        elif not dual:
            worst = max(worst, float(abs(part).max(initial=0.0)))
    return worst
