"""Set-points of one step, and what times and orientations in a file must be."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array

# An angle, or a quaternion, in a file may differ by this much from the plan's at that time [rad].
_SAME_ANGLE = 1e-9
_UNEVEN = 1e-6


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
    if times.size < 2 or times[0] != start or times[-1] != end or not (np.diff(times) > 0).all():
        raise InvalidInput(f"{path}: times must rise from {start:g} to {shown(end)} s")


def check_spacing(path: Path, steps: Sequence[tuple[Array, float]], rate: float | None = None) -> float:
    """The even spacing [s] of the rows of steps, times (m,) from 0 to a duration; a last one may come early.

    rate: rows per second, or None for any. Raises ``InvalidInput`` where a row is missing or moved, by more
    than a millionth of the spacing: forces are compared at each row's own time.
    """
    several = [times for times, _ in steps if times.size > 2]
    if rate is not None:
        spacing = 1 / rate
    elif several:
        spacing = float(several[0][-2]) / (several[0].size - 2)
    else:
        spacing = max(duration for _, duration in steps)
    for times, duration in steps:
        off = abs(times[:-1] - spacing * np.arange(times.size - 1)) > _UNEVEN * spacing
        if off.any() or duration - times[-2] > spacing * (1 + _UNEVEN):
            near = float(times[np.argmax(off)] if off.any() else times[-2])
            raise InvalidInput(
                f"{path}: rows must come every {spacing:.9g} s to the end; one is missing or moved near "
                f"{near:.9g} s of its step"
            )
    return spacing


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
