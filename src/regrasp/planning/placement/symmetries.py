"""By which turns and reflections an outline and its loads are what they were.

A symmetry takes edge e to edge e + j, or backwards to edge j - 1 - e: in u, the number of an edge plus the
fraction of it passed, u to u + j or j - u.
"""

import numpy as np

from regrasp.mechanics.checks import Array

_CLOSE = 1e-9
_MOST = 4096  # vertices beyond which none are looked for


def images(points: Array, loads: Array, u: Array) -> Array:
    """(i, k) what symmetries make of places u (k,), themselves first.

    points: (m, 2) vertices, or (m, 3, 2) the control points but the last of cubic edges, about the centre of
    mass. loads: (L, 3), which have to be the same set after each.
    """
    m, thirds = len(points), points.reshape(len(points), -1, 2)
    found = [u]
    if m > _MOST:
        return u[None]
    ring = thirds.reshape(-1, 2) @ [1.0, 1.0j]  # one complex number after the other
    per = thirds.shape[1]
    size = np.abs(ring).max()
    at = int(np.abs(ring[::per]).argmax())  # a vertex away from the centre
    first = np.roll(ring, -per * at)
    same = np.abs(np.abs(ring[::per]) - np.abs(first[0])) <= _CLOSE * size
    for end in np.flatnonzero(same).tolist():
        turned = np.roll(ring, -per * end)
        for mirrored in (False, True):
            image = np.roll(turned[::-1], 1) if mirrored else turned
            start = np.conj(first) if mirrored else first
            turn = image[0] / start[0]
            if np.abs(image - turn * start).max() > _CLOSE * size:
                continue
            if (end != at or mirrored) and _keeps(loads, turn / abs(turn), mirrored, size):
                found.append(((end + at) - u if mirrored else u + (end - at)) % m)
    return np.array(found)


def _keeps(loads: Array, turn: complex, mirrored: bool, size: float) -> bool:
    """Whether a set of loads is the same afterwards."""
    force, torque = loads[:, :2] @ [1.0, 1.0j], loads[:, 2] / size
    moved = turn * (np.conj(force) if mirrored else force)
    turned = -torque if mirrored else torque
    off = np.abs(moved[:, None] - force) + np.abs(turned[:, None] - torque)
    return bool(off.min(axis=1).max() <= _CLOSE * (np.abs(force) + np.abs(torque)).max())
