"""The same functions, compiled by Numba for arrays. Imported only when a batch is asked for.

Every function of ``locus``, ``best`` and ``choice`` is compiled from its own code, so a formula is written
once. Work is cut into blocks. An argument holds all N grasps, or one block of equal values that serves
every block (``start`` 0 in place of the block's own start); pairs are flat, (x, y, x, y, ...), because the
compiler then sees their stride and uses vector instructions.

The numbers of a block are judged while they are in the cache: the loops return how many grasps are doubtful,
and the caller looks at these numbers again only if there are any.
"""

from math import inf
from typing import Any

from numba import njit

from regrasp.closed_form import best, choice, locus
from regrasp.closed_form.compiled.compiling import compiled, digest
from regrasp.closed_form.compiled.sharing import shared

BLOCK = 1024
"""Grasps in a block."""

MODULES = (locus, best, choice)

names = compiled(MODULES)
_squeeze_interval = names["squeeze_interval"]
_best_squeeze = names["best_squeeze"]
_margin_tangent = names["margin_tangent"]


@njit(error_model="numpy", forceinline=True)
def _is_doubtful(x1, y1, nx1, ny1, mu1, x2, y2, nx2, ny2, mu2, fx, fy, tau):  # type: ignore[no-untyped-def]
    """Whether numbers may not be finite, a normal zero, a friction negative or the contacts at one point."""
    dx, dy = x2 - x1, y2 - y1
    squares = (dx * dx + dy * dy) * (nx1 * nx1 + ny1 * ny1) * (nx2 * nx2 + ny2 * ny2)
    total = squares + mu1 + mu2 + fx + fy + tau
    return not ((squares > 0.0) & (total - total == 0.0) & (mu1 >= 0.0) & (mu2 >= 0.0))


@njit(error_model="numpy", forceinline=True)
def _is_doubtful_limit(fx, fy, tau, limit1, limit2):  # type: ignore[no-untyped-def]
    """Whether a limit is not above zero, or there is neither a load nor a limit on both forces."""
    idle = (fx == 0.0) & (fy == 0.0) & (tau == 0.0)
    return not ((limit1 > 0.0) & (limit2 > 0.0)) or (idle & ((limit1 == inf) | (limit2 == inf)))


def _loops(sources: str) -> tuple[Any, Any]:
    @shared("the loci of many pairs of contacts", error_model="numpy")
    def intervals(begin, end, r1, n1, mu1, r2, n2, mu2, f, tau, whole, lo, hi):  # type: ignore[no-untyped-def]
        _ = sources
        doubtful = 0
        for block in range(begin, end):
            first = block * BLOCK
            start = first * whole
            size = min(BLOCK, lo.size - first)
            doubtful += _intervals(
                r1[2 * start[0] :], n1[2 * start[1] :], mu1[start[2] :],
                r2[2 * start[3] :], n2[2 * start[4] :], mu2[start[5] :],
                f[2 * start[6] :], tau[start[7] :],
                lo[first : first + size], hi[first : first + size],
            )  # fmt: skip
        return doubtful

    @shared("the best squeezes of many pairs of contacts", error_model="numpy")
    def squeezes(  # type: ignore[no-untyped-def]
        begin, end, r1, n1, mu1, r2, n2, mu2, f, tau, limit1, limit2, objective, peak_ratio, whole, x
    ):
        _ = sources
        doubtful = 0
        for block in range(begin, end):
            first = block * BLOCK
            start = first * whole
            size = min(BLOCK, x.size - first)
            doubtful += _squeezes(
                r1[2 * start[0] :], n1[2 * start[1] :], mu1[start[2] :],
                r2[2 * start[3] :], n2[2 * start[4] :], mu2[start[5] :],
                f[2 * start[6] :], tau[start[7] :], limit1[start[8] :], limit2[start[9] :],
                objective, peak_ratio, x[first : first + size],
            )  # fmt: skip
        return doubtful

    return intervals, squeezes


@njit(error_model="numpy")
def _intervals(r1, n1, mu1, r2, n2, mu2, f, tau, lo, hi):  # type: ignore[no-untyped-def]
    doubtful = 0
    for j in range(lo.size):
        i = 2 * j
        pair = (  # all read before anything is written, so that nothing is read twice
            r1[i], r1[i + 1], n1[i], n1[i + 1], mu1[j],
            r2[i], r2[i + 1], n2[i], n2[i + 1], mu2[j],
            f[i], f[i + 1], tau[j],
        )  # fmt: skip
        doubtful += _is_doubtful(*pair)
        lo[j], hi[j] = _squeeze_interval(*pair)
    return doubtful


@njit(error_model="numpy")
def _squeezes(  # type: ignore[no-untyped-def]
    r1, n1, mu1, r2, n2, mu2, f, tau, limit1, limit2, objective, peak_ratio, x
):
    doubtful = 0
    for j in range(x.size):
        i = 2 * j
        pair = (
            r1[i], r1[i + 1], n1[i], n1[i + 1], mu1[j],
            r2[i], r2[i + 1], n2[i], n2[i + 1], mu2[j],
            f[i], f[i + 1], tau[j],
        )  # fmt: skip
        doubtful += _is_doubtful(*pair) | _is_doubtful_limit(*pair[10:], limit1[j], limit2[j])
        x[j] = _best_squeeze(*pair, objective, limit1[j], limit2[j], peak_ratio)[0]
    return doubtful


INTERVALS, SQUEEZES = _loops(digest(MODULES))


def intervals(*arguments: Any) -> int:
    """Fills the last two, lo and hi; how many grasps are doubtful."""
    return sum(INTERVALS(-(-arguments[-1].size // BLOCK), *arguments))


def squeezes(*arguments: Any) -> int:
    """Fills the last, x; how many grasps are doubtful."""
    return sum(SQUEEZES(-(-arguments[-1].size // BLOCK), *arguments))
