"""Which sequences the search for ways looks at: against all simple ones of small graphs drawn by chance."""

from collections.abc import Iterator
from itertools import combinations, permutations
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from regrasp.motions import ShutIn
from regrasp.motions.regrasps import plan_regrasp_motions

pytestmark = pytest.mark.oracle

PLACES = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [3.0, 0.0]])
Hold = frozenset[int]
Sequence = tuple[Hold, ...]


def moves(sequence: Sequence) -> list[tuple[int, int, Hold]]:
    """From where to where the free finger goes while each hold but the first and the last holds."""
    found = []
    for before, held, after in zip(sequence, sequence[1:], sequence[2:], strict=False):
        (origin,), (target,) = before - held, after - held
        if origin != target:
            found.append((origin, target, held))
    return found


def simple_sequences(held: list[Hold], start: Hold, goal: Hold) -> Iterator[Sequence]:
    """All from a hold to another, no hold twice; holds that follow one another share a finger."""

    def on(so_far: Sequence) -> Iterator[Sequence]:
        if so_far[-1] == goal:
            yield so_far
            return
        for hold in held:
            if hold not in so_far and len(hold & so_far[-1]) == 1:
                yield from on((*so_far, hold))

    return on((start,))


def as_plan(sequence: Sequence, margin: float) -> Any:
    """What the search reads of a plan: contacts by name, moves, margin."""
    used = sorted(frozenset().union(*sequence))
    step = SimpleNamespace(grasp=[SimpleNamespace(name=f"C{p}", position=PLACES[p]) for p in used])
    return SimpleNamespace(sequence=sequence, steps=(step,), moves=moves(sequence), margin=margin)


def shut(a: int, b: int, held: Hold) -> ShutIn:
    return ShutIn(
        step=0, finger=0, place=f"C{a}", origin=f"C{a}", target=f"C{b}", position=PLACES[a],
        held=tuple(f"C{p}" for p in sorted(held)), other=None, alone=False,
    )  # fmt: skip


def all_three(sequence: Sequence, a: int, b: int, held: Hold) -> bool:
    """Whether it has the hold, one before it with the origin, and one after it with the target."""
    holds = set(sequence)
    return held in holds and all(any(frozenset({p, q}) in holds for q in held) for p in (a, b))


def tried(rng: np.random.Generator, closed_share: float, patch: pytest.MonkeyPatch) -> tuple[Any, ...]:
    """Of a graph drawn by chance: all sequences by rank, those whose moves have ways, the one found."""
    pairs = [frozenset(p) for p in combinations(range(len(PLACES)), 2)]
    margins = dict(zip(pairs, rng.uniform(size=len(pairs)), strict=True))
    held = [p for p in pairs if rng.uniform() < 0.9]
    closed = {
        (a, b, h)
        for h in pairs
        for a, b in permutations(set(range(len(PLACES))) - h, 2)
        if rng.uniform() < closed_share
    }
    least = {s: min(margins[h] for h in s) for s in simple_sequences(held, held[0], held[-1])}
    every = sorted(least, key=lambda s: (len(moves(s)), -least[s]))
    plans = {s: as_plan(s, least[s]) for s in every}
    corners = {h: PLACES[sorted(h)] for h in pairs}

    def planned(*_: Any, keep: Any = None, **__: Any) -> Any:
        kept = {h for h in held if keep is None or keep(corners[h][None, 0], corners[h][None, 1], 0.0).all()}
        for s in every:
            if kept.issuperset(s):
                return plans[s]
        raise rg.Infeasible("none")

    def with_ways(plan: Any, *_: Any, **__: Any) -> Any:
        for move in plan.moves:
            if move in closed:
                raise rg.Infeasible("no way", shut(*move))
        return plan

    patch.setattr("regrasp.planning.regrasps.verbs.plan_regrasp", planned)
    patch.setattr("regrasp.motions.plan.plan_motions", with_ways)
    far = rg.Grasp(rg.Contact([9.0, y], [1, 0], 0.5) for y in (0.0, 1.0, 2.0))
    options: Any = {"tip_radius": 0.1, "clearance": 0.1, "attempts": 1000}
    try:
        found: Any = plan_regrasp_motions(SimpleNamespace(), far, far, rg.Wrench([0, -1.0]), **options)
        chosen = found.sequence
    except rg.Infeasible:
        chosen = None
    shut_in = [m for s in every for m in moves(s) if m in closed]
    return every, [s for s in every if not closed.intersection(moves(s))], chosen, shut_in


@pytest.mark.parametrize(("closed_share", "counted"), [(0.1, (53, 6, 0)), (0.5, (32, 22, 0))])
def test_what_is_missed_has_all_parts_of_a_move_without_way(
    closed_share: float, counted: tuple[int, int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Counted: where the best that has ways is found, another that has, and none although there is one."""
    rng = np.random.default_rng(3)
    best = other = none = 0
    for _ in range(60):
        _, with_ways, found, shut_in = tried(rng, closed_share, monkeypatch)
        assert found is None or found in with_ways
        if with_ways and found != with_ways[0]:
            assert any(all_three(with_ways[0], *move) for move in shut_in)
            other, none = other + (found is not None), none + (found is None)
        else:
            best += bool(with_ways)
    assert (best, other, none) == counted
