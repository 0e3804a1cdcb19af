"""Grasps in space for tests, and the choice of a state written again for cvxpy from the mathematics."""

from math import cos, pi

import cvxpy as cp
import numpy as np

import regrasp as rg


def nose_cone(count: int, friction: float) -> rg.Grasp:
    """The grasp of Lobo et al. 1998 (tests/golden.json)."""
    contacts = []
    for j in range(1, count + 1):
        x, y = 0.3 + np.cos(2 * pi * j / count), np.sin(2 * pi * j / count)
        contacts.append(rg.Contact([x, y, x * x + y * y], normal=[-2 * x, -2 * y, 1], friction=friction))
    return rg.Grasp(contacts)


def random_grasp(rng: np.random.Generator, count: int, friction: float | None = None) -> rg.Grasp:
    """Fingers on a dented sphere, which push roughly inwards."""
    points = rng.normal(size=(count, 3))
    points *= rng.uniform(0.6, 1.4, count)[:, None] / np.linalg.norm(points, axis=1)[:, None]
    normals = -points + 0.4 * rng.normal(size=(count, 3))
    mu = rng.uniform(0.2, 0.9, count) if friction is None else np.full(count, friction)
    return rg.Grasp(rg.Contact(p, n, m) for p, n, m in zip(points, normals, mu, strict=True))


def random_load(rng: np.random.Generator) -> rg.Wrench:
    """A force and a small torque."""
    return rg.Wrench(rng.normal(size=3), 0.1 * rng.normal(size=3))


def rotated(grasp: rg.Grasp, matrix: np.ndarray, length: float = 1.0) -> rg.Grasp:
    """The same grasp seen in another frame and unit of length."""
    return rg.Grasp(
        rg.Contact(length * (matrix @ c.position), matrix @ c.normal, c.friction, name=c.name) for c in grasp
    )


def random_rotation(rng: np.random.Generator) -> np.ndarray:
    """A rotation matrix."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def best_by_cvxpy(
    grasp: rg.Grasp, load: rg.Wrench, objective: str, facets: int | None = None, *, outer: bool = False
) -> float:
    """The best value with exact cones, or with pyramids whose first vertex lies along n x e_z."""
    f = cp.Variable((len(grasp), 3))
    total = sum(f[i] for i in range(len(grasp)))
    torques = sum(_cross(c.position) @ f[i] for i, c in enumerate(grasp))
    held = [total + load.force == 0, torques + load.torque == 0]
    normals, margins = [], []
    for i, c in enumerate(grasp):
        along = c.normal @ f[i]
        across = f[i] - along * c.normal
        normals.append(along)
        if facets is None:
            held.append(cp.norm(across) <= c.friction * along)
        else:
            t1 = np.cross(c.normal, [0, 0, 1.0])
            t1 /= np.linalg.norm(t1)
            t2 = np.cross(c.normal, t1)
            inner = c.friction * (1 if outer else cos(pi / facets))
            for k in range(facets):
                a = 2 * pi * (k + 0.5) / facets
                held.append((np.cos(a) * t1 + np.sin(a) * t2) @ f[i] <= inner * along)
        margins.append((c.friction * along - cp.norm(across)) / np.sqrt(1 + c.friction**2))
    goal = {
        "effort": cp.sum_squares(f),
        "peak": cp.max(cp.norm(f, axis=1)),
        "peak_normal": cp.maximum(*normals),
        "force": -cp.minimum(*margins),
    }[objective]
    if objective == "force":
        peak = best_by_cvxpy(grasp, load, "peak", facets)
        held.append(cp.norm(f, axis=1) <= 3.0 * peak)
    problem = cp.Problem(cp.Minimize(goal), held)
    problem.solve(solver=cp.CLARABEL)
    if problem.status not in ("optimal", "infeasible"):
        raise RuntimeError(problem.status)
    value = float(problem.value)
    return -value if objective == "force" else value


def _cross(r: np.ndarray) -> np.ndarray:
    x, y, z = r
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def soft_random(rng, count):
    points = rng.normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    kinds = [None if rng.random() < 0.4 else float(rng.uniform(0.02, 0.3)) for _ in range(count)]
    kinds[0] = 0.1
    return rg.Grasp(
        rg.Contact(p, -p + 0.3 * rng.normal(size=3), float(rng.uniform(0.3, 0.8)), torsion=e)
        for p, e in zip(points, kinds, strict=True)
    )
