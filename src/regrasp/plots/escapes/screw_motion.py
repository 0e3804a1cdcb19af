"""Where points of an object go along an escape twist in space, for pictures of it."""

from math import pi

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import EscapeTwist


def moved(twist: EscapeTwist, points: Array, amount: float) -> Array:
    """Points (m, 3) after the object turned by ``amount`` [rad] about its screw axis, or slid by it [m]."""
    if twist.axis is None:
        velocity = twist.twist[:3]
        slid: Array = points + amount * velocity / np.linalg.norm(velocity)
        return slid
    centre, n = twist.axis
    arms = points - centre
    along = arms @ n
    across = arms - np.multiply.outer(along, n)
    turned = np.cos(amount) * across + np.sin(amount) * np.cross(n, across)  # Rodrigues
    result: Array = centre + turned + np.multiply.outer(along + twist.pitch * amount, n)
    return result


def amount_for(twist: EscapeTwist, points: Array, way: float) -> float:
    """The amount of motion in which the fastest of points goes ``way`` [m]; a quarter turn at most."""
    if twist.axis is None:
        return way
    centre, n = twist.axis
    arms = np.linalg.norm(np.cross(n, points - centre), axis=-1)
    fastest = float(np.hypot(arms.max(), twist.pitch))
    return min(way / fastest, pi / 2) if fastest else pi / 2
