"""The forces of the highest level of narrowed cones: the widest angle margin, the least use of friction.

The depth t to which forces reach inside the cones of a level falls with it, and the duals z of that program
say how fast, dt/dlevel = sum z_i n_i.f_i dmu_i/dlevel: Newton's method, kept between levels within and out of
reach, finds the level where it is zero.
"""

from math import atan, inf, sqrt, tan
from typing import Any

from regrasp.closed_form.choice import ANGLE
from regrasp.closed_form.conic.balance import Room
from regrasp.closed_form.conic.state_program import LEVEL, solve, write_forces

_MOST = 40
_CLOSE = 1e-9
_DEPTH = 1e-9


def narrow(objective: int, n: int, mu: Any, level: float, room: Room) -> None:
    """Writes the frictions of the cones of a level, and the weights by which depths in them are distances."""
    for i in range(n):
        if objective == ANGLE:
            room.mu[i] = tan(max(atan(mu[i]) - level, 0.0))
        else:
            room.mu[i] = mu[i] * (1.0 - level)
        room.weights[i] = sqrt(1.0 + room.mu[i] * room.mu[i])


def fall(objective: int, n: int, d: int, normals: Any, mu: Any, forces: Any, room: Room) -> float:
    """How fast the depth falls with the level, by the duals of the program just solved."""
    total = 0.0
    for i in range(n):
        normal = 0.0
        push = room.z[2 * i] + room.z[2 * i + 1] if d == 2 else room.z[room.first[i]]
        for a in range(d):
            normal += normals[i, a] * forces[i, a]
        rate = mu[i]
        if objective == ANGLE:
            rate = 1.0 + room.mu[i] * room.mu[i]
        total += push * normal * rate
    return total


def climb(
    objective: int, n: int, d: int, p: int, normals: Any, tangents: Any, mu: Any, room: Room, forces: Any
) -> bool:
    """Writes the forces of the highest level within ``room.limits``; whether they were found.

    mu: (n,) of the whole cones. ``room.deep`` are forces within them, at the unknowns ``room.start``.
    """
    low, high = 0.0, 1.0
    if objective == ANGLE:
        high = inf
        for i in range(n):
            high = min(high, atan(mu[i]))
    level, nearest = high, inf  # the highest of all is reached often
    for step in range(_MOST):
        narrow(objective, n, mu, level, room)
        for j in range(p):
            room.x[j] = room.start[j]
        if not solve(LEVEL, n, d, p, normals, tangents, room):
            if step > 0:
                return False
            level = high / 2.0
            continue
        depth = room.x[p]
        write_forces(n, d, p, room, room.trial)
        if abs(depth) < nearest:
            nearest = abs(depth)
            for i in range(n):
                for a in range(d):
                    forces[i, a] = room.trial[i, a]
        if nearest <= _DEPTH or (step == 0 and depth > 0.0):
            return True
        if depth > 0.0:
            low = level
        else:
            high = level
        if high - low <= _CLOSE:
            return True
        slope = fall(objective, n, d, normals, mu, room.trial, room)
        level = level + depth / slope if slope > 0.0 else -inf
        if not low < level < high:
            level = (low + high) / 2.0
    return False
