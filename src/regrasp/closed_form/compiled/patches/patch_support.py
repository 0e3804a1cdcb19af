"""The most work that a finger of a patch does along a twist: of all corners, but few of them looked at.

Let a group of faces have its corners within r of c and its normals within theta of a. sigma(v), the most of
v . f over forces f of size 1 (``patch_gauge``), is that of a body of forces within L of 0, so with
v_c = v_0 + omega x c it is at most

    sigma <= L |v_c| cos(max(0, |x| - theta)) + L |omega| r

where x is the angle from v_c to the edge of the cone about a, and 0 inside of it where |f| = 1; L is 1 there,
and sqrt(1 + mu^2) where n . f = 1. Groups are halved, and those below the largest found are left out.
"""

from math import sqrt

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS

FEW = 12
"""Rows of a patch, all of which are looked at."""
DEEP = 256
"""Groups that wait to be halved, one after another: twice as many as halvings of any surface go deep."""


@njit(**VIEWS)
def _velocity(row, y):  # type: ignore[no-untyped-def]
    """Of a place along a twist: along the normal, across it, and the speed across."""
    vx = y[0] + y[4] * row[2] - y[5] * row[1]
    vy = y[1] + y[5] * row[0] - y[3] * row[2]
    vz = y[2] + y[3] * row[1] - y[4] * row[0]
    along = vx * row[3] + vy * row[4] + vz * row[5]
    tx, ty, tz = vx - along * row[3], vy - along * row[4], vz - along * row[5]
    return along, tx, ty, tz, sqrt(tx * tx + ty * ty + tz * tz)


@njit(**VIEWS)
def _most(along, across, mu, size):  # type: ignore[no-untyped-def]
    """The most work of a force of size 1, and its slope to the normal."""
    if size == 1 and across <= mu * along:  # |f| = 1, in the direction of motion
        return sqrt(along * along + across * across), across / along if along > 0.0 else 0.0
    most = along + mu * across
    return most / sqrt(1.0 + mu * mu) if size == 1 else most, mu


@njit(**VIEWS)
def work(row, y, mu, size):  # type: ignore[no-untyped-def]
    """The most work of a force of size 1 along a twist, 0 if there is none."""
    along, _, _, _, across = _velocity(row, y)
    return max(_most(along, across, mu, size)[0], 0.0)


@njit(**VIEWS)
def sigma(row, y, mu, size, force):  # type: ignore[no-untyped-def]
    """The most work of a force of size 1 along a twist, and the force that does it."""
    along, tx, ty, tz, across = _velocity(row, y)
    most, slope = _most(along, across, mu, size)
    if most <= 0.0:
        force[0] = force[1] = force[2] = 0.0
        return 0.0
    length = 1.0 if size == 0 else 1.0 / sqrt(1.0 + slope * slope)
    share = slope / across if across > 0.0 else 0.0
    force[0] = (row[3] + share * tx) * length
    force[1] = (row[4] + share * ty) * length
    force[2] = (row[5] + share * tz) * length
    return most


@njit(**VIEWS)
def _below(ball, y, mu, size):  # type: ignore[no-untyped-def]
    """A bound of sigma over a group; see the module. ball: c, r, a, and cosine and sine of theta."""
    vx = y[0] + y[4] * ball[2] - y[5] * ball[1]
    vy = y[1] + y[5] * ball[0] - y[3] * ball[2]
    vz = y[2] + y[3] * ball[1] - y[4] * ball[0]
    speed = sqrt(vx * vx + vy * vy + vz * vz)
    along = vx * ball[4] + vy * ball[5] + vz * ball[6]
    across = sqrt(max(speed * speed - along * along, 0.0))
    length = sqrt(1.0 + mu * mu)
    cosine, sine = along + mu * across, across - mu * along  # of x, times L and the speed
    most = speed * length
    if cosine < ball[7] * most and (size == 0 or sine > 0.0):
        most = max(cosine * ball[7] + abs(sine) * ball[8], 0.0)
    most += ball[3] * length * sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5])
    return most if size == 0 else most / length


@njit(**VIEWS)
def largest(surface, patch, y, mu, size, best, stack, above, looked):  # type: ignore[no-untyped-def]
    """The largest sigma of a patch and its row; the force that does it in ``best``.

    surface: rows (R, 6), points and inward normals; spans (K, 2), first row and rows of each patch; tree
    (K, 3), its halves; balls (K, 9) of groups. looked: (1,) rows and groups looked at.
    """
    rows, spans, tree, balls = surface
    most, at, waiting = 0.0, spans[patch, 0], 1
    stack[0], above[0] = patch, np.inf
    while waiting > 0:
        waiting -= 1
        if above[waiting] <= most:
            continue
        one = stack[waiting]
        first, count = spans[one, 0], spans[one, 1]
        if count <= FEW:
            looked[0] += count
            for r in range(first, first + count):
                found = work(rows[r], y, mu, size)
                if found > most:
                    most, at = found, r
            continue
        looked[0] += 2
        left, right = tree[one, 0], tree[one, 1]
        less, more = _below(balls[left], y, mu, size), _below(balls[right], y, mu, size)
        if less > more:  # the half of more is looked at first
            left, right, less, more = right, left, more, less
        stack[waiting], above[waiting] = left, less
        stack[waiting + 1], above[waiting + 1] = right, more
        waiting += 2
    sigma(rows[at], y, mu, size, best)
    return most, at
