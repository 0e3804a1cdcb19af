"""Least normal forces in the choice of states and of the ends of plans."""

import cvxpy as cp
import numpy as np
import pytest

import regrasp as rg
from models import OBJECTIVES
from paper import GRASP, LOAD
from space import random_grasp, random_load
from strategies import comfortable_pair, comfortable_triple

pytestmark = pytest.mark.oracle

TWO = GRASP.without("P3")


def normals(state: rg.GraspState) -> np.ndarray:
    return state.grasp.cones.normal(state.grasp.cones.measured(state.forces))


def least_effort(grasp: rg.Grasp, load: rg.Wrench, least: list[float]) -> float:
    """By cvxpy, from the mathematics; infinite where there is none."""
    d = grasp.dimension
    f = cp.Variable((len(grasp), d))
    held = [grasp.matrix @ cp.reshape(f, (len(grasp) * d,), order="C") + load.vector == 0]
    for i, c in enumerate(grasp):
        n = c.normal @ f[i]
        held += [cp.norm(f[i] - n * c.normal) <= c.friction * n, n >= least[i]]
    problem = cp.Problem(cp.Minimize(cp.sum_squares(f)), held)
    return float(problem.solve(solver=cp.CLARABEL))


@pytest.mark.parametrize("seed", range(8))
def test_least_effort_that_presses(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for grasp, load in (
        comfortable_pair(rng), comfortable_triple(rng), (random_grasp(rng, 4), random_load(rng)),
    ):  # fmt: skip
        size = float(np.linalg.norm(load.force))
        least = tuple((size * rng.uniform(0, 0.8, len(grasp)) * (rng.random(len(grasp)) < 0.7)).tolist())
        wanted = least_effort(grasp, load, list(least))
        if not np.isfinite(wanted):
            with pytest.raises(rg.Infeasible):
                rg.choose_state(grasp, load, "effort", min_normal=least, reserve=0.0)
            continue
        state = rg.choose_state(grasp, load, "effort", min_normal=least, reserve=0.0)
        assert state.value == pytest.approx(wanted, rel=1e-6)
        assert (normals(state) >= np.array(least)).all()
        assert state.is_balanced(reserve=0.0)


@pytest.mark.parametrize("objective", [*OBJECTIVES, "sum_normal"])
@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_every_objective_keeps_it(objective: str, unit: float) -> None:
    load = rg.Wrench([-1.5 * unit, -3.5 * unit])
    free = rg.choose_state(GRASP, load, objective)
    state = rg.choose_state(GRASP, load, objective, min_normal=2.5 * unit)
    assert (normals(state) >= 2.5 * unit).all()
    assert state.is_balanced()
    better = 1 if state.criteria.objective.maximise else -1
    if min(normals(free)) < 2.5 * unit and objective not in ("angle", "friction_use", "force"):
        assert better * free.value > better * state.value  # the rest squeeze under a limit that rises
    loose = rg.choose_state(GRASP, load, objective, min_normal=1e-3 * float(min(normals(state))))
    assert loose.is_balanced()


def test_one_that_does_not_bind_changes_nothing() -> None:
    free = rg.choose_state(GRASP, LOAD, "force")
    assert min(normals(free)) > 0.5
    kept = rg.choose_state(GRASP, LOAD, "force", min_normal=0.5)
    assert kept.value == pytest.approx(free.value, rel=1e-6)
    assert rg.choose_state(GRASP, LOAD, "force", min_normal=0.0).forces.tolist() == free.forces.tolist()
    assert rg.choose_state(GRASP, LOAD, "force", min_normal=None).forces.tolist() == free.forces.tolist()


def test_a_squeeze_without_load() -> None:
    state = rg.choose_state(GRASP, rg.Wrench([0, 0]), "effort", min_normal=1.0)
    assert (normals(state) >= 1.0).all()
    assert state.is_balanced()


def test_ends_are_chosen_under_it() -> None:
    """The leaving finger need not press; those that stay do at every instant."""
    for kept in (0.9, 1.3):
        plan = rg.plan_removal(GRASP, "P3", load=LOAD, min_normal=kept)
        assert rg.verify(plan).ok
        assert plan.record.least_normals == (kept, kept, 0.0)
        t = np.linspace(0, 1, 51)
        pushed = (plan.forces(t) * GRASP.normals).sum(axis=-1)
        assert (pushed[:, :2] >= kept * (1 - 1e-9)).all()
        back = rg.plan_addition(TWO, GRASP["P3"], load=LOAD, min_normal=kept)
        assert rg.verify(back).ok
        assert back.record.least_normals == (kept, kept, 0.0)
    turned = rg.plan_rotation(GRASP, 0.5, load=LOAD, min_normal=1.5)
    assert rg.verify(turned).ok
    assert turned.record.least_normals == (1.5, 1.5, 1.5)
    assert ((turned.forces(np.linspace(0, 1, 51)) * GRASP.normals).sum(axis=-1) >= 1.5 * (1 - 1e-9)).all()


def test_criteria_carry_it_into_plans() -> None:
    asked = rg.Criteria("force", min_normal=1.2)
    plan = rg.plan_removal(GRASP, "P3", load=LOAD, objective=asked)
    assert plan.record.least_normals == (1.2, 1.2, 0.0)
    assert rg.verify(plan).ok
    p4 = rg.Contact([0.5, 8], [0, -1], 0.3, name="P4")
    exchange = rg.plan_exchange(GRASP, "P3", p4, load=LOAD, objective=asked)
    assert exchange.record.least_normals == (1.2, 1.2, 0.0, 0.0)
    assert rg.verify(exchange).ok


def test_what_cannot_press_so_hard_is_refused() -> None:
    with pytest.raises(rg.Infeasible, match="push along the normals with P1 20, P2 20 or more were found"):
        rg.plan_removal(GRASP, "P3", load=LOAD, min_normal=20.0)
    with pytest.raises(rg.Infeasible, match="lower min_normal, or raise the force limits"):
        rg.choose_state(GRASP, LOAD, "effort", min_normal=5.0, max_force=5.0)
    with pytest.raises(rg.Infeasible) as refusal:  # the cones alone say why
        rg.choose_state(TWO, rg.Wrench([9.0, 3.5]), min_normal=1.0)
    assert refusal.value.certificate.is_proof


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: rg.choose_state(GRASP, LOAD, min_normal=-1.0), "min_normal must be at least 0"),
        (lambda: rg.choose_state(GRASP, LOAD, min_normal=(1.0, 2.0)), "min_normal must be one number or 3"),
        (lambda: rg.choose_state(TWO, LOAD, min_normal=1.0, method="closed-form"), "keeps no least normal"),
        (
            lambda: rg.EquilibriumLocus(TWO, LOAD).best(rg.Criteria(min_normal=1.0)),
            "the closed form keeps no",
        ),
        (lambda: rg.sensitivity(GRASP, LOAD, rg.Criteria(min_normal=1.0)), "a sensitivity keeps no least"),
    ],
)
def test_where_it_is_not_kept_it_is_refused(call, words) -> None:
    with pytest.raises(rg.InvalidInput, match=words):
        call()


ROUND = rg.Grasp(
    [
        rg.Contact([-0.05, 0], [1, 0], 0.6),
        rg.Contact([0.05, 0.01], [-1, 0], 0.6),
        rg.Contact([0.0, -0.04], [0, 1], 0.6),
    ]
)


@pytest.mark.parametrize(("objective", "best"), [("angle", 0.507953), ("friction_use", 0.05413)])
def test_a_looser_force_limit_is_no_worse(objective: str, best: float) -> None:
    for limit in (50.0, 1e3, 1e5, 3e5):
        state = rg.choose_state(ROUND, rg.Wrench([0, -5.0]), objective, max_force=limit, min_normal=1.0)
        assert state.value == pytest.approx(best, abs=2e-4)


def test_a_squeeze_without_a_load_presses() -> None:
    pair, none = ROUND.without(2), rg.Wrench([0, 0])
    free = rg.choose_state(pair, none, max_force=5.0).value
    for least in (0.001, 0.1, 1.0):
        state = rg.choose_state(pair, none, max_force=5.0, min_normal=least)
        assert state.value == pytest.approx(free, abs=1e-6)


def test_forces_whose_rounding_is_the_load_are_refused() -> None:
    assert rg.choose_state(ROUND, rg.Wrench([0, -5.0]), "effort", min_normal=4.9e9).is_balanced()
    for least in (5.1e9, 1e99):
        with pytest.raises(rg.InvalidInput, match="at most 1e\\+09 times the load"):
            rg.choose_state(ROUND, rg.Wrench([0, -5.0]), "effort", min_normal=least)
    with pytest.raises(rg.InvalidInput, match="at most 1e\\+100 N"):
        rg.Criteria(min_normal=1e101)
