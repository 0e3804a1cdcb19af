"""A linear program in three unknowns by the dual simplex method.

    minimise c . x   subject to   a_r . x + b_r >= 0   for every column r of ``rows`` (4, R)

The basis is three rows whose planes meet in x, with c = sum y_j a_j and y >= 0: x is the optimum of these
three rows alone. Rows join one at a time, as in Seidel's incremental method, the most violated first; each
takes the place of the row whose multiplier vanishes first. When none can, the four rows alone have no
solution:

    a_r - sum d_j a_j = 0,   d_j <= 0,   while   b_r - sum d_j b_j < 0      (Farkas).

Only b depends on the load, so the last basis of one load is a valid start for the next; from neighbour to
neighbour none or one row changes.
"""

from typing import Any

FOUND, NONE, UNDECIDED = 0, 1, 2
"""An optimum; no solution, with a certificate; rounding or cycling left the question open."""

FEASIBLE = 2.0**-44
"""A row below zero by this fraction of 1 + max |x| is met."""
_PIVOT = 2.0**-40  # a smaller d_j is rounding
_BLAND = 40  # steps after which rows join and leave in the order that cannot cycle
_MOST = 400

Answer = tuple[int, int, float, tuple[float, float, float], tuple[float, float, float]]
"""(status, row r, its value a_r . x + b_r, x, d); r, its value and d are for ``NONE``."""


def least(rows: Any, c0: float, c1: float, c2: float, basis: Any) -> Answer:
    """The optimum from a ``basis`` (3,) of row numbers, which is overwritten by the last one.

    Columns 0, 1 and 2 must bound one unknown each from the side to which c pushes it; they are where the
    method starts when the basis given is no optimum of its own three rows.
    """
    count = rows.shape[1]
    r, worst, x0, x1, x2, d0, d1, d2 = -1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for step in range(_MOST):
        i, j, k = basis[0], basis[1], basis[2]
        p0, p1, p2, pb = rows[0, i], rows[1, i], rows[2, i], rows[3, i]
        q0, q1, q2, qb = rows[0, j], rows[1, j], rows[2, j], rows[3, j]
        s0, s1, s2, sb = rows[0, k], rows[1, k], rows[2, k], rows[3, k]
        # Columns of the inverse: q x s, s x p and p x q over the determinant.
        g0, g1, g2 = q1 * s2 - q2 * s1, q2 * s0 - q0 * s2, q0 * s1 - q1 * s0
        h0, h1, h2 = s1 * p2 - s2 * p1, s2 * p0 - s0 * p2, s0 * p1 - s1 * p0
        w0, w1, w2 = p1 * q2 - p2 * q1, p2 * q0 - p0 * q2, p0 * q1 - p1 * q0
        determinant = p0 * g0 + p1 * g1 + p2 * g2
        per = 1.0 / determinant if determinant != 0.0 else 0.0
        y0 = (c0 * g0 + c1 * g1 + c2 * g2) * per
        y1 = (c0 * h0 + c1 * h1 + c2 * h2) * per
        y2 = (c0 * w0 + c1 * w1 + c2 * w2) * per
        if per == 0.0 or (step == 0 and min(y0, y1, y2) < -_PIVOT):
            if step > 0 or (i == 0 and j == 1 and k == 2):
                break
            basis[0], basis[1], basis[2] = 0, 1, 2
            continue
        x0 = -(pb * g0 + qb * h0 + sb * w0) * per
        x1 = -(pb * g1 + qb * h1 + sb * w1) * per
        x2 = -(pb * g2 + qb * h2 + sb * w2) * per
        least_value = -FEASIBLE * (1.0 + max(abs(x0), abs(x1), abs(x2)))
        r, worst = -1, least_value
        for at in range(count):
            value = rows[0, at] * x0 + rows[1, at] * x1 + rows[2, at] * x2 + rows[3, at]
            if value < worst and at != i and at != j and at != k:
                r, worst = at, value
                if step >= _BLAND:
                    break
        if r < 0:
            return FOUND, r, worst, (x0, x1, x2), (d0, d1, d2)
        a0, a1, a2 = rows[0, r], rows[1, r], rows[2, r]
        d0 = (a0 * g0 + a1 * g1 + a2 * g2) * per
        d1 = (a0 * h0 + a1 * h1 + a2 * h2) * per
        d2 = (a0 * w0 + a1 * w1 + a2 * w2) * per
        leaving, ratio, d = -1, 0.0, 0.0
        for place in range(3):
            y, e = (y0, d0) if place == 0 else ((y1, d1) if place == 1 else (y2, d2))
            if e > _PIVOT:
                y = max(y, 0.0)
                if leaving < 0 or y < ratio * e:
                    better = True
                elif y == ratio * e:
                    better = basis[place] < basis[leaving] if step >= _BLAND else e > d
                else:
                    better = False
                if better:
                    leaving, ratio, d = place, y / e, e
        if leaving < 0:
            return NONE, r, worst, (x0, x1, x2), (d0, d1, d2)
        basis[leaving] = r
    return UNDECIDED, r, worst, (x0, x1, x2), (d0, d1, d2)
