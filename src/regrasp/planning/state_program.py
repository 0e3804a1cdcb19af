"""The choice of a state as a convex program: the seam where mechanics becomes rows.

Unknowns x = (f_1, ..., f_n, t), forces in units of ``unit`` [N] and torques divided by the grasp's size, so
that the data are of order one whatever the units. In the plane two half-planes are the friction cone:

    equilibrium   G f = -w_ext                                          zero cone
    friction      mu f.n -+ f.t >= 0                                    non-negative
                  f.t = 0 and f.n >= 0 without friction                 zero, non-negative
    limits        |f_i| <= limit_i                                      second order

    effort        minimise sum |f_i|^2
    peak          minimise t,  |f_i| <= t
    peak_normal   minimise t,  f_i.n_i <= t
    force         maximise t,  mu f.n -+ f.t >= t sqrt(1 + mu^2)   (contacts with friction)

``angle`` and ``friction_use`` are quasi-convex: a level is reached when cones narrowed to it hold the load,
which is the program ``force`` over narrower cones.
"""

from math import inf

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.state_form import state_form
from regrasp.programs import Program

CONVEX = ("effort", "peak", "peak_normal", "force")
"""Objectives that are one program."""

# Both sides of a cone: mu f.n - f.t and mu f.n + f.t.
_SIDES = np.array([[-1.0], [1.0]])


def state_program(
    grasp: Grasp,
    load: Wrench,
    objective: str,
    frictions: list[float],
    limits: list[float],
    unit: float,
    facets: int | None = None,
    weights: Array | None = None,
) -> Program:
    """The program of one of ``CONVEX``; forces come out in units of ``unit`` [N].

    frictions, limits: (n,), in place of the contacts' own. facets: sides of the inner polygon that stands for
    each circle |f| <= r, or None for second-order cones. weights: (n,) in the place of sqrt(1 + mu^2) in
    ``force``. ``effort`` has no unknown t.
    """
    if grasp.dimension != 2:
        raise InvalidInput("states are chosen for planar grasps so far; this grasp is in space")
    if objective not in CONVEX:
        raise InvalidInput(f"one program states {', '.join(CONVEX)}; got {objective!r}")
    mu, limit = np.array(frictions), np.array(limits)
    form = state_form(objective, tuple(mu > 0), tuple(limit < inf), facets)
    normals, tangents = grasp.normals, grasp.tangents
    length = grasp.size or 1.0
    edges = mu[:, None, None] * normals[:, None] + _SIDES * tangents[:, None]  # (n, 2, 2)
    numbers = [form.constants, -grasp.matrix[2] / length, -edges[form.rough].ravel()]
    if form.smooth.size:
        numbers += [-tangents[form.smooth].ravel(), -normals[form.smooth].ravel()]
    if objective == "peak_normal":
        numbers.append(normals.ravel())
    if objective == "force":
        weights = np.sqrt(1 + mu**2) if weights is None else weights
        numbers.append(np.repeat(weights[form.rough], 2))
    b = np.zeros(form.rows)
    b[:3] = load.vector / unit
    b[2] /= length
    b[form.limit_rows] = form.limit_scale * np.repeat(limit[form.limited], form.limit_repeats) / unit
    return Program(form.P, form.q, form.pattern.filled(np.concatenate(numbers)), b, form.blocks)
