"""The least peak force of three fingers, and the widest angle by which their cones can be narrowed.

Both are the extreme value of one parameter of the rows for which the program still has a solution. Where it
has none, four rows are in the way (see ``dual_simplex``), and where these four alone can be met is the next
to try. The peak enters them linearly, so that each trial is a bound and the first with a solution is the
answer. The angle enters by a product, so that Newton's steps are kept between the best angle met and the
least one refused.
"""

from math import inf, nan, sqrt
from typing import Any

from regrasp.closed_form.dual_simplex import FEASIBLE, FOUND, NONE, UNDECIDED, Answer
from regrasp.closed_form.pyramid import slope, write_facets
from regrasp.closed_form.triple import Vector
from regrasp.closed_form.triple_program import FACETS, IDLE, LIMITS, Workspace, solve, write_limits

_CUTS = 60  # trials; more than a few dozen have not been seen
_TRIALS = 80
_CLOSE = 2.0**-32  # trials this near to one another, of the friction, are one


def least_peak(work: Workspace, mu: Vector, limits: Vector, answer: Answer) -> tuple[float, Answer]:
    """The least p with f_i.n_i <= p cos(atan mu_i) for all contacts, and its state; NaN if left open.

    Four rows that cannot be met at one p are met at a larger one, from which the next trial starts: the p of
    every trial is a bound from below, and the first that has a state is the answer.
    """
    p = 0.0
    for i in range(3):
        p += _row_value(work.ahead, i, answer) / 3.0
    for _ in range(_CUTS):
        write_limits(work, mu, (min(limits[0], p), min(limits[1], p), min(limits[2], p)))
        answer = solve(work, work.narrow)
        if answer[0] == FOUND:
            return p, answer
        if answer[0] == UNDECIDED:
            break
        gain = 0.0  # how the certificate's value grows with p
        for place in range(4):
            row = answer[1] if place == 3 else work.narrow[place]
            weight = 1.0 if place == 3 else max(-answer[4][place], 0.0)
            i = row - LIMITS
            if 0 <= i < 3 and p < limits[i]:
                gain += weight / sqrt(1.0 + mu[i] * mu[i])
        if not gain > 0.0:
            break
        p = max(p - answer[2] / gain, p * (1.0 + FEASIBLE))
    return nan, answer


def _row_value(rows: Any, at: int, answer: Answer) -> float:
    x = answer[3]
    value: float = rows[0, at] * x[0] + rows[1, at] * x[1] + rows[2, at] * x[2] + rows[3, at]
    return value


def widest(work: Workspace, mu: Vector, cos_half: float, answer: Answer) -> tuple[float, Answer]:
    """The tangent of the widest angle by which all pyramids can be narrowed, and its state.

    ``answer`` is a state with the pyramids as they are. Trials close in on the widest angle from both sides;
    one without a state is followed by Newton's step to where its four rows can be met.
    """
    lo, hi, best = 0.0, min(mu[0], mu[1], mu[2]), answer
    close = _CLOSE * hi
    trial, at_hi, width, slow = 0.5 * hi, inf, hi, 0
    four = (0, 0, 0, 0)
    for _ in range(_TRIALS):
        write_facets(work.ahead, work.sideways, mu, trial, cos_half, FACETS, work.rows)
        answer = solve(work, work.narrow)
        if answer[0] == FOUND:
            lo, best, at_lo = trial, answer, inf
            if at_hi < 0.0:
                at_lo = _gap(work, mu, cos_half, four, lo)
                if at_lo <= FEASIBLE:  # four rows are only just met: this is the widest
                    break
            trial = (lo * at_hi - hi * at_lo) / (at_hi - at_lo) if at_lo < inf else 0.5 * (lo + hi)
        elif answer[0] == NONE:
            hi = trial
            four = (work.narrow[0], work.narrow[1], work.narrow[2], answer[1])
            at_hi = _gap(work, mu, cos_half, four, hi)
            slope_there = _slope(work, mu, cos_half, answer, hi)
            trial = hi - answer[2] / slope_there if slope_there < 0.0 else 0.5 * (lo + hi)
        else:
            hi, at_hi = trial, inf
            trial = 0.5 * (lo + hi)
        if hi - lo <= close:
            break
        slow = 0 if hi - lo <= 0.5 * width else slow + 1
        if slow == 0:
            width = hi - lo
        if slow > 2 or not lo < trial < hi:
            trial, slow, width = 0.5 * (lo + hi), 0, hi - lo
    return lo, best


def _slope(work: Workspace, mu: Vector, cos_half: float, answer: Answer, narrowed: float) -> float:
    """How the value of the violated row changes with the tangent while the basis stays met."""
    total = 0.0
    for place in range(4):
        column = answer[1] if place == 3 else work.narrow[place]
        if column >= FACETS:
            i = (column - FACETS) // (work.sideways.shape[1] // 3)
            per = 1.0 + mu[i] * narrowed
            weight = 1.0 if place == 3 else -answer[4][place]
            total -= weight * (1.0 + mu[i] * mu[i]) / (per * per) * _row_value(work.ahead, i, answer)
    return cos_half * total


def _gap(
    work: Workspace, mu: Vector, cos_half: float, four: tuple[int, int, int, int], narrowed: float
) -> float:
    """Below zero where four rows cannot be met: the weighted sum of their constants, weights adding to 1.

    The weights y with sum y_i a_i = 0 are the minors of the coefficients; where they have both signs, the
    rows can be met whatever their constants are, and the gap is infinite.
    """
    a = _row(work, mu, cos_half, four[0], narrowed)
    b = _row(work, mu, cos_half, four[1], narrowed)
    c = _row(work, mu, cos_half, four[2], narrowed)
    d = _row(work, mu, cos_half, four[3], narrowed)
    y0, y1, y2, y3 = _minor(b, c, d), -_minor(a, c, d), _minor(a, b, d), -_minor(a, b, c)
    total = y0 + y1 + y2 + y3
    if total < 0.0:
        y0, y1, y2, y3, total = -y0, -y1, -y2, -y3, -total
    if total == 0.0 or min(y0, y1, y2, y3) < -IDLE * total:
        return inf
    return (y0 * a[3] + y1 * b[3] + y2 * c[3] + y3 * d[3]) / total


def _row(
    work: Workspace, mu: Vector, cos_half: float, column: int, narrowed: float
) -> tuple[float, float, float, float]:
    """A row of the program with the pyramids narrowed."""
    rows, ahead, sideways = work.rows, work.ahead, work.sideways
    if column < FACETS:
        return rows[0, column], rows[1, column], rows[2, column], rows[3, column]
    at = column - FACETS
    i = at // (sideways.shape[1] // 3)
    rho = slope(mu[i], narrowed, cos_half)
    return (
        rho * ahead[0, i] - sideways[0, at],
        rho * ahead[1, i] - sideways[1, at],
        rho * ahead[2, i] - sideways[2, at],
        rho * ahead[3, i] - sideways[3, at],
    )


def _minor(
    a: tuple[float, float, float, float],
    b: tuple[float, float, float, float],
    c: tuple[float, float, float, float],
) -> float:
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
