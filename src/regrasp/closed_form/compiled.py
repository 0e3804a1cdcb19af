"""The same functions, compiled by Numba for arrays. Imported only when a batch is asked for.

Every function of ``locus``, ``best`` and ``choice`` is compiled from its own code, so a formula is written
once. Work is cut into blocks. An argument holds all N grasps, or one block of equal values that serves
every block (``start`` 0 in place of the block's own start); pairs are flat, (x, y, x, y, ...), because the
compiler then sees their stride and uses vector instructions.

The numbers of a block are judged while they are in the cache: the loops return how many grasps are doubtful,
and the caller looks at these numbers again only if there are any.
"""

from hashlib import sha256
from math import inf
from pathlib import Path
from types import FunctionType
from typing import Any

from numba import njit, prange

from regrasp.closed_form import best, choice, locus

BLOCK = 1024
"""Grasps in a block."""

_MODULES = (locus, best, choice)


def _compiled() -> dict[str, Any]:
    """All functions of the modules; they call one another through this dictionary of names."""
    names: dict[str, Any] = {"__builtins__": __builtins__}
    for module in _MODULES:
        names.update(vars(module))
    for module in _MODULES:
        for name, function in vars(module).items():
            if isinstance(function, FunctionType) and function.__module__ == module.__name__:
                mine = FunctionType(function.__code__, names, name)
                names[name] = njit(error_model="numpy", forceinline=True)(mine)
    return names


_names = _compiled()
_squeeze_interval = _names["squeeze_interval"]
_best_squeeze = _names["best_squeeze"]

# Numba's cache watches this file only; the digest in the loops' closures makes it watch the formulas too.
_digest = sha256(b"".join(Path(str(m.__file__)).read_bytes() for m in _MODULES)).hexdigest()


def _loops(digest: str) -> tuple[Any, Any]:
    @njit(error_model="numpy", parallel=True, cache=True)
    def intervals(r1, n1, mu1, r2, n2, mu2, f, tau, whole, lo, hi):  # type: ignore[no-untyped-def]
        _ = digest
        doubtful = 0
        for block in prange((lo.size + BLOCK - 1) // BLOCK):
            first = block * BLOCK
            start = first * whole
            size = min(BLOCK, lo.size - first)
            numbers = (
                r1[2 * start[0] :], n1[2 * start[1] :], mu1[start[2] :],
                r2[2 * start[3] :], n2[2 * start[4] :], mu2[start[5] :],
                f[2 * start[6] :], tau[start[7] :],
            )  # fmt: skip
            _intervals(*numbers, lo[first : first + size], hi[first : first + size])
            doubtful += _doubtful(*numbers, size)
        return doubtful

    @njit(error_model="numpy", parallel=True, cache=True)
    def squeezes(  # type: ignore[no-untyped-def]
        r1, n1, mu1, r2, n2, mu2, f, tau, limit1, limit2, objective, peak_ratio, whole, x
    ):
        _ = digest
        doubtful = 0
        for block in prange((x.size + BLOCK - 1) // BLOCK):
            first = block * BLOCK
            start = first * whole
            size = min(BLOCK, x.size - first)
            doubtful += _doubtful(
                r1[2 * start[0] :], n1[2 * start[1] :], mu1[start[2] :],
                r2[2 * start[3] :], n2[2 * start[4] :], mu2[start[5] :],
                f[2 * start[6] :], tau[start[7] :], size,
            ) + _doubtful_limits(
                f[2 * start[6] :], tau[start[7] :], limit1[start[8] :], limit2[start[9] :], size
            )  # fmt: skip
            for j in range(size):
                a, b, c, d, e = start[0] + j, start[1] + j, start[3] + j, start[4] + j, start[6] + j
                x[first + j] = _best_squeeze(
                    r1[2 * a], r1[2 * a + 1], n1[2 * b], n1[2 * b + 1], mu1[start[2] + j],
                    r2[2 * c], r2[2 * c + 1], n2[2 * d], n2[2 * d + 1], mu2[start[5] + j],
                    f[2 * e], f[2 * e + 1], tau[start[7] + j],
                    objective, limit1[start[8] + j], limit2[start[9] + j], peak_ratio,
                )[0]  # fmt: skip
        return doubtful

    return intervals, squeezes


@njit(error_model="numpy")
def _intervals(r1, n1, mu1, r2, n2, mu2, f, tau, lo, hi):  # type: ignore[no-untyped-def]
    for j in range(lo.size):
        i = 2 * j
        lo[j], hi[j] = _squeeze_interval(
            r1[i], r1[i + 1], n1[i], n1[i + 1], mu1[j],
            r2[i], r2[i + 1], n2[i], n2[i + 1], mu2[j],
            f[i], f[i + 1], tau[j],
        )  # fmt: skip


@njit(error_model="numpy")
def _doubtful(r1, n1, mu1, r2, n2, mu2, f, tau, size):  # type: ignore[no-untyped-def]
    """How many grasps have numbers that are not finite, no normal, a negative friction or one point only."""
    count = 0
    for j in range(size):
        x, y = 2 * j, 2 * j + 1
        total = r1[x] + r1[y] + n1[x] + n1[y] + mu1[j] + r2[x] + r2[y] + n2[x] + n2[y] + mu2[j]
        total += f[x] + f[y] + tau[j]
        dx, dy = r2[x] - r1[x], r2[y] - r1[y]
        count += not (
            (total - total == 0.0)  # neither NaN nor infinite
            & (n1[x] * n1[x] + n1[y] * n1[y] > 0.0)
            & (n2[x] * n2[x] + n2[y] * n2[y] > 0.0)
            & (mu1[j] >= 0.0)
            & (mu2[j] >= 0.0)
            & (dx * dx + dy * dy > 0.0)
        )
    return count


@njit(error_model="numpy")
def _doubtful_limits(f, tau, limit1, limit2, size):  # type: ignore[no-untyped-def]
    """How many grasps have a limit that is not above zero, or neither a load nor both limits."""
    count = 0
    for j in range(size):
        idle = (f[2 * j] == 0.0) & (f[2 * j + 1] == 0.0) & (tau[j] == 0.0)
        endless = (limit1[j] == inf) | (limit2[j] == inf)
        count += not ((limit1[j] > 0.0) & (limit2[j] > 0.0)) or (idle & endless)
    return count


intervals, squeezes = _loops(_digest)
