"""Margins of one pair of points under many loads at a time.

What no load changes is computed once (``load_cone``). One pass over the loads, many at a time, then finds
those that the pair can hold, and only these go on to their margins (``turning_margin``), many at a time again.
A load at the very edge of what is held, or a margin that rounding may decide, is left to the formula of one
grasp (``choice``), compiled too.
"""

import numpy as np
from numba import njit

from regrasp.closed_form import load_cone, turning_margin
from regrasp.closed_form.choice import ANGLE
from regrasp.closed_form.compiled import MODULES, compiled
from regrasp.closed_form.compiled import names as one_grasp
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


@njit(error_model="numpy")
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


@njit(error_model="numpy", forceinline=True)
def _side(nx, ny, mu, fx, fy):  # type: ignore[no-untyped-def]
    return _angle_margin(nx * fx + ny * fy, abs(nx * fy - ny * fx), mu)


@njit(error_model="numpy", forceinline=True)
def _depths(fx, fy, x, y, result):  # type: ignore[no-untyped-def]
    """How far each load is inside the cone of four half-planes."""
    x1, x2, x3, x4, y1, y2, y3, y4 = x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3]
    for o in range(result.size):
        d1, d2 = x1 * fx[o] + y1 * fy[o], x2 * fx[o] + y2 * fy[o]
        d3, d4 = x3 * fx[o] + y3 * fy[o], x4 * fx[o] + y4 * fy[o]
        d1, d3 = d1 if d1 < d2 else d2, d3 if d3 < d4 else d4
        result[o] = d1 if d1 < d3 else d3


@njit(error_model="numpy")
def _margins_inside(fx, fy, batches, pair, limits, ratio, idle, result):  # type: ignore[no-untyped-def]
    turned, first, second = pair
    reach1, reach2 = _own_reach(first), _own_reach(second)
    for k in range(batches * _TOGETHER):
        result[k] = _turning_margin(
            fx[k], fy[k], turned, first, second, reach1, reach2, limits[0], limits[1], ratio, idle
        )


@njit(error_model="numpy")
def workspace_for(count):  # type: ignore[no-untyped-def]
    """Memory for one pair: half-planes, depths of all loads; chosen loads, their places and margins."""
    room = count + _TOGETHER
    return (
        np.empty(7), np.empty(7), np.empty(count),
        np.empty(room), np.empty(room), np.empty(room, np.int32), np.empty(room),
    )  # fmt: skip


@njit(error_model="numpy")
def held_loads(candidates, i, j, loads, workspace):  # type: ignore[no-untyped-def]
    """How many loads (x, y and size of each) a pair may hold.

    Their places, and their margins or ``NO_HOLD``, are then the last two of the workspace.
    """
    points, normals, mu, limits, ratio = candidates
    fx, fy, size = loads
    x, y, depth, gx, gy, place, margin = workspace
    turned, along1, along2, far = _pair_for_turning(
        points[i, 0], points[i, 1], normals[i, 0], normals[i, 1],
        points[j, 0], points[j, 1], normals[j, 0], normals[j, 1],
    )  # fmt: skip
    first, second = (along1[0], along1[1], mu[i]), (along2[0], along2[1], mu[j])
    if _half_planes(_cone_edges(turned, first, second), x, y) > 0:
        _depths(fx, fy, x, y, depth)
    else:
        depth[:] = np.inf
    band, count = _band(mu[i], mu[j], far), 0
    for o in range(depth.size):
        place[count] = o
        count += depth[o] > -band * size[o]
    if count == 0:
        return 0
    delicate = _is_delicate(first, second, far)
    if not delicate:
        batches = (count + _TOGETHER - 1) // _TOGETHER
        for k in range(batches * _TOGETHER):
            o = place[k] if k < count else place[0]
            gx[k], gy[k] = fx[o], fy[o]
        both = limits[i] < np.inf and limits[j] < np.inf
        _margins_inside(
            gx, gy, batches, (turned, first, second), (limits[i], limits[j]),
            np.inf if both else ratio, _idle_below(far), margin,
        )  # fmt: skip
    for k in range(count):
        o = place[k]
        if delicate or depth[o] <= band * size[o] or not margin[k] > UNSURE:
            margin[k] = _margin_of_one(candidates, i, j, fx[o], fy[o])
    return count


@njit(error_model="numpy")
def described(loads):  # type: ignore[no-untyped-def]
    """x, y and size of every load, each in one piece of memory."""
    fx, fy = loads[:, 0].copy(), loads[:, 1].copy()
    return fx, fy, np.abs(fx) + np.abs(fy)
