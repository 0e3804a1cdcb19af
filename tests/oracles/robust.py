"""Grasps that answer disturbances with stiffness, and what they withstand, written again from the
mathematics.

No name of regrasp but its values: responses by the object's displacement, cones by their definition, worst
members and largest factors by linear and conic programs.
"""

import cvxpy as cp
import numpy as np

import regrasp as rg

Array = np.ndarray


def grasp_matrix(grasp: rg.Grasp) -> Array:
    """Stacked forces to the wrench, a soft finger's torque last."""
    blocks = []
    for c in grasp:
        r, d = c.position, c.dimension
        if d == 2:
            blocks.append(np.vstack([np.eye(2), [[-r[1], r[0]]]]))
            continue
        cross = np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
        block = np.vstack([np.eye(3), cross])
        if grasp.is_soft:
            block = np.hstack([block, np.concatenate([np.zeros(3), c.normal])[:, None]])
        blocks.append(block)
    return np.hstack(blocks)


def random_stiffness(rng: np.random.Generator, n: int, soft: bool = False) -> list[list[float]] | None:
    """By contact and direction in half of the cases, alike in the others."""
    if rng.random() < 0.5 and not soft:
        return None
    rows = 10.0 ** rng.uniform(2, 4, (n, 2))
    return np.hstack([rows, rng.uniform(1, 30, (n, 1))]).tolist() if soft else rows.tolist()


def answers(grasp: rg.Grasp, stiffness: list[list[float]] | None, free: tuple[int, ...] = ()) -> Array:
    """Force changes per load, by solving for the displacement of the object that balances it."""
    matrix, w = grasp_matrix(grasp), grasp.width
    springs = np.zeros((len(grasp) * w, len(grasp) * w))
    for i, c in enumerate(grasp):
        if i in free:
            continue
        along, across = (1.0, 1.0) if stiffness is None else stiffness[i][:2]
        k = across * np.eye(c.dimension) + (along - across) * np.outer(c.normal, c.normal)
        springs[w * i : w * i + len(k), w * i : w * i + len(k)] = k
        if w == 4:
            springs[w * i + 3, w * i + 3] = 0.0 if c.torsion is None else stiffness[i][2]
    scale = np.ones(len(matrix))
    scale[grasp.dimension :] = 1 / (grasp.size or 1)
    resisted = (matrix * scale[:, None]) @ springs @ (matrix * scale[:, None]).T
    moves = np.linalg.solve(resisted, np.diag(scale))  # twist per load
    return -springs @ (matrix * scale[:, None]).T @ moves


def slack(contact: rg.Contact, force: Array, friction: float = 1.0) -> float:
    """How far a force is from leaving its cone, negative outside; without scaling."""
    d = contact.dimension
    along = float(force[:d] @ contact.normal)
    across = np.linalg.norm(force[:d] - along * contact.normal)
    if len(force) > d and contact.torsion is not None:
        across = np.hypot(across, contact.friction * force[d] / contact.torsion)
    room = friction * contact.friction * along - across
    return min(room, (contact.max_force or np.inf) - np.hypot(along, across))


def worst_slack(
    grasp: rg.Grasp, forces: Array, change: Array, members: Array, friction: float = 1.0
) -> float:
    """The least over members (m, q), of forces (n, w) that change by ``change`` (n w, q)."""
    after = forces.ravel() + members @ change.T
    shaped = after.reshape(len(members), len(grasp), -1)
    return min(slack(c, f, friction) for i, c in enumerate(grasp) for f in shaped[:, i])


def worst_of_ball(grasp: rg.Grasp, forces: Array, change: Array, axes: Array) -> float:
    """The same over d = A z, |z| <= 1, of point contacts without limits: the edge of a cone, minimised."""
    least = np.inf
    w = grasp.width
    for i, c in enumerate(grasp):
        answer = change[w * i : w * i + w] @ axes
        if w == 2:
            t = np.array([-c.normal[1], c.normal[0]])
            edges = [c.friction * c.normal + s * t for s in (1, -1)]
        else:
            t1 = np.linalg.svd(c.normal[None])[2][1:]
            turns = np.linspace(0, 2 * np.pi, 20_001)[:, None]
            edges = c.friction * c.normal - np.cos(turns) * t1[0] - np.sin(turns) * t1[1]
        edges = np.array(edges)
        least = min(least, float((edges @ forces[i] - np.linalg.norm(edges @ answer, axis=1)).min()))
    return least


def widest_by_cvxpy(
    grasp: rg.Grasp, load: rg.Wrench, change: Array, deviations: Array, limit: float
) -> float:
    """The largest s with forces f, |f + s R d| <= limit and in the cones for the deviations (m, q)."""
    n, d = len(grasp), grasp.dimension
    f, s = cp.Variable(n * d), cp.Variable()
    held = [grasp_matrix(grasp) @ f + load.vector == 0, s >= 0]
    for deviation in (0 * deviations[0], *deviations):
        after = f + s * (change @ deviation)
        for i, c in enumerate(grasp):
            g = after[d * i : d * i + d]
            along = c.normal @ g
            held += [cp.norm(g - along * c.normal) <= c.friction * along, cp.norm(g) <= limit]
    problem = cp.Problem(cp.Maximize(s), held)
    problem.solve(solver="CLARABEL")
    return float(s.value) if problem.status == "optimal" else -np.inf


def widest_of_ball_by_cvxpy(
    grasp: rg.Grasp, load: rg.Wrench, change: Array, axes: Array, limit: float
) -> float:
    """The same for d = A z, |z| <= 1, from above: edges at 720 angles, limits along some 2,000 directions."""
    n, d = len(grasp), grasp.dimension
    f, s = cp.Variable(n * d), cp.Variable()
    held = [grasp_matrix(grasp) @ f + load.vector == 0, s >= 0]
    directions = np.random.default_rng(0).normal(size=(2000, d))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    for i, c in enumerate(grasp):
        g, answer = f[d * i : d * i + d], change[d * i : d * i + d] @ axes
        if d == 2:
            across = np.array([-c.normal[1], c.normal[0]])[None] * np.array([[1.0], [-1.0]])
        else:
            t1 = np.linalg.svd(c.normal[None])[2][1:]
            turns = np.linspace(0, 2 * np.pi, 721)[:-1, None]
            across = np.cos(turns) * t1[0] + np.sin(turns) * t1[1]
        edges = c.friction * c.normal - across
        held += [edges @ g >= s * np.linalg.norm(edges @ answer, axis=1)]
        held += [directions @ g + s * np.linalg.norm(directions @ answer, axis=1) <= limit]
    problem = cp.Problem(cp.Maximize(s), held)
    problem.solve(solver="CLARABEL")
    return float(s.value)
