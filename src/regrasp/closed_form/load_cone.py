"""Which forces through the origin a pair of contacts can hold: a cone in the plane of loads.

All that does not depend on the load is computed here once, for a load that turns. In the frame of two
contacts, with y = -(x + phi) so that f_2 = y u + b p, and without torque, the load F enters linearly:

    phi = u . F,    a = A . F,    A = (r_2y, -r_2x) / |P_1 P_2|,
                    b = B . F,    B = (-r_1y, r_1x) / |P_1 P_2|.

An edge of a cone asks slope z + offset w >= 0 of the contact's own numbers, (z, w) = (x, a) or (y, b), and so
slope x + (a vector) . F >= 0. A squeeze x between all bounds exists exactly if every lower bound is below
every upper one: for two edges whose slopes have opposite signs,

    ( |slope_j| vector_i + |slope_i| vector_j ) . F >= 0.

Of four edges at most four such pairs can be made: the loads that are held are those within four half-planes.
With none, every load is held. Force limits come on top of that.
"""

from collections.abc import MutableSequence
from math import inf, sqrt

Turned = tuple[float, float, float, float, float, float]
"""(u_x, u_y, A_x, A_y, B_x, B_y): what makes phi, a and b from a load."""
Cone = tuple[float, float, float]
"""(c, s, mu): the unit normal along (u, p) and the friction."""
Reach = tuple[float, float, float, float, float, float, float]
"""(bound_1, lower_1, upper_1, bound_2, lower_2, upper_2, upright) of a contact's z, to be multiplied with w.

Of each edge: z = bound w is on it, ``lower`` is 0 if that bounds z from below and -inf if not, ``upper`` 0 or
inf. The force is upright at z = upright w.
"""
Edge = tuple[float, float, float]
"""(slope, vector_x, vector_y) of slope x + vector . F >= 0."""

# Below these sines and fractions of the load, rounding may decide.
_PARALLEL = 1e-7
_BAND = 1e-11
_IDLE = 1e-8
_FAR = 1e4


def pair_for_turning(
    x1: float, y1: float, nx1: float, ny1: float, x2: float, y2: float, nx2: float, ny2: float
) -> tuple[Turned, tuple[float, float], tuple[float, float], float]:
    """The frame for every load, both unit normals along (u, p), and how far off the pair is.

    That is the size of the coordinates over the distance of the points: a and b are as much larger than the
    load, at most, and so is their rounding.
    """
    dx, dy = x2 - x1, y2 - y1
    per_length = 1.0 / sqrt(dx * dx + dy * dy)
    ux, uy = dx * per_length, dy * per_length
    far = (abs(x1) + abs(y1) + abs(x2) + abs(y2)) * per_length
    turned = (ux, uy, y2 * per_length, -x2 * per_length, -y1 * per_length, x1 * per_length)
    first = (nx1 * ux + ny1 * uy, ny1 * ux - nx1 * uy)
    second = (nx2 * ux + ny2 * uy, ny2 * ux - nx2 * uy)
    return turned, first, second, far


def cone_edges(turned: Turned, first: Cone, second: Cone) -> tuple[Edge, Edge, Edge, Edge]:
    """Both edges of the first contact, then of the second, as bounds on x for every load."""
    ux, uy, ax, ay, bx, by = turned
    c1, s1, mu1 = first
    c2, s2, mu2 = second
    left1, right1, left2, right2 = mu1 * c1 + s1, mu1 * c1 - s1, mu2 * c2 + s2, mu2 * c2 - s2
    over1, under1, over2, under2 = mu1 * s1 - c1, mu1 * s1 + c1, mu2 * s2 - c2, mu2 * s2 + c2
    return (
        (left1, over1 * ax, over1 * ay),
        (right1, under1 * ax, under1 * ay),
        (-left2, over2 * bx - left2 * ux, over2 * by - left2 * uy),
        (-right2, under2 * bx - right2 * ux, under2 * by - right2 * uy),
    )


def half_planes(
    edges: tuple[Edge, Edge, Edge, Edge], x: MutableSequence[float], y: MutableSequence[float]
) -> int:
    """Writes the normals of the half-planes of loads, four of them with repetition; how many differ.

    ``x`` and ``y`` have room for seven: a normal is always written, and kept by counting on.
    """
    count = 0
    for i in range(3):
        slope1, x1, y1 = edges[i]
        for j in range(i + 1, 4):
            slope2, x2, y2 = edges[j]
            x[count] = abs(slope2) * x1 + abs(slope1) * x2
            y[count] = abs(slope2) * y1 + abs(slope1) * y2
            count += 1 if slope1 * slope2 < 0.0 else 0
    for k in range(count, 4):
        x[k], y[k] = x[0], y[0]
    return count


def own_reach(cone: Cone) -> Reach:
    """How a contact bounds its own z, for every w."""
    c, s, mu = cone
    left, right = mu * c + s, mu * c - s
    lower1, upper1 = (0.0, inf) if left > 0.0 else (-inf, 0.0)
    lower2, upper2 = (0.0, inf) if right > 0.0 else (-inf, 0.0)
    return (c - mu * s) / left, lower1, upper1, -(mu * s + c) / right, lower2, upper2, c / s


def is_delicate(first: Cone, second: Cone, far: float) -> bool:
    """Whether an edge is (nearly) parallel to the line of contacts, or a contact has no friction.

    Such pairs, and points close together far from the origin, are left to the formula of one grasp.
    """
    c1, s1, mu1 = first
    c2, s2, mu2 = second
    near1, near2 = _PARALLEL * (1.0 + mu1), _PARALLEL * (1.0 + mu2)
    return (
        (mu1 == 0.0) | (mu2 == 0.0) | (not far < _FAR)
        | (abs(mu1 * c1 + s1) < near1) | (abs(mu1 * c1 - s1) < near1)
        | (abs(mu2 * c2 + s2) < near2) | (abs(mu2 * c2 - s2) < near2)
    )  # fmt: skip


def band(mu1: float, mu2: float, far: float) -> float:
    """Within this distance of the cone's boundary, for a load of size 1, rounding may decide."""
    return _BAND * (1.0 + far) * (1.0 + mu1) * (1.0 + mu2)


def idle_below(far: float) -> float:
    """Smaller a and b, for a load of size 1, may be rounding of a load through a contact."""
    return _IDLE * (1.0 + far)
