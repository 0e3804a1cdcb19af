"""The best forces of one placement within limits, by linear programs and least distances alone.

Cones, least normals, sums and largest normal forces are linear; discs |f| <= limit or t are cut out by
tangents where forces leave them, until none does by more than 1e-9. The least sum of squares is a least
distance, found as Lawson and Hanson do, by non-negative least squares.
"""

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import linprog, nnls

Array = np.ndarray
CLOSE, CUTS = 1e-9, 60


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
