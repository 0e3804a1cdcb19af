"""Random grasps, states and plans that withstand something, for ``withstood.py``."""

from collections.abc import Iterator
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

import regrasp as rg
from withstood_judges import frame, measured

Array = NDArray[np.float64]


def random_grasp(rng: np.random.Generator, d: int = 0, n: int = 0) -> tuple[rg.Grasp, rg.Wrench]:
    """Two to four fingers that push roughly inwards, in the plane or in space (d), and a load."""
    plane = rng.random() < 0.6 if d == 0 else d == 2
    if d == 0:
        d, n = (2, int(rng.integers(2, 4))) if plane else (3, int(rng.integers(3, 5)))
    if plane:
        angles = rng.uniform(0, 2 * pi) + 2 * pi * (np.arange(n) + rng.uniform(-0.25, 0.25, n)) / n
        points = np.column_stack([np.cos(angles), np.sin(angles)])
    else:
        points = rng.normal(size=(n, 3))
        points /= np.linalg.norm(points, axis=1)[:, None]
    points *= rng.uniform(0.6, 1.4, n)[:, None]
    normals = -points + 0.3 * rng.normal(size=(n, d))
    soft = not plane and rng.random() < 0.3
    torsion = 0.1 if soft else None
    mu = rng.uniform(0.4, 1.0, n)
    grasp = rg.Grasp(
        rg.Contact(p, v, m, torsion=torsion) for p, v, m in zip(points, normals, mu, strict=True)
    )
    return grasp, rg.Wrench(rng.normal(size=d), 0.1 * rng.normal(size=1 if plane else 3))


def states(
    rng: np.random.Generator, count: int, d: int = 0, n: int = 0
) -> Iterator[tuple[rg.GraspState, Any]]:
    """States with room, some with force limits, and the stiffness of their fingers."""
    while count:
        grasp, load = random_grasp(rng, d, n)
        if d == 3 and grasp.is_soft:
            continue
        try:
            state: rg.GraspState = rg.choose_state(grasp, load, "force")
        except rg.Infeasible:
            continue
        if state.margins.least_force < 1e-3:
            continue
        if rng.random() < 0.4:
            limit = 1.3 * float(np.linalg.norm(measured(grasp, state.forces), axis=1).max())
            state = rg.GraspState(rg.Grasp(c.changed(max_force=limit) for c in grasp), load, state.forces)
        elif rng.random() < 0.3:
            state = rg.GraspState(with_rows(state, rng), load, state.forces)
        count -= 1
        yield state, random_stiffness(rng, grasp)


def with_rows(state: rg.GraspState, rng: np.random.Generator) -> rg.Grasp:
    """The grasp with linear limits that its forces keep, in the contacts' frames."""
    contacts = []
    for c, force in zip(state.grasp, state.forces, strict=True):
        local = frame(c) @ force[: c.dimension]
        rows = rng.normal(size=(2, c.dimension))
        bounds = np.maximum(rows @ local, 0.0) + rng.uniform(0.1, 0.5, 2) * float(np.linalg.norm(local))
        contacts.append(c.changed(limits=(rows, bounds)))
    return rg.Grasp(contacts)


def random_stiffness(rng: np.random.Generator, grasp: rg.Grasp) -> Any:
    """By contact and direction in half of the cases (and of soft fingers), alike in the others."""
    n = len(grasp)
    if rng.random() < 0.5 and not grasp.is_soft:
        return None
    rows = 10.0 ** rng.uniform(2, 4, (n, 2))
    return np.hstack([rows, rng.uniform(1, 30, (n, 1))]) if grasp.is_soft else rows


def plans(rng: np.random.Generator, count: int) -> Iterator[tuple[rg.Transition, rg.LoadSet]]:
    """Plans of every kind and the sets that they were planned to withstand."""
    kinds = ("removal", "addition", "hold", "rotation")
    while count:
        grasp, load = random_grasp(rng)
        if grasp.is_soft:
            continue
        d, size = grasp.dimension, float(np.linalg.norm(load.force))
        zero = 0.0 * load
        share, kind = 0.05 * size * rng.random(), kinds[count % len(kinds)]
        if rng.random() < 0.5:
            loads = rg.LoadSet.ball(zero, force=share, torque=0.3 * share)
        else:
            loads = rg.LoadSet.hull(
                [rg.Wrench.from_vector(share * v) for v in rng.normal(size=(6, 3 * d - 3))]
            )
        if kind in ("removal", "addition") and len(grasp) == d:
            continue
        options: dict[str, Any] = {"load": load, "disturbance": loads, "max_force": 20 * size}
        try:
            if kind == "removal":
                plan = rg.plan_removal(grasp, grasp.names[-1], **options)
            elif kind == "addition":
                plan = rg.plan_addition(grasp.without(grasp.names[-1]), grasp.contacts[-1], **options)
            elif kind == "hold":
                plan = rg.plan_hold(grasp, start_objective="effort", **options)
            elif not loads.contains(zero):
                continue
            else:
                turn = {"axis": rng.normal(size=3)} if d == 3 else {}
                plan = rg.plan_rotation(grasp, 0.5, **turn, **options)
        except rg.Infeasible:
            continue
        count -= 1
        yield plan, loads
