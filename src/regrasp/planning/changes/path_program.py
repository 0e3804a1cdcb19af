"""Forces over time as one convex program, for what a straight path cannot do.

Instants t_0 < ... < t_K; the forces at both ends are given and those between are the unknowns. Forces and
load are linear in time between instants, and so is equilibrium; the cones are convex. So what holds at the
instants holds between them.

    equilibrium   G f_k = -w_k                                     zero cone
    friction      mu n.f_k,i - |f_t| >= margin sqrt(1 + mu^2)      non-negative; second order in space
    least normal  n.f_k,i >= least_i                               non-negative
    limits        |f_k,i| <= limit_i                               second order
    linear ones   a . f_k,i <= b                                   non-negative
    rates         |f_k+1,i - f_k,i| <= rate_i (t_k+1 - t_k)        second order

    change        minimise sum_k |f_k+1 - f_k|^2 / (s_k+1 - s_k)     s: the phase, from 0 to 1
    effort        minimise sum_k |f_k|^2 h_k                         h: the share of time of an instant
    force         maximise the least margin, that of the ends included
    peak          minimise t,  |f_k,i| <= t
    rate          minimise t,  |f_k+1,i - f_k,i| <= t rate_i (t_k+1 - t_k)

With a constant load and no limits the least change is f_k = f_0 + (f_K - f_0) s_k: Eq. 1-3 with T = 1 - s.
"""

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.planning.states.faces import cone_faces, round_faces
from regrasp.programs import Program, Rows

OBJECTIVES = ("change", "effort", "force", "peak", "rate")


@dataclass(frozen=True, eq=False)
class PathTask:
    """What a path must keep to.

    times: (K,) [s]. loads: (K, 3 or 6) [N, N m]. start, end: (n, w) forces at the ends, as the cones measure
    them [N]. active: (K, n),
    false where a finger carries no force. phases: (K,) rising from 0 to 1. frictions, limits [N], rates
    [N/s] and least_normals [N]: (n,), infinite or 0 for none. stays: (n,), the fingers whose margin counts.
    unit: the size of a force [N]. set_back: in the plane (n, 2), what the edges mu n -+ t of the cones of
    fingers keep for a disturbance, g . f at least so much [N]; None for nothing. row_bounds: (m,) of the
    contacts' linear limits [N]; None for none.
    """

    grasp: Grasp
    times: Array
    loads: Array
    start: Array
    end: Array
    active: NDArray[np.bool_]
    phases: Array
    frictions: Array
    limits: Array
    rates: Array
    least_normals: Array
    stays: NDArray[np.bool_]
    unit: float
    set_back: Array | None = None
    row_bounds: Array | None = None

    @property
    def end_margin(self) -> float:
        """The least force margin of the fingers that stay, at both ends [N]."""
        grasp, mu = self.grasp, self.frictions
        ends = np.stack([self.start, self.end])
        normal = grasp.cones.normal(ends)
        margins = (mu * normal - grasp.cones.tangential(ends)) / np.sqrt(1 + mu**2)
        return float(margins[:, self.stays].min())

    @property
    def reference(self) -> Array:
        """(K, n, w) the straight path by the phases, zero where a finger carries no force [N]."""
        s = self.phases[:, None, None]
        straight: Array = self.start * (1 - s) + self.end * s
        return np.where(self.active[..., None], straight, 0.0)


def path_program(
    task: PathTask, objective: str, *, least_margin: float = 0.0, facets: int | None = None
) -> Program:
    """The program of one of ``OBJECTIVES``; unknowns are the forces of active fingers between the ends.

    They come instant by instant, less those of ``task.reference`` and in units of ``task.unit``, then t for
    ``force``, ``peak`` and ``rate``. Counted from the reference, they are zero where nothing bends the path.
    least_margin: [N], of the fingers that stay. facets: of the faces that stand for circles, balls and cones
    in space from inside (``regrasp.planning.states.faces``), or None for second-order cones.
    """
    if objective not in OBJECTIVES:
        raise InvalidInput(
            f"objective of a path must be one of {', '.join(OBJECTIVES)}; got {shown(objective)}"
        )
    return _Builder(task, objective, facets).program(least_margin)


class _Builder:
    """Blocks of one instant, repeated along the path."""

    def __init__(self, task: PathTask, objective: str, facets: int | None) -> None:
        self.task, self.objective, self.facets = task, objective, facets
        self.d = task.grasp.width  # numbers of a force
        self.count, self.width = task.times.size - 2, self.d * len(task.grasp)
        self.active = task.active[1:-1]
        inner = sparse.identity(self.count * self.width, format="csc")
        self.columns = inner[:, np.repeat(self.active, self.d, axis=1).ravel()]
        self.has_t = objective in ("force", "peak", "rate")
        self.unknowns = self.columns.shape[1] + self.has_t
        self.rows = Rows(self.unknowns)
        self.origin = np.zeros(self.unknowns)
        self.origin[: self.columns.shape[1]] = task.reference[1:-1].ravel() @ self.columns / task.unit

    def program(self, least_margin: float) -> Program:
        """All rows, and the objective."""
        task, unit = self.task, self.task.unit
        grasp = task.grasp
        weight = 1 / grasp.lengths
        balance = sparse.kron(sparse.identity(self.count), grasp.cones.matrix * weight[:, None], format="csr")
        self.rows.equal(self._wide(balance @ self.columns), (task.loads[1:-1] * weight / unit).ravel())
        self._cones(least_margin / unit)
        held = np.flatnonzero(task.least_normals > 0)
        if held.size:
            normals = self._of_fingers(grasp.cones.normals[held, None], held)
            self.rows.at_least_zero(self._wide(normals[0]), -task.least_normals[held][normals[1]] / unit)
        self._circles(np.flatnonzero(task.limits < inf), task.limits / unit, None)
        rows = grasp.limit_rows
        if rows is not None and task.row_bounds is not None:
            matrix, place = self._of_fingers(-rows.rows[:, None], rows.contacts)
            self.rows.at_least_zero(self._wide(matrix), task.row_bounds[place] / unit)
        if self.objective == "peak":
            self._circles(np.arange(len(grasp)), np.zeros(len(grasp)), 1.0)
        change, offset = self._change()
        if (task.rates < inf).any():
            self._rates(change, offset)
        q = np.zeros(self.unknowns)
        if self.has_t:
            q[-1] = -1.0 if self.objective == "force" else 1.0
            return self._from_origin(self.rows.program(q))
        if self.objective == "effort":
            share = np.gradient(task.times)[1:-1] / np.diff(task.times).sum()
            each = np.repeat(share, self.width) @ self.columns
            return self._from_origin(self.rows.program(q, sparse.diags(2 * each)))
        scale = sparse.diags(np.repeat(1 / np.diff(task.phases), self.width))
        return self._from_origin(
            self.rows.program(2 * change.T @ (scale @ offset), 2 * change.T @ scale @ change)
        )

    def _from_origin(self, program: Program) -> Program:
        """The program in x - origin."""
        q, b = program.q + program.P @ self.origin, program.b - program.A @ self.origin
        return replace(program, q=q, b=b, size=1.0)  # an x of one unit matters, be the best x zero

    def _wide(self, matrix: sparse.spmatrix, t: Array | float = 0.0) -> sparse.csr_matrix:
        """The matrix with a last column for the unknown t, if there is one."""
        if not self.has_t:
            return sparse.csr_matrix(matrix)
        column = np.broadcast_to(np.asarray(t, dtype=float), matrix.shape[0])
        return sparse.hstack([matrix, sparse.csr_matrix(column[:, None])], format="csr")

    def _of_fingers(
        self, each: Array, fingers: NDArray[np.intp]
    ) -> tuple[sparse.csr_matrix, NDArray[np.intp]]:
        """Rows ``each`` (k, r, d) of fingers (k,) at every instant where they are active.

        Returns the matrix and, for each of its rows, the place in ``fingers``.
        """
        k, r, _ = each.shape
        block = np.zeros((k, r, self.width // self.d, self.d))
        block[np.arange(k), :, fingers] = each
        whole = sparse.kron(sparse.identity(self.count), block.reshape(k * r, self.width), format="csr")
        used = np.repeat(self.active[:, fingers], r, axis=1).ravel()
        place = np.tile(np.repeat(np.arange(k), r), self.count)
        return sparse.csr_matrix(whole[used] @ self.columns), place[used]

    def _cones(self, least_margin: float) -> None:
        grasp, mu = self.task.grasp, self.task.frictions
        rough, smooth = np.flatnonzero(mu > 0), np.flatnonzero(mu == 0)
        n, t = grasp.cones.normals[:, None], grasp.cones.tangents
        if rough.size:
            is_round = self.d > 2 and self.facets is None
            each = np.hstack([mu[:, None, None] * n, t]) if is_round else cone_faces(grasp, mu, self.facets)
            matrix, place = self._of_fingers(each[rough], rough)
            per_margin = np.where(self.task.stays, np.sqrt(1 + mu**2), 0.0)[rough][place]
            if is_round:
                per_margin[np.arange(place.size) % self.d > 0] = 0.0
            wide = self._wide(matrix, -per_margin if self.objective == "force" else 0.0)
            if is_round:
                self.rows.second_order(wide, -least_margin * per_margin, size=self.d)
            else:
                offset = -least_margin * per_margin
                if self.task.set_back is not None:
                    edge = np.arange(place.size) % each.shape[1]
                    offset = offset - self.task.set_back[rough][place, edge] / self.task.unit
                self.rows.at_least_zero(wide, offset)
        if self.objective == "force":
            none = sparse.csr_matrix((1, self.columns.shape[1]))
            self.rows.at_least_zero(self._wide(none, -1.0), self.task.end_margin / self.task.unit)
        if smooth.size:
            self.rows.equal(self._wide(self._of_fingers(t[smooth], smooth)[0]))
            self.rows.at_least_zero(self._wide(self._of_fingers(n[smooth], smooth)[0]))

    def _circles(self, fingers: NDArray[np.intp], radii: Array, slope: float | None) -> None:
        """|f_i| <= radius_i + slope t."""
        if not fingers.size:
            return
        each = np.zeros((fingers.size, self.d + 1, self.d))
        each[:, 1:] = np.eye(self.d)
        matrix, place = self._of_fingers(each, fingers)
        first = np.arange(place.size) % (self.d + 1) == 0
        self._round(matrix, np.where(first, radii[fingers][place], 0.0), np.where(first, slope or 0.0, 0.0))

    def _round(self, matrix: sparse.csr_matrix, offset: Array, t: Array) -> None:
        """Cones of rows (radius, x, y[, z]), or the polygons or polyhedra inside them."""
        size = self.d + 1
        if self.facets is None:
            self.rows.second_order(self._wide(matrix, t), offset, size=size)
            return
        directions, cosines = round_faces(self.facets, self.d)
        faces = np.column_stack([cosines, -directions])
        flat = sparse.kron(sparse.identity(matrix.shape[0] // size), faces, format="csr")
        self.rows.at_least_zero(self._wide(flat @ matrix, flat @ t), flat @ offset)

    def _change(self) -> tuple[sparse.csr_matrix, Array]:
        """The changes f_k+1 - f_k of all fingers as D x + d."""
        task, steps = self.task, self.count + 1
        step = sparse.diags([1.0, -1.0], [0, -1], shape=(steps, self.count))
        matrix = sparse.kron(step, sparse.identity(self.width), format="csr") @ self.columns
        offset = np.zeros((steps, self.width))
        offset[0] -= task.start.ravel() / task.unit
        offset[-1] += task.end.ravel() / task.unit
        return self._wide(matrix), offset.ravel()

    def _rates(self, change: sparse.csr_matrix, offset: Array) -> None:
        task = self.task
        moves = (task.active[1:] | task.active[:-1]) & (task.rates < inf)
        step, finger = np.nonzero(moves)
        allowed = task.rates[finger] * np.diff(task.times)[step] / task.unit
        axes, size = np.arange(self.d), self.d + 1
        at = (step * self.width + self.d * finger)[:, None] + axes  # rows of the change
        to = size * np.arange(len(at))[:, None] + 1 + axes
        pick = sparse.csr_matrix((np.ones(at.size), (to.ravel(), at.ravel())), (size * len(at), offset.size))
        radius = np.zeros(size * len(at))
        radius[::size] = allowed
        bare = change[:, : self.columns.shape[1]]
        if self.objective == "rate":
            self._round(pick @ bare, pick @ offset, radius)
        else:
            self._round(pick @ bare, pick @ offset + radius, 0 * radius)
