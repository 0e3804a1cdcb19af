"""Judges of what is withstood, for ``withstood.py``: displacements, cones, programs from the mathematics."""

from collections import Counter
from math import cos, inf, pi, sin
from typing import Any

import clarabel
import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.optimize import linprog, minimize

import regrasp as rg

Array = NDArray[np.float64]
LESS, MORE = 0.999, 1.001
_FINE = {"xatol": 1e-12, "fatol": 1e-15, "maxiter": 2000}


def frame(c: rg.Contact) -> Array:
    """Normal and tangents: turned left in the plane, n x z and n x (n x z) in space."""
    n = c.normal
    if c.dimension == 2:
        return np.array([n, [-n[1], n[0]]])
    first = np.cross(n, [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first)
    return np.array([n, first, np.cross(n, first)])


def grasp_matrix(grasp: rg.Grasp) -> Array:
    """Stacked forces to the wrench, a soft finger's torque last."""
    blocks = []
    for c in grasp:
        r = c.position
        if c.dimension == 2:
            blocks.append(np.vstack([np.eye(2), [[-r[1], r[0]]]]))
            continue
        cross = np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
        about = [np.concatenate([np.zeros(3), c.normal])[:, None]] if grasp.is_soft else []
        blocks.append(np.hstack([np.vstack([np.eye(3), cross]), *about]))
    return np.hstack(blocks)


def answers(grasp: rg.Grasp, stiffness: Any, free: tuple[int, ...] = ()) -> Array:
    """(n w, q) changes of forces per load, by the displacement of the object that balances it."""
    matrix, w = grasp_matrix(grasp), grasp.width
    springs = np.zeros((matrix.shape[1], matrix.shape[1]))
    for i, c in enumerate(grasp):
        if i in free:
            continue
        along, across = (1.0, 1.0) if stiffness is None else stiffness[i][:2]
        here = slice(w * i, w * i + c.dimension)
        springs[here, here] = across * np.eye(c.dimension) + (along - across) * np.outer(c.normal, c.normal)
        if w == 4:
            springs[w * i + 3, w * i + 3] = stiffness[i][2]
    moves = np.linalg.solve(matrix @ springs @ matrix.T, np.eye(len(matrix)))
    return -springs @ matrix.T @ moves


def measured(grasp: rg.Grasp, forces: Array) -> Array:
    """(..., n, w) forces, a soft finger's torque as the tangential force that uses as much friction."""
    result = np.array(forces)
    if grasp.is_soft:
        result[..., 3] *= grasp.frictions / np.array([c.torsion for c in grasp])
    return result


def slack(grasp: rg.Grasp, forces: Array, friction: float = 1.0) -> float:
    """The least of all (..., n, w) forces to the edges of cones and to limits; negative outside."""
    f, d = measured(grasp, forces), grasp.dimension
    normal = np.einsum("...nd,nd->...n", f[..., :d], grasp.normals)
    across = f.copy()
    across[..., :d] -= normal[..., None] * grasp.normals
    limits = np.array([inf if c.max_force is None else c.max_force for c in grasp])
    room = friction * grasp.frictions * normal - np.linalg.norm(across, axis=-1)
    least = float(np.minimum(room, limits - np.linalg.norm(f, axis=-1)).min())
    for i, c in enumerate(grasp):
        if c.limits is not None:
            used = np.asarray(forces)[..., i, :d] @ (c.limits.rows @ frame(c)).T
            least = min(least, float((c.limits.bounds - used).min()))
    return least


def judge_tolerances(state: rg.GraspState, stiffness: Any, counts: Counter[str]) -> None:
    """A thousandth less and a thousandth more of each tolerance."""
    grasp, load, change = state.grasp, state.load, answers(state.grasp, stiffness)
    found = rg.tolerances(state, stiffness=stiffness).withstood
    counts["states within linear limits"] += grasp.contacts[0].limits is not None
    d, q, size = grasp.dimension, load.vector.size, float(np.linalg.norm(load.force))
    counts[
        "states, stiffness by contact and direction" if stiffness is not None else "states, all alike"
    ] += 1
    counts[f"states in {'the plane' if d == 2 else 'space'}"] += 1

    def least(members: Array, friction: float = 1.0) -> float:
        return slack(
            grasp, (state.forces.ravel() + members @ change.T).reshape(-1, *state.forces.shape), friction
        )

    def judged(what: str, inside: float, outside: float) -> None:
        counts[f"{what}: {'as said' if inside >= 0 > outside else 'WRONG'}"] += 1

    still = np.zeros((1, q))
    judged("friction", least(still, MORE * found.friction), least(still, LESS * found.friction))
    if found.load < inf:
        judged("load", *(least(k * (found.load - 1) * load.vector[None]) for k in (LESS, MORE)))
    ways = around(load.force / size)
    if found.tilt < pi:

        def tilted(share: float, ways: Array = ways) -> float:
            a = share * found.tilt
            turned = cos(a) * load.force + sin(a) * size * ways
            return least(np.pad(turned - load.force, ((0, 0), (0, q - d))))

        outside = tilted(MORE)
        if outside >= 0 and d == 3:  # a force may leave its cone and come back within less than a thousandth
            basis = np.linalg.svd(load.force[None])[2][1:]

            def worst(at: Array) -> float:
                way = cos(at[1]) * basis[0] + sin(at[1]) * basis[1]
                return tilted(min(at[0], MORE), way[None])

            starts = [(share, turn) for share in (0.9999, 1.0) for turn in np.linspace(0, 2 * pi, 25)]
            outside = min(minimize(worst, at, method="Nelder-Mead", options=_FINE).fun for at in starts)
        judged("tilt", min(map(tilted, (0.3, 0.6, 0.8, 0.9, LESS))), outside)
    if found.centre < inf:
        flat = np.pad(ways, ((0, 0), (0, 3 - d)))
        moments = np.cross(flat, np.pad(load.force, (0, 3 - d)))
        moments = np.pad(moments[:, 2:] if d == 2 else moments, ((0, 0), (d, 0)))
        judged("centre", *(least(k * found.centre * moments) for k in (LESS, MORE)))
    for i, length in enumerate(found.position.tolist()):
        if length < inf:
            judged("position", *(off(state, stiffness, i, k * length) for k in (LESS, MORE)))


def off(state: rg.GraspState, stiffness: Any, i: int, length: float) -> float:
    """The least slack when one contact is off along its tangents, either way, in space eight ways."""
    grasp, f = state.grasp, state.forces
    axes = frame(grasp.contacts[i])[1:]
    ways = [1.0, -1.0] if len(axes) == 1 else [[cos(k * pi / 4), sin(k * pi / 4)] for k in range(8)]
    least = inf
    for way in ways:
        contacts = list(grasp)
        step = length * np.ravel(way) @ axes
        c = contacts[i]
        kept = {"max_force": c.max_force, "torsion": c.torsion, "limits": c.limits, "name": c.name}
        contacts[i] = rg.Contact(c.position + step, c.normal, c.friction, **kept)
        moved = rg.Grasp(contacts)
        error = (grasp_matrix(moved) - grasp_matrix(grasp)) @ f.ravel()
        least = min(least, slack(moved, f + (answers(moved, stiffness) @ error).reshape(f.shape)))
    return least


def around(unit: Array) -> Array:
    """Unit vectors across one: both in the plane, many in space."""
    if unit.size == 2:
        return np.array([[-unit[1], unit[0]], [unit[1], -unit[0]]])
    basis = np.linalg.svd(unit[None])[2][1:]
    angles = np.linspace(0, 2 * pi, 1441)[:, None]
    result: Array = np.cos(angles) * basis[0] + np.sin(angles) * basis[1]
    return result


def judge_laws(grasp: rg.Grasp, counts: Counter[str]) -> None:
    """Ferrari and Canny's radii against one another and the least weight."""
    one, each = (rg.wrench_ball(grasp, limit=1.0, norm=norm, length=1.0).radius for norm in ("L1", "Linf"))
    sound = one <= each * (1 + 1e-9) and each <= len(grasp) * one * (1 + 1e-9)
    counts[f"eps_1 <= eps_inf <= n eps_1: {'holds' if sound else 'BROKEN'}"] += 1
    sides = grasp.frictions[:, None] * np.stack([-grasp.normals[:, 1], grasp.normals[:, 0]], axis=1)
    edges = np.concatenate([grasp.normals + sides, grasp.normals - sides])
    arms = np.concatenate([grasp.positions, grasp.positions])
    w = np.vstack([edges.T, arms[:, 0] * edges[:, 1] - arms[:, 1] * edges[:, 0]])
    m, k = w.shape
    answer = linprog(
        [0] * k + [-1],
        A_eq=np.block([[w, np.zeros((m, 1))], [np.ones(k), 0]]),
        b_eq=[0] * m + [1],
        A_ub=np.c_[-np.eye(k), np.ones(k)],
        b_ub=np.zeros(k),
        bounds=[(None, None)] * (k + 1),
    )
    if answer.status == 0 and -answer.fun > 1e-6:
        bound = -answer.fun * np.linalg.svd(w - w.mean(axis=1, keepdims=True))[1][-1]
        counts[f"eps_L1 >= l sigma_min: {'holds' if one >= bound * (1 - 1e-9) else 'BROKEN'}"] += 1


def judge_growth(problem: tuple[rg.Grasp, rg.Wrench], counts: Counter[str]) -> None:
    """Tolerances shrink as the set grows that is withstood besides."""
    grasp, load = problem
    small = rg.LoadSet.ball(0.0 * load, force=0.02, torque=0.01)
    try:
        state = rg.choose_state(grasp, load, "force", disturbance=small)
    except rg.Infeasible:
        return
    wide, narrow = (rg.tolerances(state, disturbance=loads).withstood for loads in (None, small.scaled(0.9)))
    pairs = [(getattr(wide, key), getattr(narrow, key)) for key in ("load", "tilt", "centre")]
    shrinks = all(a >= b * (1 - 1e-9) for a, b in pairs) and wide.friction <= narrow.friction * (1 + 1e-9)
    shrinks &= bool((wide.position >= narrow.position * (1 - 1e-9) - 1e-9).all())
    counts[f"tolerances shrink as sets grow: {'holds' if shrinks else 'BROKEN'}"] += 1


def judge_largest(state: rg.GraspState, counts: Counter[str]) -> None:
    """The largest factor of the load under a force limit: of normal forces, by a program of our own."""
    if state.grasp.is_soft or state.grasp.contacts[0].limits is not None:
        return
    limit = 4.0 * float(np.linalg.norm(state.load.vector))
    grasp = rg.Grasp(c.changed(max_force=limit) for c in state.grasp)
    most = rg.largest_load(grasp, state.load)
    held = [is_held(grasp, k * most.factor * state.load.vector, limit) for k in (LESS, MORE)]
    where = "plane, linear program" if grasp.dimension == 2 else "space, conic program"
    counts[f"largest load, {where}: {'as said' if held == [True, False] else 'WRONG'}"] += 1


def is_held(grasp: rg.Grasp, load: Array, limit: float) -> bool:
    """Whether forces within cones and limits balance a load, by the depth to which some do."""
    n, d = grasp.positions.shape
    matrix = np.hstack([grasp_matrix(grasp), np.zeros((len(load), 1))])
    if d == 2:  # the disc of the limit by 720 sides from inside, and the edges of the cones, all by a depth
        angles = 2 * pi * (np.arange(720) + 0.5) / 720
        sides = np.column_stack([np.cos(angles), np.sin(angles)])
        rows, bounds = [], []
        for i, c in enumerate(grasp):
            t = np.array([-c.normal[1], c.normal[0]])
            edges = np.array([t - c.friction * c.normal, -t - c.friction * c.normal])
            block = np.zeros((722, 2 * n + 1))
            block[:, 2 * i : 2 * i + 2], block[:, -1] = np.vstack([edges, sides]), 1.0
            rows.append(block)
            bounds.append(np.r_[0.0, 0.0, np.full(720, limit * cos(pi / 1440))])
        goal = np.r_[np.zeros(2 * n), -1.0]
        free = [(None, None)] * (2 * n + 1)
        answer = linprog(goal, np.vstack(rows), np.concatenate(bounds), matrix, -load, free, method="highs")
        return answer.status == 0 and answer.x[-1] >= 0
    # maximise t: (mu n . f - t, f across n) and (limit - t, f) in second-order cones
    blocks, right = [matrix], [-load]
    for i, c in enumerate(grasp):
        basis = np.linalg.svd(c.normal[None])[2][1:]
        cone = np.zeros((3, 3 * n + 1))
        cone[:, 3 * i : 3 * i + 3], cone[0, -1] = -np.vstack([c.friction * c.normal, basis]), 1.0
        ball = np.zeros((4, 3 * n + 1))
        ball[1:, 3 * i : 3 * i + 3], ball[0, -1] = -np.eye(3), 1.0
        blocks += [cone, ball]
        right += [np.zeros(3), np.r_[limit, 0.0, 0.0, 0.0]]
    cones = [clarabel.ZeroConeT(len(load))]
    cones += [clarabel.SecondOrderConeT(k) for _ in range(n) for k in (3, 4)]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    nothing = sparse.csc_matrix((3 * n + 1, 3 * n + 1))
    goal = np.r_[np.zeros(3 * n), -1.0]
    solver = clarabel.DefaultSolver(
        nothing, goal, sparse.csc_matrix(np.vstack(blocks)), np.concatenate(right), cones, settings
    )
    answer = solver.solve()
    return str(answer.status) in ("Solved", "AlmostSolved") and answer.x[-1] >= 0


def judge_members(
    plan: rg.Transition, loads: rg.LoadSet, rng: np.random.Generator, count: int, counts: Counter[str]
) -> None:
    """Random members at random instants, by the springs of the fingers that stay."""
    grasp = plan.grasp
    free = tuple(grasp.index(name) for name in (*plan.leaving, *plan.arriving))
    change = answers(grasp, None, free)
    ways = rng.normal(size=(count, change.shape[1]))
    ways[:, grasp.dimension :] *= rng.choice([0.1, 1.0, 10.0], size=(count, 1))
    worst = np.array([loads.extreme(u).vector for u in ways])
    members = loads.center.vector + rng.random((count, 1)) ** 0.2 * (worst - loads.center.vector)
    members[: count // 2] = worst[: count // 2]
    forces = plan.forces(rng.random(count) * plan.duration)
    after = forces + (members @ change.T).reshape(forces.shape)
    outside = sum(slack(grasp, f) < -1e-12 * float(np.abs(f).max()) for f in after)
    counts[f"plans: {plan.kind}"] += 1
    counts["members inside"] += count - outside
    counts["members OUTSIDE"] += outside
