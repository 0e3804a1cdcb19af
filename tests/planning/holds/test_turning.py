"""Holds over all orientations: arcs against linear programs, sequences against samples and brute force."""

from itertools import permutations

import numpy as np
import pytest
from scipy.optimize import linprog

import regrasp as rg
from regrasp.closed_form.pairs.load_arcs import (
    ARC,
    LINE,
    NOTHING,
    load_arcs,
    turning_sides,
    widest_narrowings,
)
from regrasp.outline import parts
from regrasp.planning.holds.pairs import HoldGraph, evenly, named
from regrasp.planning.holds.sequences import MAX_TURN, sequences
from regrasp.planning.holds.stances import REACH
from regrasp.planning.holds.turning import margins
from regrasp.planning.holds.turning.arcs import Arcs, Widest
from regrasp.planning.holds.turning.least_turning import least_turning
from regrasp.planning.holds.turning.margins import Candidates
from regrasp.planning.holds.turning.search import ExactSearch, apart_from_each_other

pytestmark = pytest.mark.oracle

SHAPES = (rg.Outline.ellipse(2, 1), parts.wrench(), parts.bracket(), parts.cam(), parts.bottle())


def holds(contacts, direction):
    """Whether contacts hold a load in a direction, by a linear program."""
    columns = []
    for r, n, mu in contacts:
        for side in (-mu, mu):
            f = (n[0] - side * n[1], n[1] + side * n[0])
            columns.append([*f, r[0] * f[1] - r[1] * f[0]])
    wanted = [-np.cos(direction), -np.sin(direction), 0.0]
    return linprog(np.zeros(4), A_eq=np.array(columns).T, b_eq=wanted, method="highs").status == 0


def of_whole_numbers(rng):
    while True:
        pair = []
        for _ in range(2):
            n = rng.integers(-1, 2, 2)
            pair.append((rng.integers(-3, 4, 2), n / np.hypot(*n) if n.any() else np.array([1.0, 0.0]),
                         float(rng.choice([0.0, 0.5, 1.0]))))  # fmt: skip
        if (pair[0][0] != pair[1][0]).any():
            return pair


def anywhere(rng):
    normals = rng.normal(size=(2, 2))
    return [(rng.normal(size=2), n / np.hypot(*n), rng.uniform(0.05, 1.2)) for n in normals]


@pytest.mark.parametrize("draw", [of_whole_numbers, anywhere])
def test_arcs_are_what_linear_programs_hold(draw):
    rng = np.random.default_rng(2)
    kinds = set()
    opposite = [(np.array([x, 0.0]), np.array([-x, 0.0]), 0.0) for x in (1.0, -1.0)]
    for pair in (opposite, *(draw(rng) for _ in range(40))):
        arrays = [np.array([x], dtype=float) for contact in pair for x in contact]
        (kind,), (begin,), (length,) = load_arcs(*arrays)
        kinds.add(int(kind))
        both = [np.concatenate([arrays[k], arrays[k + 3]]) for k in range(3)]
        widest = widest_narrowings(*turning_sides(*both), np.arctan(both[2]))[0, 1]
        assert widest >= 0 or kind == NOTHING
        if kind == NOTHING:  # or cones without width that only press against each other
            assert widest < 0 or min(pair[0][2], pair[1][2]) == 0
        for direction in np.radians([*np.arange(3.7, 360, 24.3), *np.arange(0, 360, 45)]):
            off = (direction - begin + 1e-11) % (2 * np.pi)
            inside = (kind == ARC and off <= length + 2e-11) or (kind == LINE and off % np.pi <= 2e-11)
            assert inside == holds(pair, direction)
    assert kinds == {ARC, NOTHING, LINE}


def some_contacts(rng, count, limited=False):
    shape = SHAPES[int(rng.integers(len(SHAPES)))]
    friction, limit = float(rng.choice([0.1, 0.3, 0.6])), 3.0 if limited else None
    places = rng.uniform(0, shape.length, count)
    contacts = [shape.contact_at(float(s), friction=friction, max_force=limit) for s in places]
    angle = rng.uniform(0, 2 * np.pi)
    return tuple(named(contacts, "c")), rg.Wrench([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("limited", [False, True])
def test_arcs_and_widest_margins_are_those_of_samples_and_better(limited):
    rng = np.random.default_rng(4 + limited)
    for _ in range(3):
        contacts, load = some_contacts(rng, 12, limited)
        graph = HoldGraph(contacts, load, evenly(360))
        arcs = Arcs(Candidates(contacts, load, graph.peak_ratio, one_finger=False))
        pairs = tuple(ends.astype(np.int64) for ends in graph.pairs)
        bounds = arcs.bounds()[pairs]
        widest = arcs.widest(pairs, bounds)
        sampled = graph.margins.max(axis=0)
        assert (widest.margins >= sampled - 1e-6).all()
        assert (widest.margins <= bounds + 1e-9).all()
        again = arcs.candidates.margins(pairs, widest.angles)
        assert widest.margins == pytest.approx(again, abs=1e-12)
        for level in (0.0, 0.08):
            wide = widest.margins >= level
            some = tuple(ends[wide] for ends in pairs)
            found = arcs.at(some, level, Widest(widest.margins[wide], widest.angles[wide]))
            for p, mine in zip(np.flatnonzero(wide), found, strict=True):
                off = [(graph.angles - lo + 1e-9) % (2 * np.pi) <= hi - lo + 2e-9 for lo, hi in mine]
                inside = np.any(off, axis=0) if off else np.zeros(360, dtype=bool)
                near = abs(graph.margins[:, p] - level) < 1e-6  # the table is in single precision
                assert ((graph.margins[:, p] >= level) == inside)[~near].all()


@pytest.mark.parametrize("options", [{}, {"min_normal": 0.02}, {"one_finger": True}])
def test_margins_are_the_same_interpreted_and_compiled(options, monkeypatch):
    rng = np.random.default_rng(3)
    contacts, load = some_contacts(rng, 14, True)
    one_finger = options.pop("one_finger", False)
    candidates = Candidates((*contacts[:9], *some_contacts(rng, 5)[0]), load, 3.0, one_finger, **options)
    pairs = tuple(rng.permuted(np.tile(np.arange(14), (2000, 1)), axis=1)[:, :2].T)
    angles = rng.uniform(0, 2 * np.pi, 2000)
    found = []
    for patience in (0, 10**9):
        monkeypatch.setattr(margins, "PATIENCE", patience)
        monkeypatch.setattr(margins, "_COMPILED", "none of its name")
        found.append(candidates.margins(pairs, angles))
    assert found[0] == pytest.approx(found[1], abs=1e-15)
    assert ((found[0] < 0) == (found[1] < 0)).all()
    assert 30 < (found[0] >= 0).sum() < 1900


def test_both_of_two_peaks_that_tie_are_arcs():
    """Contacts that mirror each other hold at mirrored angles, in arcs narrower than any grid at the top."""
    rng, two = np.random.default_rng(5), 0
    for _ in range(150):
        (x, y), n = rng.uniform(0.2, 1, 2), rng.normal(size=2)
        pair = [rg.Contact([side * x, y], [side * n[0], n[1]], 0.3) for side in (1, -1)]
        arcs = Arcs(Candidates(pair, rg.Wrench([1.0, 0.0]), 3.0, one_finger=False))
        places = np.array([0]), np.array([1])
        widest = arcs.widest(places, arcs.bounds()[places])
        if widest.margins[0] <= 0:
            continue
        (runs,) = arcs.at(places, widest.margins[0] * (1 - 1e-6), widest)
        middles = np.array([(lo + hi) / 2 for lo, hi in runs])
        mirrored = np.pi - middles  # the load is seen at minus the object's angle
        apart = abs((middles[:, None] - mirrored + np.pi) % (2 * np.pi) - np.pi)
        assert (apart.min(axis=1) < 1e-4).all()
        two += len(runs) > 1 and widest.peaks is not None
    assert two >= 5


def steps_and_turning(angles, last):
    turns = abs(np.diff([0.0, *angles, angles[-1] + (last - angles[-1] + np.pi) % (2 * np.pi) - np.pi]))
    return int(np.maximum(np.ceil(turns / MAX_TURN - 1e-9), 1).sum()), turns.sum()


def exact(contacts, load, start, goal, last, allowed=None, extra=0):
    candidates = Candidates(contacts, load, 3.0, one_finger=False)
    apart = apart_from_each_other(candidates.points, 0.0)
    return ExactSearch(candidates, apart, allowed, MAX_TURN, 0.0).sequences(start, goal, last, extra)


@pytest.mark.parametrize("labelled", [False, True])
def test_no_sampled_sequence_is_better(labelled):
    rng = np.random.default_rng(6)
    found = 0
    for _ in range(8):
        contacts, load = some_contacts(rng, 12)
        start, goal = (tuple(rng.choice(12, 3, replace=False).tolist()) for _ in range(2))
        allowed = rng.random((3, 12)) < 0.8 if labelled else None
        if labelled:
            allowed[(0, 1, 2), start] = allowed[(0, 1, 2), goal] = True
        last = int(rng.integers(24))
        angle = 2 * np.pi * last / 24
        mine = exact(contacts, load, start, goal, angle, allowed, extra=2)
        for count in (24, 72, 360):
            graph = HoldGraph(contacts, load, evenly(count))
            theirs = sequences(graph, start, goal, last * count // 24, allowed=allowed, extra=2)
            assert bool(mine) >= bool(theirs)
            for other in theirs:  # as few moves, with as wide a margin
                few = [m for m in mine if m.sequence.moves <= other.moves]
                assert few
                assert few[-1].sequence.margin >= other.margin - 2e-6
        for one in mine:
            found += 1
            pairs = tuple(np.array([h[k] for h in one.sequence.holds]) for k in (0, 1))
            margins = Candidates(contacts, load, 3.0, one_finger=False).margins(pairs, np.array(one.angles))
            assert margins.min() == pytest.approx(one.sequence.margin, abs=1e-12)
            turns = np.diff([0.0, *one.angles])
            assert (abs(turns) <= REACH + 1e-6).all()
    assert found >= 5


def test_the_fewest_steps_and_the_least_turning_are_those_of_brute_force():
    """Angles on a fine grid in small layered graphs of arcs."""
    rng = np.random.default_rng(9)
    seen = 0
    for _ in range(25):
        count, width = int(rng.integers(1, 4)), 3
        unit = np.pi / 18
        arcs, bits = {}, {}
        for layer in range(count):
            for v in range(width):
                lo, size = int(rng.integers(36)), int(rng.integers(0, 9))
                arcs[0, layer, v] = [(lo * unit, (lo + size) * unit)]
                bits[layer, v] = [(lo + k) % 36 for k in range(size + 1)]
        linked = rng.random((count, width, width)) < 0.6
        goal, max_turn = int(rng.integers(36)), float(rng.choice([0.9, 1.6, 2.1]))

        def after(layer, node):
            return [(0, layer + 1, w) for w in range(width) if linked[layer, node[2], w]]  # noqa: B023

        way = least_turning(
            [(0, 0, v) for v in range(width)], after, count, arcs.__getitem__, goal * unit, max_turn
        )

        def paid(cost, a, b):
            turn = abs((b - a + 18) % 36 - 18) * np.pi / 18
            extra = max(int(np.ceil(turn / max_turn - 1e-9)), 1) - 1  # noqa: B023
            return (cost[0] + extra, cost[1] + turn) if turn <= REACH else (99, 0.0)

        best = [((0, 0.0), None, 0)]
        for layer in range(count):
            reached = {}
            for cost, v, a in best:
                for w in range(width):
                    if v is None or linked[layer - 1, v, w]:
                        for b in bits[layer, w]:
                            new = paid(cost, a, b)
                            if new < reached.get((w, b), (99, 0.0)):
                                reached[w, b] = new
            best = [(cost, w, b) for (w, b), cost in reached.items()]
        expected = min((paid(cost, a, goal) for cost, _, a in best), default=(99, 0.0))
        if way is None:
            assert expected[0] >= 99
            continue
        seen += 1
        angles = [0.0, *(angle for _, angle in way)]
        rest = (goal * unit - angles[-1] + np.pi) % (2 * np.pi) - np.pi
        turns = abs(np.diff([*angles, angles[-1] + rest]))
        extra = (np.maximum(np.ceil(turns / max_turn - 1e-7), 1) - 1).sum()
        assert (extra, turns.sum()) <= (expected[0], expected[1] + 1e-6)
        for node, angle in way:
            (lo, hi) = arcs[node][0]
            assert (angle - lo + 1e-7) % (2 * np.pi) <= hi - lo + 2e-7
    assert seen >= 15


def test_moves_and_margins_are_those_of_all_rows():
    """Every row of holds of three fingers, one by one, on five contacts."""
    rng = np.random.default_rng(12)
    seen = 0
    for _ in range(10):
        contacts, load = some_contacts(rng, 5)
        arcs = Arcs(Candidates(contacts, load, 3.0, one_finger=False))
        first, second = np.triu_indices(5, 1)
        widest = np.full((5, 5), -1.0)
        found = arcs.widest((first, second), arcs.bounds()[first, second])
        widest[first, second] = widest[second, first] = found.margins
        start, goal = (tuple(rng.permutation(5)[:3].tolist()) for _ in range(2))
        best, frontier = {}, {(start, -1): np.pi}
        for moves in range(5):  # places of all fingers, and which is free
            reached = {}
            for (at, free), margin in frontier.items():
                for now in range(3):
                    if now == free:
                        continue
                    i, j = (at[f] for f in range(3) if f != now)
                    value = min(margin, widest[i, j])
                    if value >= 0:
                        for point in set(range(5)) - set(at):
                            there = (*at[:now], point, *at[now + 1 :])
                            key = (there, now)
                            reached[key] = max(reached.get(key, -1.0), value)
            best[moves + 1] = max(
                (m for (at, _), m in reached.items() if at in set(permutations(goal))), default=-1.0
            )
            frontier = reached
        mine = exact(contacts, load, start, goal, 0.3)
        if set(start) == set(goal):
            continue
        fewest = next((k for k, m in best.items() if m >= 0), None)
        assert (mine[0].sequence.moves if mine else None) == fewest
        if mine:
            seen += 1
            assert mine[0].sequence.margin == pytest.approx(best[fewest], rel=3e-6)
    assert seen >= 4


def test_holds_at_their_widest_half_a_turn_from_the_goal() -> None:
    """Parallel sides hold best where the load is across them: holds half a turn apart are turned between."""
    brick = rg.Outline([[0, 0], [4, 0], [4, 2], [0, 2]])
    start, goal = (
        rg.Grasp(brick.contact_at(p * brick.length, friction=0.4) for p in places)
        for places in ((0.593, 0.26, 0.84), (0.5095, 0.511, 0.753))
    )
    problem = rg.RegraspProblem(brick, start, goal, rg.Wrench([0, -3.0]), friction=0.4, candidates=12)
    (found,) = problem.turning_sequences()
    assert found.sequence.margin == pytest.approx(np.arctan(0.4), abs=1e-5)
    assert abs(np.diff([0.0, *found.angles])).max() <= REACH + 1e-9
    with pytest.raises(rg.Infeasible, match="the fingers of the goal cannot hold the load"):
        problem.plans()


def test_rows_whose_holds_are_always_half_a_turn_apart_come_to_an_end() -> None:
    """Contacts without friction hold rays: rows of any number of holds exist, none of them near enough."""
    places = [[1, 2], [2, -2], [1, -2], [-2, 2], [-3, -2]]
    normals = [[-1, 0], [1, -1], [0, -1], [0, -1], [0, 1]]
    contacts = tuple(rg.Contact(p, n, 0.0) for p, n in zip(places, normals, strict=True))
    assert exact(contacts, rg.Wrench([0.0, -1.0]), (4, 2, 3), (2, 1, 0), 23 * np.pi / 12) == []
