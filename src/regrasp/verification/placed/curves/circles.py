"""Proofs of what is the same after every turn: a circle under loads of all directions.

Turn a placement until its first finger is at the polar angle of the beginning of the boundary. Every finger
then is at the polar angle of some place of the boundary, and the loads, turned with it, are as large as they
were. So a tree suffices whose first finger stays there, for all loads together that turns make of those of
the proof. A boundary is a circle but for a little: with Bernstein coefficients of |p|^2 from a to b, and
those of T . p, T the tangent, at most c of those of p x T, a finger that is turned is (b - a) / (2 a) of the
radius R or less from the place at its polar angle, and its normal 2 c or less from the normal there. Its work
along a twist may be more than that at this place, but by no more than

    (|v_x| + |v_y| + |omega| R) root(1 + mu^2) play,    play = (b - a) / (2 a) + 2 c.
"""

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from math import comb

from regrasp.verification.placed.protocol import Point, Proof
from regrasp.verification.placed.roots import root_above


def play_of(proof: Proof, control: list[list[Point]]) -> tuple[Fraction, Fraction] | None:
    """Of a proof of turns, how far its boundary is from a circle about the centre of mass, and its reach.

    None where it is none. control: of cubic edges, relative to the centre of mass.
    """
    sides, legs = proof.sides.tolist(), [_differences(edge) for edge in control]
    ends = [(a, b) for _, a, b in sides]
    whole = ends[0][0] == 0 and ends[-1][1] == len(control)
    whole &= all(one[1] == other[0] for one, other in pairwise(ends))
    closed = all(one[3] == other[0] for one, other in zip(control, control[1:] + control[:1], strict=True))
    squares = [c for edge in control for c in _product(edge, edge, _dot)]
    along = max(abs(c) for each in zip(control, legs, strict=True) for c in _product(*each, _dot))
    across = min(c for each in zip(control, legs, strict=True) for c in _product(*each, _cross))
    least, most = min(squares), max(squares)
    if not (whole and closed and across > 0 and least > 0):
        return None
    return (most - least) / (2 * least) + 2 * along / across, root_above(most)


def _product(ps: list[Point], qs: list[Point], of: Callable[[Point, Point], Fraction]) -> list[Fraction]:
    """The Bernstein coefficients of a product of two curves."""
    m, n = len(ps) - 1, len(qs) - 1
    found = [Fraction(0)] * (m + n + 1)
    for i, p in enumerate(ps):
        for j, q in enumerate(qs):
            found[i + j] += Fraction(comb(m, i) * comb(n, j), comb(m + n, i + j)) * of(p, q)
    return found


def _differences(points: list[Point]) -> list[Point]:
    return [(q[0] - p[0], q[1] - p[1]) for p, q in pairwise(points)]


def _dot(a: Point, b: Point) -> Fraction:
    return a[0] * b[0] + a[1] * b[1]


def _cross(a: Point, b: Point) -> Fraction:
    return a[0] * b[1] - a[1] * b[0]
