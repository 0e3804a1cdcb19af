"""The choice of a state as a convex program: the seam where mechanics becomes rows.

Unknowns x = (f_1, ..., f_n, t), forces in units of ``unit`` [N] and torques divided by the grasp's size, so
that the data are of order one whatever the units. In the plane two half-planes are the friction cone; in
space it is of second order, or an inner pyramid of ``facets`` faces (``regrasp.planning.states.faces``):

    equilibrium   G f = -w_ext                                          zero cone
    friction      mu f.n -+ f.t >= 0                                    non-negative (plane)
                  |(f.t_1, f.t_2)| <= mu f.n                            second order (space)
                  mu cos(pi/m) f.n - f.u_k >= 0                         non-negative (space, m facets)
                  f.t = 0 and f.n >= 0 without friction                 zero, non-negative
    limits        |f_i| <= limit_i                                      second order

What is optimised depends on the objective's ``Bound``:

    NONE      minimise sum a_i |f_i|^2 + c_i . f_i  (soft fingers: as cones measure them, ``mechanics.cones``)
    FORCE     minimise t,  |f_i| <= t
    NORMAL    minimise t,  f_i.n_i <= t
    MARGIN    maximise t,  mu f.n -+ f.t >= t sqrt(1 + mu^2)   (contacts with friction; in space |f_t|)

A ``LevelObjective`` is quasi-convex: a level is reached when cones narrowed to it hold the load, which is the
program of ``force`` over narrower cones.
"""

from functools import lru_cache
from math import inf
from typing import NamedTuple

import numpy as np
from scipy import sparse

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import NEGLIGIBLE
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.faces import ball_faces, cone_faces
from regrasp.planning.states.objectives import Bound, ConvexObjective, Objective, objective_of
from regrasp.planning.states.program_form import StateForm, state_form
from regrasp.programs import Program


def state_program(
    grasp: Grasp,
    load: Wrench,
    objective: str | Objective,
    frictions: list[float],
    limits: list[float],
    unit: float,
    facets: int | None = None,
    weights: Array | None = None,
) -> Program:
    """The program of a convex objective; forces come out in units of ``unit`` [N].

    frictions, limits: (n,), in place of the contacts' own. facets: sides of the inner polygon that stands for
    each circle |f| <= r, or None for second-order cones. weights: (n,) in the place of sqrt(1 + mu^2) of
    ``Bound.MARGIN``.
    """
    sought = objective_of(objective)
    if not isinstance(sought, ConvexObjective):
        raise InvalidInput(
            f"one program states a convex objective, such as 'effort'; got {shown(sought.name)}"
        )
    if grasp.is_soft and facets is not None:
        raise InvalidInput("facets stand for the cones of point contacts; leave them out with soft fingers")
    asked = (
        grasp,
        sought,
        unit if sought.follows_unit else 1.0,
        tuple(frictions),
        tuple(limit < inf for limit in limits),
        facets,
    )
    rows = _rows(*asked) if weights is None else _new_rows(*asked, weights)
    b = np.zeros(rows.form.rows)
    b[: load.vector.size] = load.vector / (unit * grasp.lengths)
    if rows.form.limited.size:
        b[rows.form.limit_rows] = (rows.shares * np.array(limits)[rows.form.limited, None]).ravel() / unit
    return rows.program.with_right_side(b)


class _Rows(NamedTuple):
    """A program whose b is yet to come, its form, and the shares (k, 1 or faces) of limits that go into b."""

    form: StateForm
    program: Program
    shares: Array


def _new_rows(
    grasp: Grasp,
    objective: ConvexObjective,
    unit: float,
    frictions: tuple[float, ...],
    limited: tuple[bool, ...],
    facets: int | None,
    weights: Array | None = None,
) -> _Rows:
    mu = np.array(frictions)
    mu[mu <= NEGLIGIBLE] = 0.0
    form = state_form(objective.bound, tuple(mu > 0), limited, facets, grasp.width)
    normals, tangents = grasp.cones.normals, grasp.cones.tangents
    if form.is_round:
        sides = np.concatenate([mu[:, None, None] * normals[:, None], tangents], axis=1)
    else:
        sides = cone_faces(grasp, mu, facets)
    numbers = [form.constants, _torque_entries(grasp), -sides[form.rough].ravel()]
    if form.smooth.size:
        numbers += [-tangents[form.smooth].ravel(), -normals[form.smooth].ravel()]
    if objective.bound is Bound.NORMAL:
        numbers.append(normals.ravel())
    if objective.bound is Bound.MARGIN:
        weights = np.sqrt(1 + mu**2) if weights is None else weights
        numbers.append(np.repeat(weights[form.rough], 1 if form.is_round else sides.shape[1]))
    shares = np.ones((form.limited.size, 1))
    if facets is not None:
        directions, cosines = ball_faces(grasp, mu, facets)
        if objective.bound is Bound.FORCE:
            numbers += [directions.ravel(), -cosines.ravel()]
        numbers.append(directions[form.limited].ravel())
        shares = cosines[form.limited]
    A = form.pattern.filled(np.concatenate(numbers))
    A.data.setflags(write=False)  # programs of other loads share it
    return _Rows(
        form,
        Program(*_cost(objective, grasp, unit, form), A, np.zeros(form.rows), form.blocks, size=1.0),
        shares,
    )


@lru_cache(maxsize=64)
def _cost(
    objective: ConvexObjective, grasp: Grasp, unit: float, form: StateForm
) -> tuple[sparse.csc_matrix, Array]:
    """P and q: the cost of the forces themselves, and of the unknown besides them."""
    squares, linear = objective.squares(grasp), objective.linear(grasp, unit)
    size = form.q.size
    P = sparse.csc_matrix((size, size))
    if squares is not None:
        P = sparse.csc_matrix(2 * np.diag(np.repeat(squares, grasp.width)))
    q = form.q if linear is None else np.append(linear.ravel(), form.q[linear.size :])
    for shared in (q, P.data, P.indices, P.indptr):  # programs of other loads share them
        shared.setflags(write=False)
    return P, q


@lru_cache(maxsize=64)
def _rows(
    grasp: Grasp,
    objective: ConvexObjective,
    unit: float,
    frictions: tuple[float, ...],
    limited: tuple[bool, ...],
    facets: int | None,
) -> _Rows:
    """Kept, with what audits need: loads change more often than grasps."""
    rows = _new_rows(grasp, objective, unit, frictions, limited, facets)
    program = rows.program
    _ = program.has_second_order, program.why_not_convex, program.is_quick, program.floors
    return rows


def _torque_entries(grasp: Grasp) -> Array:
    """Torque rows of -G, divided by the size, in the form's order, without what is always zero."""
    matrix = -grasp.scaled_matrix
    if grasp.dimension == 2:
        planar: Array = matrix[2]
        return planar
    about, axis = np.nonzero(~np.eye(3, grasp.width, dtype=bool))
    entries: Array = matrix[3:].reshape(3, len(grasp), grasp.width)[about, :, axis]
    return entries.ravel()
