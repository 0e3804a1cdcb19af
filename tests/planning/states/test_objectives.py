"""Objectives are values: what each says of itself is true, and one of a user's own is as good as the rest."""

import pickle
from pathlib import Path
from typing import get_args

import cvxpy as cp
import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD
from regrasp.closed_form import choice as closed
from regrasp.files import read_plan, write_plan
from regrasp.planning.states.objectives import (
    OBJECTIVES,
    ConvexObjective,
    LevelObjective,
    Objective,
    ObjectiveName,
    objective_of,
)
from regrasp.planning.states.program import state_program
from space import random_grasp, random_load, soft_random
from strategies import comfortable_pair, comfortable_triple

pytestmark = pytest.mark.contract


def test_the_words_are_known_everywhere() -> None:
    assert tuple(OBJECTIVES) == get_args(ObjectiveName)
    assert {o.name: o.closed_form for o in OBJECTIVES.values()} == {
        name: code for code, name in enumerate(closed.OBJECTIVES)
    } | {"wrench": None}
    for objective in OBJECTIVES.values():
        assert isinstance(objective, ConvexObjective) != isinstance(objective, LevelObjective)
        assert pickle.loads(pickle.dumps(objective)) == objective
        assert objective_of(objective.name) is objective is objective_of(objective)


@pytest.mark.parametrize("wrong", ["speed", None, 3, ["angle"], object()])
def test_nothing_unknown_falls_through(wrong: object) -> None:
    words = "objective must be one of angle, force, .*, peak_normal, friction_use, sum_normal, wrench; got"
    for call in (
        lambda: rg.choose_state(GRASP, LOAD, wrong),
        lambda: rg.plan_removal(GRASP, "P3", load=LOAD, objective=wrong),
        lambda: rg.plan_removal(GRASP, "P3", load=LOAD, whole_objective=wrong),
        lambda: rg.Criteria(wrong),
        lambda: state_program(GRASP, LOAD, wrong, [0.3] * 3, [9.0] * 3, 1.0),
    ):
        with pytest.raises(rg.InvalidInput, match=words):
            call()
    with pytest.raises(rg.InvalidInput, match="one program states a convex objective"):
        state_program(GRASP, LOAD, "angle", [0.3] * 3, [9.0] * 3, 1.0)


class Unfinished(Objective):
    """Neither a program nor a level."""

    def of_contacts(self, forces: np.ndarray, grasp: rg.Grasp) -> np.ndarray:
        return np.zeros(forces.shape[:-1])


def test_an_objective_that_is_neither_program_nor_level_is_refused() -> None:
    with pytest.raises(rg.InvalidInput, match="a ConvexObjective or a LevelObjective, got Unfinished"):
        rg.choose_state(GRASP, LOAD, Unfinished("mine", "mine", "mine", "sum", "N"))


# -- the least sum of normal forces ---------------------------------------------------------------------


def sum_by_cvxpy(grasp: rg.Grasp, load: rg.Wrench, limit: float | None = None) -> float:
    d = grasp.dimension
    f = cp.Variable((len(grasp), d))
    held = [grasp.matrix @ cp.reshape(f, (len(grasp) * d,), order="C") + load.vector == 0]
    normals = []
    for i, c in enumerate(grasp):
        n = c.normal @ f[i]
        normals.append(n)
        held.append(cp.norm(f[i] - n * c.normal) <= c.friction * n)
        if limit is not None:
            held.append(cp.norm(f[i]) <= limit)
    problem = cp.Problem(cp.Minimize(cp.sum(cp.hstack(normals))), held)
    problem.solve(solver=cp.CLARABEL)
    return float(problem.value)


@pytest.mark.parametrize("seed", range(6))
def test_least_sum_of_normals(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pair, triple = comfortable_pair(rng), comfortable_triple(rng)
    for grasp, load in (pair, triple, (random_grasp(rng, 4), random_load(rng))):
        try:
            state = rg.choose_state(grasp, load, "sum_normal", reserve=0.0)
        except rg.Infeasible:
            continue
        least = sum_by_cvxpy(grasp, load)
        assert state.value == pytest.approx(least, rel=1e-6, abs=1e-9)
        assert state.value == pytest.approx(float(grasp.cones.normal(state.forces).sum()), rel=1e-12)
        assert state.is_balanced(reserve=0.0)
    closed_form = rg.choose_state(*pair, "sum_normal")
    solved = rg.choose_state(*pair, "sum_normal", method="clarabel")
    assert (closed_form.method, solved.method) == ("closed-form", "clarabel")
    assert solved.value == pytest.approx(closed_form.value, rel=1e-7)


def test_sum_of_normals_where_any_squeeze_adds_as_much_as_it_takes() -> None:
    """Parallel normals: the sum is the load's, whatever the squeeze; then the least effort."""
    legs = rg.Grasp([rg.Contact([-1, 0], [0, 1], 0.5), rg.Contact([1, 0], [0, 1], 0.5)])
    state = rg.choose_state(legs, rg.Wrench([0, -2.0]), "sum_normal")
    assert state.value == pytest.approx(2.0)
    assert state.forces == pytest.approx(np.array([[0, 1.0], [0, 1.0]]))


def test_sum_of_normals_in_batches_and_sensitivities() -> None:
    grasp, load = comfortable_pair(np.random.default_rng(2))
    a, b = grasp
    x = rg.best_squeezes(
        a.position, a.normal, a.friction, b.position, b.normal, b.friction, load.force, load.torque[0],
        objective="sum_normal",
    )  # fmt: skip
    locus = rg.EquilibriumLocus(grasp, load)
    assert float(x) == pytest.approx(locus.squeeze(locus.best("sum_normal", reserve=0.0)), rel=1e-12)
    rates = rg.sensitivity(grasp, load, "sum_normal")
    step = 1e-6
    for i in range(2):
        turned = []
        for sign in (1, -1):
            c, s = np.cos(sign * step), np.sin(sign * step)
            n = grasp[i].normal
            contact = rg.Contact(
                grasp[i].position,
                [c * n[0] - s * n[1], s * n[0] + c * n[1]],
                grasp[i].friction,
                name=grasp[i].name,
            )
            turned.append(rg.choose_state(grasp.replaced(i, contact), load, "sum_normal").value)
        assert rates.normal[i] == pytest.approx((turned[0] - turned[1]) / (2 * step), rel=1e-4, abs=1e-6)


# -- an objective of one's own --------------------------------------------------------------------------


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_forces_near_given_ones(unit: float) -> None:
    """The nearest forces, weighed per finger, against cvxpy; in any unit of force."""
    rng = np.random.default_rng(5)
    grasp, load = comfortable_triple(rng)
    load = rg.Wrench(unit * load.force, unit * load.torque[0])
    towards, weights = unit * rng.normal(size=(3, 2)), np.array([1.0, 4.0, 0.5])
    cost = rg.ForceCost("nearness", weights=weights, towards=towards)
    state = rg.choose_state(grasp, load, cost, reserve=0.0)
    f = cp.Variable((3, 2))
    held = [grasp.matrix @ cp.reshape(f, (6,), order="C") + load.vector / unit == 0]
    for i, c in enumerate(grasp):
        held.append(cp.norm(f[i] - (c.normal @ f[i]) * c.normal) <= c.friction * (c.normal @ f[i]))
    away = cp.sum(cp.multiply(weights, cp.sum(cp.square(f - towards / unit), axis=1)))
    problem = cp.Problem(cp.Minimize(away), held)
    problem.solve(solver=cp.CLARABEL)
    assert state.value == pytest.approx(problem.value * unit**2, rel=1e-6)
    assert state.forces == pytest.approx(f.value * unit, abs=1e-5 * unit)
    assert state.criteria.objective is cost
    assert str(cost) == "nearness"


def test_prices_of_forces() -> None:
    rng = np.random.default_rng(6)
    grasp, load = comfortable_triple(rng)
    prices = rng.normal(size=(3, 2))
    state = rg.choose_state(grasp, load, rg.ForceCost(weights=0.1, prices=prices))
    assert state.value == pytest.approx(float((0.1 * state.forces**2 + prices * state.forces).sum()))
    without = rg.choose_state(grasp, load, "effort")
    assert state.value < float((0.1 * without.forces**2 + prices * without.forces).sum())


def test_a_cost_of_ones_own_plans_and_has_rates(tmp_path: Path) -> None:
    cost = rg.ForceCost("careful", weights=[1.0, 9.0])
    plan = rg.plan_removal(GRASP, "P3", load=LOAD, objective=cost)
    assert rg.verify(plan).ok
    assert plan.record.choices[0].objective == "own:careful"
    write_plan(plan, tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json") == plan
    two = GRASP.without("P3")
    rates = rg.sensitivity(two, LOAD, cost, reserve=0.0)
    ahead = rg.choose_state(two, rg.Wrench([-1.5 + 1e-6, -3.5]), cost, reserve=0.0).value
    behind = rg.choose_state(two, rg.Wrench([-1.5 - 1e-6, -3.5]), cost, reserve=0.0).value
    assert rates.load[0] == pytest.approx((ahead - behind) / 2e-6, rel=1e-4)


def test_a_target_is_met_without_a_load_too() -> None:
    squeeze = np.array([[1.0, 0], [-1.0, 0]])
    pair = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    nothing = rg.Wrench([0, 0])
    assert rg.choose_state(pair, nothing, rg.ForceCost(towards=squeeze)).forces == pytest.approx(squeeze)
    assert not rg.choose_state(pair, nothing, rg.ForceCost(weights=2.0)).forces.any()


def test_soft_fingers_have_costs_too() -> None:
    rng, load = np.random.default_rng(3), rg.Wrench([0, 0.3, -1.0])
    held = 0
    while held < 3:
        grasp = soft_random(rng, 5)
        try:
            effort = rg.choose_state(grasp, load, "effort").forces
        except rg.Infeasible:
            continue
        held += 1
        assert rg.choose_state(grasp, load, rg.ForceCost()).forces == pytest.approx(effort, abs=1e-6)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"weights": -1.0}, "weights must be at least 0"),
        ({"weights": 0.0}, "one of them above it"),
        ({"name": "angle"}, "name must be a word that is not one of angle"),
        ({"towards": [1.0, 2.0]}, "towards must have shape"),
        ({"weights": [1.0, 2.0]}, "must be one number or 3, for P1, P2, P3 which it is asked for, got 2"),
        ({"towards": [[0.0, 0.0]]}, r"towards of 'cost' must have shape \(3, 2\), for P1, P2, P3"),
    ],
)
def test_costs_that_do_not_fit(arguments: dict, words: str) -> None:
    with pytest.raises(rg.InvalidInput, match=words):
        rg.choose_state(GRASP, LOAD, rg.ForceCost(**arguments))


def test_costs_have_no_closed_form() -> None:
    two = GRASP.without("P3")
    with pytest.raises(rg.InvalidInput, match="objective 'cost' has no closed form"):
        rg.choose_state(two, LOAD, rg.ForceCost(), method="closed-form")
    with pytest.raises(rg.InvalidInput, match="objective 'cost' has no closed form"):
        rg.EquilibriumLocus(two, LOAD).best(rg.ForceCost())
    with pytest.raises(rg.InvalidInput, match="has no closed form, so it has no batch"):
        rg.best_squeezes([0, 0], [0, 1], 0.5, [1, 0], [0, 1], 0.5, [0, -1], objective=rg.ForceCost())


class Weighed(ConvexObjective):
    """A cost that is no dataclass."""

    def __init__(self, weights: list[float]) -> None:
        super().__init__("weighed", "least cost", "cost", "sum", "-")
        object.__setattr__(self, "weights", weights)

    def of_contacts(self, forces, grasp):
        return np.array(self.weights) * (forces**2).sum(axis=-1)

    def squares(self, grasp):
        return np.array(self.weights, dtype=float)

    def scale(self, unit):
        return unit**2


def test_objectives_that_differ_by_what_they_keep_are_two() -> None:
    assert Weighed([1, 1, 1]) != Weighed([1, 1, 9])
    assert Weighed([1, 1, 9]) == Weighed([1, 1, 9])
    for weights in ([1, 1, 1], [1, 1, 9]):
        own, known = Weighed(weights), rg.ForceCost("known", weights)
        found, expected = (rg.choose_state(GRASP, LOAD, cost) for cost in (own, known))
        np.testing.assert_allclose(found.forces, expected.forces, atol=1e-6)


def test_a_cost_that_falls_without_end_is_refused() -> None:
    pair = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.6), rg.Contact([1, 0], [-1, 0], 0.6)])
    four = rg.Grasp(
        [
            *pair, rg.Contact([0, -1], [0, 1], 0.6), rg.Contact([0, 1], [0, -1], 0.6),
        ]
    )  # fmt: skip
    paid = rg.ForceCost(weights=[0, 0, 1, 1], prices=[[-1, 0], [0, 0], [0, 0], [0, 0]])
    with pytest.raises(rg.InvalidInput, match="falls without bound"):
        rg.choose_state(four, rg.Wrench([0, -1.0]), paid)
    assert rg.choose_state(four, rg.Wrench([0, -1.0]), paid, max_force=9.0).value < 0
