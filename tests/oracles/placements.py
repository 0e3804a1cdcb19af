"""Outlines and loads to choose grasps for, and the value of a grasp, by linear programs written once more."""

import numpy as np
from scipy.optimize import linprog

import regrasp as rg

BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
TILTED = rg.LoadSet.hull(
    [rg.Wrench([0, -1], 0.2), rg.Wrench([0, -1], -0.2), rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1])]
)
DEVIATIONS = rg.LoadSet.hull(
    [rg.Wrench([0, 0], 0.2), rg.Wrench([0, 0], -0.2), rg.Wrench([0.3, 0]), rg.Wrench([-0.3, 0])]
)


def star(seed: int, count: int) -> rg.Outline:
    rng = np.random.default_rng(seed)
    angles = (np.arange(count) + rng.uniform(0.1, 0.9, count)) * 2 * np.pi / count
    radii = rng.uniform(0.7, 1.3, count)
    return rg.Outline(np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1))


def least_normals(grasp: rg.Grasp, load: rg.Wrench, largest: bool) -> float:
    """Least sum, or largest, of normal forces, written once more for a solver of linear programs."""
    columns = []
    for contact in grasp:
        x, y = contact.position
        nx, ny = contact.normal
        for side in (-contact.friction, contact.friction):
            fx, fy = nx - side * ny, ny + side * nx
            columns.append([fx, fy, x * fy - y * fx])
    G, n = np.array(columns).T, len(columns)
    if not largest:
        found = linprog(np.ones(n), A_eq=G, b_eq=-load.vector, method="highs")
    else:
        rows = np.kron(np.eye(n // 2), [1.0, 1.0])
        found = linprog(
            np.append(np.zeros(n), 1.0),
            A_ub=np.column_stack([rows, -np.ones(n // 2)]),
            b_ub=np.zeros(n // 2),
            A_eq=np.column_stack([G, np.zeros(3)]),
            b_eq=-load.vector,
            method="highs",
        )
    return float(found.fun) if found.status == 0 else np.inf


def value_of(grasp: rg.Grasp, loads: np.ndarray, objective: str) -> float:
    worst = 0.0
    for vector in loads:
        load = rg.Wrench.from_vector(vector)
        if objective in ("sum_normal", "peak_normal"):
            worst = max(worst, least_normals(grasp, load, objective == "peak_normal"))
        else:
            try:
                worst = max(worst, rg.choose_state(grasp, load, objective).value)
            except rg.Infeasible:
                return np.inf
    return worst
