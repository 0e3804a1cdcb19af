"""The best of all pairs and triples of points on an outline, by judges that share nothing with the search.

Norms, margins and use are those of ``choose_states``, whose forces are checked one by one; what is answered
is bisected among the placements that are left; what is withstood comes from linear programs
(``withstood_attack``), and the ball of Ferrari and Canny from the hull of what fingers make (Qhull).

With least normal forces (``least``) cones, sums and largest normal forces are linear; discs |f| <= limit or t
are cut out by tangents where forces leave them, until none does by more than 1e-9. The least sum of squares
is a least distance, found as Lawson and Hanson do, by non-negative least squares.
"""

from itertools import combinations, product
from typing import NamedTuple

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import linprog, nnls
from scipy.spatial import ConvexHull, QhullError

import regrasp as rg
from random_attack import on_outline
from withstood_attack import FINE, ROUGH, withstood

Array = np.ndarray
LARGEST = ("angle", "force", "answered", "wrench", "wrench_ball")
FIRST = 100  # placements that are judged under all loads first: their best leaves others out
LOOKS = (0, 2, 8)  # numbers of loads, after which the best so far are
HALVINGS = 40  # of levels that are answered
CLOSE, CUTS = 1e-9, 60


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


def best(places: Places, task: Task, above: float = 0.0) -> tuple[float, bool]:
    """The best value of the placements, and whether some hold; where none does, the worst value there is.

    above: of what is answered or withstood, a level from which on it is worth to know: the best is this if
    none is better.
    """
    if task.objective == "wrench_ball":
        radii = [ball(p, n, task) for p, n in zip(*places, strict=True)]
        return max(radii), max(radii) > 0
    if task.deviations is not None:
        held = places.some(_holds(places, task, 0.0))
        if not len(held.positions):
            return 0.0, False
        held = held.some(_holds(held, task, above)) if above else held
        return (_answered if task.objective == "answered" else _withstood)(held, task, above), True
    values = norms(places, task)
    found = float(values.min(initial=np.inf))
    return (-found if task.objective in LARGEST else found), found < np.inf


def norms(places: Places, task: Task, *, whole: bool = False) -> Array:
    """(m,) values for the worst load, negative ones of what is to be large; infinite where a load is lost.

    Those that are worse than the best may be given what they need for some loads, unless ``whole``.
    """
    count = len(places.positions)
    worst, left, enough = np.full(count, -np.inf), np.arange(count), np.inf
    for number, load in enumerate(task.loads):
        worst[left] = np.maximum(worst[left], _norms_of(places.some(left), task, load))
        left = left[worst[left] < np.inf]
        if whole or count <= FIRST:
            continue
        if number in LOOKS:
            first = left[np.argsort(worst[left], kind="stable")[:FIRST]]
            enough = min(enough, norms(places.some(first), task, whole=True).min(initial=np.inf))
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


def _answered(held: Places, task: Task, low: float) -> float:
    """The largest level that one of those that answer one answers."""
    if not len(held.positions):
        return low
    high = max(1.0, 2 * low)
    while len(more := _holds(held, task, high)):
        held, low, high = held.some(more), high, 2 * high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if len(more := _holds(held, task, middle)):
            held, low = held.some(more), middle
        else:
            high = middle
    return low


def _withstood(held: Places, task: Task, found: float) -> float:
    """The largest level that one withstands, by linear programs; those that do not answer more are left out.

    Polygons around the circles of limits, of few sides, say first what none withstands more than.
    """
    left = np.random.default_rng(0).permutation(len(held.positions))
    while len(left):
        each, left = [held.some(i) for i in left[:FIRST]], left[FIRST:]
        most = np.array([withstood(*one, task.friction, task.deviations, ROUGH, False) for one in each])
        before = found
        for i in np.argsort(-most, kind="stable"):
            if most[i] <= found:
                break
            found = max(found, withstood(*each[i], task.friction, task.deviations, FINE, True))
        if found > before:
            left = left[_holds(held.some(left), task, found)]
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


def least(
    p: Array, n: Array, mu: float, load: Array, objective: str, limit: float, min_normal: float
) -> float:
    """The least ``sum_normal``, ``peak_normal``, ``peak`` or ``effort`` of forces (k, 2); infinite for none.

    p, n: positions and inward unit normals (k, 2). load: (3,) to be balanced. limit: of every force.
    """
    k = len(p)
    size = float(np.linalg.norm(p, axis=1).max())
    made = np.zeros((3, 2 * k))
    made[0, 0::2] = made[1, 1::2] = 1.0
    made[2, 0::2], made[2, 1::2] = -p[:, 1] / size, p[:, 0] / size
    wanted = -load / [1, 1, size]
    t = np.stack([-n[:, 1], n[:, 0]], axis=1)
    rows: list[Array] = []
    most: list[float] = []

    def add(i: int, direction: Array, right: float, level: float = 0.0) -> None:
        """Direction . f_i - level times the level <= right."""
        one = np.zeros(2 * k + 1)
        one[2 * i : 2 * i + 2], one[-1] = direction, -level
        rows.append(one)
        most.append(right)

    discs = [(limit, 0.0)] * bool(np.isfinite(limit)) + [(0.0, 1.0)] * (objective == "peak")
    around = np.arange(8) * np.pi / 4
    for i in range(k):
        for way in (-1, 1):
            add(i, way * t[i] - mu * n[i], 0.0)
        add(i, -n[i], -min_normal)
        if objective == "peak_normal":
            add(i, n[i], 0.0, 1.0)
        for right, level in discs:
            for angle in around:
                add(i, np.array([np.cos(angle), np.sin(angle)]), right, level)
    for _ in range(CUTS):
        found = _solved(made, wanted, np.array(rows), np.array(most), objective, n)
        if found is None:
            return np.inf
        f, level_found = found
        left = False
        for i, force in enumerate(f):
            far = float(np.hypot(*force))
            for right, level in discs:
                if far > (right + level * level_found) * (1 + CLOSE) + 1e-12:
                    add(i, force / far, right, level)
                    left = True
        if not left:
            break
    normal = (f * n).sum(axis=1)
    return float({
        "sum_normal": normal.sum(), "peak_normal": normal.max(), "peak": np.hypot(*f.T).max(),
        "effort": (f**2).sum(),
    }[objective])  # fmt: skip


def _solved(
    made: Array, wanted: Array, rows: Array, most: Array, objective: str, n: Array
) -> tuple[Array, float] | None:
    """Forces (k, 2) and the level; None without any."""
    k = len(n)
    if objective == "effort":
        return _least_distance(made, wanted, rows[:, :-1], most)
    cost = np.append(n.ravel(), 0.0) if objective == "sum_normal" else np.append(np.zeros(2 * k), 1.0)
    found = linprog(
        cost, rows, most, np.column_stack([made, np.zeros(3)]), wanted, [(None, None)] * (2 * k + 1),
        method="highs",
    )  # fmt: skip
    return (found.x[:-1].reshape(k, 2), float(found.x[-1])) if found.status == 0 else None


def _least_distance(made: Array, wanted: Array, rows: Array, most: Array) -> tuple[Array, float] | None:
    """The least |f| of those that balance, rows . f <= most."""
    start = np.linalg.lstsq(made, wanted, rcond=None)[0]
    if np.abs(made @ start - wanted).max() > 1e-9 * max(float(np.abs(wanted).max()), 1e-300):
        return None
    free = null_space(made)
    # minimise |z| with -rows (start + free z) >= -most
    right = rows @ start - most
    unit = max(float(np.abs(right).max()), 1e-300)
    matrix = np.vstack([-(rows @ free).T, right / unit])
    target = np.append(np.zeros(free.shape[1]), 1.0)
    shares, _ = nnls(matrix, target, maxiter=1000)
    rest = matrix @ shares - target
    if np.abs(rest).max() < 1e-9 or -rest[-1] < 1e-12:
        return None
    z = unit * rest[:-1] / -rest[-1]
    return (start + free @ z).reshape(-1, 2), 0.0
