"""Holds under a load that rises to the edge of what least normal forces or linear limits let a grasp hold."""

from contextlib import suppress

import numpy as np
import pytest
from scipy.optimize import linprog

import regrasp as rg

pytestmark = pytest.mark.laws


def problem(seed: int, pressed: bool) -> tuple[rg.Grasp, np.ndarray, float]:
    """Four planar fingers around an object, a load, and the least normal force [N], 0 for none."""
    rng = np.random.default_rng(seed)
    angles = np.arange(4) * np.pi / 2 + rng.uniform(-0.4, 0.4, 4)
    points = np.column_stack([np.cos(angles), np.sin(angles)])
    limits = [[1, 0], [0, 1], [0, -1]], [rng.uniform(2, 4), 0.7, 0.7]
    fingers = [rg.Contact(p, -p, 0.5, limits=limits) for p in points]
    return rg.Grasp(fingers), rng.normal(size=3), 0.6 if pressed else 0.0


def edge(grasp: rg.Grasp, load: np.ndarray, least: float) -> float:
    """The largest factor of the load, by linear programming."""
    n = len(grasp)
    G, rows, bounds = np.zeros((3, 2 * n + 1)), [], []
    G[:, -1] = load
    for k, c in enumerate(grasp):
        at, along = slice(2 * k, 2 * k + 2), np.array([-c.normal[1], c.normal[0]])
        G[:2, at], G[2, at] = np.eye(2), [-c.position[1], c.position[0]]
        sides = [(along - 0.5 * c.normal, 0.0), (-along - 0.5 * c.normal, 0.0), (-c.normal, -least)]
        assert c.limits is not None
        sides += [
            (a[0] * c.normal + a[1] * along, b) for a, b in zip(c.limits.rows, c.limits.bounds, strict=True)
        ]
        for side, bound in sides:
            row = np.zeros(2 * n + 1)
            row[at] = side
            rows.append(row)
            bounds.append(bound)
    free = [(None, None)] * (2 * n) + [(0, None)]
    best = linprog(-np.eye(2 * n + 1)[-1], np.array(rows), bounds, G, np.zeros(3), free)
    return float(best.x[-1])


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("pressed", [False, True])
def test_a_hold_at_its_edge_is_planned_or_refused(seed: int, pressed: bool) -> None:
    """To 1e-6 inside planned, from 1e-6 outside refused; between either, and never a solver's failure."""
    grasp, load, least = problem(seed, pressed)
    top = edge(grasp, load, least)
    assert top > 0.1
    for off in (-1e-6, 0.0, 3e-9, 3e-8, 1e-6):

        def rising(t: float, most: float = top * (1 + off)) -> rg.Wrench:
            return rg.Wrench.from_vector(most * (0.3 + 2.8 * t * (1 - t)) * load)

        plan = None
        with suppress(rg.Infeasible):
            plan = rg.plan_hold(grasp, rising, objective="effort", min_normal=least or None, instants=5)
        assert off < 1e-6 if plan is not None else off > -1e-6
        assert plan is None or rg.verify(plan).ok
