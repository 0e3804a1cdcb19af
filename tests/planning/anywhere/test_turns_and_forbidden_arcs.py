"""Regrasps anywhere on an outline while the object turns, away from forbidden arcs, by fewest exchanges."""

from collections import Counter
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
from regrasp.planning.anywhere import hold_map

pytestmark = pytest.mark.laws

BOWL = rg.Outline([[0, 0], [4, 0], [6, 4], [5, 4], [2, 1], [-1, 4], [-2, 4]])
DOWN = rg.Wrench([-1.0, -3.0])
START, GOAL = (3.39, 9.01, 12.0), (0.44, 18.46, 12.0)


def on_bowl(friction, *places):
    return rg.Grasp(BOWL.contact_at(s, friction=friction) for s in places)


def asked(friction=0.2, start=START, goal=GOAL, load=DOWN, **options):
    ends = (on_bowl(friction, *places) for places in (start, goal))
    return rg.regrasps_on_outline(BOWL, *ends, load, friction=friction, **options)


def sampled_holds(points, friction, loads):
    """(n, n) which pairs hold in any of some orientations, by the closed form of two contacts."""
    hold = np.zeros((len(points),) * 2, dtype=bool)
    i, j = np.nonzero(abs(points[:, None] - points) > 1e-9)
    p, n = BOWL.points(points), BOWL.normals(points)
    for load in loads:
        lo, hi = rg.locus_intervals(p[i], n[i], friction, p[j], n[j], friction, load.force)
        hold[i, j] |= lo <= hi
    return hold | hold.T


def fewest(hold):
    """Exchanges from a hold of the first three points to one of the next three; None without a way."""
    reached = {i for pair in combinations(range(3), 2) if hold[pair] for i in pair}
    ends = [pair for pair in combinations(range(3, 6), 2) if hold[pair]]
    before = set()
    for count in range(1, len(hold)):
        if any(set(pair) & reached for pair in ends):
            return count
        if reached <= before:
            return None
        before |= reached
        reached = set(np.flatnonzero(hold[sorted(reached)].any(axis=0)).tolist()) - before
    return None


def within(arcs, places):
    return any(1e-9 < (s - lo) % BOWL.length < hi - lo - 1e-9 for lo, hi in arcs for s in places)


def test_samples_have_no_way_that_is_denied_nor_a_shorter_one():
    rng = np.random.default_rng(8)
    seen = Counter()
    while seen["tasks"] < 60:
        friction, angle = float(rng.uniform(0.02, 0.2)), rng.uniform(0, 2 * np.pi)
        load = rg.Wrench([np.cos(angle), np.sin(angle)])
        lo, hi = [(0.0, 0.0), (0.0, 0.4), (-0.5, 0.3)][int(rng.integers(3))]
        loads = [load.rotated(-a) for a in np.linspace(lo, hi, 9 if lo < hi else 1).tolist()]
        begin = rng.uniform(0, BOWL.length)
        arcs = [(begin, begin + rng.uniform(3, 9))] if rng.random() < 0.5 else []
        points = rng.uniform(0, BOWL.length, 46)
        hold = sampled_holds(points, friction, loads)
        pairs = [(i, j) for i, j in np.argwhere(hold).tolist() if i < j]
        if len(pairs) < 2:
            continue
        ends = [
            [*points[list(pairs[int(k)])], rng.uniform(0, BOWL.length)]
            for k in rng.integers(len(pairs), size=2)
        ]
        if within(arcs, np.concatenate(ends)):
            continue
        try:
            found = asked(friction, *ends, load, turns=(lo, hi), forbidden=arcs)
        except rg.Infeasible:  # all three do not hold the load where it is
            continue
        seen["tasks"] += 1
        free = [s for s in points.tolist() if not within(arcs, [s])]
        best = fewest(sampled_holds(np.array([*ends[0], *ends[1], *free]), friction, loads))
        assert found.exists is not None
        seen[found.exists] += 1
        if not found.exists:
            assert best is None
            assert rg.verify(found.certificate).ok
            seen["barred"] += bool(asked(friction, *ends, load, turns=(lo, hi)).exists)
            continue
        least, most = found.exchanges
        assert least == most == max(len(found.walk) - 1, 0)
        if best is not None and lo == hi:
            assert least <= best
            seen["shorter"] += least < best
        for before, after in zip(found.walk[:-1].tolist(), found.walk[1:].tolist(), strict=True):
            assert set(before) & set(after)
        for places, turn in zip(found.walk, found.angles.tolist(), strict=True):
            assert lo <= turn <= hi
            assert not within(arcs, places)
            assert sampled_holds(places, friction, [load.rotated(-turn)])[0, 1]
    assert min(seen[key] for key in (True, False, "shorter", "barred")) >= 1, seen


def test_a_turn_joins_what_is_apart():
    still = asked()
    assert still.exists is False
    assert not asked(turns=(-0.05, 0.05)).exists
    turned = asked(turns=(-1.0, 1.0))
    assert turned.exists
    assert abs(turned.angles).max() > 0.05
    assert "while the object turns within -57.3 to 57.3 deg" in str(turned)


def test_proofs_are_of_the_turn_and_the_arcs_they_name():
    cut = asked(turns=(-0.05, 0.05), forbidden=[(5.0, 6.0)]).certificate
    assert rg.verify(cut).ok
    assert "at any orientation within a turn of" in str(cut)
    assert rg.OutlineCut.from_dict(cut.to_dict()) == cut
    plain = asked().certificate
    old = {k: v for k, v in plain.to_dict().items() if k not in ("turned", "forbidden")}
    assert rg.OutlineCut.from_dict(old) == plain
    for spoiled in (
        replace(cut, turned=DOWN.rotated(-1.0).force),
        replace(cut, turned=-cut.force),
        replace(cut, forbidden=()),
        replace(cut, force=DOWN.rotated(1.0).force),
    ):
        assert not rg.verify(spoiled).ok
    assert "whole numbers from 0" in str(refusal(lambda: replace(cut, forbidden=[99.0])))


def test_too_large_a_map_is_open(monkeypatch):
    for name in ("MOST_REGIONS", "MOST_LINKS"):
        with monkeypatch.context() as patch:
            patch.setattr(hold_map, name, 5)
            found = asked()
        assert found.exists is None
        assert "20,000 regions" in str(found)
        assert not found.regions
        assert found.exchanges is None


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"turns": (0.1, 0.2)}, "turns must be a least and a largest angle"),
        ({"turns": (-2.0, 2.0)}, "less than pi apart"),
        ({"goal_orientation": 0.3}, "with 0 and goal_orientation between them"),
        ({"turns": 3}, "turns must"),
        ({"forbidden": [(3.0, 2.0)]}, "forbidden must be arcs"),
        ({"forbidden": [(0.0, 99.0)]}, "forbidden must be arcs"),
        ({"forbidden": "all"}, "forbidden must be arcs"),
        ({"forbidden": [(3.0, 4.0)]}, "contact 'P1' of the start is on a forbidden arc"),
    ],
)
def test_what_is_no_such_task_is_refused(options, words):
    assert words in str(refusal(lambda: asked(**options)))
