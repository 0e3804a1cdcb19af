# mypy: allow-untyped-calls
"""Which constraints the least of a cost of forces touches; see ``face_newton``.

touched: (n, 4) whether a finger is idle, on its cone, at its limit, at t. sizes: (n, 3) of a force along the
normal, across it, in all. z: multipliers of the equations, in their order: balance, then finger by finger.
"""

import numpy as np

NONE, PEAK, PEAK_NORMAL, MARGIN = range(4)
"""What t is: nothing, the largest force, the largest normal force, the least distance to a cone (s = -1)."""

# Constraints nearer than this fraction of the largest force may be touched; the root of a solver's tolerance.
NEAR = 3e-5
# A force below this fraction of the largest is nothing, or the mark of a flat minimum.
TRACE = 1e-4
# What multipliers and forces may miss their signs by.
SIGN, OVER = 1e-9, 3e-11
# Of the largest force: what a finger pushes with that is no longer idle.
_SMALL = 1e-6


def measure(x, normals, sizes):  # type: ignore[no-untyped-def]
    """The ``sizes`` of forces."""
    n, w = normals.shape
    for i in range(n):
        along, square = 0.0, 0.0
        for k in range(w):
            along += x[w * i + k] * normals[i, k]
            square += x[w * i + k] ** 2
        across = 0.0
        for k in range(w):
            across += (x[w * i + k] - along * normals[i, k]) ** 2
        sizes[i, 0], sizes[i, 1], sizes[i, 2] = along, np.sqrt(across), np.sqrt(square)


def shared(sizes, frictions, kind):  # type: ignore[no-untyped-def]
    """The t of forces."""
    t = 0.0
    if kind == PEAK:
        t = sizes[:, 2].max()
    if kind == PEAK_NORMAL:
        t = sizes[:, 0].max()
    if kind == MARGIN:
        t = np.inf
        for i in range(frictions.size):
            if frictions[i] > 0:
                mu = frictions[i]
                t = min(t, (mu * sizes[i, 0] - sizes[i, 1]) / np.sqrt(1 + mu * mu))
    return t if t < np.inf else 0.0


def guess(t, sizes, frictions, limits, kind, touched):  # type: ignore[no-untyped-def]
    """What is touched, by how near it is."""
    for i in range(frictions.size):
        touched[i, 0] = sizes[i, 2] < TRACE and kind != MARGIN
        if touched[i, 0]:
            continue
        touched[i, 1] = frictions[i] > 0 and abs(beyond(t, sizes[i], frictions[i], kind)) < NEAR
        touched[i, 2] = abs(sizes[i, 2] - limits[i]) < NEAR
        touched[i, 3] = (kind == PEAK and t - sizes[i, 2] < NEAR) or (
            kind == PEAK_NORMAL and t - sizes[i, 0] < NEAR
        )


def beyond(t, size, mu, kind):  # type: ignore[no-untyped-def]
    """How far a force is outside its cone, or the part of it that t leaves."""
    return size[1] - mu * size[0] + (t * np.sqrt(1 + mu * mu) if kind == MARGIN else 0.0)


def equations(touched, frictions, r, w):  # type: ignore[no-untyped-def]
    """The number of equations."""
    rows = r
    for i in range(frictions.size):
        if touched[i, 0]:
            rows += w
        else:
            rows += (w if frictions[i] == 0 else 0) + touched[i, 1] + touched[i, 2] + touched[i, 3]
    return rows


def corrected(x, z, touched, sizes, matrix, normals, frictions, limits, squares, linear, kind):  # type: ignore[no-untyped-def]
    """Whether equations had to be dropped or added."""
    n, w = normals.shape
    r = matrix.shape[0]
    largest = SIGN * max(1.0, np.abs(z).max())
    t = x[-1]
    row, worst, at, what = r, -largest, -1, 0
    changed = False
    across = np.zeros(w)
    for i in range(n):
        if touched[i, 0]:
            along, square = 0.0, 0.0  # of the pull that keeps the finger idle
            for k in range(w):
                along -= z[row + k] * normals[i, k]
            for k in range(w):
                across[k] = -z[row + k] - along * normals[i, k]
                square += across[k] ** 2
            row += w
            if along - frictions[i] * np.sqrt(square) < worst:
                worst, at, what = along - frictions[i] * np.sqrt(square), i, 0
            continue
        row += w if frictions[i] == 0 else 0
        for part in range(1, 4):
            if touched[i, part]:
                if z[row] < worst:
                    worst, at, what = z[row], i, part
                row += 1
        if sizes[i, 0] < 0 and kind != MARGIN:
            touched[i] = False
            touched[i, 0] = True
            changed = True
            continue
        over = np.array(
            [
                0.0,
                beyond(t, sizes[i], frictions[i], kind) if frictions[i] > 0 else 0.0,
                sizes[i, 2] - limits[i],
                sizes[i, 2] - t if kind == PEAK else (sizes[i, 0] - t if kind == PEAK_NORMAL else 0.0),
            ]
        )
        for part in range(1, 4):
            if not touched[i, part] and over[part] > OVER:
                touched[i, part] = True
                changed = True
    if not changed and at >= 0:
        changed = True
        touched[at, what] = False
        if what == 0:  # it pushes where the object gives way most
            row = r
            for i in range(at):
                if touched[i, 0]:
                    row += w
                else:
                    row += (w if frictions[i] == 0 else 0) + touched[i, 1] + touched[i, 2] + touched[i, 3]
            along, square = 0.0, 0.0
            for k in range(w):
                along -= z[row + k] * normals[at, k]
            for k in range(w):
                across[k] = -z[row + k] - along * normals[at, k]
                square += across[k] ** 2
            touched[at, 1] = frictions[at] > 0 and square > 0
            for k in range(w):
                lean = frictions[at] * across[k] / np.sqrt(square) if square > 0 else 0.0
                x[w * at + k] = _SMALL * (normals[at, k] - lean)
    return changed
