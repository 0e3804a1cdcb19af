"""What is asked of a whole outline: arguments checked, ends placed on sides."""

from math import inf, pi

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, instance, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.outline.polygon import PolygonBoundary
from regrasp.planning.anywhere.forbidden import parted_outline
from regrasp.planning.anywhere.limits import Limits
from regrasp.planning.anywhere.search import Asked, End, Places
from regrasp.planning.anywhere.walk import Hold

MOST_SIDES = 500
_LESS = 1e-9  # of two sides that meet one where fingers may touch is taken
_ON_SIDE = 1e-6  # of the size: farther from every side a contact is not on the outline


def asked_of(
    outline: Outline,
    start: Grasp,
    goal: Grasp,
    load: Wrench,
    friction: float,
    goal_orientation: float,
    turns: ArrayLike,
    forbidden: ArrayLike,
    min_normal: float,
    max_force: float | None,
) -> tuple[Asked, tuple[End, End]]:
    """The task and its ends, of arguments as ``regrasps_on_outline`` takes them; or ``InvalidInput``."""
    if not isinstance(outline, Outline) or not isinstance(outline.boundary, PolygonBoundary):
        raise InvalidInput(f"outline must be an Outline that is a polygon, got {shown(outline)}")
    vertices, free = parted_outline(outline.polygon(), forbidden)
    if len(vertices) > MOST_SIDES:
        raise InvalidInput(f"outline must have at most {MOST_SIDES} sides, got {len(vertices)}")
    mu = number(friction, "friction", above=0)
    instance(load, "load", Wrench)
    if load.dimension != 2 or not load.force.any() or load.torque.any():
        raise InvalidInput(
            f"load must be a planar force through the centre of mass, not zero, got {shown(load)}"
        )
    limits = _limits(min_normal, max_force)
    angle = number(goal_orientation, "goal_orientation")
    lo, hi = _turns(turns, angle)
    one, other = (
        _places(vertices, free, grasp, mu, max_force, name)
        for grasp, name in ((start, "start"), (goal, "goal"))
    )
    return Asked(vertices, free, mu, load, limits, (lo, hi)), (End(start, one, 0.0), End(goal, other, angle))


def arc_lengths_of(vertices: Array, holds: list[Hold]) -> Array:
    """(h, 2) of the places of holds [m]."""
    lengths = np.hypot(*(np.roll(vertices, -1, axis=0) - vertices).T)
    starts = np.cumsum(lengths) - lengths
    sides = np.array([[p[0], q[0]] for p, q, _ in holds], dtype=np.intp).reshape(-1, 2)
    fractions = np.array([[p[1], q[1]] for p, q, _ in holds]).reshape(-1, 2)
    result: Array = starts[sides] + fractions * lengths[sides]
    return result


def _limits(min_normal: float, max_force: float | None) -> Limits:
    least = number(min_normal, "min_normal", least=0)
    most = inf if max_force is None else number(max_force, "max_force", above=0)
    if least > most:
        raise InvalidInput(f"min_normal must be at most max_force, got {least:g} and {most:g}")
    return Limits(least, most)


def _turns(turns: ArrayLike, goal_orientation: float) -> tuple[float, float]:
    lo, hi = array(turns, "turns", (2,)).tolist()
    if not lo <= min(0.0, goal_orientation) <= max(0.0, goal_orientation) <= hi or hi - lo >= pi:
        raise InvalidInput(
            f"turns must be a least and a largest angle less than pi apart, with 0 and goal_orientation "
            f"between them, got {shown((lo, hi))} and {goal_orientation:g}"
        )
    return lo, hi


def _places(
    vertices: Array, free: np.ndarray, grasp: Grasp, friction: float, max_force: float | None, name: str
) -> Places:
    """The sides of three contacts, by point and normal, and the fractions passed."""
    if not isinstance(grasp, Grasp) or grasp.dimension != 2 or len(grasp) != 3:
        raise InvalidInput(f"{name} must be a planar Grasp of three contacts, got {shown(grasp)}")
    refuse_limits(grasp, "a search on a whole outline")
    if any(c.max_force not in (None, max_force) for c in grasp):
        raise InvalidInput(
            f"contacts of the {name} have force limits of their own; all fingers have the one limit max_force"
        )
    if (grasp.frictions != friction).any():
        raise InvalidInput(
            f"all contacts of the {name} must have the friction {friction:g} of the outline, "
            f"got {shown(grasp.frictions.tolist())}"
        )
    along = np.roll(vertices, -1, axis=0) - vertices
    lengths = np.hypot(*along.T)
    unit, size = along / lengths[:, None], float(np.hypot(*vertices.T).max())
    found = []
    for contact in grasp:
        away = contact.position - vertices
        f = np.clip((away * unit).sum(axis=1) / lengths, 0.0, 1.0)
        distance = np.hypot(*(away - f[:, None] * along).T) / size
        turned = np.hypot(contact.normal[0] + unit[:, 1], contact.normal[1] - unit[:, 0])
        side = int(np.argmin(distance + turned + _LESS * ~free))
        if distance[side] + turned[side] > _ON_SIDE:
            raise InvalidInput(
                f"contact {shown(contact.name)} of the {name} is on no side of the outline, "
                f"with its inward normal"
            )
        if not free[side]:
            raise InvalidInput(f"contact {shown(contact.name)} of the {name} is on a forbidden arc")
        found.append((side, float(f[side])))
    return tuple(found)
