"""The most work of fingers along motions that are affine in all of their places, at the corners of a box.

Under each of L loads finger i moves by u = still + sum_j move_ij p_j, a force of at most 1 of it is between
two rays of length 1 that belong to the edge it is on, and does the most of u . f. The sum over fingers and
loads is convex in the places while all stay on their edges: so corners tell, of every edge with its own rays.
"""

from math import sqrt

from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS
from regrasp.compilation import kept


@njit(**VIEWS)
def _most(ray, x, y):  # type: ignore[no-untyped-def]
    """Of a force between two rays, less than half a turn from the first to the other, along (x, y)."""
    ax, ay, bx, by = ray[0, 0], ray[0, 1], ray[1, 0], ray[1, 1]
    a, b = ax * x + ay * y, bx * x + by * y
    if ax * y >= ay * x and x * by >= y * bx and a + b > 0.0:
        return sqrt(x * x + y * y)
    return max(a, b, 0.0)


@njit(**VIEWS)
def _corners(move, still, points, rays, counts, limit, sums, at, worst):  # type: ignore[no-untyped-def]
    """The most work at any corner, and where (``worst``); of one that is above a limit, if there is one."""
    k, loads = len(counts), len(still)
    for i in range(k):
        at[i] = 0
        for d in range(loads):
            sums[0, i, d, 0], sums[0, i, d, 1] = still[d, 0], still[d, 1]
    best, moved = -1.0, 0
    while True:
        for j in range(moved, k):
            x, y = points[j, at[j], 0], points[j, at[j], 1]
            for i in range(k):
                for d in range(loads):
                    m = move[d, i, j]
                    sums[j + 1, i, d, 0] = sums[j, i, d, 0] + m[0, 0] * x + m[0, 1] * y
                    sums[j + 1, i, d, 1] = sums[j, i, d, 1] + m[1, 0] * x + m[1, 1] * y
        done = 0.0
        for i in range(k):
            ray = rays[i, at[i]]
            for d in range(loads):
                done += _most(ray, sums[k, i, d, 0], sums[k, i, d, 1])
        if done > best:
            best = done
            for i in range(k):
                worst[i] = at[i]
            if best > limit:
                return best
        moved = k - 1
        while moved >= 0 and at[moved] == counts[moved] - 1:
            at[moved] = 0
            moved -= 1
        if moved < 0:
            return best
        at[moved] += 1


@kept("what fingers of equal stiffness withstand", error_model="numpy", _nrt=False)
def most_at_corners(moves, stills, limits, order, points, rays, counts, sums, at, worst):  # type: ignore[no-untyped-def]
    """The first of some motions whose work is within its limit at all corners, and that work; or -1.

    moves: (P, L, k, k, 2, 2), stills: (P, L, 2), limits: (P,) of their work. order: which are tried. points:
    (k, T, 2) that each finger may be at, of which ``counts`` (k,) count. rays: (k, T, 2, 2) there. sums:
    (k + 1, k, L, 2) and at: (k,) scratch. worst: (k,) where the last one that was tried does the most, or
    too much.
    """
    done = -1.0
    for n in order:
        done = _corners(moves[n], stills[n], points, rays, counts, limits[n], sums, at, worst)
        if done <= limits[n]:
            return n, done
    return -1, done
