"""Margins of some pairs of points under many loads at a time.

What no load changes is computed once per pair (``load_cone``). One pass over the loads, many at a time, finds
those that the pair can hold, and only these go on to their margins (``turning_margin``), many at a time, too.
A load at the very edge of what is held, or a margin that rounding may decide, is left to the formula of one
grasp (``choice``), compiled as well.
"""

import numpy as np
from numba import njit

from regrasp.closed_form import load_cone, turning_margin
from regrasp.closed_form.choice import ANGLE
from regrasp.closed_form.compiled.compiling import INNER, compiled
from regrasp.closed_form.compiled.two_fingers import MODULES
from regrasp.closed_form.compiled.two_fingers import names as one_grasp
from regrasp.closed_form.turning_margin import NO_HOLD, UNSURE

_TOGETHER = 8  # margins of one vector instruction: work is done for so many even where fewer are asked for

FORMULAS = (*MODULES, load_cone, turning_margin)
"""Modules that are compiled here."""

# A product and a sum may be one instruction: nothing here depends on how they are rounded.
_turning = compiled((load_cone, turning_margin), fastmath={"contract"})
_pair_for_turning, _cone_edges, _half_planes = (
    _turning[name] for name in ("pair_for_turning", "cone_edges", "half_planes")
)
_own_reach, _is_delicate, _band, _idle_below, _turning_margin = (
    _turning[name] for name in ("own_reach", "is_delicate", "band", "idle_below", "turning_margin")
)
_best_squeeze, _angle_margin = one_grasp["best_squeeze"], one_grasp["margin_tangent"]
_arc_tangent = _turning["arc_tangent"]


@njit(**INNER)
def _margin_of_one(candidates, i, j, fx, fy):  # type: ignore[no-untyped-def]
    """Widest least angle margin of a pair under a force through the origin, or ``NO_HOLD``."""
    points, normals, mu, limits, ratio = candidates
    _, f, _ = _best_squeeze(
        points[i, 0], points[i, 1], normals[i, 0], normals[i, 1], mu[i],
        points[j, 0], points[j, 1], normals[j, 0], normals[j, 1], mu[j],
        fx, fy, 0.0, ANGLE, limits[i], limits[j], ratio,
    )  # fmt: skip
    if f[0] != f[0]:
        return NO_HOLD
    a = _side(normals[i, 0], normals[i, 1], mu[i], f[0], f[1])
    b = _side(normals[j, 0], normals[j, 1], mu[j], f[2], f[3])
    return _arc_tangent(max(min(a, b), 0.0), 1.0)


@njit(forceinline=True, **INNER)
def _side(nx, ny, mu, fx, fy):  # type: ignore[no-untyped-def]
    return _angle_margin(nx * fx + ny * fy, abs(nx * fy - ny * fx), mu)


@njit(forceinline=True, **INNER)
def _depths(fx, fy, size, band, x, y, depth, held):  # type: ignore[no-untyped-def]
    """How far each load is inside a cone of four half-planes, and whether it may be held: 1 or 0.

    Returns how many may be held, and how many are so near the edge, for their size, that rounding may decide.
    """
    x1, x2, x3, x4, y1, y2, y3, y4 = x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3]
    some, doubtful = 0, 0
    for o in range(fx.size):
        d1, d2 = x1 * fx[o] + y1 * fy[o], x2 * fx[o] + y2 * fy[o]
        d3, d4 = x3 * fx[o] + y3 * fy[o], x4 * fx[o] + y4 * fy[o]
        d1, d3 = d1 if d1 < d2 else d2, d3 if d3 < d4 else d4
        d = d1 if d1 < d3 else d3
        edge = band * size[o]
        depth[o] = d
        may = 1 if d > -edge else 0
        held[o] = may
        some += may
        doubtful += 1 if abs(d) <= edge else 0
    return some, doubtful


@njit(forceinline=True, **INNER)
def _margins(fx, fy, batches, pair, limited, limits, ratio, idle, result, start):  # type: ignore[no-untyped-def]
    """Writes margins from ``start`` on; how many of them are none, and left to the formula of one grasp."""
    turned, first, second = pair
    reach1, reach2 = _own_reach(first), _own_reach(second)
    left = 0
    for k in range(batches * _TOGETHER):
        m = _turning_margin(
            fx[k], fy[k], turned, first, second, reach1, reach2, limited, limits[0], limits[1], ratio, idle
        )
        result[start + k] = m
        left += 0 if m > UNSURE else 1
    return left


@njit(**INNER)
def _margins_inside(  # type: ignore[no-untyped-def]
    fx, fy, batches, pair, limits, ratio, idle, result, start
):
    """The loop of ``_margins``, compiled without limits, which saves two roots of five, and with them."""
    if limits[0] == np.inf and limits[1] == np.inf:
        return _margins(fx, fy, batches, pair, False, limits, ratio, idle, result, start)
    peak = ratio if limits[0] == np.inf or limits[1] == np.inf else np.inf
    return _margins(fx, fy, batches, pair, True, limits, peak, idle, result, start)


@njit(**INNER)
def workspace_for(pairs, count):  # type: ignore[no-untyped-def]
    """Memory for some pairs under ``count`` loads, as ``held_loads`` fills it."""
    room = pairs * count + _TOGETHER
    return np.empty(room, np.int32), np.empty(room, np.int32), np.empty(room)


@njit(**INNER)
def held_loads(  # type: ignore[no-untyped-def]
    candidates, first, second, begin, end, loads, pair, load, margin
):
    """How many loads the pairs from ``begin`` to ``end`` may hold; written are which pair, load and margin.

    A margin may also be ``NO_HOLD``. candidates: points, unit normals, frictions, limits (inf for none), peak
    ratio. loads: (2, O), none of them zero. The loop over pairs is in here, since Numba counts references to
    every array at every call, and threads would wait for one another to do so.
    """
    points, normals, mu, limits, ratio = candidates
    fx, fy = loads[0], loads[1]
    size = np.abs(fx) + np.abs(fy)
    x, y, depth, held = np.empty(7), np.empty(7), np.empty(fx.size), np.empty(fx.size, np.int64)
    gx, gy = np.empty(fx.size + _TOGETHER), np.empty(fx.size + _TOGETHER)
    start = 0
    for p in range(begin, end):
        i, j = first[p], second[p]
        turned, along1, along2, far = _pair_for_turning(
            points[i, 0], points[i, 1], normals[i, 0], normals[i, 1],
            points[j, 0], points[j, 1], normals[j, 0], normals[j, 1],
        )  # fmt: skip
        one, two = (along1[0], along1[1], mu[i]), (along2[0], along2[1], mu[j])
        band, stop, doubtful = _band(mu[i], mu[j], far), start, 0
        if _half_planes(_cone_edges(turned, one, two), x, y) > 0:
            some, doubtful = _depths(fx, fy, size, band, x, y, depth, held)
            if some == 0:
                continue
            for o in range(fx.size):
                load[stop] = o
                stop += held[o]
        else:
            for o in range(fx.size):
                load[stop + o], depth[o] = o, np.inf
            stop += fx.size
        delicate = _is_delicate(one, two, far)
        left = 0
        if not delicate:
            batches = (stop - start + _TOGETHER - 1) // _TOGETHER
            for k in range(batches * _TOGETHER):
                o = load[start + k] if start + k < stop else load[start]
                gx[k], gy[k] = fx[o], fy[o]
            left = _margins_inside(
                gx, gy, batches, (turned, one, two), (limits[i], limits[j]),
                ratio, _idle_below(far), margin, start,
            )  # fmt: skip
        for k in range(start, stop):
            pair[k] = p
        for k in range(start, stop if delicate or doubtful + left > 0 else start):
            o = load[k]
            if delicate or depth[o] <= band * size[o] or not margin[k] > UNSURE:
                margin[k] = _margin_of_one(candidates, i, j, fx[o], fy[o])
        start = stop
    return start
