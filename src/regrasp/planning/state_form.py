"""What programs of one shape have in common: everything but the numbers, worked out once."""

from dataclasses import dataclass
from functools import lru_cache
from math import cos, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from regrasp.mechanics.checks import Array
from regrasp.programs import Block, Cone, Pattern

Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class StateForm:
    """The form of a program for a choice of forces.

    constants: entries of A that no number of the grasp changes; they come first in ``pattern``.
    rough, smooth, limited: the contacts with friction, without it, and with a force limit.
    limit_rows: rows of b that hold the limits, ``limit_repeats`` to a contact, times ``limit_scale``.
    """

    pattern: Pattern
    constants: Array
    blocks: tuple[Block, ...]
    P: sparse.csc_matrix
    q: Array
    rough: Index
    smooth: Index
    limited: Index
    limit_rows: slice
    limit_scale: float
    limit_repeats: int

    @property
    def rows(self) -> int:
        """Rows of A."""
        return sum(block.rows for block in self.blocks)


@lru_cache(maxsize=256)
def state_form(
    objective: str, has_friction: tuple[bool, ...], has_limit: tuple[bool, ...], facets: int | None
) -> StateForm:
    """The form of a program: constant entries, then those that ``state_program`` fills, in its order."""
    n = len(has_friction)
    rough, smooth = np.flatnonzero(has_friction), np.flatnonzero(np.logical_not(has_friction))
    limited = np.flatnonzero(has_limit)
    t = 2 * n
    width = t if objective == "effort" else t + 1
    force = np.arange(t).reshape(n, 2)  # columns of each force
    places = _Places()
    balance = places.block(Cone.ZERO, 3)
    straight = places.block(Cone.ZERO, 1, smooth.size)
    inside = places.block(Cone.NONNEGATIVE, 1, 2 * rough.size)
    pushing = places.block(Cone.NONNEGATIVE, 1, smooth.size)
    for axis in (0, 1):
        places.constant(np.full(n, balance[axis]), force[:, axis], -1.0)
    if objective == "force" and not rough.size:  # no cone bounds the margin of rays: it is zero
        places.constant(places.block(Cone.NONNEGATIVE, 1), [t], 1.0)
    if objective == "peak_normal":
        below = places.block(Cone.NONNEGATIVE, 1, n)
        places.constant(below, np.full(n, t), -1.0)
    if objective == "peak":
        _circles(places, force, facets, t)
    limit_rows, scale, repeats = _circles(places, force[limited], facets, None)

    varying = [(np.full(t, balance[2]), force.ravel())]
    varying.append((np.repeat(inside, 2), np.repeat(force[rough], 2, axis=0).ravel()))
    if smooth.size:
        varying += [(np.repeat(rows, 2), force[smooth].ravel()) for rows in (straight, pushing)]
    if objective == "peak_normal":
        varying.append((np.repeat(below, 2), force.ravel()))
    if objective == "force":
        varying.append((inside, np.full(2 * rough.size, t)))
    rows, columns, constants = places.all(varying)
    q = np.zeros(width)
    q[t:] = -1.0 if objective == "force" else 1.0
    P = sparse.csc_matrix(2 * np.eye(width)) if objective == "effort" else sparse.csc_matrix((width, width))
    for shared in (q, P.data, P.indices, P.indptr):  # all programs of this form have them in common
        shared.setflags(write=False)
    return StateForm(
        Pattern((places.rows, width), rows, columns),
        constants,
        tuple(places.blocks),
        P,
        q,
        rough,
        smooth,
        limited,
        limit_rows,
        scale,
        repeats,
    )


class _Places:
    """Collects blocks of rows and the constant entries in them."""

    def __init__(self) -> None:
        self.rows = 0
        self.blocks: list[Block] = []
        self._entries: list[tuple[Index, Index, Array]] = []

    def block(self, cone: Cone, size: int, count: int = 1) -> Index:
        """The rows of ``count`` new cones."""
        rows = self.rows + np.arange(size * count)
        if count:
            self.blocks.append(Block(cone, size, count))
            self.rows += size * count
        return rows

    def constant(self, rows: ArrayLike, columns: ArrayLike, value: ArrayLike) -> None:
        """Entries of A that stay."""
        rows, columns, values = np.broadcast_arrays(rows, columns, value)
        self._entries.append((rows.ravel(), columns.ravel(), values.ravel().astype(float)))

    def all(self, varying: list[tuple[Index, Index]]) -> tuple[Index, Index, Array]:
        """Rows and columns of the constant entries, then of the varying ones; the constants."""
        rows = [entry[0] for entry in self._entries] + [place[0] for place in varying]
        columns = [entry[1] for entry in self._entries] + [place[1] for place in varying]
        constants = np.concatenate([entry[2] for entry in self._entries])
        return np.concatenate(rows), np.concatenate(columns), constants


def _circles(places: _Places, force: Index, facets: int | None, t: int | None) -> tuple[slice, float, int]:
    """Demand |f| <= radius for forces in columns (k, 2): radius is the unknown t, or waits in b.

    Returns the rows of b that hold the radius, its factor there, and how many rows a force has.
    """
    first, count = places.rows, len(force)
    if facets is None:
        rows = places.block(Cone.SECOND_ORDER, 3, count).reshape(count, 3)
        places.constant(rows[:, 1:], force, -1.0)
        if t is not None:
            places.constant(rows[:, 0], t, -1.0)
        return slice(first, places.rows, 3), 1.0, 1
    angles, apothem = 2 * pi * np.arange(facets) / facets, cos(pi / facets)
    rows = places.block(Cone.NONNEGATIVE, 1, facets * count).reshape(count, facets)
    for axis, towards in enumerate((np.cos(angles), np.sin(angles))):
        places.constant(rows, force[:, axis, None], towards)
    if t is not None:
        places.constant(rows, t, -apothem)
    return slice(first, places.rows), apothem, facets
