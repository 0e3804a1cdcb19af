"""What fingers withstand wherever they are on their arcs: a conic program, whose duals bound it.

Fingers of equal stiffness answer a deviation by forces -(v + omega x p), one small motion (v, omega) for all.
That is: such changes do no work on any z with sum z_i = 0 and sum p_i x z_i = 0, of which all are made of
pairs, z_i = p_i - p_j = -z_j, and triples, z_i = S J (p_j - p_l) and so around, S symmetric, J a quarter of a
turn. These are linear in the places, so that what duals multiply a force by is affine in them, and the most
work convex: corners of a box tell. The proof stands in the documentation, page "Where to put the fingers".
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from math import inf

import numpy as np
from scipy import sparse

from regrasp.mechanics.checks import Array
from regrasp.programs import Block, Cone, Program, Status
from regrasp.programs.backends import asked

_SAFE = 1e-9
_ROUGH = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), 1e-7)  # any duals bound
_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


@dataclass(frozen=True)
class Withstood:
    """factor: no places withstand more. duals: a twist for each load, then ties for each deviation.

    pressed: (C, k, L) how hard fingers push under each load at each corner of the box.
    """

    factor: float
    duals: Array
    pressed: Array


@dataclass(frozen=True, eq=False)
class Ties:
    """Fingers under a load and deviations of it, whose forces of at most 1 are tied by equal stiffness.

    Args:
        fingers: k, how many.
        center: (3,) the load.
        deviations: (m, 3).
    """

    fingers: int
    center: Array
    deviations: Array

    @cached_property
    def forms(self) -> Array:
        """(T, k, 2, k, 2) by which places become forces in balance that change no motion."""
        k, found = self.fingers, []
        for i, j in combinations(range(k), 2):
            pair = np.zeros((k, k))
            pair[[i, j], [i, j]], pair[[i, j], [j, i]] = 1.0, -1.0
            found.append(np.einsum("ij,ab->iajb", pair, np.eye(2)))
        for few in combinations(range(k), 3):
            around = np.zeros((k, k))
            for i, j, other in (few, few[1:] + few[:1], few[2:] + few[:2]):
                around[i, j], around[i, other] = 1.0, -1.0
            for s in ([[1, 0], [0, 0]], [[0, 0], [0, 1]], [[0, 1], [1, 0]]):
                found.append(np.einsum("ij,ab->iajb", around, np.array(s) @ _TURN))
        return np.array(found)

    def answer(self, points: Array, rays: Array) -> Withstood | None:
        """The bound of a box of places, of a placement what it withstands; None where no solver has one.

        points: (C, k, 2) places at the corners of the box. rays: (k, 2, 2) clockwise and other edge of all
        forces of each finger, of length 1.
        """
        (corners, k, _), m = points.shape, len(self.deviations)
        forms, loads = self.forms, m + 1
        unknowns = np.arange(2 * corners * k * loads).reshape(corners, k, loads, 2)
        n = unknowns.size
        equal = np.zeros((3 * loads + m * len(forms) + 1, n + corners + 1))
        balance = equal[: 3 * loads, :n].reshape(loads, 3, *unknowns.shape)
        tied = equal[3 * loads : -1, :n].reshape(m, len(forms), *unknowns.shape)
        around = points[:, :, None, 0] * rays[:, :, 1] - points[:, :, None, 1] * rays[:, :, 0]
        ties = np.einsum("tiajb,cjb,ira->tcir", forms, points, rays)
        for d in range(loads):
            balance[d, :2, :, :, d] = rays.transpose(2, 0, 1)[:, None]
            balance[d, 2, :, :, d] = around
            if d:
                tied[d - 1, :, :, :, d], tied[d - 1, :, :, :, 0] = ties, -ties
        equal[3 : 3 * loads, -1] = self.deviations.ravel()
        equal[-1, n:-1] = 1.0  # shares of the corners, which limit forces there
        forces = np.arange(n // 2)
        disc = 3 * forces.reshape(corners, k, loads)
        edges = np.broadcast_to(rays[:, None], (corners, k, loads, 2, 2))
        row = [disc.ravel(), *((disc + 1 + t)[..., None].repeat(2, 3).ravel() for t in range(2))]
        column = [n + forces // (k * loads), unknowns.ravel(), unknowns.ravel()]
        value = [np.ones(n // 2), *(edges[..., t].ravel() for t in range(2))]
        inside = (-np.concatenate(value), (np.concatenate(row), np.concatenate(column)))
        A = sparse.vstack(
            [
                sparse.csc_matrix(equal),
                -sparse.eye(n + corners, n + corners + 1, format="csc"),
                sparse.csc_matrix(inside, shape=(3 * n // 2, n + corners + 1)),
            ],
            format="csc",
        )
        b = np.zeros(A.shape[0])
        b[: 3 * loads], b[len(equal) - 1] = np.tile(-self.center, loads), 1.0
        q = np.zeros(A.shape[1])
        q[-1] = -1.0
        blocks = (
            Block(Cone.ZERO, len(equal)), Block(Cone.NONNEGATIVE, n + corners),
            Block(Cone.SECOND_ORDER, 3, n // 2),
        )  # fmt: skip
        found = asked(Program(sparse.csc_matrix((len(q), len(q))), q, A, b, blocks), "clarabel", _ROUGH)
        if found.status not in (Status.SOLVED, Status.STOPPED):
            return None
        duals = -found.duals[: len(equal) - 1]
        return Withstood(self.factor(points, rays, duals), duals, found.value[unknowns].sum(axis=3))

    def factor(self, points: Array, rays: Array, duals: Array) -> float:
        """More than these places withstand no places of the box do, by duals of another program, too."""
        m = len(self.deviations)
        twists, ties = duals[: 3 * m + 3].reshape(-1, 3), duals[3 * m + 3 :].reshape(m, -1)
        p = points[:, :, None]
        along = np.stack([
            twists[:, 0] - twists[:, 2] * p[..., 1], twists[:, 1] + twists[:, 2] * p[..., 0]
        ], axis=-1)  # fmt: skip
        tied = np.einsum("mt,tiajb,cjb->cima", ties, self.forms, points)
        along[:, :, 1:] += tied
        along[:, :, 0] -= tied.sum(axis=2)
        most = _most(rays, along).sum(axis=(1, 2)).max()
        work, gained = float(-(twists @ self.center).sum()), float(-(twists[1:] * self.deviations).sum())
        if gained <= 0:
            return inf
        return float(most - work + _SAFE * (most + abs(work))) / gained


def _most(rays: Array, along: Array) -> Array:
    """(C, k, L) the most of a force of at most 1 between its rays along (C, k, L, 2)."""
    first, last = rays[:, None, 0], rays[:, None, 1]
    x, y = along[..., 0], along[..., 1]
    between = (first[..., 0] * y >= first[..., 1] * x) & (x * last[..., 1] >= y * last[..., 0])
    a, b = (along * first).sum(axis=-1), (along * last).sum(axis=-1)
    result: Array = np.where(between & (a + b > 0), np.hypot(x, y), np.maximum(np.maximum(a, b), 0.0))
    return result
