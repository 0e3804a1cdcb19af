"""The hold graph: every pair of points that holds the load, at every orientation (docs/facts.md, 7)."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, Flags, array, function, items, number, whole
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.loads.rotated import turned_load
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import PEAK_RATIO

Filter = Callable[[Array, Array, float], Flags]
"""(m, 2) first points, (m, 2) second points, the object's angle [rad] -> (m,) which pairs are allowed."""

MOST_ORIENTATIONS = 1_000_000
"""Angles of the object, or directions of the load, that are tried."""
MOST_BYTES = 2 * 2**30
"""Default memory for the margins of a hold graph."""


@dataclass(frozen=True, eq=False)
class WidestHolds:
    """The widest hold of every pair over the angles of a graph.

    margins: (P,) [rad]; negative where a pair holds at no angle. places: (P,) of the angles where they are
    reached, the first of equals. holding: (O,) how many pairs hold at each angle.
    """

    margins: NDArray[np.float32]
    places: NDArray[np.int32]
    holding: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class HoldGraph(ArrayValue):
    """Pairs of contacts that hold a load through the centre of mass while the object has one of some angles.

    A hold's margin is the widest least angle margin [rad] of its states, with forces below the contacts' own
    limits or, without one, ``peak_ratio`` times the least peak force. ``margins`` takes 4 bytes per pair and
    angle; ``widest`` does without. A regrasp looks at all angles (docs/facts.md, 7); this is for maps of
    holds, bottlenecks and orientations chosen on purpose.

    Args:
        contacts: candidates, planar, relative to the centre of mass [m].
        load: a force through the centre of mass, seen from the object at angle 0 [N].
        angles: (O,) of the object [rad].
        peak_ratio: as for ``choose_state`` [-].
        min_distance: between two fingers [m].
        keep: a filter of pairs by reach or collision.
        most_bytes: of ``margins``, which raises ``InvalidInput`` where it would take more.
        one_finger: whether a pair also holds where one of its fingers carries the whole load; otherwise both
            have to push.
        min_normal: with which each finger pushes at the least [N].

    Raises:
        InvalidInput: For arguments that are not what they must be.
    """

    contacts: tuple[Contact, ...]
    load: Wrench
    angles: Array
    peak_ratio: float = PEAK_RATIO
    min_distance: float = 0.0
    keep: Filter | None = None
    most_bytes: int = MOST_BYTES
    one_finger: bool = False
    min_normal: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "angles", array(self.angles, "angles", (None,)))
        if not self.angles.size:
            raise InvalidInput("angles has none; give the object's angles [rad], such as [0.0]")
        contacts = tuple(items(self.contacts, "contacts"))
        if len(contacts) < 2 or any(not isinstance(c, Contact) or c.dimension != 2 for c in contacts):
            raise InvalidInput("a hold graph needs two planar contacts or more")
        refuse_limits(contacts, "a hold graph")
        object.__setattr__(self, "contacts", contacts)
        number(self.peak_ratio, "peak_ratio", least=1)
        number(self.min_distance, "min_distance", least=0)
        number(self.min_normal, "min_normal", least=0)
        whole(self.most_bytes, "most_bytes", least=0, most=2**62)
        if not isinstance(self.one_finger, bool):
            raise InvalidInput(f"one_finger must be True or False, got {shown(self.one_finger)}")
        if not isinstance(self.load, Wrench):
            raise InvalidInput(f"load must be a Wrench, got {shown(self.load)}; write Wrench(force=[...])")
        if self.load.dimension != 2 or self.load.torque.any() or not self.load.force.any():
            raise InvalidInput(
                f"expected a planar force through the centre of mass, which is not zero, as the load of "
                f"regrasps and hold graphs, got {shown(self.load)}; single changes and turns take a torque"
            )
        if self.keep is not None:
            function(self.keep, "keep", "a function of first points, second points and the angle", 3)

    @cached_property
    def pairs(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Indices (P,) of the first and the second contact of every pair, the first below the second."""
        from regrasp.closed_form.compiled.holds import pairs_of

        count = len(self.contacts)
        if 24 * (count * (count - 1) // 2) > max(self.most_bytes, MOST_BYTES):  # while they are listed
            raise InvalidInput(f"{count} contacts make too many pairs to list; take fewer")

        return pairs_of(len(self.contacts))

    @cached_property
    def margins(self) -> NDArray[np.float32]:
        """(O, P) margins [rad]; negative where a pair cannot hold the load or is not allowed."""
        from regrasp.closed_form.compiled.holds import hold_margins
        from regrasp.closed_form.turning_margin import NO_HOLD

        count, needed = len(self.contacts), 4 * self.pairs[0].size * len(self.angles)
        if needed > self.most_bytes:
            raise InvalidInput(
                f"{count} points at {len(self.angles)} orientations need {needed / 2**30:.3g} GiB, more than "
                f"{self.most_bytes / 2**30:.3g}; take fewer, allow more by most_bytes, or ask for widest()"
            )
        result = np.full((len(self.angles), self.pairs[0].size), NO_HOLD, dtype=np.float32)
        hold_margins(*self.pairs, self.loads, self._candidates, result)
        result[:, ~self._apart] = NO_HOLD
        if self.min_normal:
            holding = np.nonzero(result >= 0)
            result[holding] = self._by_states(*holding)
        else:
            for o, places in self._alone.items():
                result[o, places] = self._shared(o, places)
        if self.keep is not None:
            for o, row in enumerate(result):
                row[~self._kept(o)] = NO_HOLD
        return result

    def widest(self) -> WidestHolds:
        """The widest hold of every pair over all angles, in memory that does not grow with the angles."""
        if self.min_normal:
            table = self.margins
            return WidestHolds(
                table.max(axis=0), table.argmax(axis=0).astype(np.int32), (table >= 0).sum(axis=1)
            )
        from regrasp.closed_form.compiled.holds import STRETCH, widest_margins
        from regrasp.closed_form.turning_margin import NO_HOLD

        size = self.pairs[0].size
        margins, places = np.full(size, NO_HOLD, dtype=np.float32), np.zeros(size, dtype=np.int32)
        holding = []
        for some in self._together():
            o, loads = some.start, self.loads[some]
            counts = np.zeros((-(-size // STRETCH), len(loads)), dtype=np.int64)
            allowed = self._apart if self.keep is None else self._apart & self._kept(o)
            alone = self._alone.get(o, np.empty(0, dtype=np.int64))
            alone = alone[allowed[alone]]
            if alone.size:
                allowed = allowed.copy()
                allowed[alone] = False
            widest_margins(*self.pairs, loads, self._candidates, allowed, o, margins, places, counts)
            holding.append(counts.sum(axis=0))
            if alone.size:
                shared = self._shared(o, alone)
                wider = shared > margins[alone]
                margins[alone[wider]], places[alone[wider]] = shared[wider], o
                holding[-1] += (shared >= 0).sum()
        return WidestHolds(margins, places, np.concatenate(holding))

    def _together(self) -> Iterator[slice]:
        """Orientations to sweep at once: those with a filter or with ``_alone`` pairs go by themselves."""
        begun = 0
        for o in range(len(self.angles) + 1):
            own = o < len(self.angles) and (self.keep is not None or o in self._alone)
            if (own or o == len(self.angles)) and begun < o:
                yield slice(begun, o)
                begun = o
            if own:
                yield slice(o, o + 1)
                begun = o + 1

    @cached_property
    def _alone(self) -> dict[int, NDArray[np.int64]]:
        """Pairs with a contact that the load passes through, by orientation: it might carry all of it."""
        from regrasp.closed_form.pairs.pair_margin import passes_through

        found: dict[int, NDArray[np.int64]] = {}
        for o, load in enumerate(self.loads):
            through = np.flatnonzero(passes_through(*self._points.T, *load))
            if not through.size:
                continue
            first, second = self.pairs
            pairs = np.flatnonzero((np.isin(first, through) | np.isin(second, through)) & self._apart)
            if pairs.size:
                found[o] = pairs
        return found

    def _shared(self, o: int, places: NDArray[np.int64]) -> NDArray[np.float32]:
        """(m,) margins of pairs at an orientation, of which one finger might carry the load alone."""
        return self._by_states(np.full(places.size, o), places)

    def _by_states(self, o: NDArray[np.int64], places: NDArray[np.int64]) -> NDArray[np.float32]:
        """(m,) margins of pairs, each at an orientation, by the states that have them."""
        from regrasp.planning.holds.turning.margins import Candidates

        first, second = (ends[places].astype(np.int64) for ends in self.pairs)
        pair = Candidates(self.contacts, self.load, self.peak_ratio, self.one_finger, self.min_normal)
        return pair.margins((first, second), self.angles[o]).astype(np.float32)

    @cached_property
    def _points(self) -> Array:
        return np.array([c.position for c in self.contacts])

    @cached_property
    def _apart(self) -> NDArray[np.bool_]:
        """(P,) whether two contacts are far enough from each other."""
        first, second = self.pairs
        least = max(self.min_distance, 1e-9 * abs(self._points).max())
        x, y = self._points.T
        apart: NDArray[np.bool_] = np.hypot(x[first] - x[second], y[first] - y[second]) >= least
        return apart

    def _kept(self, o: int) -> NDArray[np.bool_]:
        """(P,) what the filter says at an orientation."""
        assert self.keep is not None
        first, second = self.pairs
        kept = self.keep(self._points[first], self._points[second], float(self.angles[o]))
        if np.shape(kept) != first.shape:
            raise InvalidInput(
                f"keep must return which of {first.size} pairs are allowed, shape {first.shape}; it returned "
                f"shape {np.shape(kept)}"
            )
        return np.asarray(kept, dtype=np.bool_)

    @property
    def _candidates(self) -> tuple[Any, ...]:
        """Points, normals, frictions, limits and peak ratio, as the compiled loops take them."""
        mu = np.array([c.friction for c in self.contacts])
        limits = np.array([inf if c.max_force is None else c.max_force for c in self.contacts])
        normals = np.array([c.normal for c in self.contacts])
        return self._points, normals, mu, limits, float(self.peak_ratio)

    @property
    def loads(self) -> Array:
        """(O, 2) forces of the load seen from the object at each angle [N]."""
        return np.array([turned_load(self.load, a).force for a in self.angles.tolist()])

    def pair(self, i: int, j: int) -> int:
        """The place of a pair of contacts in ``pairs``.

        Args:
            i: the place of one contact.
            j: the place of another.
        """
        i, j = min(i, j), max(i, j)
        return i * len(self.contacts) - i * (i + 1) // 2 + (j - i - 1)

    def margin(self, i: int, j: int, o: int) -> float:
        """The margin of a hold [rad]; negative where it does not hold.

        Args:
            i: the place of one contact.
            j: the place of another.
            o: the place of an angle.
        """
        return float(self.margins[o, self.pair(i, j)])

    def components(self, o: int | None = None) -> NDArray[np.int32]:
        """(V,) the component of each contact at one orientation, or over all; -1 without any hold.

        Two holds can be exchanged into one another, without turning or with turns, exactly when their points
        are in one component.

        Args:
            o: the place of an angle; over all if not given.
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

    def reachable(self, places: Iterable[int]) -> NDArray[np.bool_]:
        """(V,) the contacts in holds that can be reached, with turns, from holds within some places.

        Args:
            places: of contacts.
        """
        start = sorted(set(places))
        labels = self.components()
        own = {
            int(labels[i])
            for k, i in enumerate(start)
            for j in start[k + 1 :]
            if self.margins[:, self.pair(i, j)].max() >= 0
        }
        return np.isin(labels, sorted(own)) & (labels >= 0)

    def row(self, i: int, o: int) -> Array:
        """(V,) margins of a contact with every other [rad]; negative where they do not hold.

        Args:
            i: the place of the contact.
            o: the place of an angle.
        """
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
    whole(orientations, "orientations", least=1, most=MOST_ORIENTATIONS)
    return 2 * np.pi * np.arange(orientations) / orientations


def named(contacts: Sequence[Contact], prefix: str) -> list[Contact]:
    """The contacts called prefix1, prefix2, ..."""
    return [contact.named(f"{prefix}{i}") for i, contact in enumerate(contacts, 1)]
