"""The best of all pairs and triples of points on an outline, by judges that share nothing with the search.

Norms, margins and use are those of ``choose_states``, whose forces are checked one by one; what is answered
is bisected among the placements that are left; what is withstood comes from linear programs
(``withstood_attack``), and the ball of Ferrari and Canny from the hull of what fingers make (Qhull).
"""

from itertools import combinations, product
from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull, QhullError

import regrasp as rg
from random_attack import on_outline
from withstood_attack import FINE, withstood

Array = np.ndarray
LARGEST = ("angle", "force", "answered", "wrench", "wrench_ball")
FIRST = 100  # placements that are judged under all loads first: their best leaves others out
STEP, HALVINGS = 1.1, 40  # of levels that are answered


class Places(NamedTuple):
    """Placements: positions about the centre of mass and inward unit normals, (m, k, 2)."""

    positions: Array
    normals: Array

    def some(self, which: Array) -> "Places":
        """Those of these numbers."""
        return Places(self.positions[which], self.normals[which])


class Task(NamedTuple):
    """What is asked of placements: loads (l, 3), of which the first is the load without deviations.

    deviations: of ``answered`` and ``wrench`` (d, 3). length: by which torques are divided.
    """

    objective: str
    friction: float
    loads: Array
    limit: float
    deviations: Array | None = None
    length: float = 1.0


def points_of(outline: rg.Outline, count: int, *, in_holes: bool = False) -> tuple[Array, Array]:
    """Evenly spread points (count, 2) and their inward normals, of holes, too, if asked."""
    if not in_holes:
        return on_outline(outline)((np.arange(count) + 0.5) / count * outline.length)
    rings = [outline.polygon(), *(hole[::-1] for hole in outline.hole_polygons())]
    start = np.concatenate(rings)
    along = np.concatenate([np.roll(ring, -1, axis=0) - ring for ring in rings])
    far = np.hypot(*along.T)
    end = np.cumsum(far)
    s = (np.arange(count) + 0.5) / count * end[-1]
    edge = np.searchsorted(end, s)
    unit = along[edge] / far[edge, None]
    points = start[edge] + (s - end[edge] + far[edge])[:, None] * unit
    return points, np.stack([-unit[:, 1], unit[:, 0]], axis=1)


def all_of(points: tuple[Array, Array], fingers: int) -> Places:
    """Every choice of so many of the points."""
    few = np.array(list(combinations(range(len(points[0])), fingers)))
    return Places(points[0][few], points[1][few])


def best(places: Places, task: Task) -> tuple[float, bool]:
    """The best value of the placements, and whether some hold; where none does, the worst value there is."""
    if task.objective == "wrench_ball":
        radii = [ball(p, n, task) for p, n in zip(*places, strict=True)]
        return max(radii), max(radii) > 0
    if task.deviations is not None:
        held = places.some(_holds(places, task, 0.0))
        if not len(held.positions):
            return 0.0, False
        found = _answered(held, task) if task.objective == "answered" else _withstood(held, task)
        return found, True
    values = norms(places, task)
    found = float(values.min(initial=np.inf))
    return (-found if task.objective in LARGEST else found), found < np.inf


def norms(places: Places, task: Task, *, whole: bool = False) -> Array:
    """(m,) values for the worst load, negative ones of what is to be large; infinite where a load is lost.

    Those that are worse than the best may be given what they need for some loads, unless ``whole``.
    """
    count = len(places.positions)
    worst, left = np.full(count, -np.inf), np.arange(count)
    for number, load in enumerate(task.loads):
        worst[left] = np.maximum(worst[left], _norms_of(places.some(left), task, load))
        left = left[worst[left] < np.inf]
        if number == 0 and count > FIRST and not whole:
            first = left[np.argsort(worst[left], kind="stable")[:FIRST]]
            enough = norms(places.some(first), task, whole=True).min(initial=np.inf)
        if count > FIRST and not whole:
            left = left[worst[left] <= enough]
    return worst


def _norms_of(places: Places, task: Task, load: Array) -> Array:
    if not len(places.positions):
        return np.zeros(0)
    d = places.positions.shape[-1]
    force, torque = load[:d], load[d:] if d == 3 else load[2]
    found = rg.choose_states(
        *places, task.friction, force, torque, objective=task.objective, max_force=task.limit
    )
    signed = -found.values if task.objective in LARGEST else found.values
    return np.where(found.held, signed, np.inf)


def _holds(places: Places, task: Task, level: float) -> Array:
    """Which hold the load and all deviations, scaled."""
    loads = task.loads if level == 0 else task.loads[0] + level * task.deviations
    held = np.arange(len(places.positions))
    for load in loads:
        if len(held):
            held = held[_norms_of(places.some(held), task._replace(objective="peak"), load) < np.inf]
    return held


def _answered(held: Places, task: Task) -> float:
    """The largest level that one of those that hold answers."""
    low, high = 0.0, 1.0
    while len(more := _holds(held, task, high)):
        held, low, high = held.some(more), high, 2 * high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if len(more := _holds(held, task, middle)):
            held, low = held.some(more), middle
        else:
            high = middle
    return low


def _withstood(held: Places, task: Task) -> float:
    """The largest level that one withstands: those that answer most are judged first, by linear programs."""
    levels, left, level = [], [np.arange(len(held.positions))], 0.05
    while len(more := left[-1][_holds(held.some(left[-1]), task, level)]):
        left.append(more)
        levels.append(level)
        level *= STEP
    found = 0.0
    for number in reversed(range(len(left))):
        if number + 1 < len(left) and levels[number] <= found:
            break
        for i in left[number] if number + 1 == len(left) else np.setdiff1d(left[number], left[number + 1]):
            found = max(found, withstood(*(a[i] for a in held), task.friction, task.deviations, FINE, True))
    return found


def ball(positions: Array, normals: Array, task: Task) -> float:
    """The distance of zero from the hull of what fingers make with normal forces of at most the limit [N]."""
    across = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    made = [
        np.zeros((len(positions), 3)),
        *(_wrenches(positions, normals + way * task.friction * across, task.length) for way in (-1, 1)),
    ]
    each = np.stack(made, axis=1)
    sums = np.array([sum(ends) for ends in product(*each)])
    try:
        facets = ConvexHull(sums).equations
    except QhullError:  # flat
        return 0.0
    return task.limit * max(float(-facets[:, 3].max()), 0.0)


def _wrenches(positions: Array, forces: Array, length: float) -> Array:
    torque = positions[:, 0] * forces[:, 1] - positions[:, 1] * forces[:, 0]
    result: Array = np.column_stack([forces, torque / length])
    return result
