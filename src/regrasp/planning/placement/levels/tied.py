"""What fingers withstand wherever they are on their arcs: a conic program, whose duals bound it.

Fingers of equal stiffness answer a deviation by forces -(v + omega x p), one small motion (v, omega) for all.
That is: such changes do no work on any z with sum z_i = 0 and sum p_i x z_i = 0, of which all are made of
pairs, z_i = p_i - p_j = -z_j, and triples, z_i = S J (p_j - p_l) and so around, S symmetric, J a quarter of a
turn. These are linear in the places, so that what duals multiply a force by is affine in them, and the most
work convex while fingers stay on their edges: corners tell, of each edge. The proof stands in the
documentation, page "Where to put the fingers".
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from scipy import sparse

from regrasp.mechanics.checks import Array
from regrasp.programs import Block, Cone, Program, Status
from regrasp.programs.backends import asked

_ROUGH = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), 1e-7)  # any duals bound
_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


@dataclass(frozen=True)
class Withstood:
    """factor: what corners withstand together, but for what solvers are off by.

    No bound of a box that has these corners is less. duals: a twist for each load, then ties for each
    deviation. pressed: (C, k, L) how hard fingers push under each load at each corner.
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
        """What corners of a box withstand together, or a placement; None where no solver says.

        points: (C, k, 2) places at the corners. rays: (C, k, 2, 2) clockwise and other edge of all forces of
        each finger there, of length 1.
        """
        (corners, k, _), m = points.shape, len(self.deviations)
        forms, loads = self.forms, m + 1
        unknowns = np.arange(2 * corners * k * loads).reshape(corners, k, loads, 2)
        n = unknowns.size
        equal = np.zeros((3 * loads + m * len(forms) + 1, n + corners + 1))
        balance = equal[: 3 * loads, :n].reshape(loads, 3, *unknowns.shape)
        tied = equal[3 * loads : -1, :n].reshape(m, len(forms), *unknowns.shape)
        around = points[..., None, 0] * rays[..., 1] - points[..., None, 1] * rays[..., 0]
        ties = np.einsum("tiajb,cjb,cira->tcir", forms, points, rays)
        for d in range(loads):
            balance[d, :2, :, :, d] = rays.transpose(3, 0, 1, 2)
            balance[d, 2, :, :, d] = around
            if d:
                tied[d - 1, :, :, :, d], tied[d - 1, :, :, :, 0] = ties, -ties
        equal[3 : 3 * loads, -1] = self.deviations.ravel()
        equal[-1, n:-1] = 1.0  # shares of the corners, which limit forces there
        forces = np.arange(n // 2)
        disc = 3 * forces.reshape(corners, k, loads)
        edges = np.broadcast_to(rays[:, :, None], (corners, k, loads, 2, 2))
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
        return Withstood(float(found.value[-1]), duals, found.value[unknowns].sum(axis=3))

    def motions(self, duals: Array) -> tuple[Array, Array]:
        """(L, k, k, 2, 2) and (L, 2): finger i moves by still + sum_j move_ij p_j under each load."""
        k, m = self.fingers, len(self.deviations)
        twists, ties = duals[: 3 * m + 3].reshape(-1, 3), duals[3 * m + 3 :].reshape(m, -1)
        tied = np.einsum("mt,tiajb->mijab", ties, self.forms)
        move = np.concatenate([-tied.sum(axis=0, keepdims=True), tied])
        own = np.arange(k)
        move[:, own, own] += twists[:, 2, None, None, None] * _TURN
        return np.ascontiguousarray(move), twists[:, :2].copy()

    def worked(self, duals: Array) -> tuple[float, float]:
        """The work of the load on all twists, less than none, and of the deviations on theirs."""
        twists = duals[: 3 * len(self.deviations) + 3].reshape(-1, 3)
        return float(-(twists @ self.center).sum()), float(-(twists[1:] * self.deviations).sum())
