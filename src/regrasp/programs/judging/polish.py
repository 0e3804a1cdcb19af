"""Answers that are nearly right, made right by Newton's steps on what they touch.

An answer touches all zero rows; an inequality or a cone whose dual is larger than its slack, each without
unit; and a cone's apex, with all of its rows, where s is nearer to it than z to the boundary. With the faces
E that are touched, orthonormal, taken as equations, E s = 0 and z = E'y, an optimum solves

    H dx + A'E'dy = -(P x + q + A'E'E z),   E A dx = E s,   s = b - A x

where H is P and the curvature of the cones, z_0 (B'B - u u') / |v| for s = (t, v), the rows B of A of v and
u = B'v / |v|. The step taken is the shortest where many serve, in units in which the largest entry of each
row and column of these is one.
"""

from typing import Any

import numpy as np
from scipy import sparse

from regrasp.programs.blocks import Array
from regrasp.programs.judging.audit import audited
from regrasp.programs.judging.terms import reciprocal
from regrasp.programs.program import Program

_STEPS = 5
_NEAR = 1e-3
"""Largest measure of what steps are taken from: what is farther off was no answer."""
_NOISE = 1e-6
"""Terms that are a smaller part of the objective's are a solver's noise."""
_LARGEST = 300
"""Unknowns and rows up to which steps are taken."""


def polished(program: Program, x: Array, z: Array, allowed: float) -> tuple[Array, Array] | None:
    """An answer that is sound, for one that may not be, or None: never one that is not.

    Sound is what ``audit`` measures: its first four, rows, columns, products and the gap, each in its own
    unit, are at most ``allowed``. The duals that are returned lie in K*. An x that is not finite is refused;
    duals that are not count as zero. Without an objective nothing pulls, and all duals are zero. The first
    that is sound is taken of the answer as it is; x = 0, the best point where rows and objective grow with x;
    the answer without duals that are noise; and ``_STEPS`` steps from an answer whose measures are at most
    ``_NEAR``, in programs of at most ``_LARGEST`` unknowns and rows.
    """
    if not np.isfinite(x).all():
        return None
    with np.errstate(all="ignore"):
        z = program.cones.dual(np.where(np.isfinite(z), z, 0.0))
        if not program.q.any() and not program.P.nnz:
            z = np.zeros(z.size)
        for first in ((x, z), (np.zeros(x.size), z), (x, _without_noise(program, x, z))):
            if _is_sound(program, *first, allowed):
                return first
        if sum(program.A.shape) > _LARGEST or not _is_sound(program, x, z, _NEAR):
            return None
        for _ in range(_STEPS):
            answer = _step(program, x, z)
            if answer is None or _is_sound(program, *answer, allowed):
                return answer
            x, z = answer
    return None


def _without_noise(program: Program, x: Array, z: Array) -> Array:
    """Duals (m,) but those whose rows, weighted by them, have terms next to none of the objective's."""
    terms, cones, sizes = program.terms, program.cones, np.abs(x)
    of_rows = cones.units(np.abs(z)) * cones.units(terms.abs_A @ sizes + np.abs(program.b))
    return np.where(of_rows > _NOISE * (sizes @ (terms.abs_P @ sizes + np.abs(program.q))), z, 0.0)


def _is_sound(program: Program, x: Array, z: Array, allowed: float) -> bool:
    return all(measure <= allowed for measure in audited(program, x, z)[:4])


def _step(program: Program, x: Array, z: Array) -> tuple[Array, Array] | None:
    """The answer one step on; None where numbers are too large for it."""
    P, A = _dense(program.terms.P), _dense(program.terms.A)
    s, E = program.b - A @ x, touched(program, x, z)
    H, z, faces = P + _curvature(program, A, s, z), E.T @ (E @ z), E @ A
    matrix: Any = np.block([[H, faces.T], [faces, np.zeros((len(E), len(E)))]])
    target = np.r_[-(P @ x + program.q + A.T @ z), E @ s]
    if not np.isfinite(matrix).all():
        return None
    rows = reciprocal(np.abs(matrix).max(axis=1, initial=0.0))
    matrix = matrix * rows[:, None]
    columns = reciprocal(np.abs(matrix).max(axis=0, initial=0.0))
    moved = columns * np.linalg.lstsq(matrix * columns, target * rows, rcond=1e-12)[0]
    return x + moved[: x.size], program.cones.dual(z + E.T @ moved[x.size :])


def _curvature(program: Program, A: Array, s: Array, z: Array) -> Array:
    """(n, n) of the Lagrangian, from the cones."""
    bent = np.zeros((A.shape[1], A.shape[1]))
    for part in program.cones.round:
        v, B = s[part][1:], A[part][1:]
        if length := float(np.linalg.norm(v)):
            u = v @ B / length
            bent += z[part.start] / length * (B.T @ B - np.outer(u, u))
    return bent


def touched(program: Program, x: Array, z: Array) -> Array:
    """(k, m) the faces that an answer x (n,), z (m,) touches, orthonormal."""
    terms, cones = program.terms, program.cones
    s = program.b - terms.A @ x
    units = reciprocal(cones.units(terms.abs_A @ np.abs(x) + np.abs(program.b)))
    of_columns = terms.abs_P @ np.abs(x) + np.abs(program.q) + terms.abs_A.T @ np.abs(z)
    pulls = cones.units(z) * cones.units(terms.abs_A @ reciprocal(of_columns))
    one = np.eye(z.size)
    faces = [*one[cones.zero | (cones.nonnegative & (pulls > s * units))]]
    for part in cones.round:
        t, pull, unit = s[part.start], pulls[part.start], units[part.start]
        length, along = (float(np.linalg.norm(v[part][1:])) for v in (s, z))
        if np.linalg.norm(s[part]) * unit * z[part.start] < pull * (z[part.start] - along):  # the apex
            faces += [*one[part]]
        elif pull > (t - length) * unit:
            faces.append(np.r_[1.0, -s[part][1:] / length] / np.sqrt(2) @ one[part])
    return np.array(faces).reshape(len(faces), z.size)


def _dense(matrix: Any) -> Any:
    return matrix.toarray() if sparse.issparse(matrix) else matrix
