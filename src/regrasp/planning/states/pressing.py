"""Least normal forces: f_i . n_i >= least_i, as rows beside those of any state program.

The feasible set stays convex, and a straight path between two states that keep them keeps them, too. They are
no cone, so that an escape twist does not prove a refusal that they alone bring about.
"""

import numpy as np
from scipy import sparse

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.programs import Block, Cone, Program

_SPARE = 1e-8
"""Fraction by which programs ask for more, so that exact equilibrium moves no force below its least."""
LARGE = 1e3
"""Forces of programs count up to so many units."""


def pressing(program: Program, grasp: Grasp, least: Array, unit: float, size: float) -> Program:
    """A state program whose fingers push with ``least`` (n,) or more along their normals [N].

    unit: of the program's forces [N]. size: how large its forces may be [N].
    """
    pressed = np.flatnonzero(least > 0)
    if not pressed.size:
        return program
    asked = least[pressed] + _SPARE * np.maximum(least[pressed], min(size, LARGE * unit))
    width = grasp.width
    columns = (pressed[:, None] * width + np.arange(width)).ravel()
    rows = np.repeat(np.arange(pressed.size), width)
    normals = grasp.cones.normals[pressed].ravel()
    more = sparse.csc_matrix((-normals, (rows, columns)), (pressed.size, program.q.size))
    return Program(
        program.P,
        program.q,
        sparse.vstack([program.A, more], format="csc"),
        np.append(program.b, -asked / unit),
        (*program.blocks, Block(Cone.NONNEGATIVE, 1, int(pressed.size))),
        size=program.size,
    )


def presses(forces: Array, grasp: Grasp, least: Array) -> bool:
    """Whether forces (n, w), as the cones measure them, keep the least normal forces (n,) [N]."""
    return bool((grasp.cones.normal(forces) >= least).all())
