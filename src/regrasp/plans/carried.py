"""The load on an object that is carried: its weight and its inertia, from its mass and its motion."""

from collections.abc import Callable

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, number, numbers_in, point
from regrasp.mechanics.wrench import Wrench

STEP = 1e-3
"""Of differences in time [s]: of fourth order, so that smooth motions are good to eight digits or more."""

# Central differences of fourth order at -2, -1, 0, 1, 2 steps.
_FIRST = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12
_SECOND = np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / 12

Motion = Callable[[float], ArrayLike]


def carried_load(
    mass: float,
    gravity: ArrayLike,
    *,
    position: Motion | None = None,
    orientation: Motion | None = None,
    inertia: ArrayLike | None = None,
    step: float = STEP,
) -> Callable[[float], Wrench]:
    """The load on an object that a hand carries along a motion, as a function of time for ``plan_hold``.

    In the object's frame, about its centre of mass: F = R'(m (g - p'')) and tau = -(I alpha + w x I w), in
    the plane tau = -I theta''. Derivatives are differences of fourth order.

    Args:
        mass: of the object [kg], in units that fit those of force, length and time.
        gravity: (d,) acceleration in the world [m/s^2].
        position: of the centre of mass in the world over time, (d,) [m]; at rest if not given.
        orientation: over time, the object's angle [rad], in space the (3, 3) rotation matrix from its frame
            to the world; not turning if not given.
        inertia: about the centre of mass: a number in the plane, (3, 3) in the object's frame in space
            [kg m^2]; needed where the object turns.
        step: of the differences [s]; functions are asked up to two steps before and after each time.

    Raises:
        InvalidInput: For bad input, and where a motion returns what is none.
    """
    weight, g = number(mass, "mass", above=0), point(gravity, "gravity")
    d, h = g.size, number(step, "step", above=0)
    for what, motion in (("position", position), ("orientation", orientation)):
        if motion is not None and not callable(motion):
            raise InvalidInput(f"{what} must be a function of time, got {shown(motion)}")
    if orientation is not None and inertia is None:
        raise InvalidInput("an object that turns has an inertia: give inertia= about its centre of mass")
    shape: tuple[int | None, ...] = () if d == 2 else (3, 3)
    moment = None if inertia is None else array(inertia, "inertia", shape)
    if moment is not None and d == 3 and abs(moment - moment.T).max() > 1e-9 * abs(moment).max():
        raise InvalidInput("inertia must be a symmetric matrix")

    def around(motion: Motion, t: float, shape: tuple[int, ...], what: str) -> Array:
        values = [numbers_in(motion(t + k * h), f"{what} must be numbers") for k in range(-2, 3)]
        for value in values:
            if value.shape != shape or not np.isfinite(value).all():
                raise InvalidInput(f"{what} must return {shape or 'one number'}, got {shown(value)}")
        return np.array(values)

    def load(t: float) -> Wrench:
        force = weight * g
        if position is not None:
            force = force - weight * np.tensordot(_SECOND, around(position, t, (d,), "position"), 1) / h**2
        if orientation is None:
            return Wrench(force)
        assert moment is not None
        if d == 2:
            angles = around(orientation, t, (), "orientation")
            torque = -float(moment) * float(_SECOND @ angles) / h**2
            return Wrench(force, torque).rotated(-float(angles[2]))
        turns = around(orientation, t, (3, 3), "orientation")
        middle = turns[2]
        if abs(middle.T @ middle - np.eye(3)).max() > 1e-9:
            raise InvalidInput(f"orientation must return a rotation matrix, got {shown(middle)}")
        first, second = (middle.T @ np.tensordot(c, turns, 1) for c in (_FIRST / h, _SECOND / h**2))
        spin = _axial(first)
        alpha = _axial(second - first @ first)
        torques = -(moment @ alpha + np.cross(spin, moment @ spin))
        return Wrench(middle.T @ force, torques)

    return load


def _axial(matrix: Array) -> Array:
    """The vector w of the skew part of a matrix, [w] v = w x v."""
    skew = (matrix - matrix.T) / 2
    return np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
