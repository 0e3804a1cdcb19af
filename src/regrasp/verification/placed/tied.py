"""The bound of what is withstood in a box: all loads together, forces tied by equal stiffness, in rationals.

Fingers that are put down with forces f and left alone answer a load d with f - (v + omega x p): their changes
do no work on any forces z with sum z_i = 0 and sum p_i x z_i = 0. Of such z

    of a pair     z_i = c (p_i - p_j) = -z_j
    of a triple   z_i = S J (p_j - p_l), and so around, S = [[a, c], [c, b]], J (x, y) = (-y, x)

are linear in the places. With twists y_d for all loads w_d, and z_d for all but the first,

    sum_d (-w_d) . y_d = sum_i sum_d u_id . f_id,   u_id = v_i(y_d) + z_id,   u_i0 = v_i(y_0) - sum_d z_id

for all forces that hold so. The u are affine in the places, the most of u . f is convex in u: the largest of
the right side is at corners, one point of those whose hull contains its arc for each finger.
"""

from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import combinations, product

from regrasp.verification.placed.protocol import Point, velocity

Most = Callable[[int, Point], Fraction]
"""The most work of a finger's force of size 1 along u, at any place of its arc."""


def ties_of(fingers: int) -> int:
    """How many there are: one of a pair, three of a triple."""
    return len(list(combinations(range(fingers), 2))) + 3 * len(list(combinations(range(fingers), 3)))


def works(
    row: list[float], loads: list[list[float]], hulls: list[list[Point]], most: Most
) -> tuple[Fraction, Fraction]:
    """Of the duals of a box the left side, and the largest of the right side for forces of size 1."""
    numbers = [Fraction(c) for c in row]
    twists = [numbers[3 * d : 3 * d + 3] for d in range(len(loads))]
    count = ties_of(len(hulls))
    rest = numbers[3 * len(loads) :]
    ties = [rest[count * d : count * (d + 1)] for d in range(len(loads) - 1)]
    work = Fraction(0)
    for load, y in zip(loads, twists, strict=True):
        work -= sum(Fraction(w) * c for w, c in zip(load, y, strict=True))
    return work, max(_done(twists, ties, corner, most) for corner in product(*hulls))


def _done(
    twists: list[list[Fraction]], ties: list[list[Fraction]], places: tuple[Point, ...], most: Most
) -> Fraction:
    """The right side at most, for fingers at these places."""
    along = [[velocity(y, p) for y in twists] for p in places]
    for d, factors in enumerate(ties, 1):
        for i, (x, y) in _forces(factors, places):
            (ax, ay), (bx, by) = along[i][d], along[i][0]
            along[i][d], along[i][0] = (ax + x, ay + y), (bx - x, by - y)
    return sum((most(i, u) for i, each in enumerate(along) for u in each), start=Fraction(0))


def _forces(factors: list[Fraction], places: tuple[Point, ...]) -> Iterator[tuple[int, Point]]:
    """The forces z of ties, one finger after the other."""
    left = iter(factors)
    for i, j in combinations(range(len(places)), 2):
        c = next(left)
        x, y = c * (places[i][0] - places[j][0]), c * (places[i][1] - places[j][1])
        yield i, (x, y)
        yield j, (-x, -y)
    for i, j, k in combinations(range(len(places)), 3):
        a, b, c = next(left), next(left), next(left)
        for f, g, h in ((i, j, k), (j, k, i), (k, i, j)):
            x, y = places[h][1] - places[g][1], places[g][0] - places[h][0]
            yield f, (a * x + c * y, c * x + b * y)
