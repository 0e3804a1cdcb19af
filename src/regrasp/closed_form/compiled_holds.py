"""Holds by the million: margins of every pair of points under every load direction, and steps between holds.

For each pair, what no load changes is computed once (``load_cone``). One pass over the loads, many at a time,
then finds those that the pair can hold, and only these go on to their margins (``turning_margin``), many at a
time again. A load at the very edge of what is held, or a margin that rounding may decide, is left to the
formula of one grasp (``choice``), compiled too.
"""

from typing import Any

import numpy as np
from numba import njit, prange

from regrasp.closed_form import load_cone, turning_margin
from regrasp.closed_form.choice import ANGLE
from regrasp.closed_form.compiled import MODULES, compiled, digest
from regrasp.closed_form.compiled import names as one_grasp
from regrasp.closed_form.turning_margin import NO_HOLD, UNSURE

_BLOCK = 16  # pairs whose margins share a cache line
STRETCH = 4096
"""Pairs that a thread takes at a time where only the widest margin of each is kept."""
_TOGETHER = 8  # margins of one vector instruction: work is done for so many even where fewer are asked for

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
def _workspace(count):  # type: ignore[no-untyped-def]
    """Memory for one pair: half-planes, depths of all loads; chosen loads, their places and margins."""
    room = count + _TOGETHER
    return (
        np.empty(7), np.empty(7), np.empty(count),
        np.empty(room), np.empty(room), np.empty(room, np.int32), np.empty(room),
    )  # fmt: skip


@njit(error_model="numpy")
def _held(candidates, i, j, loads, workspace):  # type: ignore[no-untyped-def]
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
        if delicate or depth[o] <= band * size[o] or margin[k] == UNSURE:
            margin[k] = _margin_of_one(candidates, i, j, fx[o], fy[o])
    return count


@njit(error_model="numpy")
def _described(loads):  # type: ignore[no-untyped-def]
    """x, y and size of every load, each in one piece of memory."""
    fx, fy = loads[:, 0].copy(), loads[:, 1].copy()
    return fx, fy, np.abs(fx) + np.abs(fy)


def _loops(sources: str) -> tuple[Any, Any]:
    @njit(error_model="numpy", parallel=True, cache=True)
    def margins(first, second, loads, candidates, result):  # type: ignore[no-untyped-def]
        """The margin of each pair under each load.

        candidates: points, unit normals, frictions, limits (inf for none), peak ratio. No load is zero.
        """
        _ = sources
        described = _described(loads)
        for block in prange((first.size + _BLOCK - 1) // _BLOCK):
            begin, end = block * _BLOCK, min((block + 1) * _BLOCK, first.size)
            for o in range(len(loads)):
                for p in range(begin, end):
                    result[o, p] = NO_HOLD
            workspace = _workspace(len(loads))
            places, found = workspace[5], workspace[6]
            for p in range(begin, end):
                for k in range(_held(candidates, first[p], second[p], described, workspace)):
                    result[places[k], p] = found[k]

    @njit(error_model="numpy", parallel=True, cache=True)
    def widest(  # type: ignore[no-untyped-def]
        first, second, loads, candidates, allowed, place, best, where, counts
    ):
        _ = sources
        described = _described(loads)
        each = 1 if len(allowed) > 1 else 0
        for stretch in prange(len(counts)):
            workspace = _workspace(len(loads))
            places, found = workspace[5], workspace[6]
            for p in range(stretch * STRETCH, min((stretch + 1) * STRETCH, first.size)):
                if allowed[:, p].any():
                    for k in range(_held(candidates, first[p], second[p], described, workspace)):
                        o, m = places[k], np.float32(found[k])
                        if m >= 0.0 and allowed[each * o, p]:
                            counts[stretch, o] += 1
                            if m > best[p]:
                                best[p], where[p] = m, place + o

    return margins, widest


hold_margins, _widest = _loops(digest((*MODULES, load_cone, turning_margin)))


def widest_margins(
    first: np.ndarray,
    second: np.ndarray,
    loads: np.ndarray,
    candidates: tuple[Any, ...],
    allowed: np.ndarray,
    place: int,
    best: np.ndarray,
    where: np.ndarray,
    counts: np.ndarray,
) -> None:
    """Widens the best margins of allowed pairs by these loads, the first of them number ``place``.

    allowed: (pairs,) under all loads, or (loads, pairs). A pair is prepared once for all loads of a call, so
    many loads at a time are faster. counts (stretches, loads): how many pairs of a stretch hold, to be summed
    over the stretches.
    """
    _widest(first, second, loads, candidates, np.atleast_2d(allowed), place, best, where, counts)


@njit(error_model="numpy", parallel=True, cache=True)
def relaxed(first, second, margins, reach, result):  # type: ignore[no-untyped-def]
    """Widest least margin of a path that ends in a hold with each point, one exchange further.

    reach (orientations, points): of a path to a hold with that point, from which the object may turn to that
    orientation. A hold is entered over either of its points, and lends its value to both.
    """
    for o in prange(len(margins)):
        for p in range(first.size):
            m = margins[o, p]
            if m >= 0.0:
                i, j = first[p], second[p]
                value = min(max(reach[o, i], reach[o, j]), m)
                if value > result[o, i]:
                    result[o, i] = value
                if value > result[o, j]:
                    result[o, j] = value


def pairs_of(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Every pair i < j of ``count`` points, (count (count - 1) / 2,) each, by i and then by j."""
    first, second = np.triu_indices(count, 1)
    return first.astype(np.int32), second.astype(np.int32)
