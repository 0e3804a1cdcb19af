"""Withstanding a set as rows beside those of any state program; in proportion to a factor, or as it is.

In the plane a cone has two edges g, and for any set g . f >= sigma(-R' g) says it all. In space polytopes by
their vertices v: f + R v in the cone. Round sets: f = a + b with b in the cone and a in the intersection of
the half-spaces h_k . a >= sigma(-R' h_k) of an outer pyramid h_k of the dual cone: since sigma is convex,
a + R d is in the cone for every d (an apex of it), and so is f + R d. That
holds in proportion, where a pyramid in the place of the cone may lose all of a factor.

Limits: |f + R v| <= L by vertices. Of a ball (L, f) is in a cone, too, and so the same way: (L, f) = (s, a) +
b with b in that cone and s - u_k . a >= sigma(R' u_k). Of soft fingers |f + R c| + |R A| <= L: sufficient.
Corners h_k and u_k that matter are cut off (``cutting``): 0.99 or more of the widest factor.
"""

from math import inf

import numpy as np
from scipy import sparse

from regrasp.mechanics.checks import Array
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.planning.states.withstanding.apexes import CONE, LIMIT, Apexes, Key
from regrasp.planning.states.withstanding.demand import Demand
from regrasp.programs import Program, Rows

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
    apexes: Apexes | None = None,
    inside: bool = True,
) -> Program:
    """The program whose forces withstand the demand, as it is or by the factor that is its last unknown.

    frictions, limits: (n,), infinite for none; forces come in units of ``unit`` [N]. apexes: the polytopes of
    round sets, those to begin with if not given. inside: whether forces are safe; otherwise polytopes inside
    round sets ask for less than these do, and the factor is a bound.
    """
    n, w = len(demand.grasp), demand.grasp.width
    is_round = inside and demand.disturbance.half_axes is not None
    widths = [w * (w > 2) + (w + 1) * (w < 4 and limit < inf) if is_round else 0 for limit in limits]
    more = sum(widths[i] for case in demand.cases for i in case.contacts)
    total = program.q.size + more
    apexes = Apexes() if apexes is None else apexes
    apexes.forget()
    numbers = np.array(frictions), np.array(limits), unit, total, by_factor
    demands = _Demands(Rows(total), demand, *numbers, apexes, program.b.size, inside)
    place = n * w
    for k, case in enumerate(demand.cases):
        for i in case.contacts:
            demands.contact(k, i, place)
            place += widths[i]
    if by_factor:
        demands.rows.at_least_zero(demands.last)
    added = demands.rows.program(np.zeros(total))
    at = n * w
    P = _wider(program.P, at, more, more)
    P.indices[P.indices >= at] += more
    return Program(
        P,
        np.concatenate([program.q[:at], np.zeros(more), program.q[at:]]),
        sparse.vstack([_wider(program.A, at, more, 0), added.A], format="csc"),
        np.append(program.b, added.b),
        (*program.blocks, *added.blocks),
        size=program.size,
    )


def _wider(matrix: sparse.csc_matrix, at: int, columns: int, rows: int) -> sparse.csc_matrix:
    """The matrix with empty columns before column ``at``, and with room for more rows."""
    starts = np.concatenate([matrix.indptr[:at], np.repeat(matrix.indptr[at], columns), matrix.indptr[at:]])
    m, n = matrix.shape
    return sparse.csc_matrix((matrix.data, matrix.indices.copy(), starts), (m + rows, n + columns))


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
        apexes: Apexes,
        first_row: int,
        inside: bool,
    ) -> None:
        self.apexes, self.first_row, self.inside = apexes, first_row, inside
        self.rows, self.demand, self.by_factor = rows, demand, by_factor
        self.frictions, self.limits, self.unit, self.total = frictions, limits, unit, total
        self.last = np.zeros((1, total))
        self.last[0, -1] = 1.0
        self.set: LoadSet = demand.disturbance
        self.center = self.set.center.vector

    def contact(self, k: int, i: int, place: int) -> None:
        """The cone and the limit of one contact in a case; ``place``: of the columns of its apexes."""
        case, cones = self.demand.cases[k], self.demand.grasp.cones
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
        elif self.inside:
            apex = np.zeros((w, self.total))
            apex[:, place : place + w] = np.eye(w)
            self._faces(mu * normal - self._corners((k, i, CONE), w - 1) @ tangents, apex, answer)
            none = np.zeros(w)
            self._round(np.vstack([mu * normal, tangents]) @ (pick - apex), none, none)
        else:
            self._faces(mu * normal - self.apexes.points((k, i, CONE), w - 1) @ tangents, pick, answer)
        rows = self.demand.grasp.limit_rows
        if rows is not None and (rows.contacts == i).any():
            mine = rows.contacts == i
            self._faces(-rows.rows[mine], pick, answer, rows.bounds[mine] / self.unit)
        if self.limits[i] < inf:
            limit = self.limits[i] / self.unit
            if self.set.half_axes is None or (w > 3 and self.inside):
                self._limit(limit, pick, answer)
            elif self.inside:
                self._round_limit(limit, pick, answer, (k, i, LIMIT), place + w * (w > 2))
            else:
                self._faces(-self.apexes.points((k, i, LIMIT), w), pick, answer, limit)

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

    def _corners(self, key: Key, size: int) -> Array:
        return self.apexes.corners(key, size, self.first_row + len(self.rows))

    def _round_limit(self, limit: float, pick: Array, answer: Array, key: Key, place: int) -> None:
        """Faces around an apex (s, a), and (L - s, f - a) in the cone of second order."""
        size = len(pick)
        apex = np.zeros((size + 1, self.total))
        apex[:, place : place + size + 1] = np.eye(size + 1)
        corners = self._corners(key, size)
        faces = np.hstack([np.ones((len(corners), 1)), -corners])
        self._faces(faces, apex, np.vstack([np.zeros(answer.shape[1]), answer]))
        force = np.vstack([np.zeros(self.total), pick])
        kept = limit if self.by_factor else (1 - _SPARE) * limit
        self.rows.second_order(force - apex, np.append(kept, np.zeros(size)))

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
