"""Set-points of one step, and what times and orientations in a file must be."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array

# An angle, or a quaternion, in a file may differ by this much from the plan's at that time [rad].
_SAME_ANGLE = 1e-9


class Rows(NamedTuple):
    """Set-points of one step, or of a plan that is one transition.

    step: its number, from 0. times: (m,) from its start [s]. angles: (m,) of the object, from its start
    [rad]. forces: (m, n, d) of the step's contacts [N], (m, n, 4) with soft fingers.
    """

    step: int
    times: Array
    angles: Array
    forces: Array


def check_times(path: Path, times: Array, start: float, end: float) -> None:
    """Raise ``InvalidInput`` unless times (m,) rise from ``start`` to ``end`` [s]."""
    if times[0] != start or times[-1] != end or not (np.diff(times) > 0).all():
        raise InvalidInput(f"{path}: times must rise from {start:g} to {end!r} s")


def check_angles(path: Path, angles: Array, planned: Array) -> None:
    """Raise ``InvalidInput`` unless angles (m,) [rad] are the plan's."""
    off = float(abs(angles - planned).max())
    if off > _SAME_ANGLE:
        raise InvalidInput(f"{path}: angles must be the plan's at these times; one is off by {off:.3g} rad")


def check_quaternions(path: Path, quaternions: Array, planned: Array) -> None:
    """Raise ``InvalidInput`` unless quaternions (m, 4) are the plan's, their signs included."""
    off = float(np.linalg.norm(quaternions - planned, axis=1).max())
    if off > _SAME_ANGLE:
        raise InvalidInput(f"{path}: quaternions must be the plan's at these times; one is off by {off:.3g}")
