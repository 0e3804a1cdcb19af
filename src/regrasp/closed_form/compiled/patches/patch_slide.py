"""Fingers that slide over a surface of triangles to where less force is needed."""

from math import sqrt
from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS, digest
from regrasp.closed_form.compiled.patches import patch_gauge, patch_search, patch_support
from regrasp.closed_form.compiled.patches.patch_gauge import bound_by
from regrasp.closed_form.compiled.patches.patch_search import value_of
from regrasp.closed_form.compiled.places import placement_search
from regrasp.compilation import kept

_WAYS, _TOGETHER = 8, 24  # directions in which one finger is moved, and moves of all


@njit(**VIEWS)
def _foot(rows, one, p, foot):  # type: ignore[no-untyped-def]
    """The point of a triangle nearest to p, and the square of its distance (Ericson, 2004, 5.1.5)."""
    ab, ac, u, v = 0.0, 0.0, 0.0, 0.0
    bb, bc, cc = 0.0, 0.0, 0.0
    for c in range(3):
        a, e, f = rows[one, c], rows[one + 1, c] - rows[one, c], rows[one + 2, c] - rows[one, c]
        ab += e * (p[c] - a)
        ac += f * (p[c] - a)
        bb += e * e
        bc += e * f
        cc += f * f
    det = bb * cc - bc * bc
    u, v = (cc * ab - bc * ac) / det, (bb * ac - bc * ab) / det
    if u < 0.0 or v < 0.0 or u + v > 1.0:  # the nearest of the three edges' nearest points
        least, bu, bv = np.inf, 0.0, 0.0
        for edge in range(3):
            if edge == 0:
                s = min(max(ab / bb, 0.0), 1.0)
                tu, tv = s, 0.0
            elif edge == 1:
                s = min(max(ac / cc, 0.0), 1.0)
                tu, tv = 0.0, s
            else:
                s = min(max((ac - ab + bb - bc) / (bb - 2.0 * bc + cc), 0.0), 1.0)
                tu, tv = 1.0 - s, s
            away = bb * tu * tu + 2.0 * bc * tu * tv + cc * tv * tv - 2.0 * (ab * tu + ac * tv)
            if away < least:
                least, bu, bv = away, tu, tv
        u, v = bu, bv
    away = 0.0
    for c in range(3):
        a, e, f = rows[one, c], rows[one + 1, c] - rows[one, c], rows[one + 2, c] - rows[one, c]
        foot[c] = a + u * e + v * f
        away += (foot[c] - p[c]) ** 2
    return away


@njit(**VIEWS)
def _put(rows, triangles, p, spot, foot):  # type: ignore[no-untyped-def]
    """Writes the place of the surface nearest to p and its normal."""
    least = np.inf
    for t in range(triangles):
        away = _foot(rows, 3 * t, p, foot)
        if away < least:
            least = away
            for c in range(3):
                spot[c], spot[3 + c] = foot[c], rows[3 * t, 3 + c]


@njit(**VIEWS)
def _no_less(spots, loads, law, value, twists, spare):  # type: ignore[no-untyped-def]
    """Whether twists (L, 6), of each load or 0, prove that fingers at spots need no less than ``value``."""
    mu, size, norm, _ = law
    surface = (spots, spare[9], spare[10], spare[11])
    for load in range(len(loads)):
        if bound_by(surface, spare[3], loads[load], twists[load], mu, size, norm, spare[8][:16]) >= value:
            return True
    return False


def _loop(digest: str) -> Any:
    @kept("sliding fingers over surfaces", error_model="numpy", _nrt=False)
    def slide(  # type: ignore[no-untyped-def]
        rows, triangles, loads, law, least, step, shortest, spots, value, trial, scratch, twists, spare
    ):
        """Moves spots (k, 6) while that lowers ``value``, computed if infinite, which it returns.

        Steps of ``step`` in eight directions along the face, of one finger and of all, are halved where none
        helps, to ``shortest``. twists: (L, 6) zeros, which become those that last said of each load what a
        place needs: most trials beside it are no better by one of them, and need no more than a look.
        """
        _ = digest
        k = len(spots)
        p, foot, chance, worst = scratch[0], scratch[1], 0.5, 0
        if value == np.inf:
            value, _ = value_of(spots, loads, law, value, worst, least, spare)
        while step > shortest:
            helped = False
            for move in range(_WAYS * k + _TOGETHER):
                for j in range(k):
                    for c in range(6):
                        trial[j, c] = spots[j, c]
                for i in range(k):
                    turn = 0.7853981633974483 * (move % _WAYS)
                    if move >= _WAYS * k:  # all of them, each some way: along valleys between loads
                        chance = (chance * 0.7548776662466927 + 0.5698402909980532) * 997.0 % 1.0
                        turn = 6.283185307179586 * chance
                    elif move // _WAYS != i:
                        continue
                    n = spots[i, 3:6]
                    axis = 0
                    for c in range(3):
                        if abs(n[c]) < abs(n[axis]):
                            axis = c
                    # u = e - (e.n) n and v = n x u
                    length = sqrt(1.0 - n[axis] * n[axis])
                    cs, sn = np.cos(turn) * step / length, np.sin(turn) * step / length
                    for c in range(3):
                        u = (1.0 if c == axis else 0.0) - n[axis] * n[c]
                        a, b = (c + 1) % 3, (c + 2) % 3
                        v = n[a] * (1.0 if b == axis else 0.0) - n[b] * (1.0 if a == axis else 0.0)
                        p[c] = spots[i, c] + cs * u + sn * v
                    _put(rows, triangles, p, trial[i], foot)
                if _no_less(trial, loads, law, value, twists, spare):
                    continue
                found, load = value_of(trial, loads, law, value, worst, least, spare)
                if load >= 0:
                    worst = load
                    for c in range(6):
                        twists[worst, c] = spare[7][c]
                if found < value * (1.0 - 1e-9):
                    value, helped = found, True
                    for j in range(k):
                        for c in range(6):
                            spots[j, c] = trial[j, c]
            if not helped:
                step *= 0.5
        return value

    return slide


# Numba's cache watches this file only; the digest in the loop's closure makes it watch these, too.
slide = _loop(digest((patch_gauge, patch_search, patch_support, placement_search)))
