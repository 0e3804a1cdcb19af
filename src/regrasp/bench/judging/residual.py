"""How far a point is from satisfying a program's constraints, each row by its own unit."""

from math import nan

import numpy as np

from regrasp.programs.blocks import Array, Cone
from regrasp.programs.judging.units import units_of_unknowns
from regrasp.programs.program import Program


def row_residual(program: Program, x: Array) -> float:
    """The largest violation of a row or second-order cone, relative to its |b_i| + max_j |a_ij x_j|; x: (n,).

    An unknown near zero counts as large as its unit (``regrasp.programs.judging.units``), but no larger than
    the largest; of a cone the largest row counts. Rows in other units, forces and torques for one, count
    alike, and what is large elsewhere hides nothing. NaN if x or the rows are not finite.
    """
    if not np.isfinite(x).all():
        return nan
    with np.errstate(over="ignore", invalid="ignore"):
        slack = program.b - program.A @ x
        units = np.minimum(units_of_unknowns(program)[0], abs(x).max(initial=0.0))
        sizes = np.maximum(abs(x), units)
        scale = program.terms.in_rows(sizes) + abs(program.b)
    if not (np.isfinite(slack).all() and np.isfinite(scale).all()):
        return nan
    worst = 0.0
    for block, rows in program.slices:
        s, sizes = slack[rows], scale[rows]
        if block.cone is Cone.SECOND_ORDER:
            shape = (block.count, block.size)
            s, sizes = s.reshape(shape), sizes.reshape(shape).max(axis=1)
            off = np.maximum(np.linalg.norm(s[:, 1:], axis=1) - s[:, 0], 0.0)
        else:
            off = abs(s) if block.cone is Cone.ZERO else np.maximum(-s, 0.0)
        worst = max(worst, float((off[off > 0] / sizes[off > 0]).max(initial=0.0)))
    return worst
