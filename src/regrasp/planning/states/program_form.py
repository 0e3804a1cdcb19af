"""What programs of one shape have in common: everything but the numbers, worked out once."""

from dataclasses import dataclass
from functools import lru_cache
from math import ceil

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array, ArrayLike
from regrasp.planning.states.objectives import Bound
from regrasp.programs import Block, Cone, Pattern

Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class StateForm:
    """The form of a program for a choice of forces.

    constants: entries of A that no number of the grasp changes; they come first in ``pattern``.
    rough, smooth, limited: the contacts with friction, without it, and with a force limit.
    q: cost of the unknown besides the forces, if there is one.
    is_round: whether cones are of second order; otherwise they have faces. limit_rows: rows of b that hold
    the limits, a contact after the other.
    """

    pattern: Pattern
    constants: Array
    blocks: tuple[Block, ...]
    q: Array
    rough: Index
    smooth: Index
    limited: Index
    is_round: bool
    limit_rows: slice

    @property
    def rows(self) -> int:
        """Rows of A."""
        return sum(block.rows for block in self.blocks)


@lru_cache(maxsize=256)
def state_form(
    bound: Bound,
    has_friction: tuple[bool, ...],
    has_limit: tuple[bool, ...],
    facets: int | None,
    width: int = 2,
) -> StateForm:
    """The form of a program: constant entries, then those that ``state_program`` fills, in its order.

    bound: what the unknown besides the forces bounds. width: numbers per force, 2 in the plane, 3 in space, 4
    with soft fingers.
    """
    n, w, d = len(has_friction), width, min(width, 3)
    rough, smooth = np.flatnonzero(has_friction), np.flatnonzero(np.logical_not(has_friction))
    limited = np.flatnonzero(has_limit)
    is_round = d == 3 and facets is None
    sides = w if is_round else 2 if d == 2 else facets or 0  # rows of a friction cone
    t = w * n
    unknowns = t if bound is Bound.NONE else t + 1
    force = np.arange(t).reshape(n, w)  # columns of each force
    places = _Places()
    balance = places.block(Cone.ZERO, 3 if d == 2 else 6)
    straight = places.block(Cone.ZERO, 1, (w - 1) * smooth.size).reshape(-1, w - 1)
    if is_round:
        inside = places.block(Cone.SECOND_ORDER, sides, rough.size).reshape(-1, sides)
    else:
        inside = places.block(Cone.NONNEGATIVE, 1, sides * rough.size).reshape(-1, sides)
    pushing = places.block(Cone.NONNEGATIVE, 1, smooth.size)
    for axis in range(d):
        places.constant(np.full(n, balance[axis]), force[:, axis], -1.0)
    if bound is Bound.MARGIN and not rough.size:  # no cone bounds the margin of rays: it is zero
        places.constant(places.block(Cone.NONNEGATIVE, 1), [t], 1.0)
    if bound is Bound.NORMAL:
        below = places.block(Cone.NONNEGATIVE, 1, n)
        places.constant(below, np.full(n, t), -1.0)
    varying = [_torques(balance, force)]
    varying.append(_each(inside, force[rough]))
    if smooth.size:
        varying += [_each(straight, force[smooth]), _each(pushing[:, None], force[smooth])]
    if bound is Bound.NORMAL:
        varying.append(_each(below[:, None], force))
    if bound is Bound.MARGIN:
        margin = inside[:, 0] if is_round else inside.ravel()
        varying.append((margin, np.full(margin.size, t)))
    if bound is Bound.FORCE:
        _, moving = _balls(places, force, facets, t)
        varying += moving
    limit_rows, moving = _balls(places, force[limited], facets, None)
    varying += moving
    rows, columns, constants = places.all(varying)
    q = np.zeros(unknowns)
    q[t:] = -1.0 if bound in (Bound.MARGIN, Bound.FACTOR) else 1.0
    q.setflags(write=False)  # all programs of this form have it in common
    return StateForm(
        Pattern((places.rows, unknowns), rows, columns),
        constants,
        tuple(places.blocks),
        q,
        rough,
        smooth,
        limited,
        is_round,
        limit_rows,
    )


def _each(rows: Index, columns: Index) -> tuple[Index, Index]:
    """Rows (k, r) of k forces, each filled over that force's columns (k, d)."""
    wide = np.broadcast_to(rows[:, :, None], (*rows.shape, columns.shape[1]))
    return wide.ravel(), np.broadcast_to(columns[:, None], wide.shape).ravel()


def _torques(balance: Index, force: Index) -> tuple[Index, Index]:
    """Entries of the torque rows: all in the plane; in space a force gives no torque about its own axis."""
    n, w = force.shape
    if w == 2:
        return np.full(2 * n, balance[2]), force.ravel()
    about, axis = np.nonzero(~np.eye(3, w, dtype=bool))
    return np.repeat(balance[3 + about], n), force[:, axis].T.ravel()


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


def _balls(
    places: _Places, force: Index, facets: int | None, t: int | None
) -> tuple[slice, list[tuple[Index, Index]]]:
    """Demand |f| <= radius for forces in columns (k, d): radius is the unknown t, or waits in b.

    Returns the rows of b that hold the radius and, where faces stand for the ball, the places of their
    numbers: directions, then the cosines at t.
    """
    first, (count, d) = places.rows, force.shape
    if facets is None:
        rows = places.block(Cone.SECOND_ORDER, d + 1, count).reshape(count, d + 1)
        places.constant(rows[:, 1:], force, -1.0)
        if t is not None:
            places.constant(rows[:, 0], t, -1.0)
        return slice(first, places.rows, d + 1), []
    faces = facets if d == 2 else facets * ceil(facets / 4)
    rows = places.block(Cone.NONNEGATIVE, 1, faces * count).reshape(count, faces)
    varying = [_each(rows, force)]
    if t is not None:
        varying.append((rows.ravel(), np.full(rows.size, t)))
    return slice(first, places.rows), varying
