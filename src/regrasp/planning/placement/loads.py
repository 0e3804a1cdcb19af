"""The loads that a placement is bounded by, and those that it is judged by."""

from math import ceil, pi, sqrt

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench

_MOST_FRICTION, _LEAST_LOAD, _LARGEST_LOAD = 1e4, 1e-60, 1e60
_MOST = 1000  # loads of a round set: every box looks at all of them


def check_planar(load: Wrench | LoadSet) -> None:
    """Raise ``InvalidInput`` for what is no planar load or set of loads."""
    if not isinstance(load, Wrench | LoadSet):
        raise InvalidInput(f"load must be a Wrench or a LoadSet, got {shown(load)}")
    if load.dimension != 2:
        raise InvalidInput("load is in space and the shape in the plane; give a planar load")


def check_sizes(friction: float, load: Wrench | LoadSet) -> None:
    """Raise ``InvalidInput`` for what doubles have no room to prove anything of."""
    if friction > _MOST_FRICTION:
        raise InvalidInput(f"friction must be at most {_MOST_FRICTION:g} here, got {friction:g}")
    if isinstance(load, Wrench):
        sizes = np.abs(load.vector)
    else:
        axes = np.eye(3 * load.dimension - 3)
        sizes = np.array([max(load.support(axis), load.support(-axis)) for axis in axes])
    size = float(sizes.max())
    if size and not _LEAST_LOAD <= size <= _LARGEST_LOAD:
        raise InvalidInput(
            f"loads must be from {_LEAST_LOAD:g} to {_LARGEST_LOAD:g} N or N m here, or 0; got {size:g}"
        )


def inner_and_outer(load: Wrench | LoadSet, tolerance: float) -> tuple[Array, Array]:
    """Loads (m, 3) of the set, and loads (l, 3) whose hull contains it: the same for a point or a hull.

    A bound from loads of the set is one for the set, and a grasp that holds the outer ones holds the set. The
    outer ones are farther from its middle by a fraction of about ``tolerance`` at most, or by 5e-6 of a round
    set, which has a thousand loads at most.
    """
    if isinstance(load, Wrench):
        return load.vector[None], load.vector[None]
    if load.vertices is not None:
        points = np.unique(load.vertices, axis=0)
        return points, points
    middle, flat = _middle_and_axes(load)
    if flat.shape[0] == 0:
        return middle[None], middle[None]
    if flat.shape[0] == 3:
        raise InvalidInput(
            "a set of loads whose forces and torques are both round has no polygon near it; give the hull of "
            "some of its loads"
        )
    count = min(max(8, ceil(pi / sqrt(2 * tolerance))), _MOST) if flat.shape[0] == 2 else 2
    angles = 2 * pi * np.arange(count) / count
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)[:, : flat.shape[0]]
    twists = around @ flat
    inner = np.array([load.extreme(twist).vector for twist in twists])
    if flat.shape[0] == 1:
        return inner, inner
    # neighbouring tangents of the set meet outside it
    reach = np.array([load.support(twist) - twist @ middle for twist in twists])
    step = 2 * pi / count
    after = np.roll(reach, -1)
    along = (after - reach * np.cos(step)) / np.sin(step)
    outer = reach[:, None] * around + along[:, None] * np.stack([-around[:, 1], around[:, 0]], axis=1)
    scale = flat / (flat**2).sum(axis=1)[:, None]
    return inner, middle + outer @ scale


def offset_by(loads: Array, offset: float) -> Array:
    """Loads whose forces act ``offset`` [m] beside their lines, to both sides; as they are for 0."""
    if not offset:
        return loads
    torque = np.hypot(loads[:, 0], loads[:, 1])[:, None] * [0.0, 0.0, offset]
    return np.vstack([loads - torque, loads + torque])


def _middle_and_axes(load: LoadSet) -> tuple[Array, Array]:
    """The middle of a set, and (r, 3) the axes along which it has a width, each scaled to half of it."""
    ahead, back = (np.array([load.support(a) for a in axes]) for axes in (np.eye(3), -np.eye(3)))
    wide, middle = 0.5 * (ahead + back), 0.5 * (ahead - back)
    kept = wide > 1e-14 * (np.abs(middle) + wide)
    axes: Array = (np.eye(3) / np.where(kept, wide, 1.0)[:, None])[kept]
    return middle, axes
