"""The forces of one grasp as a program in the forces that squeeze only, written into given memory and solved.

Forces are f = base + N x, base the least ones that balance the load and N an orthonormal basis of those with
G f = 0, so that equilibrium costs no rows and the effort is |x|^2 but for a constant. In units of the load:

    DEPTH        maximise t,  mu n.f - |f_t| >= t weight,  |f| <= limit - t
    FORCE        maximise t,  the same,  |f| <= limit
    LEVEL        maximise t,  the same,  n.f >= 0, which cones without friction leave open
    EFFORT       minimise |x|^2
    PEAK         minimise t,  |f| <= t
    PEAK_NORMAL  minimise t,  n.f <= t
    SUM_NORMAL   minimise sum n.f

With weight sqrt(1 + mu^2) the depth is a distance.
"""

from math import inf, sqrt
from typing import Any

from regrasp.closed_form.choice import EFFORT, FORCE, PEAK, PEAK_NORMAL, SUM_NORMAL
from regrasp.closed_form.conic.balance import Room
from regrasp.closed_form.conic.cone_program import minimise

DEPTH, LEVEL = -1, -2


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
            for side in (-1.0, 1.0):
                gx = mu[i] * normals[i, 0] + side * tangents[i, 0, 0]
                gy = mu[i] * normals[i, 1] + side * tangents[i, 0, 1]
                b[row] = gx * base[2 * i] + gy * base[2 * i + 1]
                for j in range(p):
                    A[row, j] = -(gx * basis[2 * i, j] + gy * basis[2 * i + 1, j])
                A[row, p] = room.weights[i] if kind in (DEPTH, FORCE, LEVEL) else 0.0
                row += 1
    if kind in (PEAK_NORMAL, LEVEL):
        sign = 1.0 if kind == PEAK_NORMAL else -1.0
        for i in range(n):
            b[row] = 0.0
            for a in range(d):
                b[row] -= sign * normals[i, a] * base[d * i + a]
            for j in range(p):
                A[row, j] = 0.0
                for a in range(d):
                    A[row, j] += sign * normals[i, a] * basis[d * i + a, j]
            A[row, p] = -1.0 if kind == PEAK_NORMAL else 0.0
            row += 1
    flat, cone = row, 0
    first[0] = row
    if d == 3:
        for i in range(n):
            for part in range(3):
                b[row] = 0.0
                for j in range(p + 1):
                    A[row, j] = 0.0
                for a in range(3):
                    g = mu[i] * normals[i, a] if part == 0 else tangents[i, part - 1, a]
                    b[row] += g * base[3 * i + a]
                    for j in range(p):
                        A[row, j] -= g * basis[3 * i + a, j]
                if part == 0 and kind in (DEPTH, FORCE, LEVEL):
                    A[row, p] = room.weights[i]
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
        room.c[p] = -1.0 if kind in (DEPTH, FORCE, LEVEL) else 1.0
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
        x[p] = min(worst, 0.0) - 1.0 if kind in (DEPTH, FORCE, LEVEL) else 1.0 - min(worst, 0.0)
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
