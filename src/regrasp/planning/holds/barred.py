"""Sequences that avoid barred moves, such as those for which a finger has no way.

From where the free finger came to a hold matters where moves are barred, so that tables are of stances here,
and not of holds as in ``margin_search``: F_i+1(T') is the best of the ways inside T' that begin with F_i(T),
of all T that share a hold with T' and whose move to T' is not barred. A move changes one contact: of k moves
in all only stances with at most k - i contacts to go are looked at after i.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf
from typing import Any, NamedTuple

import numpy as np

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array
from regrasp.planning.holds.cost_search import Cheapest, Costs
from regrasp.planning.holds.sequences import Sequence, as_sequence, preference
from regrasp.planning.holds.stances import Places, Stances

MOST_STANCES = 50_000
"""Stances that are looked at for one number of moves."""

Tables = dict[Places, Array]
"""(n, O) of stances: what is known of each of their holds at each orientation."""


@dataclass(frozen=True)
class Barred:
    """What fingers may not do, on contacts by their places.

    together: contacts that are in no stance together. moves: from where to where the free finger does not go,
    in either direction, while others hold: both contacts, or the one that it neither leaves nor comes to; and
    the contacts that hold, or those of them that do so at the least.
    """

    together: frozenset[frozenset[int]] = frozenset()
    moves: frozenset[tuple[frozenset[int], frozenset[int]]] = frozenset()

    def __or__(self, other: "Barred") -> "Barred":
        return Barred(self.together | other.together, self.moves | other.moves)

    def stands(self, stance: Places) -> bool:
        """Whether fingers may be at these contacts."""
        return not any(few.issubset(stance) for few in self.together)

    def goes(self, origin: int, target: int, held: frozenset[int]) -> bool:
        """Whether a finger may go from one contact to another while others hold."""
        move = frozenset((origin, target))
        return not any(ends <= move and few <= held for ends, few in self.moves)


class _Widest:
    """Widest least margins [rad], -1 for none."""

    none, kind = -1.0, np.float32

    def __init__(self, fingers: Stances) -> None:
        self.fingers = fingers

    def first(self, holds: Places) -> Array:
        """Of the holds of the start."""
        f = self.fingers
        return np.where(f.further[0] < inf, f.margins[f.rows[list(holds)]], -1.0).astype(np.float32)

    def inside(self, holds: Places, entry: Array, moved: bool) -> Array:
        """Within a stance, from what is known of its holds as it is entered."""
        from regrasp.closed_form.compiled.hold_paths import widen

        f, result = self.fingers, np.empty(entry.shape)
        widen(tuple(range(len(holds))), entry, f.margins, f.rows[list(holds)], f.near, -0.5, result)
        return result.astype(np.float32)

    def last(self, table: Array, o: int) -> Array:
        """In the goal's stance, all fingers then turning to the orientation of the end."""
        return np.where(self.fingers.further[o] < inf, table, -1.0)

    @staticmethod
    def best(a: Array, b: Array) -> Array:
        """The better of each."""
        return np.maximum(a, b)


class _Cheapest:
    """Least costs, inf for none; as ``_Widest``."""

    none, kind = inf, np.float64

    def __init__(self, fingers: Stances, costs: Costs) -> None:
        self.fingers, self.costs = fingers, costs
        further = fingers.further
        self.turns = costs.turning * fingers.apart + costs.step * np.where(further < inf, further, 0.0)
        self.near = np.take_along_axis(self.turns, fingers.near, axis=1)

    def first(self, holds: Places) -> Array:
        f = self.fingers
        return np.where(f.further[0] < inf, self.costs.worth[f.rows[list(holds)]] + self.turns[0], inf)

    def inside(self, holds: Places, entry: Array, moved: bool) -> Array:
        from regrasp.closed_form.compiled.hold_paths import cheapen

        f, costs, result = self.fingers, self.costs, np.empty(entry.shape)
        cheapen(
            tuple(range(len(holds))), entry, costs.move * moved, costs.worth, f.rows[list(holds)], f.near,
            self.near, costs.step, np.full(entry.shape[1], inf), result,
        )  # fmt: skip
        return result

    def last(self, table: Array, o: int) -> Array:
        return np.where(self.fingers.further[o] < inf, table + self.turns[o], inf)

    @staticmethod
    def best(a: Array, b: Array) -> Array:
        return np.minimum(a, b)


class _Reached(NamedTuple):
    """By moves: what is known on entering stances and in them. whole: whether more moves lead nowhere."""

    entries: list[Tables]
    tables: list[Tables]
    whole: bool


class BarredSearch:
    """Sequences from a start, held at the first orientation, to a goal at that of place ``o``."""

    def __init__(self, fingers: Stances, start: Places, goal: Places, o: int, barred: Barred) -> None:
        self.fingers, self.o, self.barred = fingers, o, barred
        self.start, self.goals, self.goal = fingers.start(start), fingers.ways(goal), frozenset(goal)
        allowed = fingers.allowed
        self.contacts = range(fingers.count if allowed is None else allowed.shape[1])

    def preferred(self) -> list[Sequence]:
        """The sequence of fewest moves, then of the widest margin, fewest steps, least turning; or none."""
        widest, moves = _Widest(self.fingers), len(self.goal - set(self.start))
        while True:
            reached = self._reached(widest, moves)
            ends = reached.tables[moves] if len(reached.tables) > moves else {}
            margins = [widest.last(ends[goal], self.o).max() for goal in self.goals if goal in ends]
            margin = float(max(margins, default=-1.0))
            if margin >= 0:
                worth = preference(self.fingers.margins, margin)
                found, _ = self._way(_Cheapest(self.fingers, worth), moves)
                assert found is not None
                return [as_sequence(self.fingers, found)]
            if reached.whole:
                return []
            moves += 1

    def cheapest(self, costs: Costs) -> list[Sequence]:
        """The sequence of least cost; or none."""
        ways, moves = _Cheapest(self.fingers, costs), len(self.goal - set(self.start))
        best: Cheapest | None = None
        turn = costs.turning * float(self.fingers.apart[0, self.o])
        while best is None or costs.move * moves + turn < best.cost:
            found, whole = self._way(ways, moves)
            if found is not None and (best is None or found.cost < best.cost):
                best = found
            if whole:
                break
            moves += 1
        return [] if best is None else [as_sequence(self.fingers, best)]

    def _reached(self, kind: Any, moves: int) -> _Reached:
        """All that at most ``moves`` moves reach and from which the rest of them may lead to the goal."""
        none, whole = kind.none, True
        first = kind.first(self._holds([self.start])[0])
        entries: list[Tables] = [{self.start: first} if self.barred.stands(self.start) else {}]
        tables: list[Tables] = []
        seen: Tables = {}
        while True:
            table: Tables = {}
            leaving: Tables = {}
            for stance, holds in zip(entries[-1], self._holds(entries[-1]), strict=True):
                known = kind.inside(holds, entries[-1][stance], bool(tables))
                on = self._leaving(kind, stance, known) if tables else known
                both = np.concatenate([known, on])
                before = seen.get(stance, np.full_like(both, none))
                if (kind.best(both, before) != before).any():  # fewer moves did not lead to as much
                    table[stance], leaving[stance], seen[stance] = known, on, kind.best(both, before)
            if len(seen) > MOST_STANCES:
                raise Infeasible(
                    f"{MOST_STANCES} stances were looked at in sequences of {moves} moves; it is not proven "
                    f"that there is none"
                )
            tables.append(table)
            left = moves - len(tables)  # moves after the next one
            entry: Tables = {}
            for stance, known in leaving.items():
                for q in np.flatnonzero((known != none).any(axis=1)).tolist():
                    origin, held = _split(stance, q)
                    rest = self.goal - held
                    within = len(rest) <= left
                    whole &= within
                    for target in self.contacts if within else rest if len(rest) - 1 <= left else ():
                        after = self._moved(stance, origin, target, held)
                        if after is not None:
                            place = _slot(after, target)
                            if after not in entry:
                                entry[after] = np.full(known.shape, none, dtype=kind.kind)
                            entry[after][place] = kind.best(entry[after][place], known[q])
            if not entry or left < 0:
                return _Reached(entries, tables, whole and not entry)
            entries.append(entry)

    def _leaving(self, kind: Any, stance: Places, known: Array) -> Array:
        """What is known of a stance's holds as its free finger leaves, which came while others held.

        A finger that did not touch did not come: it would go on to where it has no way from before.
        """
        result = known.copy()
        for q in range(len(stance)):
            if self._avoided(stance, q):
                result[q] = kind.inside(self.fingers.of(stance), _but(known, q, kind.none), False)[q]
        return result

    def _avoided(self, stance: Places, q: int) -> bool:
        """Whether moves are barred while this hold of a stance holds."""
        held = _split(stance, q)[1]
        return any(few <= held for _, few in self.barred.moves)

    def _moved(self, stance: Places, origin: int, target: int, held: frozenset[int]) -> Places | None:
        """The stance after a move; None where it is barred, or no finger may be there."""
        if target in stance or not self.barred.goes(origin, target, held):
            return None
        allowed, finger = self.fingers.allowed, stance.index(origin)
        if allowed is not None and not allowed[finger, target]:
            return None
        after = (*stance[:finger], target, *stance[finger + 1 :])
        after = after if allowed is not None else tuple(sorted(after))
        return after if self.barred.stands(after) and min(self.fingers.of(after)) >= 0 else None

    def _holds(self, stances: Iterable[Places]) -> list[Places]:
        """The numbers of their holds, whose margins are looked at."""
        holds = [self.fingers.of(stance) for stance in stances]
        if holds:
            self.fingers.look_at(np.unique(holds))
        return holds

    def _way(self, kind: "_Cheapest", moves: int) -> tuple[Cheapest | None, bool]:
        """The cheapest of so many moves, and whether more lead nowhere."""
        reached = self._reached(kind, moves)
        ends = reached.tables[moves] if len(reached.tables) > moves else {}
        costs = {goal: kind.last(ends[goal], self.o) for goal in self.goals if goal in ends}
        stance = min(costs, key=lambda goal: float(costs[goal].min()), default=None)
        if stance is None or costs[stance].min() == inf:
            return None, reached.whole
        q, o = (int(k) for k in np.unravel_index(int(costs[stance].argmin()), costs[stance].shape))
        cost, way = float(costs[stance][q, o]), [(self.fingers.of(stance)[q], o)]
        for i in range(moves, -1, -1):
            holds, known = self.fingers.of(stance), reached.tables[i][stance]
            entry = reached.entries[i][stance] + kind.costs.move * (i > 0)
            parts = [(known, entry)]
            if 0 < i < moves and self._avoided(stance, q):
                touched = _but(known, q, inf)
                parts.insert(0, (kind.inside(holds, touched, False), touched))
            for inside, begun in parts:
                while inside[q, o] < begun[q, o]:
                    before = inside[:, self.fingers.near[o]] + kind.near[o]
                    q, k = (int(n) for n in np.unravel_index(int(before.argmin()), before.shape))
                    o = int(self.fingers.near[o, k])
                    way.append((holds[q], o))
            if i:
                entered = reached.entries[i][stance][q, o]
                stance, q = self._before(kind, stance, q, o, entered, reached.tables[i - 1], i > 1)
        return Cheapest(tuple(way[::-1]), moves, cost), reached.whole

    def _before(
        self, kind: "_Cheapest", stance: Places, q: int, o: int, cost: float, tables: Tables, came: bool
    ) -> tuple[Places, int]:
        """The stance from which a finger came to this one, of those before it, and the hold meanwhile."""
        target, held = _split(stance, q)
        for origin in self.contacts:
            before = self._moved(stance, target, origin, held)
            if before in tables:
                p, known = _slot(before, origin), tables[before]
                if (self._leaving(kind, before, known) if came else known)[p, o] == cost:
                    return before, p
        raise AssertionError("a stance that was reached was reached from another")


def _but(known: Array, q: int, none: float) -> Array:
    """The same without what is known of a hold."""
    result = known.copy()
    result[q] = none
    return result


def _split(stance: Places, q: int) -> tuple[int, frozenset[int]]:
    """The contact of a stance that is not in one of its holds, and those that are."""
    free = stance[len(stance) - 1 - q]
    return free, frozenset(stance) - {free}


def _slot(stance: Places, free: int) -> int:
    """Which of its holds is without a contact."""
    return len(stance) - 1 - stance.index(free)
