"""The least of functions over unit vectors: over two of them on a line, else by a grid that is refined."""

from collections.abc import Callable
from functools import lru_cache
from math import pi

import numpy as np

from regrasp.mechanics.checks import Array, read_only

_START = {2: 48, 3: 240, 4: 800}
_ROUNDS = {2: 9, 3: 18, 4: 22}
_FIRST = {2: 0.07, 3: 0.16, 4: 0.35}  # half the distance of neighbours at the start [rad]
_SHRINK = {2: 0.125, 3: 0.45, 4: 0.5}


def least_over(
    value: Callable[[Array], Array], count: int, size: int, starts: int = 1, own: Array | None = None
) -> tuple[Array, Array]:
    """Least values (count,) of ``count`` functions over unit vectors (size,), and where, (count, size).

    value: from (count, m, size) unit vectors to (count, m). Functions are smooth around their minima. starts:
    where they have several, the best points of so many parts of the grid are refined. own: (count, size) each
    function's own start besides, where there are several.
    """
    if size == 1:
        at = np.broadcast_to(np.array([[1.0], [-1.0]]), (count, 2, 1))
        return _best(value(at), at)
    start = np.broadcast_to(_grid(size), (count, *_grid(size).shape))
    if starts > 1:
        return _from_several(value, start, starts, own)
    least, where = _best(value(start), start)
    step, pattern = _FIRST[size], _pattern(size)
    for _ in range(_ROUNDS[size]):
        near = where[:, None] + step * _across(where, pattern)
        near = near / np.sqrt((near * near).sum(axis=-1, keepdims=True))
        found, at = _best(value(near), near)
        better = found < least
        least, where = np.where(better, found, least), np.where(better[:, None], at, where)
        step *= _SHRINK[size]
    return least, where


def _from_several(
    value: Callable[[Array], Array], start: Array, starts: int, own: Array | None
) -> tuple[Array, Array]:
    """The same from the best point of each part of the grid, all refined side by side."""
    count, _, size = start.shape
    values = np.where(np.isnan(found := value(start)), np.inf, found)
    parts = np.array_split(np.argsort(start[0, :, 0], kind="stable"), starts)
    best = np.stack([part[values[:, part].argmin(axis=1)] for part in parts], axis=1)  # (count, starts)
    rows = np.arange(count)[:, None]
    least, where = values[rows, best], start[rows, best]
    if own is not None:
        found = value(own[:, None])
        least = np.hstack([least, np.where(np.isnan(found), np.inf, found)])
        where, starts = np.concatenate([where, own[:, None]], axis=1), starts + 1
    step, pattern = _FIRST[size], _pattern(size)
    for _ in range(_ROUNDS[size]):
        near = where.reshape(-1, 1, size) + step * _across(where.reshape(-1, size), pattern)
        near = near / np.sqrt((near * near).sum(axis=-1, keepdims=True))
        reached = value(near.reshape(count, -1, size)).reshape(count * starts, -1)
        found, at = _best(reached, near)
        found, at = found.reshape(count, starts), at.reshape(count, starts, size)
        better = found < least
        least, where = np.where(better, found, least), np.where(better[..., None], at, where)
        step *= _SHRINK[size]
    return _best(least, where)


def _best(values: Array, at: Array) -> tuple[Array, Array]:
    values = np.where(np.isnan(values), np.inf, values)
    k = values.argmin(axis=1)
    rows = np.arange(len(k))
    return values[rows, k], at[rows, k]


@lru_cache
def _grid(size: int) -> Array:
    """(m, size) unit vectors, evenly spread."""
    m = _START[size]
    if size == 2:
        angles = 2 * pi * np.arange(m) / m
        return read_only(np.column_stack([np.cos(angles), np.sin(angles)]))
    if size == 3:  # Fibonacci's lattice
        z = 1 - (2 * np.arange(m) + 1) / m
        turn = pi * (3 - 5**0.5) * np.arange(m)
        r = np.sqrt(1 - z * z)
        return read_only(np.column_stack([r * np.cos(turn), r * np.sin(turn), z]))
    points = np.random.default_rng(0).normal(size=(m, size))
    return read_only(points / np.linalg.norm(points, axis=1, keepdims=True))


@lru_cache
def _pattern(size: int) -> Array:
    """(m, size - 1) steps across a unit vector, within [-1, 1]."""
    if size == 2:
        return read_only(np.linspace(-1, 1, 17)[:, None])
    steps = np.linspace(-1, 1, 5 if size == 3 else 3)
    return read_only(np.stack(np.meshgrid(*[steps] * (size - 1)), axis=-1).reshape(-1, size - 1))


def _across(where: Array, pattern: Array) -> Array:
    """(count, m, size) steps across the vectors, by Householder's reflection of the last axis onto them."""
    size = where.shape[1]
    sign = np.where(where[:, -1:] >= 0, 1.0, -1.0)
    v = where.copy()
    v[:, -1:] += sign
    square = (v * v).sum(axis=1)[:, None, None]
    basis = np.eye(size)[:-1] - 2 * v[:, None, :] * v[:, :-1, None] / square  # (count, size - 1, size)
    result: Array = np.einsum("mk,cks->cms", pattern, basis)
    return result
