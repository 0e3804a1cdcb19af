"""Three fingers and a load as a linear program in the three squeezes (see ``dual_simplex``).

Its rows, in units of the largest particular force:

    0-2   bounds of the squeezes, beyond which none is sought
    3-5   limits: f_i.n_i <= limit_i cos(atan mu_i) keeps |f_i| <= limit_i in the whole cone
    6-8   f_i.n_i >= 0: the facets say it, too, but not those of a finger without friction
    9-    facets of the inner pyramids

What the program accepts is judged once more by the exact cones and the residual of the forces themselves.
"""

from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np

from regrasp.closed_form.dual_simplex import UNDECIDED, Answer, least
from regrasp.closed_form.pyramid import write_tangents
from regrasp.closed_form.triple import Frame, Three, Vector, cross, dot, plus

FAR = 2.0**20
"""No squeeze beyond this many times the largest particular force is sought."""
IDLE = 2.0**-40
"""A force below this fraction of the largest is no force; a residual below it is equilibrium."""
LIMITS, PUSHES, FACETS = 3, 6, 9
"""First columns of these rows."""


class Fingers(NamedTuple):
    """Three contacts on plain numbers.

    mu and limits (of |f_i|, infinite for none) are what a state is judged by; what the program may use of
    them is a little less, so that rounding does no harm.
    """

    points: Three
    normals: Three
    mu: Vector
    limits: Vector
    usable_mu: Vector
    usable_limits: Vector


class Workspace(NamedTuple):
    """Arrays that one triple after the other is written into; see ``pyramid`` and ``dual_simplex``.

    basis: of the program with the contacts' own limits. narrow: with other limits or narrowed pyramids.
    """

    tangents: Any
    ahead: Any
    sideways: Any
    rows: Any
    basis: Any
    narrow: Any
    goal: Any


def workspace(facets: int) -> Workspace:
    """Room for pyramids of so many facets."""
    return Workspace(
        np.zeros((3, 3 * facets)),
        np.zeros((4, 3)),
        np.zeros((4, 3 * facets)),
        np.zeros((4, FACETS + 3 * facets)),
        np.array([0, 1, 2]),
        np.array([0, 1, 2]),
        np.zeros(3),
    )


def write_triple(work: Workspace, frame: Frame, normals: Three, angles: Any) -> None:
    """Fills in what does not depend on the load. The goal is the least sum of the normal forces."""
    write_tangents(frame, normals, angles, work.tangents, work.ahead, work.sideways)
    for c in range(3):
        work.goal[c] = work.ahead[c, 0] + work.ahead[c, 1] + work.ahead[c, 2]
        for i in range(3):
            work.rows[c, i] = 0.0
            work.rows[c, LIMITS + i] = -work.ahead[c, i]
            work.rows[c, PUSHES + i] = work.ahead[c, i]
        work.rows[c, c] = 1.0 if work.goal[c] >= 0.0 else -1.0
        work.rows[3, c] = FAR
        work.basis[c] = work.narrow[c] = c


def write_limits(work: Workspace, mu: Vector, limits: Vector) -> None:
    """Fills in the limits of |f_i|, in units of the program, and that fingers only push."""
    for i in range(3):
        work.rows[3, PUSHES + i] = work.ahead[3, i]
        work.rows[3, LIMITS + i] = limits[i] / sqrt(1.0 + mu[i] * mu[i]) - work.ahead[3, i]


def solve(work: Workspace, basis: Any) -> Answer:
    """The program as it stands, from a basis of one before."""
    goal = work.goal
    answer = least(work.rows, goal[0], goal[1], goal[2], basis)
    if answer[0] == UNDECIDED:  # another way there may be open
        basis[0], basis[1], basis[2] = 0, 1, 2
        answer = least(work.rows, goal[0], goal[1], goal[2], basis)
    return answer


def largest(forces: Three) -> float:
    """The largest |f_i|."""
    return sqrt(max(dot(forces[0], forces[0]), dot(forces[1], forces[1]), dot(forces[2], forces[2])))


def is_state(fingers: Fingers, force: Vector, torque: Vector, forces: Three) -> bool:
    """Whether forces are in equilibrium, inside the exact cones and below their limits."""
    points, normals, mu, limits = fingers.points, fingers.normals, fingers.mu, fingers.limits
    peak = largest(forces)
    total, moment, reach = force, torque, 0.0
    for i in range(3):
        f, n = forces[i], normals[i]
        total = plus(total, 1.0, f)
        moment = plus(moment, 1.0, cross(points[i], f))
        reach = max(reach, dot(points[i], points[i]))
        square = dot(f, f)
        if square > limits[i] * limits[i]:
            return False
        if square > IDLE * IDLE * peak * peak:
            ahead, across = dot(f, n), cross(n, f)
            room = max(mu[i], IDLE) * ahead
            if not (ahead > 0.0 and dot(across, across) <= room * room):
                return False
    small = IDLE * IDLE * peak * peak
    return dot(total, total) <= small and dot(moment, moment) <= small * reach


def attained(normals: Three, mu: Vector, forces: Three) -> float:
    """The tangent of the least angle margin of forces in their cones, of the contacts that carry force."""
    peak, result = largest(forces), inf
    for i in range(3):
        f, n = forces[i], normals[i]
        if dot(f, f) > IDLE * IDLE * peak * peak:
            across = cross(n, f)
            ahead, aside = dot(f, n), sqrt(dot(across, across))
            result = min(result, (mu[i] * ahead - aside) / (ahead + mu[i] * aside))
    return result
