"""The best sequences of holds against every sequence there is, on small random graphs.

    python benchmarks/answers/every_sequence.py [TASKS]

The judge (`tests/oracles/exhaustive.py`) walks events one by one and shares no code with the searches. A task
is planar or in space, at a fixed orientation or at some, its fingers alike or each with places of its own;
its start, its goal, both or neither are held by all fingers but one. Moves and margin of every trade-off,
steps and turning of each sequence, and the least cost under random weights must be the judge's, and a
sequence must be found exactly where the judge finds one. Prints a table; a seed is a task.
"""

import sys
from collections import Counter
from collections.abc import Iterator
from itertools import combinations, pairwise
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

import regrasp as rg
from regrasp.planning.holds.cost_search import cheapest
from regrasp.planning.holds.graphs import AnyGraph, place_of
from regrasp.planning.holds.pairs import HoldGraph, evenly, named
from regrasp.planning.holds.planar_stances import Fingering
from regrasp.planning.holds.sequences import preferred
from regrasp.planning.holds.spatial_stances import Quads
from regrasp.planning.holds.stances import Stances
from regrasp.planning.holds.triples import TripleGraph, directions
from regrasp.planning.holds.weights import RegraspWeights, efforts, triple_efforts

sys.path.append(str(Path(__file__).parents[2] / "tests" / "oracles"))
from exhaustive import least_cost, trade_off, turns

LEVEL = 1e-7  # [rad] below a margin in single precision
STEP, TURN = 1.0, 1e-4


def planar(rng: np.random.Generator, orientations: int) -> HoldGraph:
    """Six to eight points on an ellipse, some pairs of which may hold."""
    outline = rg.Outline.ellipse(1.0, rng.uniform(0.3, 1.0))
    s = np.sort(rng.uniform(0, outline.length, int(rng.integers(6, 9))))
    contacts = named([outline.contact_at(x, friction=rng.uniform(0.4, 3.0)) for x in s.tolist()], "c")
    share = rng.uniform(0.15, 0.6)

    def keep(first: Any, second: Any, angle: Any) -> Any:
        return rng.random(len(first)) < share

    return HoldGraph(tuple(contacts), rg.Wrench([0, -3.0]), evenly(orientations), keep=keep)


def spatial(rng: np.random.Generator, orientations: int) -> TripleGraph:
    """Six or seven points on a sphere, some triples of which may hold; one has a force limit."""
    at = rng.normal(size=(int(rng.integers(6, 8)), 3))
    at /= np.linalg.norm(at, axis=1)[:, None]
    contacts = tuple(
        rg.Contact(p, -p + 0.3 * rng.normal(size=3), 0.6, name=f"c{i}", max_force=6.0 if i == 1 else None)
        for i, p in enumerate(at)
    )
    share = rng.uniform(0.2, 1.0)

    def keep(first: Any, second: Any, third: Any) -> Any:
        return rng.random(len(first)) < share

    ways = directions(orientations, 3.0) if orientations > 1 else np.array([[0, 0, -3.0, 0, 0, 0]])
    return TripleGraph(contacts, ways, keep=keep)


def stances(graph: AnyGraph, max_turn: float, allowed: Any, least: float = 0.0) -> Stances:
    """Where the fingers stand."""
    if isinstance(graph, HoldGraph):
        return Fingering(graph, max_turn, least, allowed)
    ways = graph.loads[:, :3] / np.linalg.norm(graph.loads[:, :3], axis=1)[:, None]
    return Quads(graph, ways, max_turn, least, allowed=allowed)


def held(graph: AnyGraph, end: tuple[int, ...], o: int) -> bool:
    """Whether all fingers but one hold an end where it is."""
    holds = combinations(sorted(end), len(end) - 1)
    return any(graph.margins[o, place_of(graph, hold)] >= 0 for hold in holds)


def walked(graph: AnyGraph, holds: Any, o: int, max_turn: float) -> tuple[int, float]:
    """Steps beyond the removal and the addition, and the turning."""
    places = [0, *(hold[-1] for hold in holds), o]
    angles = [float(turns(graph)[a, b]) for a, b in pairwise(places)]
    return sum(max(ceil(a / max_turn - 1e-9), 1) for a in angles) - 2, sum(angles)


def differences(seed: int, kinds: Counter[tuple[str, ...]]) -> Iterator[str]:
    """What the searches find in a task and the judge does not, or the other way round."""
    rng = np.random.default_rng(seed)
    plane = bool(seed % 2)
    orientations = 1 if seed % 5 == 0 else int(rng.integers(2, 6))
    graph = planar(rng, orientations) if plane else spatial(rng, orientations)
    count, fingers = len(graph.contacts), 3 if plane else 4
    start, goal = (tuple(rng.choice(count, fingers, replace=False).tolist()) for _ in range(2))
    allowed = None
    if rng.random() < 0.5:
        allowed = rng.random((fingers, count)) < 0.7
        allowed[range(fingers), start] = allowed[range(fingers), goal] = True
    o, max_turn = int(rng.integers(orientations)), float(rng.choice([1.0, 1.5, 2.09]))
    found = preferred(stances(graph, max_turn, allowed), start, goal, o, 20)
    kinds[
        "plane" if plane else "space",
        "fixed" if orientations == 1 else "turning",
        "start held" if held(graph, start, 0) else "start not held",
        "goal held" if held(graph, goal, o) else "goal not held",
        "found" if found else "none",
    ] += 1
    expected = trade_off(graph, start, goal, o, max_turn, allowed)
    mine = [(one.moves, one.margin) for one in found]
    same = len(mine) == len(expected) and all(
        a[0] == b[0] and abs(a[1] - b[1]) <= 2e-6 for a, b in zip(mine, expected, strict=True)
    )
    if not same:
        yield f"moves and margins {mine}, judge {expected}"
        return
    for one in found:
        counted = {"threshold": one.margin - LEVEL, "move": 1e3, "step": STEP, "turn": TURN}
        cost = least_cost(graph, start, goal, o, max_turn, allowed, **counted)
        steps, turning = walked(graph, one.holds, o, max_turn)
        own = 1e3 * one.moves + STEP * steps + TURN * turning
        if abs(own - cost) > 1e-5:
            yield f"steps and turning {own}, judge {cost}"
    yield from dearer(graph, start, goal, o, max_turn, allowed, rng)


def dearer(
    graph: AnyGraph, start: Any, goal: Any, o: int, max_turn: float, allowed: Any, rng: np.random.Generator
) -> Iterator[str]:
    """The same of weights."""
    moves, turning, time, effort = (rng.uniform(0.05, 1.0, 4) * (rng.random(4) < 0.7)).tolist()
    weights = RegraspWeights(moves=moves, turning=turning, time=time + 0.01, effort=effort)
    least = float(rng.choice([0.0, 0.05]))
    fingers = stances(graph, max_turn, allowed, least)
    fingers.look_at_all()
    paid = (efforts if isinstance(graph, HoldGraph) else triple_efforts)(graph, graph.margins.T >= 0)
    cost = least_cost(
        graph, start, goal, o, max_turn, allowed, least, moves, turning, 2.0 * weights.time, effort * paid
    )
    cheap = cheapest(fingers, weights.costs(graph, fingers.margins, 2.0), start, goal, o)
    if (cheap is None) != (cost is None) or (cheap is not None and abs(cheap.cost - cost) > 1e-6):
        yield f"cost {cheap and cheap.cost}, judge {cost}"


def main() -> None:
    """Judge and print."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 600
    kinds: Counter[tuple[str, ...]] = Counter()
    wrong = 0
    for seed in range(count):
        for difference in differences(seed, kinds):
            wrong += 1
            print(f"seed {seed}: {difference}", flush=True)
    print("| | | start | goal | found | none |\n|---|---|---|---|--:|--:|")
    for kind in sorted({kind[:-1] for kind in kinds}):
        print(f"| {' | '.join(kind)} | {kinds[*kind, 'found']} | {kinds[*kind, 'none']} |")
    print(f"\n{count} tasks, {wrong} differences")


if __name__ == "__main__":
    main()
