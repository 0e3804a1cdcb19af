"""Answers that are nearly right, made right: noise becomes zero, and Newton's steps do the rest.

With the rows and cones that are touched taken as equations, an optimum solves

    P dx + A_t'dz = -(P x + q + A'z),   A_t dx = s_t

A second-order cone is touched at its apex, with all of its rows, or along its boundary, with one: there
z is a multiple of (1, -v/|v|). The step taken is the shortest where many serve. What is touched and what is
noise are guesses; what comes of them is measured like any other answer.
"""

from typing import Any

import numpy as np
from scipy import sparse

from regrasp.programs.blocks import Array
from regrasp.programs.judging.audit import audited
from regrasp.programs.judging.terms import largest, reciprocal
from regrasp.programs.judging.units import units_of_columns, units_of_unknowns
from regrasp.programs.program import Program

# Fractions of the largest entry below which entries are guessed to be noise.
_NOISE = (0.0, 1e-9, 1e-7, 1e-5, 1e-3)
_STEPS = 3
# What must move by more than this was no answer.
_NEAR = 1e-4
_LARGEST = 300
"""Unknowns and rows up to which an answer is polished."""


def polished(program: Program, x: Array, z: Array, allowed: float) -> tuple[Array, Array] | None:
    """An answer near (x, z) whose relative measures are at most ``allowed``; None if none was found."""
    if not np.isfinite(x).all():
        return None
    duals = program.cones.dual(np.where(np.isfinite(z), z, 0.0))
    if not program.q.any() and not program.P.nnz:
        duals = np.zeros(z.size)  # without an objective nothing pulls
    guesses = [(noise, _without(x, noise)) for noise in _NOISE]
    if not program.b.any() and not program.P.nnz:
        guesses.append((1.0, np.zeros(x.size)))  # rows and objective grow with x: zero is as good as any
    with np.errstate(all="ignore"):
        for noise, point in guesses:
            for given in (duals, _without(duals, noise)):
                if _is_sound(program, point, given, allowed):
                    return point, given
        if sum(program.A.shape) > _LARGEST:
            return None
        near = _Near(program, x, duals)
        for noise, point in guesses:
            answer: tuple[Array, Array] | None = (point, duals)
            for _ in range(_STEPS):
                assert answer is not None
                answer = _step(program, *answer, noise)
                if answer is None or not near.has(*answer):
                    break
                if _is_sound(program, *answer, allowed):
                    return answer
    return None


def _without(values: Array, noise: float) -> Array:
    return np.where(np.abs(values) > noise * np.abs(values).max(initial=0.0), values, 0.0)


class _Near:
    """Answers that differ from one by little: rows and columns change by ``_NEAR`` of their units at most."""

    def __init__(self, program: Program, x: Array, z: Array) -> None:
        self._terms, self._x, self._z = program.terms, x, z
        terms, cones = program.terms, program.cones
        unknowns, floors = units_of_unknowns(program)
        self._rows = cones.units(terms.abs_A @ np.abs(x) + np.abs(program.b) + floors)
        pulls = terms.abs_P @ np.maximum(np.abs(x), unknowns) + np.abs(program.q)
        self._columns = pulls + terms.abs_A.T @ np.abs(z) + units_of_columns(program, pulls)

    def has(self, x: Array, z: Array) -> bool:
        """Whether (x, z) is one."""
        P, A, dx, dz = self._terms.P, self._terms.A, x - self._x, z - self._z
        changes = (largest(np.abs(A @ dx), self._rows), largest(np.abs(P @ dx), self._columns),
                   largest(np.abs(A.T @ dz), self._columns))  # fmt: skip
        return max(changes) <= _NEAR


def _is_sound(program: Program, x: Array, z: Array, allowed: float) -> bool:
    return all(measure <= allowed for measure in audited(program, x, z)[:4])


def _step(program: Program, x: Array, z: Array, noise: float) -> tuple[Array, Array] | None:
    """The answer one step on; entries of x that are zero stay so."""
    terms, cones = program.terms, program.cones
    A = _dense(terms.A)
    s = program.b - A @ x
    units = cones.units(terms.abs_A @ np.abs(x) + np.abs(program.b))
    of_columns = terms.abs_P @ np.abs(x) + np.abs(program.q) + terms.abs_A.T @ np.abs(z)
    pull = cones.units(np.abs(z)) * cones.units(terms.abs_A @ reciprocal(of_columns))  # without unit
    near = cones.units(np.abs(s)) * reciprocal(units)
    pulled = pull > np.maximum(noise, near)
    duals = z.copy()
    tight: list[Array] = []  # rows of equations A_t dx = s_t
    short: list[float] = []
    lifts: list[Array] = []  # columns of z = duals + lifts y
    identity = np.eye(z.size)
    for i in np.flatnonzero(cones.zero | cones.nonnegative):
        if cones.zero[i] or pulled[i]:
            lifts.append(identity[i])
        elif cones.nonnegative[i]:
            duals[i] = 0.0
        if cones.zero[i] or pulled[i] or s[i] < noise * units[i]:
            tight.append(A[i])
            short.append(float(s[i]))
    for part in cones.round:
        first, v = part.start, s[part][1:]
        length = float(np.linalg.norm(v))
        if near[first] <= max(noise, 1e-9):  # the apex
            tight += list(A[part])
            short += s[part].tolist()
            if pulled[first] or np.abs(z[part]).any():
                lifts += list(identity[part])
        elif length - s[first] > 0 or pull[first] > max(noise, abs(s[first] - length) / units[first]):
            face = np.r_[1.0, -v / length]
            tight.append(face @ A[part])
            short.append(float(s[first]) - length)
            duals[part] = z[first] * face
            lifts.append(face @ identity[part])
        else:
            duals[part] = 0.0
    free = x != 0 if noise else np.ones(x.size, dtype=bool)
    return _solved(program, x, duals, free, tight, short, lifts)


def _solved(
    program: Program,
    x: Array,
    z: Array,
    free: Array,
    tight: list[Array],
    short: list[float],
    lifts: list[Array],
) -> tuple[Array, Array] | None:
    P, A, n = _dense(program.terms.P), _dense(program.terms.A), x.size
    T = np.array(tight).reshape(len(tight), n)
    L = np.array(lifts).reshape(len(lifts), z.size).T
    matrix: Any = np.block([[P[:, free], A.T @ L], [T[:, free], np.zeros((len(tight), L.shape[1]))]])
    target = np.r_[-(P @ x + program.q + A.T @ z), short]
    if not (np.isfinite(matrix).all() and np.isfinite(target).all()):
        return None
    rows = reciprocal(np.abs(matrix).max(axis=1, initial=0.0))
    moved = np.linalg.lstsq(matrix * rows[:, None], target * rows, rcond=1e-12)[0]
    point = x.copy()
    point[free] += moved[: int(free.sum())]
    return point, program.cones.dual(z + L @ moved[int(free.sum()) :])


def _dense(matrix: Any) -> Any:
    return matrix.toarray() if sparse.issparse(matrix) else matrix
