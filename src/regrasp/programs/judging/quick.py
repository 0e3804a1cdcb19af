"""The audit of an answer that is sound beyond doubt, in a few products.

For programs in one unit (``Program.size``). Every measure of ``audit`` is at most what it is here, where
units are the least they can be and all products s z count as one: their sum bounds each, as those of rows
inside their cones are not negative, and those outside by e at least -e |z|.
"""

import numpy as np

from regrasp.programs.blocks import Array
from regrasp.programs.judging.audit import Audit
from regrasp.programs.judging.terms import most
from regrasp.programs.program import Program


def surely_sound(program: Program, x: Array, z: Array, close: float, allowed: float) -> Audit | None:
    """Bounds of the measures of x (n,), z (m,), none above ``allowed``; None where the audit must tell.

    close: the most that of the constraints may be.
    Objective, stationarity and gap are not bounds but themselves.
    """
    terms, cones, b, q = program.terms, program.cones, program.b, program.q
    row, column, product, unit = program.floors
    if not min(program.floors) > 0:
        return None
    s = b - terms.A @ x
    outside = most(cones.excess(s))
    if not (outside <= close * row and cones.has_dual(z)):
        return None
    px = terms.P @ x
    bent = most(np.abs(px + q + z @ terms.A))
    quadratic, linear = float(x @ px), float(q @ x)
    gap = abs(quadratic + linear + float(b @ z))
    both = abs(float(s @ z)) + 3 * outside * float(np.add.reduce(np.abs(z)))
    if not (bent <= allowed * column and both <= allowed * product and gap <= allowed * unit):
        return None
    return Audit(
        outside / row, bent / column, both / product, gap / unit,
        quadratic / 2 + linear, outside, 0.0, bent, gap,
    )  # fmt: skip
