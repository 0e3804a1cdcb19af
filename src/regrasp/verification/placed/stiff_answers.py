"""Whether states are what set-points turn into where fingers of equal stiffness answer a deviation."""

import numpy as np

from regrasp.mechanics.state import GraspState

_CLOSE = 1e-9


def answer_alike(states: tuple[GraspState, ...]) -> bool:
    """Whether the forces of planar states differ from those of the first as equal springs make them.

    The object moves by some small twist (v, omega), the same for all fingers, and a finger at r pushes back
    with -k (v + omega x r). Which twist it is balance decides, which each state is checked for.
    """
    first, *others = states
    size = float(np.linalg.norm(first.grasp.positions, axis=1).max()) or 1.0
    x, y = (first.grasp.positions / size).T
    moved = np.zeros((2 * len(x), 3))
    moved[0::2, 0] = moved[1::2, 1] = 1.0
    moved[0::2, 2], moved[1::2, 2] = -y, x
    for state in others:
        change = (state.forces - first.forces).ravel()
        left = change - moved @ np.linalg.lstsq(moved, change, rcond=None)[0]
        if np.abs(left).max() > _CLOSE * np.abs(state.forces).max():
            return False
    return True
