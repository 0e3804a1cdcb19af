"""The forces that balance a load: the least ones, and a basis of those that squeeze only, in given memory."""

from math import sqrt
from typing import Any, NamedTuple

_FLAT = 1e-9


class Room(NamedTuple):
    """Arrays that one grasp after the other is written into, for n contacts of d numbers and q loads.

    qr: (nd, q). tau: (q,). basis: (nd, nd). base: (nd,). A: (rows, nd + 1). b, s, z: (rows,). c, x, start:
    (nd + 1,). first: (3n + 2,). vectors: (12, rows). h: (nd + 1, nd + 1). scaled: (rows, nd + 1). mu, limits:
    (n,). weights: (n,) how deep in a cone a unit of depth is. deep,
    trial: (n, d) forces well inside, and of the last step.
    """

    qr: Any
    tau: Any
    basis: Any
    base: Any
    A: Any
    b: Any
    s: Any
    z: Any
    c: Any
    x: Any
    first: Any
    vectors: Any
    h: Any
    scaled: Any
    mu: Any
    limits: Any
    weights: Any
    deep: Any
    trial: Any
    start: Any


def split(matrix: Any, load: Any, count: int, q: int, room: Room) -> bool:
    """Writes base and basis from G (q, count) by Householder's reflections; False where G is flat."""
    qr, tau, basis, base = room.qr, room.tau, room.basis, room.base
    size = 0.0
    for i in range(count):
        for k in range(q):
            qr[i, k] = matrix[k, i]
            size = max(size, abs(matrix[k, i]))
    diagonal = room.vectors[0]
    for k in range(q):
        norm = 0.0
        for i in range(k, count):
            norm += qr[i, k] * qr[i, k]
        norm = sqrt(norm)
        if not norm > _FLAT * size:
            return False
        alpha = -norm if qr[k, k] > 0.0 else norm
        diagonal[k] = alpha
        qr[k, k] -= alpha
        inner = 0.0
        for i in range(k, count):
            inner += qr[i, k] * qr[i, k]
        tau[k] = 2.0 / inner
        for j in range(k + 1, q):
            reflect(qr, k, tau[k], qr, j, count)
    for i in range(q):  # R' y = -w
        entry = -load[i]
        for k in range(i):
            entry -= qr[k, i] * room.vectors[1][k]
        room.vectors[1][i] = entry / diagonal[i]
    for j in range(count - q + 1):
        for i in range(count):
            basis[i, j] = 0.0
        if j < count - q:
            basis[q + j, j] = 1.0
        else:
            for i in range(q):
                basis[i, j] = room.vectors[1][i]
        for k in range(q - 1, -1, -1):
            reflect(qr, k, tau[k], basis, j, count)
    for i in range(count):
        base[i] = basis[i, count - q]
    for k in range(q):
        tau[k] = diagonal[k] if diagonal[k] != 0.0 else 1.0
    return True


def reflect(qr: Any, k: int, share: float, at: Any, j: int, count: int) -> None:
    """The k-th reflection of column j of ``at``."""
    inner = 0.0
    for i in range(k, count):
        inner += qr[i, k] * at[i, j]
    inner *= share
    for i in range(k, count):
        at[i, j] -= inner * qr[i, k]
