"""Least normal forces f_i . n_i >= least_i and contacts' linear limits A f <= b, as rows of any program.

The feasible set stays convex, and a straight path between two states that keep them keeps them, too. Least
normal forces are no cone, so that an escape twist does not prove a refusal that they alone bring about; of
linear limits it does (``linear.row_duals``).
"""

import numpy as np
from scipy import sparse

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.programs import Block, Cone, Program

_SPARE = 1e-8
"""Fraction by which programs ask for more, so that exact equilibrium moves no force beyond."""
LARGE = 1e3
"""Forces of programs count up to so many units."""


def pressing(program: Program, grasp: Grasp, least: Array, unit: float, size: float) -> Program:
    """A state program whose fingers push with ``least`` (n,) or more along their normals [N].

    unit: of the program's forces [N]. size: how large its forces may be [N].
    """
    program = _within_rows(program, grasp, unit)
    pressed = np.flatnonzero(least > 0)
    if not pressed.size:
        return program
    asked = least[pressed] + _SPARE * np.maximum(least[pressed], min(size, LARGE * unit))
    width = grasp.width
    columns = (pressed[:, None] * width + np.arange(width)).ravel()
    rows = np.repeat(np.arange(pressed.size), width)
    normals = grasp.cones.normals[pressed].ravel()
    more = sparse.csc_matrix((-normals, (rows, columns)), (pressed.size, program.q.size))
    return _with_rows(program, more, -asked / unit)


def _within_rows(program: Program, grasp: Grasp, unit: float) -> Program:
    """The program within the contacts' linear limits."""
    limits = grasp.limit_rows
    if limits is None:
        return program
    columns = limits.contacts[:, None] * grasp.width + np.arange(grasp.width)
    rows = np.repeat(np.arange(len(columns)), grasp.width)
    entries = limits.rows.ravel(), (rows, columns.ravel())
    more = sparse.csc_matrix(entries, (len(columns), program.q.size))
    return _with_rows(program, more, (1 - _SPARE) * limits.bounds / unit)


def _with_rows(program: Program, more: sparse.csc_matrix, bounds: Array) -> Program:
    return Program(
        program.P,
        program.q,
        sparse.vstack([program.A, more], format="csc"),
        np.append(program.b, bounds),
        (*program.blocks, Block(Cone.NONNEGATIVE, 1, len(bounds))),
        size=program.size,
    )


def presses(forces: Array, grasp: Grasp, least: Array) -> bool:
    """Whether forces (n, w), as cones measure them, keep least normal forces (n,) [N] and linear limits."""
    rows = grasp.limit_rows
    return bool((grasp.cones.normal(forces) >= least).all()) and (rows is None or rows.kept(forces))
