"""Withstanding a set as rows beside those of any state program; in proportion to a factor, or as it is.

In the plane a cone has two edges g, and for any set g . f >= sigma(-R' g) says it all. In space polytopes by
their vertices v: f + R v in the cone. Round sets: f = a + b with b in the cone and a in the intersection of
the half-spaces h_k . a >= sigma(-R' h_k) of an outer pyramid h_k of the dual cone: since sigma is convex,
a + R d is in the cone for every d (an apex of it), and so is f + R d. That holds in proportion: of the widest
factor it reaches 0.99 or more (24 sides), where a pyramid in the place of the cone may lose all of it.

Limits: |f + R v| <= L by vertices; of a ball |f + R c| + |R A| <= L, sufficient. Linear ones like edges.
"""

from functools import lru_cache
from math import cos, inf, pi

import numpy as np
from scipy import sparse

from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.planning.states.withstanding.demand import Case, Demand
from regrasp.programs import Program, Rows

SIDES = 24
_SPHERE = 60
_NOTHING = 1e-12
"""Of a response: what of it a frictionless finger may make across its normal, for rounding."""
_SPARE = 1e-8
"""What programs ask for besides, in units, so that exact equilibrium moves no force outside."""


def with_rows(
    program: Program,
    demand: Demand,
    frictions: list[float],
    limits: list[float],
    unit: float,
    by_factor: bool,
) -> Program:
    """The program whose forces withstand the demand, as it is or by the factor that is its last unknown.

    frictions, limits: (n,), infinite for none; forces come in units of ``unit`` [N].
    """
    n, w = len(demand.grasp), demand.grasp.width
    apexes = w > 2 and demand.disturbance.half_axes is not None
    more = sum(len(case.contacts) for case in demand.cases) * w if apexes else 0
    total = program.q.size + more
    demands = _Demands(Rows(total), demand, np.array(frictions), np.array(limits), unit, total, by_factor)
    place = n * w
    for case in demand.cases:
        for i in case.contacts:
            demands.contact(case, i, place)
            place += w if apexes else 0
    if by_factor:
        demands.rows.at_least_zero(demands.last)
    added = demands.rows.program(np.zeros(total))
    at = n * w

    def wider(matrix: sparse.csc_matrix) -> sparse.csc_matrix:
        none = sparse.csc_matrix((matrix.shape[0], more))
        return sparse.hstack([matrix[:, :at], none, matrix[:, at:]], format="csc")

    return Program(
        sparse.csc_matrix(wider(wider(program.P).T.tocsc())),
        np.concatenate([program.q[:at], np.zeros(more), program.q[at:]]),
        sparse.vstack([wider(program.A), added.A], format="csc"),
        np.append(program.b, added.b),
        (*program.blocks, *added.blocks),
        size=program.size,
    )


class _Demands:
    """Adds the rows of contacts; a set times the factor is a column where another is a constant."""

    def __init__(
        self,
        rows: Rows,
        demand: Demand,
        frictions: Array,
        limits: Array,
        unit: float,
        total: int,
        by_factor: bool,
    ) -> None:
        self.rows, self.demand, self.by_factor = rows, demand, by_factor
        self.frictions, self.limits, self.unit, self.total = frictions, limits, unit, total
        self.last = np.zeros((1, total))
        self.last[0, -1] = 1.0
        self.set: LoadSet = demand.disturbance
        self.center = self.set.center.vector

    def contact(self, case: Case, i: int, place: int) -> None:
        """The cone and the limit of one contact; ``place``: of the columns of its apex."""
        cones = self.demand.grasp.cones
        n, w = len(self.demand.grasp), self.demand.grasp.width
        pick = np.zeros((w, self.total))  # T f, by rows
        pick[:, : n * w] = (
            np.eye(n * w)[w * i : w * i + w] if case.transform is None else case.transform[w * i : w * i + w]
        )
        answer, mu = case.responses[i] / self.unit, float(self.frictions[i])
        normal, tangents = cones.normals[i], cones.tangents[i]
        if w == 2 or mu == 0:
            edges = np.vstack([mu * normal - tangents, mu * normal + tangents])
            if mu == 0:
                moved = self.set.support(-edges @ answer) > _NOTHING * np.abs(answer).max()
                edges = np.vstack([normal, edges[moved]])
            self._faces(edges, pick, answer)
        elif self.set.half_axes is None:
            cone = np.vstack([mu * normal, tangents])
            for vertex in self._vertices():
                self._round(cone @ pick, cone @ answer @ vertex, cone @ answer @ self.center)
        else:
            apex = np.zeros((w, self.total))
            apex[:, place : place + w] = np.eye(w)
            self._faces(mu * normal - _outside(w) @ tangents, apex, answer)
            none = np.zeros(w)
            self._round(np.vstack([mu * normal, tangents]) @ (pick - apex), none, none)
        rows = self.demand.grasp.limit_rows
        if rows is not None and (rows.contacts == i).any():
            mine = rows.contacts == i
            self._faces(-rows.rows[mine], pick, answer, rows.bounds[mine] / self.unit)
        if self.limits[i] < inf:
            self._limit(self.limits[i] / self.unit, pick, answer)

    def _vertices(self) -> Array:
        found = self.set.cover
        assert found is not None
        return found

    def _faces(self, faces: Array, pick: Array, answer: Array, bounds: Array | float = 0.0) -> None:
        """Bounds + faces . f at least the most work of the set against them."""
        work = self.set.support(-faces @ answer)
        if self.by_factor:
            stays = -faces @ answer @ self.center
            self.rows.at_least_zero(faces @ pick - (work - stays)[:, None] * self.last, bounds - stays)
        else:
            self.rows.at_least_zero(faces @ pick, bounds - work - _SPARE * (1 + np.abs(work)))

    def _round(self, matrix: Array, change: Array, stays: Array) -> None:
        if self.by_factor:
            self.rows.second_order(matrix + (change - stays)[:, None] * self.last, stays)
        else:
            spare = np.zeros(len(change))
            spare[0] = _SPARE * (1 + np.abs(change).max())
            self.rows.second_order(matrix, change - spare)

    def _limit(self, limit: float, pick: Array, answer: Array) -> None:
        axes, matrix = self.set.half_axes, np.vstack([np.zeros((1, self.total)), pick])
        constant = np.append(limit, answer @ self.center)
        if axes is None:
            changes = [np.append(0, answer @ (vertex - self.center)) for vertex in self._vertices()]
        else:
            changes = [np.append(-np.linalg.norm(answer @ axes, 2), np.zeros(len(pick)))]
        constant[0] *= 1 if self.by_factor else 1 - _SPARE
        for change in changes:
            if self.by_factor:
                self.rows.second_order(matrix + change[:, None] * self.last, constant)
            else:
                self.rows.second_order(matrix, constant + change)


@lru_cache
def _outside(width: int) -> Array:
    """(k, w - 1) corners of a polytope around the unit circle or sphere of tangents."""
    if width == 3:
        angles = 2 * pi * np.arange(SIDES) / SIDES
        return read_only(np.column_stack([np.cos(angles), np.sin(angles)]) / cos(pi / SIDES))
    from scipy.spatial import ConvexHull

    z = 1 - (2 * np.arange(_SPHERE) + 1) / _SPHERE
    turn = pi * (3 - 5**0.5) * np.arange(_SPHERE)
    points = np.column_stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z])
    inside = float(-ConvexHull(points).equations[:, -1].max())
    return read_only(points / inside * (1 + 1e-12))
