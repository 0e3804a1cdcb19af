"""Least normal forces and force limits of fingers anywhere on an outline: maps, walks and proofs."""

from collections import Counter
from dataclasses import replace
from fractions import Fraction
from math import inf

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
from regrasp.files import read_cut, write_cut
from regrasp.planning.anywhere.hold_map import HoldMap
from regrasp.planning.anywhere.limited_twists import _Finder
from regrasp.planning.anywhere.limits import Limits, limited_intervals
from regrasp.verification.refusals.limited_work import corners, least_work, root

pytestmark = pytest.mark.laws

BOWL = rg.Outline([[0, 0], [4, 0], [6, 4], [5, 4], [2, 1], [-1, 4], [-2, 4]])
START, GOAL = (3.39, 9.01, 12.0), (0.44, 18.46, 12.0)
KINDS = ({"min_normal": 0.3}, {"max_force": 0.9}, {"min_normal": 0.15, "max_force": 1.2})


def on_bowl(friction, *places):
    return rg.Grasp(BOWL.contact_at(s, friction=friction) for s in places)


def asked(friction, start, goal, load, **options):
    return rg.regrasps_on_outline(
        BOWL, on_bowl(friction, *start), on_bowl(friction, *goal), load, friction=friction, **options
    )


def heading(angle):
    return rg.Wrench([np.cos(angle), np.sin(angle)])


def holds(friction, places, load, limits):
    """By the closed form of one state, which knows nothing of maps."""
    try:
        rg.choose_state(on_bowl(friction, *places), load, "peak", reserve=0.0, **limits)
    except rg.Infeasible:
        return False
    return True


def are_held(friction, places, load, limits):
    """(m,) of pairs (m, 2), by the intervals that the next test compares with ``holds``."""
    points, normals = (
        np.stack([f(s) for s in np.transpose(places)], axis=1) for f in (BOWL.points, BOWL.normals)
    )
    forces = np.tile(load.force, (len(places), 1))
    lo, hi = limited_intervals(points, normals, friction, forces, Limits(**limits))
    return lo <= hi


@pytest.mark.parametrize("limits", KINDS)
def test_maps_are_exact_with_least_normals_and_enclosed_with_force_limits(limits):
    rng = np.random.default_rng(5)
    vertices, seen = BOWL.polygon(), Counter()
    lengths = np.hypot(*(np.roll(vertices, -1, axis=0) - vertices).T)
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    bounds = Limits(**limits)
    for friction in (0.3, 0.7):
        load = heading(rng.uniform(0, 2 * np.pi))
        outer = HoldMap.of(vertices, friction, load.force, None, bounds, 8)
        inner = HoldMap.of(vertices, friction, load.force, None, bounds.chords(friction, 8), 8)
        s, t = rng.uniform(0, BOWL.length, (2, 600))
        truth = are_held(friction, np.stack([s, t], axis=1), load, limits)
        for k, (one, other) in enumerate(zip(s.tolist(), t.tolist(), strict=True)):
            places = []
            for at in (one, other):
                side = int(np.searchsorted(starts, at, side="right")) - 1
                places.append((side, (at - starts[side]) / lengths[side]))
            known = bool(truth[k])
            sure, maybe = bool(inner.at(*places, 1e-9)), bool(outer.at(*places, -1e-9))
            assert sure <= known <= maybe
            seen[sure, maybe] += 1
            if k < 25 or sure != maybe:
                assert known == holds(friction, (one, other), load, limits)
    assert seen[True, True] > 20
    assert seen[False, True] == 0 if "max_force" not in limits else seen[False, True] < 20


def test_random_tasks_agree_with_sampled_places_and_every_none_is_proven():
    rng = np.random.default_rng(18)
    seen = Counter()
    while seen["tasks"] < 20:
        friction, load = float(rng.uniform(0.03, 0.3)), heading(rng.uniform(0, 2 * np.pi))
        limits = KINDS[seen["drawn"] % 3]
        seen["drawn"] += 1
        points = rng.uniform(0, BOWL.length, (300, 2))
        held = points[are_held(friction, points, load, limits)][:2].tolist()
        if len(held) < 2:
            continue
        start, goal = ([*pair, float(rng.uniform(0, BOWL.length))] for pair in held)
        try:
            found = asked(friction, start, goal, load, **limits)
        except rg.Infeasible:  # all three of an end do not push as hard
            continue
        seen["tasks"] += 1
        assert found.exists is not None
        seen[found.exists] += 1
        if not found.exists:
            assert rg.verify(found.certificate).ok
            seen["by limits"] += bool(asked(friction, start, goal, load).exists)
        if len(found.walk):
            assert holds(friction, found.walk[len(found.walk) // 2], load, limits)
            assert are_held(friction, found.walk, load, limits).all()
        ends = on_bowl(friction, *start), on_bowl(friction, *goal)
        problem = rg.RegraspProblem(
            BOWL, *ends, load, friction, candidates=60, orientations=1, **{"min_normal": 0.0} | limits
        )
        sampled = problem.sequences()
        assert not sampled or found.exists
        seen["missed"] += bool(found.exists and not sampled)
    assert min(seen[key] for key in (True, False, "by limits", "missed")) >= 1, seen


def test_a_proof_is_of_its_limits(tmp_path):
    load = rg.Wrench([-1.0, -3.0])
    for limits, spoiled in (
        ({"max_force": 4.6}, [{"max_force": 4.9}, {"max_force": None}]),
        ({"max_force": 4.0, "min_normal": 0.5}, [{"max_force": None}, {"friction": 0.6}]),
        ({"max_force": 4.0}, [{"max_force": 5.0}, {"force": [-0.5, -1.5]}]),
    ):
        found = asked(0.4, START, GOAL, load, **limits)
        cut = found.certificate
        assert found.exists is False
        assert rg.verify(cut).ok
        assert f"forces of at most {limits['max_force']:g} N" in str(rg.verify(cut))
        assert f"forces of at most {limits['max_force']:g} N" in str(found)
        write_cut(cut, tmp_path / "cut.json")
        assert read_cut(tmp_path / "cut.json") == cut
        assert not rg.verify(replace(cut, twists=-cut.twists)).ok
        for change in spoiled:
            words = str(rg.verify(replace(cut, **change)))
            assert words.startswith("not verified"), change


@pytest.mark.parametrize("limits", [Limits(0.3), Limits(0.0, 2.0), Limits(0.3, 2.0), Limits(1.9, 2.0)])
def test_works_are_the_least_of_all_forces(limits):
    """Both checks, which share no code, against many forces within the limits."""
    rng = np.random.default_rng(2)
    mu, vertices = 0.5, np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    finder = _Finder(HoldMap(vertices, mu, np.array([[0.0, -1.0]]), np.ones(4, bool), (), limits))
    top = 3.0 if limits.max_force == inf else limits.max_force
    n, t = (np.ravel(x) for x in np.meshgrid(np.linspace(0, top, 400), np.linspace(-1, 1, 401)))
    t = t * mu * n
    kept = (n >= limits.min_normal) & (np.hypot(n, t) <= limits.max_force)
    for _ in range(60):
        twist = rng.normal(size=3)
        place, normal, along = finder.axes(0, 0.4)
        way = twist[:2] + twist[2] * np.array([-place[1], place[0]])
        work = (n[kept] * (way @ normal) + t[kept] * (way @ along)).min()
        mine = finder.least_work(0, 0.4, twist)
        most = None if limits.max_force == inf else Fraction(limits.max_force)
        numbers = (Fraction(x) for x in (3 * (way @ normal), 3 * (way @ along), 9.0, mu, limits.min_normal))
        exact = least_work(*numbers, most)
        if mine == -inf:
            assert exact == -inf
            assert way @ normal < mu * abs(way @ along)
        else:
            assert float(exact) == pytest.approx(mine, abs=1e-12)
            assert mine - 1e-12 <= work <= mine + 0.05


def test_roots_and_loads_between_are_enclosed():
    for square in (
        Fraction(2),
        Fraction(1, 3),
        Fraction(10**40),
        Fraction(1, 10**40),
        Fraction(9, 4),
        Fraction(0),
    ):
        low, high = root(square, up=False), root(square, up=True)
        assert low * low <= square <= high * high
        assert high - low <= high / 2**50
    one, other = ([Fraction(x) for x in load] for load in ([1.0, 0.0, 0.0], [-0.8, 0.6, 0.0]))
    far = np.array(corners(one, other), dtype=float)[2, :2]
    assert far == pytest.approx([1.0, 3.0])  # where the tangents at both meet
    assert corners(one, one) == [one]
    assert corners(one, [-x for x in one]) == []


def test_holds_of_turning_walks_leave_room_for_the_turn():
    load, seen = rg.Wrench([-1.0, -3.0]), 0
    for most, turn in ((8.0, 0.6), (8.0, 1.2), (40.0, 1.0)):
        found = asked(0.2, START, GOAL, load, max_force=most, min_normal=0.01, turns=(-turn, turn))
        assert found.exists
        angles = found.angles.tolist()
        for k, (places, angle) in enumerate(zip(found.walk.tolist(), angles, strict=True)):
            most_turn = max(
                abs(angle - x)
                for x in [*angles[max(k - 1, 0) : k + 2], *([0.0] if k in (0, len(angles) - 1) else [])]
            )
            limits = {"max_force": most * np.cos(most_turn / 2), "min_normal": 0.01}
            assert holds(0.2, places, load.rotated(-angle), limits)
            seen += most_turn > 0
    assert seen


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"min_normal": -1.0}, "min_normal must be at least 0"),
        ({"max_force": 0.0}, "max_force must be greater than 0"),
        ({"max_force": 1.0, "min_normal": 2.0}, "min_normal must be at most max_force, got 2 and 1"),
    ],
)
def test_what_is_no_limit_is_refused(options, words):
    assert words in str(refusal(lambda: asked(0.4, START, GOAL, rg.Wrench([-1.0, -3.0]), **options)))
    limited = rg.Grasp(c.changed(max_force=9.0) for c in on_bowl(0.4, *START))
    goal = on_bowl(0.4, *GOAL)
    words = str(
        refusal(lambda: rg.regrasps_on_outline(BOWL, limited, goal, rg.Wrench([0, -1.0]), friction=0.4))
    )
    assert "force limits of their own" in words
