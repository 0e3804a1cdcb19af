"""Whether a grasp stands a whole set: wrenches of a ball, in rationals; deviations that springs answer."""

from fractions import Fraction
from itertools import combinations

import numpy as np

from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState

_CLOSE = 1e-9

Vector = tuple[Fraction, Fraction, Fraction]


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
    moved[0::2, 0] = moved[1::2, 1] = 1.0
    moved[0::2, 2], moved[1::2, 2] = -y, x
    for state in others:
        change = (state.forces - first.forces).ravel()
        left = change - moved @ np.linalg.lstsq(moved, change, rcond=None)[0]
        if np.abs(left).max() > _CLOSE * np.abs(state.forces).max():
            return False
    return True
