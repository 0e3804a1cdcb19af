"""The hold graph: every pair of points that holds the load, at every orientation (docs/facts.md, 7)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.criteria import PEAK_RATIO
from regrasp.planning.turn import turned_load

Filter = Callable[[Array, Array, float], NDArray[np.bool_]]
"""(m, 2) first points, (m, 2) second points, the object's angle [rad] -> (m,) which pairs are allowed."""

MOST_BYTES = 2 * 2**30
"""Default memory for the margins of a hold graph."""


@dataclass(frozen=True, eq=False)
class HoldGraph:
    """Pairs of contacts that hold a load through the centre of mass while the object has one of some angles.

    contacts: candidates. load: at angle 0. angles: (O,) of the object [rad]. A hold's margin is the widest
    least angle margin [rad] of its states, with forces below the contacts' own limits or, without one,
    ``peak_ratio`` times the least peak force. min_distance: between two fingers [m]. keep: a filter of pairs
    by reach or collision. Memory is 4 bytes per pair and angle; ``InvalidInput`` where that is more than
    ``most_bytes``.
    """

    contacts: tuple[Contact, ...]
    load: Wrench
    angles: Array
    peak_ratio: float = PEAK_RATIO
    min_distance: float = 0.0
    keep: Filter | None = None
    most_bytes: int = MOST_BYTES

    def __post_init__(self) -> None:
        if len(self.contacts) < 2 or any(c.dimension != 2 for c in self.contacts):
            raise InvalidInput("a hold graph needs two planar contacts or more")
        if self.load.dimension != 2 or self.load.torque.any() or not self.load.force.any():
            raise InvalidInput(
                f"the load of a hold graph is a force through the centre of mass, got {self.load!r}"
            )
        count = len(self.contacts)
        needed = 2 * count * (count - 1) * len(self.angles)
        if needed > self.most_bytes:
            raise InvalidInput(
                f"{count} points at {len(self.angles)} orientations need {needed / 2**30:.3g} GiB, more than "
                f"{self.most_bytes / 2**30:.3g}; take fewer, or allow more by most_bytes"
            )

    @cached_property
    def pairs(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Indices (P,) of the first and the second contact of every pair, the first below the second."""
        from regrasp.closed_form.compiled_holds import pairs_of

        return pairs_of(len(self.contacts))

    @cached_property
    def margins(self) -> NDArray[np.float32]:
        """(O, P) margins [rad]; negative where a pair cannot hold the load or is not allowed."""
        from regrasp.closed_form.compiled_holds import NO_HOLD, hold_margins

        first, second = self.pairs
        points, normals = (
            np.array([getattr(c, what) for c in self.contacts]) for what in ("position", "normal")
        )
        mu = np.array([c.friction for c in self.contacts])
        limits = np.array([inf if c.max_force is None else c.max_force for c in self.contacts])
        loads = np.array([turned_load(self.load, a).force for a in self.angles.tolist()])
        result = np.empty((len(loads), first.size), dtype=np.float32)
        hold_margins(first, second, points, normals, mu, loads, limits, float(self.peak_ratio), result)
        apart = np.hypot(*(points[first] - points[second]).T)
        result[:, apart < max(self.min_distance, 1e-9 * abs(points).max())] = NO_HOLD
        if self.keep is not None:
            for row, angle in zip(result, self.angles.tolist(), strict=True):
                row[~np.asarray(self.keep(points[first], points[second], angle), dtype=bool)] = NO_HOLD
        return result

    def pair(self, i: int, j: int) -> int:
        """The place of a pair of contacts in ``pairs``."""
        i, j = min(i, j), max(i, j)
        return i * len(self.contacts) - i * (i + 1) // 2 + (j - i - 1)

    def margin(self, i: int, j: int, o: int) -> float:
        """The margin of a hold at the orientation of place ``o`` [rad]; negative where it does not hold."""
        return float(self.margins[o, self.pair(i, j)])

    def components(self, o: int | None = None) -> NDArray[np.int32]:
        """(V,) the component of each contact at one orientation, or over all; -1 without any hold.

        Two holds can be exchanged into one another, without turning or with turns, exactly when their points
        are in one component.
        """
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components

        first, second = self.pairs
        holds = (self.margins[o] if o is not None else self.margins.max(axis=0)) >= 0
        count = len(self.contacts)
        graph = coo_matrix((np.ones(holds.sum()), (first[holds], second[holds])), (count, count))
        _, labels = connected_components(graph, directed=False)
        used = np.zeros(count, dtype=bool)
        used[first[holds]] = used[second[holds]] = True
        return np.where(used, labels, -1).astype(np.int32)

    def row(self, i: int, o: int) -> Array:
        """(V,) margins of contact i with every other at an orientation; negative where they do not hold."""
        count = len(self.contacts)
        others = np.arange(count)
        low, high = np.minimum(others, i), np.maximum(others, i)
        places = low * count - low * (low + 1) // 2 + (high - low - 1)
        result = np.full(count, -1.0)
        apart = others != i
        result[apart] = self.margins[o, places[apart]]
        return result


def evenly(orientations: int) -> Array:
    """(O,) angles of the object [rad] spread over a full turn, the first 0."""
    if isinstance(orientations, bool) or not isinstance(orientations, int) or orientations < 1:
        raise InvalidInput(f"orientations must be a whole number of at least 1, got {orientations!r}")
    return 2 * np.pi * np.arange(orientations) / orientations


def named(contacts: Sequence[Contact], prefix: str) -> list[Contact]:
    """The contacts called prefix1, prefix2, ..."""
    return [contact.named(f"{prefix}{i}") for i, contact in enumerate(contacts, 1)]
