"""Three fingers on polygons of many sides, two on few sides each and one on any: against the other search."""

import json
from dataclasses import replace

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.placement.laws import law_of
from regrasp.planning.placement.levels.level import FrictionLevel
from regrasp.planning.placement.levels.paired_search import closed_by_pairs, finer
from regrasp.planning.placement.reachable import sides_of
from regrasp.planning.placement.search import Search

pytestmark = pytest.mark.oracle

MANY = "regrasp.planning.placement.levels.searching.MANY"
ANGLES = np.repeat(np.arange(6) * np.pi / 3, 2)
LOADS = np.column_stack([np.cos(ANGLES), np.sin(ANGLES), np.tile([0.5, -0.5], 6)])
SHARE = 0.4  # of these torques, where more boxes are wanted


def lobed(sides: int, lobes: int = 5) -> rg.Outline:
    around = 2 * np.pi * np.arange(sides) / sides
    return rg.Outline(
        np.column_stack([np.cos(around), np.sin(around)]) * (1 + 0.1 * np.cos(lobes * around))[:, None]
    )


def asked(shape: rg.Outline, tolerance: float = 1e-2, torque: float = 1.0, **more):
    given = {"friction": 0.4, "objective": "friction_use", "max_force": 4.0, "from_corners": 0.0} | more
    loads = rg.LoadSet.hull(map(rg.Wrench.from_vector, LOADS * [1, 1, torque]))
    return rg.choose_grasp(shape, 3, loads, tolerance=tolerance, **given)


@pytest.fixture(scope="module")
def found():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(MANY, 8)
        return asked(lobed(15))


def test_both_searches_agree(found) -> None:
    other = asked(lobed(15))
    assert found.certificate.by_side is not None
    assert other.certificate.by_side is None
    assert max(found.gap, other.gap) <= 1e-2
    assert found.value >= other.bound
    assert other.value >= found.bound


def test_its_proof_stands_alone(found) -> None:
    read = rg.ChosenGrasp.from_dict(json.loads(json.dumps(found.to_dict())))
    verdict = rg.verify(read)
    assert verdict.ok
    assert verdict.bound == found.bound
    split = np.asarray(read.certificate.children)[:, 1] > 0
    assert split[read.certificate.by_side[:, 0]].any()  # sides left to boxes of their own


def test_a_number_that_is_touched_is_found(found) -> None:
    """Each row with less of a twist, another load or another box, one at a time; some are not needed."""
    proof = found.certificate
    rng = np.random.default_rng(0)
    for name, change in ("side_twists", lambda t: -t), ("by_side", lambda b: b * [1, 0] + [0, 11 - b[1]]):
        caught = 0
        for row in rng.choice(len(proof.by_side), size=12, replace=False):
            values = np.array(getattr(proof, name))
            values[row] = change(values[row])
            caught += not rg.verify(replace(proof, **{name: values})).ok
        assert caught >= 5
    rows = np.array(proof.by_side)
    for box in rng.choice(np.unique(rows[:, 0]), size=6, replace=False):
        without = rows[:, 0] != box
        less = replace(proof, by_side=rows[without], side_twists=proof.side_twists[without])
        assert not rg.verify(less).ok


def test_a_box_inside_that_shrinks_is_found(found) -> None:
    proof = found.certificate
    children = np.asarray(proof.children)
    parents = np.unique(proof.by_side[children[proof.by_side[:, 0], 1] > 0, 0])
    for parent in parents[:: max(len(parents) // 6, 1)]:
        child = int(children[parent, 0])
        wide = int(np.diff(proof.arcs[parent], axis=1).argmax())
        ends = np.array(proof.ends)
        ends[child, wide, 0] = ends[child, wide].mean()
        assert not rg.verify(replace(proof, ends=ends)).ok
        fewer = children.copy()
        fewer[parent, 1] -= 1
        assert not rg.verify(replace(proof, children=fewer)).ok


def test_fingers_that_must_be_apart_and_angles(monkeypatch) -> None:
    monkeypatch.setattr(MANY, 8)
    for more in {"min_distance": 0.5}, {"objective": "angle"}:
        one = asked(lobed(15), **more)
        assert one.certificate.by_side is not None
        assert one.gap <= 1e-2
        assert rg.verify(one).ok
        with monkeypatch.context() as patch:
            patch.setattr(MANY, 1000)
            other = asked(lobed(15), **more)
        better = 1 if more.get("objective") == "angle" else -1
        assert better * (other.value - one.bound) <= 0
        assert better * (one.value - other.bound) <= 0


def test_cut_short_the_looser_level_is_the_bound(monkeypatch) -> None:
    """With too few boxes for the last level, that of 3 % counts; with fewer still none."""
    monkeypatch.setattr(MANY, 8)
    shape, bounds = lobed(15), []
    for most in 2100, 2450:
        chosen = asked(shape, 1e-4, SHARE, most_boxes=most)
        assert rg.verify(chosen).ok
        bounds.append(chosen.bound)
    assert bounds[0] == 0.0
    assert bounds[1] >= 0.96 * chosen.value
    assert chosen.gap > 0.02


def test_long_sides_are_cut_and_no_place_is_lost() -> None:
    shape = rg.Outline([[-2, -1], [2, -1], [0, 2]])
    sides = sides_of(shape, 0.0, None, 0.0, False)
    cut = finer(sides, 0.01)
    assert len(cut.edges) > 50
    assert (np.diff(cut.edges) >= 0).all()
    for edge, (lo, hi) in enumerate(sides.ends):
        own = cut.ends[cut.edges == edge]
        assert (own[0, 0], own[-1, 1]) == (lo, hi)
        assert (own[1:, 0] == own[:-1, 1]).all()


def test_an_interrupt_leaves_the_best_so_far() -> None:
    sides = sides_of(lobed(15), 0.0, None, 0.0, False)
    search = Search(sides, 3, 0.4, LOADS, law_of("friction_use")[1], 1e-6, 1e-3)
    level = FrictionLevel(4.0, 0.4, angle=False)

    def progress(*_: float) -> None:
        raise KeyboardInterrupt

    ended, best, beyond = closed_by_pairs(search, level, -1.0, 1e-2, 10_000, progress)
    assert ended.interrupted
    assert not ended.closed
    assert (best, beyond) == (-1.0, 0.0)
