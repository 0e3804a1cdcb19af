"""Three fingers under a load, the long way round: programs over the edges of pyramids, and over exact cones.

Written from the definitions: a force in an inner pyramid is a sum of non-negative multiples of its m edges,
which lie on the cone. Nothing here knows of squeezes, facets or frames.
"""

from dataclasses import dataclass, replace
from math import atan, inf, pi, tan

import clarabel
import numpy as np
from scipy import sparse
from scipy.optimize import linprog

import regrasp as rg
from regrasp.closed_form.triple_program import Fingers


@dataclass(frozen=True)
class Case:
    """Three contacts and a load: points, normals (3, 3), mu, limits (3,), force, torque (3,)."""

    points: np.ndarray
    normals: np.ndarray
    mu: np.ndarray
    limits: np.ndarray
    force: np.ndarray
    torque: np.ndarray

    @property
    def fingers(self) -> Fingers:
        points, normals = (tuple(map(tuple, rows.tolist())) for rows in (self.points, self.normals))
        mu, limits = tuple(self.mu.tolist()), tuple(self.limits.tolist())
        return Fingers(points, normals, mu, limits, tuple((self.mu * (1 - 1e-9)).tolist()), limits)

    @property
    def load(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        return tuple(self.force.tolist()), tuple(self.torque.tolist())

    @property
    def grasp(self) -> rg.Grasp:
        each = zip(self.points, self.normals, self.mu, self.limits, strict=True)
        return rg.Grasp(
            rg.Contact(r, n, mu, max_force=None if limit == inf else limit) for r, n, mu, limit in each
        )

    @property
    def wrench(self) -> rg.Wrench:
        return rg.Wrench(self.force, self.torque)

    def with_friction(self, factor: float) -> "Case":
        return replace(self, mu=self.mu * factor)

    def moved(self, rotation: np.ndarray, length: float, force: float, order: list[int]) -> "Case":
        """In another frame, other units and another order of the contacts."""
        return Case(
            (length * self.points @ rotation.T)[order],
            (self.normals @ rotation.T)[order],
            self.mu[order],
            (force * self.limits)[order],
            force * rotation @ self.force,
            force * length * rotation @ self.torque,
        )


def random_case(seed: int, *, limited: bool = False) -> Case:
    """Contacts round an object that look roughly inwards, so that a fair part of them holds the load."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(3, 3)) * rng.uniform(0.2, 1, 3)
    normals = -points / np.linalg.norm(points, axis=1)[:, None] + 0.35 * rng.normal(size=(3, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    limits = rng.uniform(0.5, 4, 3) if limited else np.full(3, inf)
    torque = 0.2 * rng.normal(size=3) * (rng.random() < 0.5)
    return Case(points, normals, rng.uniform(0.2, 1.2, 3), limits, rng.normal(size=3), torque)


def first_edges(case: Case) -> np.ndarray:
    """(3, 3) towards the plane's normal, or towards the centroid where a contact looks along that normal."""
    a, b, c = case.points
    k = np.cross(b - a, c - a)
    k /= np.linalg.norm(k)
    edges = []
    for r, n in zip(case.points, case.normals, strict=True):
        towards = k if (n @ k) ** 2 <= 0.55 else r - case.points.mean(axis=0)
        towards = towards - (towards @ n) * n
        edges.append(towards / np.linalg.norm(towards))
    return np.array(edges)


def edges_of(case: Case, facets: int, narrowed: float = 0.0) -> np.ndarray:
    """(3, m, 3) edges of the inner pyramids of cones narrowed by an angle [rad], with normal part 1."""
    angles = 2 * pi * np.arange(facets) / facets
    result = []
    for n, e, mu in zip(case.normals, first_edges(case), case.mu, strict=True):
        around = np.outer(np.cos(angles), e) + np.outer(np.sin(angles), np.cross(n, e))
        result.append(n + tan(max(atan(mu) - narrowed, 0.0)) * around)
    return np.array(result)


def balance(case: Case, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Rows (6, 3m) and right-hand side of equilibrium for multiples of the edges, and the unit of these."""
    arms = np.repeat(case.points, edges.shape[1], axis=0)
    flat = edges.reshape(-1, 3)
    # One length for the torques, so that the solver's absolute tolerance means the same for both.
    size = abs(case.points - case.points.mean(axis=0)).max()
    centre = case.points.mean(axis=0)
    rows = np.vstack([flat.T, np.cross(arms - centre, flat).T / size])
    moment = case.torque - np.cross(centre, case.force)
    scale = max(abs(case.force).max(), abs(moment).max() / size)
    return rows, -np.r_[case.force, moment / size] / scale, scale


def caps(case: Case, facets: int, limits: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows (3, 3m) f_i.n_i <= limit_i cos(atan mu_i)."""
    rows = np.kron(np.eye(3), np.ones(facets))
    return rows, limits / np.sqrt(1 + case.mu**2)


def is_held(case: Case, facets: int, narrowed: float = 0.0, limits: np.ndarray | None = None) -> bool:
    """HiGHS' verdict over the inner pyramids."""
    rows, right, scale = balance(case, edges_of(case, facets, narrowed))
    above, most = caps(case, facets, case.limits if limits is None else limits)
    kept = most < inf
    found = linprog(
        np.zeros(rows.shape[1]), A_eq=rows, b_eq=right, A_ub=above[kept], b_ub=most[kept] / scale,
        method="highs", options={"primal_feasibility_tolerance": 1e-10},
    )  # fmt: skip
    assert found.status in (0, 2), found.message
    return bool(found.status == 0)


def least_peak(case: Case, facets: int) -> float:
    """HiGHS' least p with f_i.n_i <= p cos(atan mu_i)."""
    rows, right, scale = balance(case, edges_of(case, facets))
    above, share = caps(case, facets, np.ones(3))
    found = linprog(
        np.r_[np.zeros(rows.shape[1]), 1],
        A_eq=np.hstack([rows, np.zeros((6, 1))]), b_eq=right,
        A_ub=np.hstack([above, -share[:, None]]), b_ub=np.zeros(3), method="highs",
    )  # fmt: skip
    assert found.status == 0, found.message
    return float(found.fun) * scale


def widest_angle(case: Case, facets: int, peak_ratio: float) -> float:
    """The margin by bisection [rad]."""
    limits = case.limits
    if (limits == inf).any():
        limits = np.minimum(limits, peak_ratio * least_peak(case, facets) * (1 + 1e-9))
    lo, hi = 0.0, float(np.arctan(case.mu).min())
    while hi - lo > 1e-8:
        middle = 0.5 * (lo + hi)
        lo, hi = (middle, hi) if is_held(case, facets, middle, limits) else (lo, middle)
    return lo


def is_held_in_cones(case: Case) -> bool:
    """Clarabel's verdict over the exact cones."""
    rows, right, _ = balance(case, np.tile(np.eye(3), (3, 1, 1)))
    pushes = -np.kron(np.eye(3), np.ones((1, 3))) * case.normals.ravel()  # f.n >= 0, for mu = 0
    blocks, cones = [rows, pushes], [clarabel.ZeroConeT(6), clarabel.NonnegativeConeT(3)]
    for i in range(3):
        block = np.zeros((4, 9))
        block[0, 3 * i : 3 * i + 3] = case.mu[i] * case.normals[i]
        block[1:, 3 * i : 3 * i + 3] = np.eye(3) - np.outer(case.normals[i], case.normals[i])
        blocks.append(-block)
        cones.append(clarabel.SecondOrderConeT(4))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix((9, 9)), np.zeros(9), sparse.csc_matrix(np.vstack(blocks)),
        np.r_[right, np.zeros(15)], cones, settings,
    )  # fmt: skip
    status = str(solver.solve().status)
    assert status in ("Solved", "PrimalInfeasible", "AlmostSolved", "AlmostPrimalInfeasible"), status
    return "Solved" in status


def angle_margins(case: Case, forces: np.ndarray) -> np.ndarray:
    """(3,) atan mu less the angle of each force to its normal [rad]."""
    ahead = (forces * case.normals).sum(axis=1)
    aside = np.linalg.norm(np.cross(forces, case.normals), axis=1)
    return np.arctan(case.mu) - np.arctan2(aside, ahead)
