"""Whether a grasp stands a whole set: wrenches of a ball, in rationals; deviations that springs answer.

What places in a box withstand is bounded in rationals by all loads together, forces tied by equal stiffness.
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

import numpy as np

from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.verification.placed.protocol import Point, velocity

_CLOSE = 1e-9

Vector = tuple[Fraction, Fraction, Fraction]
Most = Callable[[int, Point], Fraction]
"""The most work of a finger's force of size 1 along u, at any place of its arc."""


def makes_ball(grasp: Grasp, limit: float, length: float, radius: Fraction) -> bool:
    """Whether a planar grasp makes the wrenches (force, torque / length) up to a radius [N].

    Each finger makes the triangle of 0 and its edges e = limit G (n -+ mu t). Facets of the sum of the
    triangles span two of their sides, so it contains the ball if and only if h(u) >= radius |u| for the
    normals u of all these, h(u) the sum of max(0, u . e) over fingers; and it is of three dimensions.
    """
    triangles = []
    for contact in grasp:
        x, y = (Fraction(c) for c in contact.position.tolist())
        nx, ny = (Fraction(c) for c in contact.normal.tolist())
        mu, most = Fraction(contact.friction), Fraction(limit)
        edges = []
        for side in (-mu, mu):
            fx, fy = most * (nx - side * ny), most * (ny + side * nx)
            edges.append((fx, fy, (x * fy - y * fx) / Fraction(length)))
        triangles.append(edges)
    sides: list[Vector] = [e for edges in triangles for e in edges]
    sides += [(b[0] - a[0], b[1] - a[1], b[2] - a[2]) for a, b in triangles]
    found = False
    for a, b in combinations(sides, 2):
        u = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
        size = _dot(u, u)
        if size == 0:
            continue
        found = True
        for sign in (1, -1):
            h = sum(max(Fraction(0), *(sign * _dot(u, e) for e in edges)) for edges in triangles)
            if h * h < radius * radius * size:
                return False
    return found


def _dot(a: Vector, b: Vector) -> Fraction:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def answer_alike(states: tuple[GraspState, ...]) -> bool:
    """Whether the forces of planar states differ from those of the first as equal springs make them.

    The object moves by some small twist (v, omega), the same for all fingers, and a finger at r pushes back
    with -k (v + omega x r). Which twist it is balance decides, which each state is checked for.
    """
    first, *others = states
    size = float(np.linalg.norm(first.grasp.positions, axis=1).max()) or 1.0
    x, y = (first.grasp.positions / size).T
    moved = np.zeros((2 * len(x), 3))
    moved[::2, 0] = moved[1::2, 1] = 1.0
    moved[::2, 2], moved[1::2, 2] = -y, x
    for state in others:
        change = (state.forces - first.forces).ravel()
        left = change - moved @ np.linalg.lstsq(moved, change, rcond=None)[0]
        if np.abs(left).max() > _CLOSE * np.abs(state.forces).max():
            return False
    return True


def ties_of(fingers: int) -> int:
    """How many there are: one of a pair, three of a triple."""
    return fingers * (fingers - 1) ** 2 // 2


def works(
    row: list[float], loads: list[list[float]], hulls: list[list[Point]], most: Most
) -> tuple[Fraction, Fraction]:
    """Of the duals of a box the left side, and the largest of the right side for forces of size 1."""
    numbers = [Fraction(c) for c in row]
    twists = [numbers[3 * d : 3 * d + 3] for d in range(len(loads))]
    count = ties_of(len(hulls))
    rest = numbers[3 * len(loads) :]
    ties = [rest[count * d :] for d in range(len(loads) - 1)]  # of which as many are taken as there are
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


def is_excluded(
    motions: list[tuple[list[float], list[float]]], bound: Fraction, hulls: list[list[Point]], most: Most
) -> bool:
    """Whether twists of some loads that move with the fingers exclude a box of straight arcs.

    motions: of each load, the load; and its velocity and angular velocity with fingers at the first ends of
    their arcs, then what fingers add to the velocities on their way to the last. The work of loads less
    ``bound`` times the most work of forces of size 1 is concave in all places, so corners tell.
    """
    k = len(hulls)
    for corner in product(range(2), repeat=k):
        work = done = Fraction(0)
        for load, motion in motions:
            x, y, turn, *more = map(Fraction, motion)
            twist = [
                x + sum(c for c, at in zip(more[:k], corner, strict=True) if at),
                y + sum(c for c, at in zip(more[k:], corner, strict=True) if at),
                turn,
            ]
            work -= sum(Fraction(w) * c for w, c in zip(load, twist, strict=True))
            for i, at in enumerate(corner):
                done += most(i, velocity(twist, hulls[i][at]))
        if not work > bound * done:
            return False
    return True


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
