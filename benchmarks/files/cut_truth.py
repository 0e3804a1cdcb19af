"""Whether a cut that no hold crosses tells the truth, from its plain data alone, in doubles.

No name of regrasp is imported. A cut of contacts is true, False, or None where a pair is within rounding of
holding; of a cut of an outline random pairs of places show that it lies, and nothing shows that it does not.
"""

from itertools import combinations, product
from math import atan, cos, hypot, sin, sqrt

import numpy as np

NEAR = 1e-9


def cut_truth(data: dict) -> bool | None:
    """Whether no pair of contacts holds across the cut, nor one of an end on the wrong side."""
    contacts, inside = data["contacts"], set(data["reached"])
    start, goal = data["start"], data["goal"]
    if any(len(set(end)) != 3 for end in (start, goal)) or set(start) == set(goal):
        return False
    wrong = [(i, j) for i, j in product(inside, range(len(contacts))) if j not in inside]
    wrong += [pair for pair in combinations(start, 2) if not set(pair) <= inside]
    wrong += [pair for pair in combinations(goal, 2) if set(pair) & inside]
    found = [_may(contacts[i], contacts[j], data["least_margin"], data["min_distance"]) for i, j in wrong]
    return False if True in found else None if None in found else True


def _may(one: dict, other: dict, margin: float, apart: float) -> bool | None:
    """Whether two contacts hold some load through the origin by an angle margin; None for nearly so."""
    away = hypot(*(a - b for a, b in zip(one["position"], other["position"], strict=True)))
    sides = [_turning(c, margin) for c in (one, other)]
    if None in sides or abs(away - apart) <= NEAR * max(away, apart):
        return None
    if away < apart:
        return False
    if "empty" in sides:  # the other one may hold alone
        return "both" in sides
    return "both" in sides or sides[0] != sides[1]


def _turning(contact: dict, margin: float) -> str | None:
    """Which way forces of a narrowed cone turn: one, the other, both, or the cone is empty."""
    half = atan(contact["friction"]) - margin
    if abs(half) <= NEAR:
        return None
    if half < 0:
        return "empty"
    (x, y), (nx, ny) = contact["position"], contact["normal"]
    size, reach = hypot(nx, ny), hypot(x, y)
    torques = []
    for a in (half, -half):
        fx, fy = (nx * cos(a) - ny * sin(a)) / size, (nx * sin(a) + ny * cos(a)) / size
        torques.append(x * fy - y * fx)
    if min(map(abs, torques)) <= NEAR * reach:
        return "both" if reach == 0 else None
    if torques[0] * torques[1] < 0:
        return "both"
    return "one" if torques[0] > 0 else "other"


def outline_cut_lies(data: dict, tries: int = 400) -> bool:
    """Whether random places across the cut hold, or places of an end on the wrong side."""
    rng = np.random.default_rng(0)
    vertices = np.array(data["vertices"], dtype=float)
    arcs = [tuple(arc) for arc in data["reached"]]
    forbidden = set(np.array(data.get("forbidden") or []).ravel().tolist())

    def inside(side: float, at: float) -> bool:
        return any(arc[0] == side and arc[1] <= at <= arc[2] for arc in arcs)

    start, goal = ([tuple(place) for place in data[end]] for end in ("start", "goal"))
    if sorted(start) == sorted(goal):
        return True
    loads = _loads(np.array(data["force"], float), np.array(data.get("turned") or data["force"], float))
    wrong = [pair for pair in combinations(start, 2) if not all(inside(*p) for p in pair)]
    wrong += [pair for pair in combinations(goal, 2) if any(inside(*p) for p in pair)]
    free = [side for side in range(len(vertices)) if side not in forbidden]
    for _ in range(tries if arcs and free else 0):
        arc = arcs[int(rng.integers(len(arcs)))]
        other = (free[int(rng.integers(len(free)))], float(rng.random()))
        if not inside(*other):
            wrong.append(((arc[0], float(arc[1] + rng.random() * (arc[2] - arc[1]))), other))
    limits = data["friction"], data.get("min_normal", 0.0), data.get("max_force")
    return any(_holds(vertices, *pair, load, *limits) for pair in wrong for load in loads)


def _loads(first: np.ndarray, last: np.ndarray) -> list[np.ndarray]:
    """Some of a turn from one to the other, the shorter way."""
    angle = np.arctan2(first[0] * last[1] - first[1] * last[0], first @ last)
    found = []
    for share in (0.0, 0.3, 0.7, 1.0) if abs(angle) > 1e-12 else (0.0,):
        c, s = cos(share * angle), sin(share * angle)
        found.append(np.array([c * first[0] - s * first[1], s * first[0] + c * first[1]]))
    return found


def _holds(vertices, one, other, load, mu: float, least: float, most: float | None) -> bool:
    """Whether two places hold a load by more than rounding: the squeeze between them has room."""
    points, normals = [], []
    for side, at in (one, other):
        p, q = (vertices[(int(side) + k) % len(vertices)] for k in (0, 1))
        along = (q - p) / (hypot(*(q - p)) or 1.0)
        points.append(p + at * (q - p))
        normals.append(np.array([-along[1], along[0]]))
    (a, b), between = points, points[1] - points[0]
    if hypot(*between) <= NEAR * np.abs(vertices).max():
        return False
    matrix = np.array([[1, 0, 1, 0], [0, 1, 0, 1], [-a[1], a[0], -b[1], b[0]]])
    still = np.linalg.lstsq(matrix, np.array([-load[0], -load[1], 0.0]), rcond=None)[0]
    squeeze = np.array([*between, *-between])
    low, high = -1e9, 1e9
    for f, d, n in zip(still.reshape(2, 2), squeeze.reshape(2, 2), normals, strict=True):
        t = np.array([n[1], -n[0]])
        for row, bound in ((mu * n - t, 0.0), (mu * n + t, 0.0), (n, least)):  # row . (f + s d) >= bound
            rise, has = row @ d, row @ f - bound
            if abs(rise) <= NEAR * hypot(*d):
                if has < NEAR * hypot(*load):
                    return False
            elif rise > 0:
                low = max(low, -has / rise)
            else:
                high = min(high, -has / rise)
        if most is not None:
            dd, df, ff = d @ d, d @ f, f @ f - most * most
            if df * df <= dd * ff:
                return False
            root = sqrt(df * df - dd * ff)
            low, high = max(low, (-df - root) / dd), min(high, (-df + root) / dd)
    return high - low > 1e-6 * (abs(high) + abs(low))
