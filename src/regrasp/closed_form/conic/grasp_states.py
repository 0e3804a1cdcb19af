"""The best forces of one grasp of point contacts, by small conic programs (``state_program``).

DEPTH always has an answer: above zero it is where the others start, below it its duals are the motion along
which the load wins.
"""

from math import inf, nan, sqrt
from typing import Any

from regrasp.closed_form.choice import ANGLE, FORCE, FRICTION_USE, PEAK
from regrasp.closed_form.conic.balance import Room, split
from regrasp.closed_form.conic.levels import climb
from regrasp.closed_form.conic.state_program import DEPTH, solve, write_forces

NONE, HELD, OPEN = 0, 1, -1
"""Verdicts: no forces, a state, and left open by rounding or by contacts that leave a motion free."""
FAR = 1e4
"""Forces are at most this multiple of the load where nothing else limits them."""
_CLEAR = 1e-9
_MOST_SHARE = 1e-4
_LESS = 1e-9
"""Of frictions and limits: what programs keep back."""


def write_twist(n: int, d: int, q: int, normals: Any, tangents: Any, room: Room, twist: Any) -> None:
    """Writes y with G'y = the sum of the duals' pushes, after DEPTH."""
    z, mu, first = room.z, room.mu, room.first
    ball = 0 if d == 2 else n
    for i in range(n):
        for a in range(d):
            entry = z[first[ball + i] + 1 + a]
            if d == 2:
                entry += (z[2 * i] + z[2 * i + 1]) * mu[i] * normals[i, a]
                entry += (z[2 * i + 1] - z[2 * i]) * tangents[i, 0, a]
            else:
                at = first[i]
                entry += z[at] * mu[i] * normals[i, a]
                entry += z[at + 1] * tangents[i, 0, a] + z[at + 2] * tangents[i, 1, a]
            room.scaled[d * i + a, 0] = entry
    count = n * d
    for k in range(q):  # Q' first, then R y = Q' v
        inner, norm = 0.0, 0.0
        for i in range(k, count):
            inner += room.qr[i, k] * room.scaled[i, 0]
            norm += room.qr[i, k] * room.qr[i, k]
        inner *= 2.0 / norm
        for i in range(k, count):
            room.scaled[i, 0] -= inner * room.qr[i, k]
    for k in range(q - 1, -1, -1):
        entry = room.scaled[k, 0]
        for j in range(k + 1, q):
            entry -= room.qr[k, j] * twist[j]
        twist[k] = entry / room.tau[k]


def deepest(n: int, d: int, p: int, normals: Any, tangents: Any, room: Room) -> float:
    """The depth to which forces reach; NaN where it was not found."""
    if not solve(DEPTH, n, d, p, normals, tangents, room):
        return nan
    depth: float = room.x[p]
    return depth


def pulled_in(
    n: int, d: int, depth: float, normals: Any, mu: Any, limits: Any, deep: Any, forces: Any
) -> bool:
    """Moves forces that rounding left outside towards those that are ``depth`` inside, hardly at all."""
    short = 0.0
    for i in range(n):
        normal, size = 0.0, 0.0
        for a in range(d):
            normal += normals[i, a] * forces[i, a]
            size += forces[i, a] * forces[i, a]
        across = 0.0
        for a in range(d):
            across += (forces[i, a] - normal * normals[i, a]) ** 2
        short = max(short, sqrt(across) - (1.0 - _LESS / 2.0) * mu[i] * normal)
        short = max(short, sqrt(size) - (1.0 - _LESS / 2.0) * limits[i])
    if short <= 0.0:
        return True
    share = 2.0 * short / (short + depth)
    if share > _MOST_SHARE:
        return False
    for i in range(n):
        for a in range(d):
            forces[i, a] += share * (deep[i, a] - forces[i, a])
    return True


def best_state(
    objective: int, matrix: Any, load: Any, normals: Any, tangents: Any, mu: Any, limits: Any,
    peak_ratio: float, n: int, d: int, room: Room, forces: Any, used: Any, twist: Any,
) -> int:  # fmt: skip
    """Writes the best forces (n, d), the limits (n,) they had, or the twist (q,) of a refusal; the verdict.

    Forces and limits are in units of the load, limits infinite for none.
    """
    q, count = 3 * d - 3, n * d
    if count < q or not split(matrix, load, count, q, room):
        return OPEN
    p = count - q
    room.x[: p + 1] = 0.0
    is_loose = False
    for i in range(n):
        is_loose = is_loose or limits[i] == inf
        room.mu[i] = (1.0 - _LESS) * mu[i]
        room.limits[i] = (1.0 - _LESS) * min(limits[i], FAR)
        room.weights[i] = sqrt(1.0 + mu[i] * mu[i])
    is_level = objective in (ANGLE, FRICTION_USE)
    depth = deepest(n, d, p, normals, tangents, room)
    if not depth > _CLEAR:
        write_twist(n, d, q, normals, tangents, room, twist)
        return NONE if depth < -_CLEAR else OPEN
    write_forces(n, d, p, room, room.deep)
    for j in range(p):
        room.start[j] = room.x[j]
    if is_loose and (is_level or objective == FORCE):
        if not solve(PEAK, n, d, p, normals, tangents, room):
            return OPEN
        most = peak_ratio * write_forces(n, d, p, room, forces)
        for i in range(n):
            room.limits[i] = min(room.limits[i], most)
    for i in range(n):
        used[i] = room.limits[i]
    if is_level:
        if not climb(objective, n, d, p, normals, tangents, mu, room, forces):
            return OPEN
    elif solve(objective, n, d, p, normals, tangents, room):
        write_forces(n, d, p, room, forces)
    else:
        return OPEN
    return HELD if pulled_in(n, d, depth, normals, mu, limits, room.deep, forces) else OPEN
