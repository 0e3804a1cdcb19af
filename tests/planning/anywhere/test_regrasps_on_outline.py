"""Regrasps anywhere on an outline: exact polygons, walks through them, and proofs that there is none."""

import json
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
from regrasp.files import read_cut, write_cut
from regrasp.planning.anywhere.hold_map import HoldMap
from regrasp.planning.anywhere.polygons import area, hold_polygons, sides_across
from scenarios import regrasp

pytestmark = pytest.mark.laws

SHAPES = {
    "bowl": [[0, 0], [4, 0], [6, 4], [5, 4], [2, 1], [-1, 4], [-2, 4]],
    "bracket": [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]],
    "spanner": [
        [0, -0.5], [1.5, -0.35], [8, -0.35], [8.6, -1.3], [9.8, -1.6], [10.9, -1.1], [10.2, -0.45],
        [9.6, -0.45], [9.3, 0], [9.6, 0.45], [10.2, 0.45], [10.9, 1.1], [9.8, 1.6], [8.6, 1.3], [8, 0.35],
        [1.5, 0.35], [0, 0.5],
    ],
}  # fmt: skip
BOWL = rg.Outline(SHAPES["bowl"])
DOWN = rg.Wrench([-1.0, -3.0])


def grasp(outline, friction, *places):
    return rg.Grasp(outline.contact_at(s, friction=friction) for s in places)


def parted(start=(3.39, 9.01, 12.0), goal=(0.44, 18.46, 12.0), friction=0.2, outline=BOWL, load=DOWN):
    """Holds on the bowl in two components."""
    ends = (grasp(outline, friction, *places) for places in (start, goal))
    return rg.regrasps_on_outline(outline, *ends, load, friction=friction)


def held(outline, friction, load, s, t):
    """By the closed form of two contacts, which knows nothing of polygons."""
    p, n, q, m = outline.points(s), outline.normals(s), outline.points(t), outline.normals(t)
    lo, hi = rg.locus_intervals(p, n, friction, q, m, friction, load.force)
    return lo <= hi


def random_load(rng):
    a = rng.uniform(0, 2 * np.pi)
    return rg.Wrench(3 * np.array([np.cos(a), np.sin(a)]))


def random_end(rng, outline, friction, load):
    """Three places, two of which hold; or None."""
    s, t = rng.uniform(0, outline.length, (2, 3000))
    found = np.flatnonzero(held(outline, friction, load, s, t))
    if not found.size:
        return None
    return grasp(outline, friction, s[found[0]], t[found[0]], rng.uniform(0, outline.length))


@pytest.mark.parametrize("name", SHAPES)
def test_polygons_are_all_holds_and_no_others(name):
    """The share of pairs that hold, pair by pair of sides, and by each polygon's own place."""
    rng = np.random.default_rng(3)
    outline = rg.Outline(SHAPES[name])
    for friction in (0.1, 0.35, 0.8):
        load = random_load(rng)
        vertices = outline.polygon()
        holds = HoldMap.of(vertices, friction, load.force)
        lengths = np.hypot(*(np.roll(vertices, -1, axis=0) - vertices).T)
        starts = np.concatenate([[0.0], np.cumsum(lengths)])
        s, t = rng.uniform(0, outline.length, (2, 1500))
        truth = held(outline, friction, load, s, t)
        seen = set()
        for one, other, known in zip(s, t, truth, strict=True):
            places = []
            for at in (one, other):
                side = int(np.searchsorted(starts, at, side="right")) - 1
                places.append((side, (at - starts[side]) / lengths[side]))
            sure, maybe = (bool(holds.at(*places, room)) for room in (1e-9, -1e-9))
            assert sure <= known <= maybe
            seen.add((bool(known), sure))
        assert seen == {(True, True), (False, False)}


def rational(part):
    return tuple(rational(x) if isinstance(x, tuple) else Fraction(x) for x in part)


def test_polygons_in_rationals_are_the_same():
    sides = sides_across(BOWL.polygon(), 0.35, (0.3, -1.0))
    exact = [tuple(rational(part) for part in side) for side in sides]
    count = 0
    for i in range(len(sides)):
        for j in range(i, len(sides)):
            found = hold_polygons(sides[i], sides[j], 1e-9)
            true = hold_polygons(exact[i], exact[j], Fraction(1, 10**9))
            assert len(found) == len(true)
            for polygon, other in zip(found, true, strict=True):
                assert area(polygon) == pytest.approx(float(area(other)), rel=1e-9)
            count += len(found)
    assert count > 10


def test_walks_are_exchanges_from_hold_to_hold_that_solvers_confirm():
    rng = np.random.default_rng(8)
    outline, friction = rg.Outline(SHAPES["spanner"]), 0.5
    longest = 0
    for _ in range(6):
        load = random_load(rng)
        start, goal = (random_end(rng, outline, friction, load) for _ in range(2))
        found = rg.regrasps_on_outline(outline, start, goal, load, friction=friction)
        assert found.exists
        assert found.certificate is None
        longest = max(longest, len(found.walk))
        for s, t in found.walk[:: max(1, len(found.walk) // 5)]:
            rg.choose_state(grasp(outline, friction, s, t), load, "angle")  # or Infeasible
        for before, after in zip(found.walk[:-1].tolist(), found.walk[1:].tolist(), strict=True):
            assert set(before) & set(after)
        for end, places in ((start, found.walk[0]), (goal, found.walk[-1])):
            away = np.hypot(*(end.positions[:, None] - outline.points(places)).transpose(2, 0, 1))
            assert (away.min(axis=0) < 1e-9).all()
    assert longest > 4


@pytest.mark.parametrize("seed", range(3))
def test_samples_never_contradict_and_every_none_is_proven(seed):
    rng = np.random.default_rng(seed)
    seen = Counter()
    while sum(seen.values()) < 12:
        name = str(rng.choice(list(SHAPES)))
        outline, friction, load = rg.Outline(SHAPES[name]), float(rng.uniform(0.03, 0.3)), random_load(rng)
        ends = [random_end(rng, outline, friction, load) for _ in range(2)]
        if None in ends:
            continue
        found = rg.regrasps_on_outline(outline, *ends, load, friction=friction)
        assert found.exists is not None  # no random task is a near tie
        seen[found.exists] += 1
        if not found.exists:
            assert rg.verify(found.certificate).ok
        try:
            rg.plan_regrasp(outline, *ends, load, friction=friction, candidates=60, orientations=1)
        except rg.Infeasible:
            continue
        assert found.exists
    assert seen[True]


def test_every_part_of_a_proof_is_needed():
    found = parted()
    cut = found.certificate
    assert found.exists is False
    assert not len(found.walk)
    verdict = rg.verify(cut)
    assert verdict.ok
    assert str(verdict).startswith("no regrasp leads from the start to the goal on this outline")
    assert "not covered: other orientations, fingers on holes, fingers that slide or roll" in str(verdict)
    assert verdict.excluded == len(cut.boxes) > 5
    for k in range(len(cut.boxes)):
        without = replace(cut, boxes=np.delete(cut.boxes, k, 0), twists=np.delete(cut.twists, k, 0))
        assert not rg.verify(without).ok
    for other in (cut.twists * -1, cut.twists * 0, cut.twists[::-1], cut.twists + np.array([0, 0, 1.0])):
        assert not rg.verify(replace(cut, twists=other)).ok
    assert rg.verify(replace(cut, twists=cut.twists * 3)).ok
    for spoiled in (
        replace(cut, friction=0.6),
        replace(cut, force=[1.0, -3.0]),
        replace(cut, reached=cut.reached[1:]),
        replace(cut, reached=[*cut.reached, [0, 0.0, 1.0]]),
        replace(cut, start=cut.goal, goal=cut.start),
        replace(cut, goal=cut.start),
        replace(cut, boxes=cut.boxes * [1, 1, 1, 1 - 1e-9, 1, 1]),
        replace(cut, vertices=cut.vertices[::-1]),
    ):
        assert not rg.verify(spoiled).ok


@pytest.mark.parametrize(
    "more",
    [
        {"friction": float("nan")},
        {"min_normal": -1.0},
        {"max_force": float("inf")},
        {"twists": np.full((12, 3), np.nan)},
        {"start": np.array([[0, 2.0], [1, 0.5], [2, 0.5]])},
        {"start": np.array([[0, 0.5], [1, 0.5]])},
        {"reached": np.array([[9, 0.0, 1.0]])},
        {"boxes": np.zeros((0, 6))},
    ],
)
def test_cuts_of_others_that_are_none_are_not_taken(more):
    """As ``verify`` may see them, past the checks of ``OutlineCut``."""
    cut = parted().certificate
    fields = (
        "vertices",
        "friction",
        "force",
        "start",
        "goal",
        "reached",
        "boxes",
        "twists",
        "turned",
        "forbidden",
        "min_normal",
        "max_force",
    )
    foreign = SimpleNamespace(**{name: getattr(cut, name) for name in fields} | more)
    words = str(rg.verify(foreign))
    assert "a cut has three places" in words
    assert rg.verify(SimpleNamespace(**{name: getattr(cut, name) for name in fields})).ok


def test_a_proof_is_read_back_and_judged_from_a_file(tmp_path, capsys):
    cut = parted().certificate
    path = tmp_path / "cut.json"
    write_cut(cut, path)
    assert read_cut(path) == cut
    status, out, err = regrasp(capsys, "verify", path)
    assert (status, err) == (0, "")
    assert "each excluded by its twist, in exact arithmetic" in out
    data = json.loads(path.read_text())
    data["boxes"][0][2] += 0.01
    path.write_text(json.dumps(data))
    status, out, err = regrasp(capsys, "verify", path)
    assert status == 1
    assert "boxes do not cover all pairs across the cut" in err
    for spoiled in ({**data, "version": 2}, {**data, "format": ["regrasp cut"]}, {**data, "colour": 1}):
        path.write_text(json.dumps(spoiled))
        with pytest.raises(rg.InvalidInput, match=r"cut\.json"):
            read_cut(path)


def test_units_and_frames_do_not_count():
    a = 0.7
    turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    plain = parted()
    for length, force in ((1e-6, 1e6), (1e6, 1e-6)):
        outline = rg.Outline(length * np.array(SHAPES["bowl"]) @ turn.T + 5 * length)
        places = [np.array(p) * length for p in ((3.39, 9.01, 12.0), (0.44, 18.46, 12.0))]
        other = parted(*places, outline=outline, load=rg.Wrench(force * turn @ DOWN.force))
        assert other.exists is False
        assert rg.verify(other.certificate).ok
        assert other.components == plain.components
        for p, q in zip(plain.regions, other.regions, strict=True):
            assert np.allclose(p * length, q, rtol=1e-6, atol=1e-9 * outline.length)
    back = parted(start=(0.44, 18.46, 12.0), goal=(3.39, 9.01, 12.0))
    assert back.exists is False
    assert rg.verify(back.certificate).ok


def test_ends_that_no_two_fingers_hold_are_proven():
    both_at_one_side = (4.6, 5.0, 5.4)
    for places in ({"start": both_at_one_side}, {"goal": both_at_one_side}):
        found = parted(**places, friction=0.1)
        assert found.exists is False
        assert rg.verify(found.certificate).ok


def test_ties_are_open_and_the_same_places_need_no_move():
    """A square on two places whose cones just reach the load's line: any less friction holds no more."""
    square = rg.Outline([[0, 0], [4, 0], [4, 4], [0, 4]])
    same = (1.0, 3.0, 6.0)
    found = parted(same, same[::-1], 0.5, square, rg.Wrench([0, -1.0]))
    assert found.exists
    assert not len(found.walk)
    # Fingers on the left and right sides, level, hold the weight by any friction; above each other by none.
    high, low = (5.0, 15.0, 6.0), (7.0, 13.0, 6.0)
    assert parted(high, low, 0.5, square, rg.Wrench([0, -1.0])).exists
    tie = parted((5.0, 13.0, 14.0), (1.0, 3.0, 6.0), 0.5, square, rg.Wrench([0, -1.0]))
    assert tie.exists in (None, True)
    assert "open" in str(replace(tie, exists=None))


def test_what_is_no_such_task_is_refused():
    start, goal = grasp(BOWL, 0.2, 1.0, 2.0, 9.0), grasp(BOWL, 0.2, 1.0, 2.0, 12.0)
    asked = {"outline": BOWL, "start": start, "goal": goal, "load": DOWN, "friction": 0.2}
    for more, words in (
        ({"outline": rg.Outline.ellipse(2, 1)}, "an Outline that is a polygon"),
        ({"load": rg.Wrench([0, 0])}, "not zero"),
        ({"load": rg.Wrench([0, -1], 0.5)}, "through the centre of mass"),
        ({"friction": 0.3}, "must have the friction 0.3"),
        ({"friction": 0.0}, "friction"),
        ({"start": start.without("P1")}, "three contacts"),
        ({"outline": rg.Outline(SHAPES["spanner"])}, "on no side of the outline"),
    ):
        assert words in str(refusal(lambda more=more: rg.regrasps_on_outline(**asked | more)))
