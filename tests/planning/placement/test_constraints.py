"""Limits that bounds know, and constraints that they do not: kept by what is chosen, and the bound is one."""

from itertools import combinations
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal

pytestmark = pytest.mark.oracle

BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
LOADS = [rg.Wrench([0, -1], 0.2), rg.Wrench([0, -1], -0.2), rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1])]
TILTED = rg.LoadSet.hull(LOADS)


def sampled_best(fingers: int, count: int, objective: str, allowed=lambda grasp: True, **limits) -> float:
    best = np.inf
    contacts = [BRACKET.contact_at(s, friction=0.4) for s in BRACKET.sample(count)]
    for few in combinations(contacts, fingers):
        grasp = rg.Grasp(few)
        if not allowed(grasp):
            continue
        try:
            values = [rg.choose_state(grasp, load, objective, **limits).value for load in LOADS]
        except rg.Infeasible:
            continue
        best = min(best, max(values))
    return best


@pytest.mark.parametrize(
    ("objective", "limits"),
    [("sum_normal", {"max_force": 0.65}), ("effort", {"min_normal": 0.45}), ("peak", {"min_normal": 0.5})],
)
def test_no_sampled_placement_within_the_limits_is_better(objective: str, limits: dict[str, float]) -> None:
    chosen = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, objective=objective, most_boxes=512, **limits)
    free = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, objective=objective)
    sampled = sampled_best(2, 14, objective, **limits)
    assert free.bound <= chosen.value * (1 + 1e-9)
    assert chosen.bound <= chosen.value <= sampled * 1.01
    for state in chosen.states:
        assert np.hypot(*state.forces.T).max() <= limits.get("max_force", np.inf) * (1 + 1e-9)
        assert (state.forces * state.grasp.normals).sum(axis=1).min() >= limits.get("min_normal", 0) - 1e-9
    assert rg.verify(chosen).ok
    assert rg.ChosenGrasp.from_dict(chosen.to_dict()) == chosen


@pytest.mark.parametrize("objective", ["sum_normal", "peak_normal", "peak", "effort"])
@pytest.mark.parametrize("limits", [{"min_normal": 0.3}, {"max_force": 0.7, "min_normal": 0.3}])
def test_gaps_close_within_limits_and_no_triple_is_better(objective: str, limits: dict[str, float]) -> None:
    chosen = rg.choose_grasp(BRACKET, 3, TILTED, friction=0.4, objective=objective, **limits)
    assert chosen.gap <= 1e-3
    assert (chosen.certificate.max_force or 0.0, chosen.certificate.min_normal) == (
        limits.get("max_force", 0.0),
        0.3,
    )
    assert chosen.bound <= chosen.value <= sampled_best(3, 9, objective, **limits)
    moved = [
        [BRACKET.contact_at(s + d, friction=0.4) for s, d in zip(chosen.places, off, strict=True)]
        for off in np.random.default_rng(0).normal(scale=0.03, size=(40, 3))
    ]
    values = []
    for few in moved:
        try:
            values.append(max(rg.choose_state(rg.Grasp(few), w, objective, **limits).value for w in LOADS))
        except rg.Infeasible:
            continue
    assert chosen.bound <= min(values) < 1.2 * chosen.value  # they compete


@pytest.mark.parametrize("unit", [1e-3, 1e3])
@pytest.mark.parametrize("objective", ["sum_normal", "effort"])
def test_limits_have_the_units_of_forces(objective: str, unit: float) -> None:
    scaled = rg.LoadSet.hull([rg.Wrench(w.force * unit, w.torque * unit * 10) for w in LOADS])
    large = rg.Outline(np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]) * 10.0)
    given = {"friction": 0.4, "objective": objective}
    one = rg.choose_grasp(BRACKET, 3, TILTED, min_normal=0.3, max_force=0.7, **given)
    other = rg.choose_grasp(large, 3, scaled, min_normal=0.3 * unit, max_force=0.7 * unit, **given)
    power = 2 if objective == "effort" else 1
    assert other.value == pytest.approx(one.value * unit**power, rel=1e-3)
    assert rg.verify(other).ok


def test_that_no_fingers_push_so_hard_is_proven() -> None:
    """Without friction both must be on the lower side, and push with 1 N together."""
    triangle, weight = rg.Outline([[0, 0], [2, 0], [1, 1.7]]), rg.Wrench([0, -1])
    half = rg.choose_grasp(triangle, 2, weight, friction=0.0, min_normal=0.49)
    assert half.value == pytest.approx(1.0)
    with pytest.raises(rg.Infeasible, match=r"each finger pushing with 0\.51 N or more") as caught:
        rg.choose_grasp(triangle, 2, weight, friction=0.0, min_normal=0.51)
    assert rg.verify(caught.value.certificate).ok


def test_a_touched_limit_is_seen() -> None:
    data = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, min_normal=0.1, max_force=2.0).to_dict()
    for name, value in (("max_force", 0.3), ("min_normal", 0.7)):
        with pytest.raises(rg.InvalidInput, match="digest"):
            rg.ChosenGrasp.from_dict({**data, name: value})
        unsigned = {key: given for key, given in data.items() if key != "digest"}
        assert not rg.verify(rg.ChosenGrasp.from_dict({**unsigned, name: value})).ok


def near(first: np.ndarray, second: np.ndarray, angle: float) -> np.ndarray:
    assert angle == 0.0
    return np.hypot(*(first - second).T) < 2.5


def test_a_gripper_of_little_reach_gets_what_it_reaches_and_an_honest_gap() -> None:
    chosen = rg.choose_grasp(
        BRACKET, 2, TILTED, friction=0.4, objective="peak", keep=near, most_boxes=3000, tolerance=1e-3
    )
    a, b = chosen.grasp.positions
    assert np.hypot(*(a - b)) < 2.5
    sampled = sampled_best(2, 20, "peak", lambda g: np.hypot(*(g.positions[0] - g.positions[1])) < 2.5)
    assert chosen.bound <= chosen.value <= sampled * 1.01
    assert chosen.gap > 1e-3  # the bound is that of all placements
    assert rg.verify(chosen).ok


def test_fingers_that_must_be_opposite_are_found_though_no_box_leads_there() -> None:
    def opposite(first: np.ndarray, second: np.ndarray, angle: float) -> np.ndarray:
        return np.abs((first - second)[:, 0]) < 0.02

    chosen = rg.choose_grasp(
        BRACKET, 2, TILTED, friction=0.4, objective="peak", keep=opposite, most_boxes=256
    )
    com = BRACKET.centre_of_mass
    values = []
    for x in np.linspace(1.05, 3.95, 30):  # along the foot, from below and above
        pair = [rg.Contact([x, y] - com, normal=[0, 1 - 2 * y], friction=0.4) for y in (0.0, 1.0)]
        try:
            values.append(max(rg.choose_state(rg.Grasp(pair), load, "peak").value for load in LOADS))
        except rg.Infeasible:
            continue
    assert values
    assert chosen.bound <= chosen.value <= min(values) * (1 + 1e-6)
    assert bool(opposite(*chosen.grasp.positions[:, None], 0.0)[0])


def test_a_third_finger_makes_nothing_worse_where_few_may_hold_together() -> None:
    """No three of 48 points are so near in x: they are two good places and one more beside them."""

    def above(first: np.ndarray, second: np.ndarray, angle: float) -> np.ndarray:
        return np.abs((first - second)[:, 0]) < 0.02

    given = {"friction": 0.4, "objective": "peak", "keep": above, "most_boxes": 256}
    two, three = (rg.choose_grasp(BRACKET, k, TILTED, **given) for k in (2, 3))
    assert three.bound <= three.value <= two.value
    assert np.ptp(three.grasp.positions[:, 0]) < 0.02


def test_who_stays_when_a_finger_leaves_holds_by_forces_that_are_no_rounding() -> None:
    """Of two loads each pair of the first choice held one, and the other by a million times its force."""
    shape = rg.Outline(
        [[1.156, 0.168], [0.58, 0.81], [-0.1, 0.942], [-1.048, 1.008], [-1.063, 0.647], [-0.646, -0.165],
         [-0.71, -1.078], [-0.19, -1.318], [0.719, -0.714], [0.447, -0.27]]
    )  # fmt: skip
    loads = [rg.Wrench([-0.76, -0.863], -0.092), rg.Wrench([0.562, -0.843], 0.144)]
    chosen = rg.choose_grasp(
        shape, 3, rg.LoadSet.hull(loads), friction=0.3, objective="peak_normal", removable=True,
        most_boxes=256,
    )  # fmt: skip

    def largest(pair: tuple[rg.Contact, ...]) -> float:
        try:
            return max(rg.choose_state(rg.Grasp(pair), load, "peak").value for load in loads)
        except rg.Infeasible:
            return np.inf

    assert min(map(largest, combinations(chosen.grasp, 2))) <= 1.2e3


def test_a_finger_can_leave_what_is_chosen_removable() -> None:
    chosen = rg.choose_grasp(
        BRACKET, 3, TILTED, friction=0.4, objective="effort", removable=True, max_force=1.0, most_boxes=3000
    )

    def holds(pair: list[rg.Contact]) -> bool:
        try:
            return all(rg.choose_state(rg.Grasp(pair), load, "peak").value <= 1.0 for load in LOADS)
        except rg.Infeasible:
            return False

    assert any(holds(list(pair)) for pair in combinations(chosen.grasp, 2))
    assert rg.verify(chosen).ok


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"keep": lambda p, q, a: [[1], [1, 2]]}, "booleans; it returned [[1], [1, 2]]"),
        ({"keep": lambda p, q, a: ["x"] * len(p)}, "booleans; it returned ['x'"),
        ({"keep": lambda p, q, a: np.full(len(p), np.nan)}, "booleans; it returned "),
        ({"keep": lambda p, q, a: None}, "booleans; it returned None"),
        ({"max_force": 1.0, "min_normal": 1.1}, "min_normal 1.1 is above max_force 1, which no force meets"),
        ({"objective": "answered", "max_force": 5.0, "load_offset": 0.1}, "load_offset is of loads"),
        ({"objective": "wrench", "max_force": 5.0, "load_offset": 0.1}, "load_offset is of loads"),
    ],
)
def test_constraints_that_say_nothing_are_refused(more: dict[str, Any], words: str) -> None:
    one = rg.Wrench([0, -1])
    assert words in refusal(lambda: rg.choose_grasp(BRACKET, 2, one, friction=0.4, **more))


def test_a_limit_too_low_is_refused_with_a_proof_and_a_filter_without() -> None:
    with pytest.raises(rg.Infeasible, match=r"at most 0\.3 N") as caught:
        rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, max_force=0.3)
    assert rg.verify(caught.value.certificate).ok
    with pytest.raises(rg.Infeasible, match="not proven") as caught:
        rg.choose_grasp(
            BRACKET, 2, TILTED, friction=0.4, keep=lambda p, q, a: len(p) * [False], most_boxes=256
        )
    assert rg.verify(caught.value.certificate).ok
