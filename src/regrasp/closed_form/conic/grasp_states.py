"""The best forces of one grasp of point contacts, by small conic programs in the forces that squeeze only.

Forces are f = base + N x, base the least ones that balance the load and N an orthonormal basis of those with
G f = 0, so that equilibrium costs no rows and the effort is |x|^2 but for a constant. In units of the load:

    DEPTH        maximise t,  mu n.f - |f_t| >= t sqrt(1 + mu^2),  |f| <= limit - t
    FORCE        maximise t,  the same,  |f| <= limit
    EFFORT       minimise |x|^2
    PEAK         minimise t,  |f| <= t
    PEAK_NORMAL  minimise t,  n.f <= t
    SUM_NORMAL   minimise sum n.f

DEPTH always has an answer: above zero it is where the others start, below it its duals are the motion along
which the load wins.
"""

from math import inf, nan, sqrt
from typing import Any

from regrasp.closed_form.choice import EFFORT, FORCE, PEAK, PEAK_NORMAL, SUM_NORMAL
from regrasp.closed_form.conic.balance import Room, split
from regrasp.closed_form.conic.cone_program import minimise

NONE, HELD, OPEN = 0, 1, -1
"""Verdicts: no forces, a state, and left open by rounding or by contacts that leave a motion free."""
DEPTH = -1
FAR = 1e4
"""Forces are at most this multiple of the load where nothing else limits them."""
_CLEAR = 1e-9
_MOST_SHARE = 1e-4
_LESS = 1e-9
"""Of frictions and limits: what programs keep back."""


def rows_of(
    kind: int, n: int, d: int, p: int, normals: Any, tangents: Any, room: Room
) -> tuple[int, int, int]:
    """Writes the program's rows for frictions and limits in ``room``; (rows, flat, unknowns)."""
    A, b, first, mu, limits = room.A, room.b, room.first, room.mu, room.limits
    basis, base = room.basis, room.base
    has_t = kind not in (EFFORT, SUM_NORMAL)
    unknowns = p + 1 if has_t else p
    row = 0
    if d == 2:
        for i in range(n):
            depth = sqrt(1.0 + mu[i] * mu[i])
            for side in (-1.0, 1.0):
                gx = mu[i] * normals[i, 0] + side * tangents[i, 0, 0]
                gy = mu[i] * normals[i, 1] + side * tangents[i, 0, 1]
                b[row] = gx * base[2 * i] + gy * base[2 * i + 1]
                for j in range(p):
                    A[row, j] = -(gx * basis[2 * i, j] + gy * basis[2 * i + 1, j])
                A[row, p] = depth if kind in (DEPTH, FORCE) else 0.0
                row += 1
    if kind == PEAK_NORMAL:
        for i in range(n):
            b[row] = 0.0
            for a in range(d):
                b[row] -= normals[i, a] * base[d * i + a]
            for j in range(p):
                A[row, j] = 0.0
                for a in range(d):
                    A[row, j] += normals[i, a] * basis[d * i + a, j]
            A[row, p] = -1.0
            row += 1
    flat, cone = row, 0
    first[0] = row
    if d == 3:
        for i in range(n):
            depth = sqrt(1.0 + mu[i] * mu[i])
            for part in range(3):
                b[row] = 0.0
                for j in range(p + 1):
                    A[row, j] = 0.0
                for a in range(3):
                    g = mu[i] * normals[i, a] if part == 0 else tangents[i, part - 1, a]
                    b[row] += g * base[3 * i + a]
                    for j in range(p):
                        A[row, j] -= g * basis[3 * i + a, j]
                if part == 0 and kind in (DEPTH, FORCE):
                    A[row, p] = depth
                row += 1
            cone += 1
            first[cone] = row
    for ball in range(2 if kind == PEAK else 1):
        for i in range(n):
            for j in range(p + 1):
                A[row, j] = 0.0
            if ball == 0:
                b[row] = limits[i]
                A[row, p] = 1.0 if kind == DEPTH else 0.0
            else:
                b[row] = 0.0
                A[row, p] = -1.0
            row += 1
            for a in range(d):
                b[row] = base[d * i + a]
                for j in range(p):
                    A[row, j] = -basis[d * i + a, j]
                A[row, p] = 0.0
                row += 1
            cone += 1
            first[cone] = row
    room.c[:unknowns] = 0.0
    if has_t:
        room.c[p] = -1.0 if kind in (DEPTH, FORCE) else 1.0
    if kind == SUM_NORMAL:
        for j in range(p):
            for i in range(n):
                for a in range(d):
                    room.c[j] += normals[i, a] * basis[d * i + a, j]
    return row, flat, unknowns


def solve(kind: int, n: int, d: int, p: int, normals: Any, tangents: Any, room: Room) -> bool:
    """The program of one kind from the x that is there; writes x, and whether it is solved."""
    rows, flat, unknowns = rows_of(kind, n, d, p, normals, tangents, room)
    cones = 0
    while room.first[cones] < rows:
        cones += 1
    first = room.first[: cones + 1]
    A, b, x, s, z = room.A, room.b, room.x, room.s, room.z
    worst = 0.0
    if unknowns > p:
        x[p] = 0.0
    for turn in range(2):  # t so far that everything is inside
        for i in range(rows):
            s[i] = b[i]
            for j in range(unknowns):
                s[i] -= A[i, j] * x[j]
        if turn == 1 or unknowns == p:
            break
        worst = inf
        for i in range(flat):
            worst = min(worst, s[i])
        for k in range(cones):
            size = 0.0
            for i in range(first[k] + 1, first[k + 1]):
                size += s[i] * s[i]
            worst = min(worst, s[first[k]] - sqrt(size))
        x[p] = min(worst, 0.0) - 1.0 if kind in (DEPTH, FORCE) else 1.0 - min(worst, 0.0)
    for i in range(flat):
        s[i] = max(s[i], 1e-3)
        z[i] = 1.0
    for k in range(cones):
        size = 0.0
        for i in range(first[k] + 1, first[k + 1]):
            size += s[i] * s[i]
            z[i] = 0.0
        size = sqrt(size)
        s[first[k]] = max(s[first[k]], size + 1e-3)
        z[first[k]] = 1.0
    weight = 2.0 if kind == EFFORT else 0.0
    done = minimise(
        weight, room.c, A, b, unknowns, rows, flat, first, x, s, z, room.vectors, room.h, room.scaled
    )
    return done == 1


def write_forces(n: int, d: int, p: int, room: Room, forces: Any) -> float:
    """Writes base + N x; the largest |f_i|."""
    largest = 0.0
    for i in range(n):
        size = 0.0
        for a in range(d):
            entry = room.base[d * i + a]
            for j in range(p):
                entry += room.basis[d * i + a, j] * room.x[j]
            forces[i, a] = entry
            size += entry * entry
        largest = max(largest, sqrt(size))
    return largest


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
    peak_ratio: float, n: int, d: int, room: Room, forces: Any, twist: Any,
) -> int:  # fmt: skip
    """Writes the best forces (n, d) in units of the load, or the twist (q,) of a refusal; the verdict.

    limits: (n,) in units of the load, infinite for none.
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
    depth = deepest(n, d, p, normals, tangents, room)
    if not depth > _CLEAR:
        write_twist(n, d, q, normals, tangents, room, twist)
        return NONE if depth < -_CLEAR else OPEN
    write_forces(n, d, p, room, room.deep)
    if is_loose and objective == FORCE:
        if not solve(PEAK, n, d, p, normals, tangents, room):
            return OPEN
        most = peak_ratio * write_forces(n, d, p, room, forces)
        for i in range(n):
            room.limits[i] = min(room.limits[i], most)
    if not solve(objective, n, d, p, normals, tangents, room):
        return OPEN
    write_forces(n, d, p, room, forces)
    return HELD if pulled_in(n, d, depth, normals, mu, limits, room.deep, forces) else OPEN
