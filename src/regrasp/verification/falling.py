"""How fast a time function falls at most, from above in rational arithmetic.

T' of a clamped uniform B-spline of degree p over s = t / duration is a B-spline of degree p - 1 with the
control values p (c_{i+1} - c_i) / (u_{i+p+1} - u_{i+1}). Each of its polynomial pieces lies within its Bezier
values (their blossoms at both ends of the piece), which halving the piece brings to it quadratically.
"""

from fractions import Fraction
from heapq import heappop, heappush
from itertools import count, pairwise

from regrasp.verification.exact import RESOLUTION
from regrasp.verification.protocols import Scaling

_CLOSE = 1 + RESOLUTION / 16
_HALVINGS = 2000
_COSTLY = 100_000  # products: beyond, the control values themselves are the bound

Values = list[Fraction]


def steepest(scaling: Scaling) -> Fraction:
    """At least the largest |dT/ds|, and at most 2^-44 of it more, but for very large splines."""
    control = [Fraction(c) for c in scaling.control]
    degree = getattr(scaling, "degree", min(3, len(control) - 1))
    spans = len(control) - degree
    knots = [Fraction(min(max(i - degree, 0), spans), spans) for i in range(len(control) + degree + 1)]
    widths = [knots[i + degree + 1] - knots[i + 1] for i in range(len(control) - 1)]
    steps = [b - a for a, b in pairwise(control)]
    slopes: Values = [degree * step / width for step, width in zip(steps, widths, strict=True)]
    if degree == 1 or spans * degree**3 > _COSTLY:
        return max(map(abs, slopes))
    return _largest([_piece(slopes, knots[1:-1], degree - 1, k) for k in range(spans)])


def _piece(control: Values, knots: Values, degree: int, k: int) -> Values:
    """The Bezier values of piece k: the blossom at (left, ..., left, right, ..., right)."""
    left, right = knots[k + degree], knots[k + degree + 1]
    values, around = control[k : k + degree + 1], knots[k : k + 2 * degree + 2]
    return [_blossom(values, around, [left] * (degree - j) + [right] * j) for j in range(degree + 1)]


def _blossom(values: Values, knots: Values, at: Values) -> Fraction:
    """De Boor's algorithm with another place in each round."""
    values, degree = list(values), len(at)
    for r, t in enumerate(at, 1):
        for j in range(degree, r - 1, -1):
            low, high = knots[j], knots[j + degree + 1 - r]
            share = (t - low) / (high - low)
            values[j] = (1 - share) * values[j - 1] + share * values[j]
    return values[degree]


def _largest(pieces: list[Values]) -> Fraction:
    """The largest |value| of polynomials, the piece with the largest bound halved first."""
    tie = count()
    queue: list[tuple[Fraction, int, Values]] = []
    met = Fraction(0)
    for piece in pieces:
        heappush(queue, (-max(map(abs, piece)), next(tie), piece))
        met = max(met, abs(piece[0]), abs(piece[-1]))
    for _ in range(_HALVINGS):
        if -queue[0][0] <= met * _CLOSE:
            break
        for half in _halves(heappop(queue)[2]):
            heappush(queue, (-max(map(abs, half)), next(tie), half))
            met = max(met, abs(half[0]), abs(half[-1]))
    return -queue[0][0]


def _halves(values: Values) -> tuple[Values, Values]:
    """Both halves of a Bezier polynomial, by de Casteljau."""
    first, second = [values[0]], [values[-1]]
    while len(values) > 1:
        values = [(a + b) / 2 for a, b in pairwise(values)]
        first.append(values[0])
        second.append(values[-1])
    return first, second[::-1]
