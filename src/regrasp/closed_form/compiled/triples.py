"""Holds of three fingers by the million, compiled by Numba from the functions of ``three_fingers``.

A triple is prepared once and meets one load after the other. The four rows that refuted a load are kept as
the motion of the object that they belong to (see ``rigid_motion``): whatever does positive work along it,
more than force limits allow against it, cannot be held either. Most loads are refuted by a motion that is
known already, with one scalar product; the others start from the last basis.
"""

from math import comb, sqrt
from types import FunctionType
from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form import (
    dual_simplex,
    pyramid,
    three_fingers,
    triple,
    triple_extremes,
    triple_program,
)
from regrasp.closed_form.compiled.compiling import compiled, digest
from regrasp.closed_form.compiled.sharing import shared
from regrasp.closed_form.three_fingers import HOLDS, NO_STATE
from regrasp.closed_form.triple_program import Fingers

_MODULES = (triple, pyramid, dual_simplex, triple_program, triple_extremes, three_fingers)
_BLOCK = 64  # triples that a thread takes at a time
_KEPT = 8  # motions kept per triple
PATIENCE = 8_000
"""Margins that are interpreted, half a millisecond each or less: then compiling, 6 s, pays."""
_asked = 0
_SURE = 2.0**-40  # of the work's terms: less than this is rounding
_NO_PUSH = 2.0**-50

NO_HOLD, NO_TRIANGLE, NOT_DECIDED = -1.0, -2.0, -3.0
"""In the place of a margin: proven not to hold; points on a line or not allowed; left open by rounding."""


_names = compiled(_MODULES, inline=False)
_triple_frame, _centroid_moment = _names["triple_frame"], _names["centroid_moment"]
_rigid_motion, _dot, _plus = _names["rigid_motion"], _names["dot"], _names["plus"]
_workspace, _write_triple, _judged = _names["workspace"], _names["write_triple"], _names["judged"]
_LIMITS, _PUSHES, _FACETS = triple_program.LIMITS, triple_program.PUSHES, triple_program.FACETS
_COLLINEAR = triple.COLLINEAR

# Numba's cache watches this file only; the digest in the loops' closures makes it watch the formulas too.
_digest = digest(_MODULES)


@njit(error_model="numpy")
def _keep_motion(work, frame, fingers, cos_half, answer, place):  # type: ignore[no-untyped-def]
    """Keeps the motion behind a refutation, (v, omega, work of the limits, |v|, |omega|); False without one.

    A bound of the squeezes, or a weight with the wrong sign, proves something about this load only.
    """
    normals, mu, limits = fingers.normals, fingers.usable_mu, fingers.usable_limits
    facets = work.tangents.shape[1] // 3
    a = [(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)]
    allowance = 0.0
    for c in range(4):
        row = answer[1] if c == 3 else work.basis[c]
        weight = 1.0 if c == 3 else -answer[4][c]
        if abs(weight) <= _NO_PUSH:
            continue
        if weight < 0.0 or row < _LIMITS:
            return False
        if row < _PUSHES:
            i = row - _LIMITS
            a[i] = _plus(a[i], -weight, normals[i])
            allowance += weight * limits[i] / sqrt(1.0 + mu[i] * mu[i])
        elif row < _FACETS:
            i = row - _PUSHES
            a[i] = _plus(a[i], weight, normals[i])
        else:
            at = row - _FACETS
            i = at // facets
            t = (work.tangents[0, at], work.tangents[1, at], work.tangents[2, at])
            a[i] = _plus(_plus(a[i], weight * cos_half * mu[i], normals[i]), -weight, t)
    v, omega = _rigid_motion(frame, (a[0], a[1], a[2]))
    place[0], place[1], place[2] = v
    place[3], place[4], place[5] = omega
    place[6], place[7], place[8] = allowance, sqrt(_dot(v, v)), sqrt(_dot(omega, omega))
    return True


@njit(error_model="numpy")
def _is_refuted(motions, count, force, moment):  # type: ignore[no-untyped-def]
    """Whether the load does more work along one of the motions than force limits allow."""
    size, turn = sqrt(_dot(force, force)), sqrt(_dot(moment, moment))
    for c in range(count):
        m = motions[c]
        done = m[0] * force[0] + m[1] * force[1] + m[2] * force[2]
        done += m[3] * moment[0] + m[4] * moment[1] + m[5] * moment[2]
        if done - m[6] > _SURE * (m[7] * size + m[8] * turn + m[6]):
            return True
    return False


def _loop(digest: str) -> Any:
    @shared("the holds of three fingers", error_model="numpy")
    def margins(  # type: ignore[no-untyped-def]
        start, stop, triples, allowed, points, normals, frictions, limits, loads, angles, cos_half,
        peak_ratio, with_margin, result,
    ):  # fmt: skip
        """Margins (O, T) of triples (T, 3) under loads (O, 6); frictions and limits (2, N), usable last.

        Where the result is ``NO_HOLD`` already it stays so.
        """
        _ = digest
        for block in range(start, stop):
            work = _workspace(len(angles))
            motions = np.zeros((_KEPT, 9))
            for p in range(block * _BLOCK, min((block + 1) * _BLOCK, len(triples))):
                i, j, k = triples[p]
                fingers = Fingers(
                    (_vector(points, i), _vector(points, j), _vector(points, k)),
                    (_vector(normals, i), _vector(normals, j), _vector(normals, k)),
                    (frictions[0, i], frictions[0, j], frictions[0, k]),
                    (limits[0, i], limits[0, j], limits[0, k]),
                    (frictions[1, i], frictions[1, j], frictions[1, k]),
                    (limits[1, i], limits[1, j], limits[1, k]),
                )
                frame = _triple_frame(fingers.points[0], fingers.points[1], fingers.points[2])
                if not (allowed[p] and frame[7] > _COLLINEAR):
                    for o in range(len(loads)):
                        result[o, p] = NO_TRIANGLE
                    continue
                _write_triple(work, frame, fingers.normals, angles)
                found = 0
                for o in range(len(loads)):
                    if result[o, p] == NO_HOLD:
                        continue
                    force = (loads[o, 0], loads[o, 1], loads[o, 2])
                    torque = (loads[o, 3], loads[o, 4], loads[o, 5])
                    moment = _centroid_moment(frame, force, torque)
                    if _is_refuted(motions, min(found, _KEPT), force, moment):
                        result[o, p] = NO_HOLD
                        continue
                    hold, answer = _judged(
                        work, frame, fingers, force, torque, moment, cos_half, peak_ratio, with_margin
                    )
                    if hold[0] == HOLDS:
                        result[o, p] = np.arctan(hold[1])
                    elif hold[0] == NO_STATE:
                        result[o, p] = NO_HOLD
                        place = motions[found % _KEPT]
                        found += _keep_motion(work, frame, fingers, cos_half, answer, place)
                    else:
                        result[o, p] = NOT_DECIDED

    return margins


@njit(error_model="numpy", forceinline=True)
def _vector(rows, i):  # type: ignore[no-untyped-def]
    return (rows[i, 0], rows[i, 1], rows[i, 2])


_margins = _loop(_digest)


_view: Any = memoryview


def _interpreted() -> Any:
    """The loop with the formulas as they are written, not compiled.

    Numbers are read and written through views of memory, which are plain floats: twice as fast as NumPy's.
    """
    names = dict(globals())
    for formula in (
        triple.triple_frame, triple.centroid_moment, triple.rigid_motion, triple.dot, triple.plus,
        triple_program.write_triple, three_fingers.judged,
    ):  # fmt: skip
        names[f"_{formula.__name__}"] = formula
    names["_workspace"] = lambda facets: triple_program.Workspace(
        *map(_view, triple_program.workspace(facets))
    )
    inner: Any
    for inner in (_keep_motion, _is_refuted, _vector):
        names[inner.__name__] = FunctionType(inner.py_func.__code__, names)
    loop: Any = _margins.plain
    return FunctionType(loop.__code__, names, closure=loop.__closure__)


def triple_margins(triples: np.ndarray, *arguments: Any) -> None:
    """Writes the margins of triples (T, 3) under loads to the last argument, (O, T); see ``_loop``.

    The first of a process are interpreted, where compiled code is not at hand.
    """
    global _asked
    blocks, result = -(-len(triples) // _BLOCK), arguments[-1]
    if _asked + result.size <= PATIENCE and not _margins.is_at_hand:
        _asked += result.size
        views = [_view(each) if isinstance(each, np.ndarray) else each for each in arguments]
        _interpreted()(0, blocks, triples.tolist(), *views)
    else:
        _margins(blocks, triples, *arguments)


def triples_of(count: int) -> np.ndarray:
    """Every triple i < j < k of ``count`` points, (T, 3), by i, then by j, then by k."""
    result = np.empty((comb(count, 3), 3), dtype=np.int32)
    first, second = np.triu_indices(count, 1)
    lengths = count - 1 - second
    result[:, 0], result[:, 1] = np.repeat(first, lengths), np.repeat(second, lengths)
    starts = np.repeat(np.cumsum(lengths) - lengths, lengths)
    result[:, 2] = np.arange(len(result)) - starts + result[:, 1] + 1
    result.setflags(write=False)
    return result
