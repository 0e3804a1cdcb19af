"""Which contacts surely withstand a set, for many instants at once.

Floating point that bounds its own rounding, and settles only what is inside by more; the rest is decided
exactly. Beside each number goes the sum of the sizes of its terms. A sum of products over m terms is within
4 (m + 8) u of it, u = 2^-53, for numbers between 2^-400 and 2^400; quadratics of such numbers are within four
times that of the sizes squared, so that 256 (m + 8) u = ``doubt`` is more than all rounding.

A cone or a limit over a ball holds where S + lambda diag(1, -1) is positive semidefinite (contacts.py), which
Cholesky's factorisation of S + lambda diag(1, -1) - delta 1 proves when it completes: its error is below
(k + 2) u trace (Higham 2002, theorem 10.3; Rump 2006), with the rounding of S far less than delta =
doubt (sizes^2 + lambda).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.verification.exact import root, rounded
from regrasp.verification.withstood.contacts import Body, Touch
from regrasp.verification.withstood.matrices import doubles
from regrasp.verification.withstood.multipliers import multipliers

_LEAST, _MOST, _LOST = 2.0**-400, 2.0**400, 2.0**-1000

Sure = NDArray[np.bool_]


class Sized(NamedTuple):
    """Numbers in doubles, and the sums of the sizes of the terms that each was added up from."""

    values: Array
    sizes: Array

    def changed(self, answer: Array, wrench: Array) -> "Sized":
        """Forces (m, n w) and what answers to the wrench that they make: f + R E f."""
        whole = answer @ wrench  # first: their lengths cancel, and what underflows is below _LOST
        more = self.sizes @ (abs(answer) @ abs(wrench) + _LOST).T
        return Sized(self.values + self.values @ whole.T, self.sizes + more)

    def part(self, rows: slice) -> "Sized":
        """Those of some columns."""
        return Sized(self.values[:, rows], self.sizes[:, rows])


def doubt(terms: int) -> float:
    """More than all rounding, relative to the sizes, for sums of so many terms."""
    return 2.0**-45 * (terms + 8)


@np.errstate(all="ignore")
def surely_withstood(
    touch: Touch, forces: Sized, answer: Array, body: Body, share: float, off: float
) -> Sure:
    """(m,) whether f + R d surely stays inside cone and limits for every d.

    forces: (m, w). answer: R, (w, q). share: the part of limits that may be used. off: ``doubt``.
    """
    count, width = forces.values.shape
    sure = np.ones(count, dtype=bool)
    normal, mu = doubles(touch.n), rounded(touch.mu)
    conditions = [(-doubles(a), float(b) * share) for a, b in touch.rows]
    if width == 2:
        across = np.array([-normal[1], normal[0]])
        conditions += [(mu * normal + sign * across, 0.0) for sign in (-1, 1)]
    for g, room in conditions:
        sure &= _keeps(g, room, forces, answer, body, off)
    limit = None if touch.limit is None else rounded(touch.limit) * share
    forms = [] if width == 2 else [((1 + mu**2) * np.outer(normal, normal), float(normal @ normal), 0.0)]
    if limit is not None:
        forms.append((np.zeros((width, width)), 1.0, limit))
    if not forms:
        return sure
    lift = np.array([root(x) for x in touch.weights])
    values, sizes = _columns(forces, answer, body, lift)
    size = np.sqrt(np.einsum("...wk,...wk->...", sizes, sizes))
    known = (size > _LEAST) & (size < _MOST)
    unit = -np.frexp(np.where(known, size, 1.0))[1]  # an exact change of units, in which sizes are about 1
    values, size = np.ldexp(values, unit[..., None, None]), np.ldexp(size, unit)
    held = known & (values[..., -1] @ normal > 0)  # a quadratic also holds in the cone the other way round
    for part, whole, bound in forms:
        form = part - whole * np.eye(width)
        s = np.swapaxes(values, -1, -2) @ form @ values
        s[..., -1, -1] += np.ldexp(bound, unit) ** 2
        held &= _surely_positive(s, off * (abs(form).sum() + 1) * size**2, off)
    sure &= held.reshape(count, -1).all(axis=1)
    return sure


def _keeps(g: Array, room: float, forces: Sized, answer: Array, body: Body, off: float) -> Sure:
    """(m,) whether g . (f + R d) + room >= 0 for every d, surely."""
    loads = body.loads
    twist, sizes = g @ answer, abs(g) @ abs(answer)
    if loads.half_axes is not None:
        center = loads.center.vector
        least = float(twist @ center - _length(twist @ loads.half_axes))
        most = float(sizes @ abs(center) + _length(sizes @ abs(loads.half_axes)))
    elif loads.vertices is not None:
        least, most = float((loads.vertices @ twist).min()), float((abs(loads.vertices) @ sizes).max())
    else:
        return np.zeros(len(forces.values), dtype=bool)
    size = forces.sizes @ abs(g) + abs(room) + most
    sure: Sure = (forces.values @ g + room + least > off * size) & (size > _LEAST) & (size < _MOST)
    return sure


def _columns(forces: Sized, answer: Array, body: Body, lift: Array) -> tuple[Array, Array]:
    """[R A, f + R c] of each instant, (m, 1, w, k + 1), or f + R v of each vertex, (m, v, w, 1); with sizes.

    ``lift``: the weights that a limit measures its components with.
    """
    loads, answer = body.loads, answer * lift[:, None]
    f, s = forces.values * lift, forces.sizes * lift
    if loads.cover is not None:
        members = (f[:, None] + loads.cover @ answer.T)[..., None]
        return members, (s[:, None] + abs(loads.cover) @ abs(answer).T)[..., None]
    center, axes = loads.center.vector, np.asarray(loads.half_axes)

    def beside(columns: Array, last: Array) -> Array:
        return np.concatenate([[columns] * len(last), last[..., None]], axis=-1)[:, None]

    sizes = beside(abs(answer) @ abs(axes), s + abs(answer) @ abs(center))
    return beside(answer @ axes, f + answer @ center), sizes


def _surely_positive(s: Array, delta: Array, off: float) -> Sure:
    """Whether quadratics z'S z + 2 b'z + c of |z| <= 1, (..., k + 1, k + 1), are surely not negative."""
    known = np.isfinite(s).all(axis=(-1, -2)) & np.isfinite(delta)
    s = np.where(known[..., None, None], s, 0.0)
    k = s.shape[-1] - 1
    multiplier = np.zeros(s.shape[:-2])
    if k:
        values, vectors = np.linalg.eigh(s[..., :-1, :-1])
        values = values - 2 * delta[..., None]
        b = np.einsum("...ij,...i->...j", vectors, s[..., :-1, -1])
        multiplier = multipliers(values, b, delta - values.min(axis=-1, initial=0.0))
    delta = delta + off * multiplier
    diagonal = np.arange(k)
    shifted = s.copy()
    shifted[..., diagonal, diagonal] += multiplier[..., None] - delta[..., None]
    shifted[..., -1, -1] -= multiplier + delta
    positive: Sure = known & _is_definite(shifted)
    return positive


def _is_definite(a: Array) -> Sure:
    """Whether Cholesky's factorisation of symmetric matrices completes."""
    complete = np.ones(a.shape[:-2], dtype=bool)
    for j in range(a.shape[-1]):
        pivot = a[..., j, j]
        complete &= pivot > 0
        row = a[..., j, j:] / np.sqrt(pivot)[..., None]
        a[..., j:, j:] -= row[..., :, None] * row[..., None, :]
    return complete


def _length(vectors: Array) -> Array:
    length: Array = np.sqrt(np.einsum("...i,...i->...", vectors, vectors))
    return length
