"""Grasps and loads from distributions that break planners. Imports nothing of the project.

Near-parallel normals, contacts 1e-13 to 1e-3 of the size apart or at one point, all on a line, sizes and
forces from 1e-6 to 1e6, frictions 0, 1e-13 ... 1e-6 and 0.1 to 10, no load, loads 1e-12 of the force limits,
pure torques, loads made by forces inside the cones, and loads at, inside and beyond an edge that is known
(``boundary``).
"""

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np

from boundary import KINDS, boundary, wrench

Array = np.ndarray
TINY_FRICTIONS = (0.0, 1e-13, 1e-11, 1e-9, 1e-6, 1e-3)
FRICTIONS = (0.1, 0.3, 0.5, 0.8, 1.5, 3.0, 10.0)


@dataclass(frozen=True)
class Problem:
    """Contacts (n, d), load (3,) or (6,) and force limits (n,), infinite for none.

    room: how far the load is known to be inside what is held, as a fraction of it; negative if it is known
    to be outside by that much; nan if unknown. max_force: a limit besides, or None.
    """

    kind: str
    positions: Array
    normals: Array
    frictions: Array
    limits: Array
    load: Array
    room: float
    max_force: float | None


def problem(seed: int) -> Problem:
    """The problem of a number, the same on every machine with the same NumPy."""
    rng = np.random.default_rng(seed)
    made = _at_an_edge(rng) if rng.random() < 0.3 else _anywhere(rng)
    length, force = 10.0 ** rng.choice([0, 0, 0, -6, -3, 3, 6]), 10.0 ** rng.choice([0, 0, 0, -6, -3, 3, 6])
    load = made.load * force
    load[made.positions.shape[1] :] *= length
    return Problem(
        made.kind, made.positions * length, made.normals, made.frictions, made.limits * force, load,
        made.room, None if made.max_force is None else made.max_force * force,
    )  # fmt: skip


def _at_an_edge(rng: np.random.Generator) -> Problem:
    d = int(rng.integers(2, 4))
    kind = str(rng.choice([k for k in KINDS if d == 3 or k != "box turns"]))
    at = boundary(rng, d, kind)
    beyond = float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.integers(-9, 0))
    return Problem(
        f"edge, {kind}", at.positions, at.normals, at.frictions, at.limits, at.load(beyond), -beyond, None
    )


def _anywhere(rng: np.random.Generator) -> Problem:
    d = int(rng.choice([2, 2, 3]))
    n = int(rng.integers(2, 5) if d == 2 else rng.integers(2, 6))
    r = rng.normal(size=(n, d))
    normals = -r / np.linalg.norm(r, axis=1)[:, None] + 0.5 * rng.normal(size=(n, d))
    shape = str(
        rng.choice(
            ["plain", "parallel", "close", "line", "one point", "lattice"],
            p=[0.4, 0.12, 0.16, 0.12, 0.1, 0.1],
        )
    )
    if shape == "parallel":
        normals[1:] = rng.choice([-1.0, 1.0], n - 1)[:, None] * normals[0] + _hair(rng) * rng.normal(
            size=(n - 1, d)
        )
    if shape == "close":
        r[1] = r[0] + _hair(rng, -13, -3) * rng.normal(size=d)
    if shape == "line":
        r = (
            r[0]
            + rng.normal(size=(n, 1)) * rng.normal(size=d)
            + rng.choice([0.0, 1e-12, 1e-6]) * rng.normal(size=(n, d))
        )
    if shape == "one point":
        r[1] = r[0]
    if shape == "lattice":
        r, normals = rng.integers(-3, 4, (2, n, d)).astype(float)
        if len({tuple(p) for p in r.tolist()}) < n or not normals.any(axis=1).all():
            return _anywhere(rng)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    frictions = rng.choice(FRICTIONS, n)
    if rng.random() < 0.3:
        frictions = np.where(rng.random(n) < 0.5, rng.choice(TINY_FRICTIONS, n), frictions)
    limits = np.where(rng.random(n) < 0.15, rng.uniform(0.3, 5, n), inf)
    max_force = float(rng.uniform(0.5, 5)) if rng.random() < 0.3 else None
    what = str(rng.choice(["none", "tiny", "torque", "random", "held"], p=[0.12, 0.1, 0.1, 0.2, 0.48]))
    load, room = rng.normal(size=3 if d == 2 else 6), float("nan")
    if what == "none":
        load, max_force = 0 * load, max_force or 1.0
    if what == "tiny":
        load, max_force = load * 10.0 ** rng.integers(-13, -5), 1.0
    if what == "torque":
        load[:d] = 0
    if what == "held":
        most = np.minimum(limits, inf if max_force is None else max_force)
        load, room = _held(rng, r, normals, frictions, most)
    return Problem(f"{shape}, {what}", r, normals, frictions, limits, load, room, max_force)


def _held(
    rng: np.random.Generator, r: Array, normals: Array, frictions: Array, limits: Array
) -> tuple[Array, float]:
    """A load that forces inside the cones hold, and at least how far inside.

    Forces that change by df stay inside where |df_i| is below the distance of f_i to its cone and limit, and
    the change of load that the smallest df makes up for is at least sigma_min(G) |df|, torques by the size.
    """
    n, d = r.shape
    f, depth = np.zeros((n, d)), np.zeros(n)
    for i in range(n):
        across = rng.normal(size=d)
        across -= (across @ normals[i]) * normals[i]
        across *= rng.uniform(0, 0.9) * frictions[i] / (np.linalg.norm(across) or 1.0)
        f[i] = normals[i] + across
        f[i] *= min(rng.uniform(0.1, 2), 0.9 * limits[i] / np.linalg.norm(f[i]))
        size = np.linalg.norm(f[i])
        tangent = np.linalg.norm(f[i] - (f[i] @ normals[i]) * normals[i])
        depth[i] = min(
            (frictions[i] * (f[i] @ normals[i]) - tangent) / sqrt(1 + frictions[i] ** 2), limits[i] - size
        )
    load = -wrench(r, f)
    arm = np.linalg.norm(r, axis=1).max()
    columns = []
    for i in range(n):
        for k in range(d):
            unit = np.zeros((n, d))
            unit[i, k] = 1
            column = wrench(r, unit)
            column[d:] /= arm
            columns.append(column)
    least = np.linalg.svd(np.array(columns).T, compute_uv=False)[-1] if n * d >= len(load) else 0.0
    scaled = np.r_[load[:d], load[d:] / arm]
    return load, float(least * depth.min() / max(np.linalg.norm(scaled), 1e-300))


def _hair(rng: np.random.Generator, low: float = -14, high: float = -1) -> float:
    return float(10.0 ** rng.uniform(low, high))
