"""Proofs of bounds on placements, re-read, tampered with, and of other grasps."""

import json
from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.placement.proofs.placement_proof import PlacementProof

pytestmark = pytest.mark.contract

BRACKET = rg.Outline(
    [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]], holes=[[[0.3, 0.3], [0.3, 0.6], [0.6, 0.3]]]
)
LOADS = rg.LoadSet.hull([rg.Wrench([0, -1], 0.2), rg.Wrench([0.9, 0.3]), rg.Wrench([-0.3, 1], -0.2)])


@cache
def chosen(objective: str = "sum_normal") -> rg.ChosenGrasp:
    return rg.choose_grasp(BRACKET, 3, LOADS, friction=0.4, objective=objective, from_corners=0.05)


@pytest.mark.parametrize("objective", ["sum_normal", "peak_normal", "peak", "effort"])
def test_a_chosen_grasp_is_verified_from_plain_data(objective: str) -> None:
    again = rg.ChosenGrasp.from_dict(json.loads(json.dumps(chosen(objective).to_dict())))
    assert again == chosen(objective)
    verdict = rg.verify(again)
    assert verdict.ok
    assert "boxes cover all of them" in str(verdict)
    assert verdict.bound == again.bound <= again.value


def spoiled(change: Callable[[dict[str, Any]], None]) -> rg.ChosenGrasp:
    """A chosen grasp whose proof was changed by somebody who does not mind the digest."""
    proof = chosen().certificate
    values = {name: np.array(v) if isinstance(v, np.ndarray) else v for name, v in vars(proof).items()}
    change(values)
    return replace(chosen(), certificate=replace(proof, **values))


def leaf(values: dict[str, Any]) -> int:
    """A box that is excluded by a twist, not the last."""
    return int(np.flatnonzero((values["children"][:, 1] == 0) & (values["number"] >= 0))[3])


def _drop(values: dict[str, Any]) -> None:
    parent = int(np.flatnonzero(values["children"][:, 1] > 0)[1])
    values["children"][parent, 1] -= 1


def _shrink(values: dict[str, Any]) -> None:
    box = leaf(values)
    values["ends"][box, 0, 1] -= 0.01 * (values["ends"][box, 0, 1] - values["ends"][box, 0, 0])


def _raise(values: dict[str, Any]) -> None:
    values["bound"] *= 1.001


def _twist(values: dict[str, Any]) -> None:
    values["twists"][leaf(values)] = 0.0


def _flip(values: dict[str, Any]) -> None:
    values["twists"][leaf(values)] *= -1


def _load(values: dict[str, Any]) -> None:
    values["number"][leaf(values)] = 77


def _near(values: dict[str, Any]) -> None:
    values["number"][leaf(values)] = -1


def _friction(values: dict[str, Any]) -> None:
    values["friction"] = 0.8


def _vertex(values: dict[str, Any]) -> None:
    values["vertices"][1] += [0.2, 0.0]


def _side(values: dict[str, Any]) -> None:
    values["sides"] = values["sides"][:-1]


def _centre(values: dict[str, Any]) -> None:
    values["centre_of_mass"] += 0.01


def _root_box(values: dict[str, Any]) -> None:
    values["arcs"][0, 0, 1] -= 1


def _loop(values: dict[str, Any]) -> None:
    values["children"][leaf(values)] = [1, 2]


def _none(values: dict[str, Any]) -> None:
    values["twists"][leaf(values)] = np.nan


@pytest.mark.parametrize(
    "change",
    [
        _drop, _shrink, _raise, _twist, _flip, _load, _near, _friction, _vertex, _side, _centre, _root_box,
        _loop, _none,
    ],
)  # fmt: skip
def test_a_spoiled_proof_proves_nothing(change: Callable[[dict[str, Any]], None]) -> None:
    assert not rg.verify(spoiled(change)).ok


def test_each_box_matters() -> None:
    """Whichever box is taken away from those that another is split into, the rest do not cover it."""
    proof = chosen().certificate
    for parent in np.flatnonzero(proof.children[:, 1] > 0)[:40]:
        children = np.array(proof.children)
        children[parent, 1] -= 1
        assert not rg.verify(replace(proof, children=children)).ok
        children[parent] += 1
        assert not rg.verify(replace(proof, children=children)).ok


def test_a_number_touched_in_a_file_is_seen() -> None:
    rng = np.random.default_rng(0)
    for name in ("twists", "ends", "vertices", "loads", "sides"):
        data = json.loads(json.dumps(chosen().to_dict()))
        row = data["certificate"][name]
        while isinstance(row[0], list):
            row = row[int(rng.integers(len(row)))]
        row[0] = row[0] + 1e-12 * (1 + abs(row[0]))
        with pytest.raises(rg.InvalidInput, match="digest"):
            rg.ChosenGrasp.from_dict(data)


def test_all_that_is_touched_beside_the_proof_is_seen_too_and_data_of_before_have_no_digest() -> None:
    data = json.loads(json.dumps(chosen().to_dict()))
    for touch in (
        lambda d: d.update(value=d["value"] * (1 + 1e-12)),
        lambda d: d.update(bound=d["bound"] * (1 - 1e-12)),
        lambda d: d.update(max_force=1e3),
        lambda d: d["others"].pop(),
        lambda d: d["others"][0]["places"].reverse(),
        lambda d: d["others"][0].update(value=2 * d["others"][0]["value"]),
        lambda d: d["grasp"]["contacts"][0].update(name="G1"),
        lambda d: d["states"].reverse(),
        lambda d: d["shape"]["vertices"][0].__setitem__(0, d["shape"]["vertices"][0][0] - 1e-9),
        lambda d: d.update(digest=d["certificate"]["digest"]),
    ):
        wrong = deepcopy(data)
        touch(wrong)
        with pytest.raises(rg.InvalidInput, match="the digest of a chosen grasp does not fit"):
            rg.ChosenGrasp.from_dict(wrong)
    del data["digest"]
    assert rg.ChosenGrasp.from_dict(data) == chosen()


def test_claims_that_the_proof_does_not_cover_are_seen() -> None:
    good = chosen()
    moved = rg.Grasp(rg.Contact(c.position + 1e-6 * c.normal, c.normal, 0.4, name=c.name) for c in good.grasp)
    states = [rg.choose_state(moved, s.load, "sum_normal") for s in good.states]
    for wrong, words in (
        (replace(good, bound=good.value * 1.01), "above the value"),
        (replace(good, bound=good.bound * 1.0001), "above what the proof says"),
        (replace(good, objective="peak"), "not of peak"),
        (replace(good, value=good.bound), "above the value"),
        (replace(good, value=good.value * 1.000001), "worse than what the states show"),
        (replace(good, grasp=moved, states=tuple(states), value=9.0), "none of the sides"),
        (replace(good, states=good.states[:2]), "has no state"),
        (replace(good, states=()), "no state"),
        (replace(good, shape=rg.Outline([[0, 0], [4, 0], [0, 3]])), "another outline"),
    ):
        assert any(words in v for v in rg.verify(wrong).violations), words


def test_the_value_is_that_of_the_loads_of_the_proof() -> None:
    """An easier load, or one vertex of a hull alone, shows no value of them all."""
    one = rg.choose_grasp(BRACKET, 2, rg.Wrench([0, -1.0]), friction=0.5, from_corners=0.05)
    (state,) = one.states
    easy = rg.GraspState(state.grasp, rg.Wrench([0, -0.1]), state.forces / 10)
    tenth = replace(one, states=(easy,), value=one.value / 10, bound=one.value / 10)
    assert any("has no state" in v for v in rg.verify(tenth).violations)
    assert any("below what the proof says" in v for v in rg.verify(tenth).violations)
    for state in chosen().states:
        value = float((state.forces * state.grasp.normals).sum())
        alone = replace(chosen(), states=(state,), value=value, bound=min(value, chosen().bound))
        assert not rg.verify(alone).ok


def test_a_factor_is_that_of_the_deviations() -> None:
    answered = rg.choose_grasp(
        BRACKET, 3, rg.Wrench([0, -1.0]), friction=0.5, objective="answered", max_force=5.0,
        disturbance=rg.LoadSet.hull([rg.Wrench([1, 0]), rg.Wrench([-1, 0]), rg.Wrench([0, 0], 0.3)]),
        tolerance=0.05,
    )  # fmt: skip
    assert rg.verify(answered).ok
    assert rg.ChosenGrasp.from_dict(json.loads(json.dumps(answered.to_dict()))) == answered
    assert answered.deviations is not None
    for wrong in (
        replace(answered, value=answered.value * 10, bound=answered.bound * 10),
        replace(answered, deviations=answered.deviations / 10),
        replace(answered, deviations=None),
        replace(answered, bound=answered.value),
    ):
        assert not rg.verify(wrong).ok


def test_limits_and_distances_that_are_no_numbers_prove_nothing() -> None:
    level = rg.choose_grasp(
        BRACKET, 3, rg.Wrench([0, -1.0]), friction=0.5, objective="angle", max_force=2.0, tolerance=0.05
    )
    assert rg.verify(level).ok
    for limit in (None, np.nan, np.inf, 0.0):
        assert not rg.verify(replace(level, max_force=limit)).ok
    mixed = rg.Grasp(c.changed(friction=0.5 + 0.1 * k) for k, c in enumerate(level.grasp))
    states = [rg.GraspState(mixed, s.load, s.forces) for s in level.states]
    assert not rg.verify(replace(level, grasp=mixed, states=tuple(states))).ok
    assert not rg.verify(replace(chosen(), min_normal=np.nan)).ok
    for distance in (-100.0, np.nan, np.inf):
        assert not rg.verify(replace(level.certificate, min_distance=distance)).ok


@pytest.mark.parametrize("scale", [1e-310, 1e-250, 1e-150, 1e-60, 1e60])
def test_twists_of_every_size_are_judged_alike(scale: float) -> None:
    """Doubles of 1e-310 have lost their digits: these boxes are judged in rationals."""
    proof = chosen().certificate
    scaled = np.array(proof.twists) * scale
    assert not rg.verify(replace(proof, twists=scaled, bound=proof.bound * 1.01)).ok
    if scale > 1e-300:
        assert rg.verify(replace(proof, twists=scaled)).ok


def test_short_sides_far_from_the_origin_are_judged_alike() -> None:
    """The filter in doubles takes the directions of sides from the vertices as they are given."""
    vertices = np.array([[1e6, 1e6], [1e6 + 1e-3, 1e6], [1e6 + 1e-3, 1e6 + 2e-3], [1e6, 1e6 + 1e-3]])
    shape = rg.Outline(vertices)
    found = rg.choose_grasp(shape, 2, rg.Wrench([0, -1.0]), friction=0.5)
    assert rg.verify(found.certificate).ok


def test_a_proof_at_its_limit() -> None:
    """The bound of a proof may rise to what its weakest box proves and no further."""
    proof = chosen().certificate
    assert rg.verify(proof).ok
    lo, hi = 1.0, 2.0
    while hi - lo > 1e-12:
        middle = (lo + hi) / 2
        lo, hi = (middle, hi) if rg.verify(replace(proof, bound=proof.bound * middle)).ok else (lo, middle)
        if hi - lo < 1e-3 and lo == 1.0:
            break
    assert not rg.verify(replace(proof, bound=proof.bound * hi)).ok
    assert hi < 1.01


def test_the_verdict_says_which_part_of_the_outline_the_proof_is_of() -> None:
    square = rg.Outline([[0, 0], [2, 0], [2, 2], [0, 2]])
    for options, part in ({"from_corners": 0.5}, "50.0%"), ({"from_corners": 0.25}, "75.0%"):
        chosen = rg.choose_grasp(square, 2, rg.Wrench([0, -1]), friction=0.5, objective="peak", **options)
        words = f"no placement on the {part} of the outline that was asked about is better than"
        assert words in str(rg.verify(chosen))
        assert words in str(rg.verify(chosen.certificate))


@cache
def in_a_valley() -> PlacementProof:
    """Of two fingers on parallel sides, where boxes need the twists of two loads."""
    bar = rg.Outline([[0, 0], [3, 0], [3, 1], [0, 1]])
    loads = rg.LoadSet.hull([rg.Wrench(f, 0.1 * sum(f)) for f in ([1, 0], [-1, 0], [0, 1], [0, -1])])
    given = {"friction": 0.4, "objective": "peak", "from_corners": 0.0, "tolerance": 0.03}
    return rg.choose_grasp(bar, 2, loads, **given).certificate  # type: ignore[arg-type]


def test_two_twists_bound_a_box_together() -> None:
    proof = in_a_valley()
    assert rg.verify(type(proof).from_dict(json.loads(json.dumps(proof.to_dict())))).ok
    assert proof.pairs is not None
    assert proof.seconds is not None
    broken = 0
    for i in range(len(proof.pairs)):
        changed = proof.seconds.copy()
        changed[i] *= -1
        broken += not rg.verify(replace(proof, seconds=changed)).ok
    assert broken == len(proof.pairs) > 9  # each is needed
    assert not rg.verify(replace(proof, pairs=np.add(proof.pairs, [0, 77]))).ok
    assert rg.verify(replace(proof, seconds=0.5 * proof.seconds, twists=0.5 * proof.twists)).ok


@pytest.mark.parametrize("change", [{"seconds": None}, {"norm": "sum"}, {"seconds": np.zeros((1, 3))}])
def test_second_twists_without_a_meaning_prove_nothing(change: dict[str, Any]) -> None:
    assert not rg.verify(replace(in_a_valley(), **change)).ok
