"""The laws a planned transition obeys, on random grasps: design sections 1 and 2.

Every grasp here holds its load by construction, so no draw is lost and a refusal is a failure.
"""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from models import OBJECTIVES
from oracle import is_held
from strategies import POWERS, Pair, grooves, held_pairs, held_triples, uneven_sizes

pytestmark = pytest.mark.laws

objectives = st.sampled_from(OBJECTIVES)
firm = st.sampled_from([0.1, 0.25, 0.3, 0.5, 1.0, 2.0, 5.0])
slippery = st.sampled_from([1e-8, 1e-6, 1e-3, 0.1, 0.3, 1.0, 5.0])
shapes = st.sampled_from(
    [
        rg.TimeScaling.spline(1.0),
        rg.TimeScaling.minimum_jerk(2.5),
        rg.TimeScaling.linear(0.3),
        rg.TimeScaling.spline(7.0, (1, 0.9, 0.9, 0.1, 0)),
    ]
)


@st.composite
def plans(draw: st.DrawFn) -> rg.Transition:
    grasp, load = draw(held_triples(firm))
    return rg.plan_removal(
        grasp,
        "C",
        load=load,
        objective=draw(objectives),
        whole_objective=draw(st.sampled_from(["force", "effort", "angle"])),
        scaling=draw(shapes),
    )


def held_exactly(grasp: rg.Grasp, load: np.ndarray, forces: list) -> tuple[bool, bool, bool]:
    limits = [c.max_force for c in grasp]
    return is_held(grasp.positions, grasp.normals, grasp.frictions, limits, load, forces)


# -- fact 1: a straight path is safe -----------------------------------------------------------------------


@given(plans())
@settings(max_examples=40)
def test_planned_set_points_hold_the_object_exactly(plan: rg.Transition) -> None:
    """Every set-point, as the doubles a controller gets: balanced, inside the cones with zero tolerance."""
    t = np.linspace(0, plan.duration, 101)
    for at, forces in zip(t, plan.forces(t), strict=True):
        assert held_exactly(plan.grasp, plan.load(at), forces.tolist()) == (True, True, True), at


@given(plans())
@settings(max_examples=25)
def test_the_path_itself_is_safe_in_rational_arithmetic(plan: rg.Transition) -> None:
    """Eq. 1-3 without rounding between the ends."""
    start, end = (
        [[Fraction(x) for x in f] for f in state.forces.tolist()] for state in (plan.start, plan.end)
    )
    for k in range(33):
        T = Fraction(k, 32)
        forces = [
            [b + (a - b) * T for a, b in zip(fa, fb, strict=True)] for fa, fb in zip(start, end, strict=True)
        ]
        assert held_exactly(plan.grasp, plan.start.load.vector, forces) == (True, True, True)


@given(plans())
@settings(max_examples=40)
def test_extremes_are_attained_at_an_end(plan: rg.Transition) -> None:
    t = np.linspace(0, plan.duration, 401)
    margins, sizes = plan.margins(t), np.linalg.norm(plan.forces(t), axis=-1)
    ends = [0, -1]
    for size, angle, force, use in zip(
        sizes.T, margins.angle.T, margins.force.T, margins.friction_use.T, strict=True
    ):
        assert size.max() <= size[ends].max() * (1 + 1e-14)
        assert force.min() >= force[ends].min() - 1e-14 * size.max()
        firm = size > 1e-6 * sizes.max()  # a direction is as exact as its force is large
        if firm[ends].any():
            assert angle[firm].min() >= np.nanmin(angle[ends]) - 1e-9
            assert use[firm].max() <= np.nanmax(use[ends]) + 1e-8


@given(plans())
@settings(max_examples=40)
def test_wrenches_sum_to_zero_and_the_leaving_force_keeps_its_direction(plan: rg.Transition) -> None:
    t = np.linspace(0, plan.duration, 101)
    forces, wrenches, T = plan.forces(t), plan.wrenches(t), plan.scaling(t)
    size = np.array([1, 1, plan.grasp.size])
    scale = max(abs(forces).max(), abs(plan.start.load.vector / size).max())
    assert abs((wrenches.sum(axis=1) + plan.load(t)) / size).max() <= 1e-12 * scale
    assert wrenches[..., :2] == pytest.approx(forces, abs=1e-15 * scale)
    gone = forces[:, 2]
    assert gone == pytest.approx(T[:, None] * plan.start.forces[2], abs=1e-15 * scale)
    assert abs(gone[:, 0] * gone[0, 1] - gone[:, 1] * gone[0, 0]).max() <= 1e-15 * (gone[0] @ gone[0])
    assert not forces[-1, 2].any()
    assert (forces[0] == plan.start.forces).all()
    assert (forces[-1] == plan.end.forces).all()


# -- reversal ------------------------------------------------------------------------------------------------


@given(plans())
@settings(max_examples=25)
def test_reversal_is_time_reversal(plan: rg.Transition) -> None:
    t = np.linspace(0, plan.duration, 101)
    back = plan.reversed()
    scale = abs(plan.forces(t)).max()
    mirrored = np.minimum(plan.duration - t, plan.duration)
    assert back.kind == "addition"
    assert back.forces(t) == pytest.approx(plan.forces(mirrored), abs=1e-14 * scale)
    assert back.rates(t) == pytest.approx(-plan.rates(mirrored), abs=1e-12 * scale / plan.duration)
    assert rg.verify(back).ok
    again = back.reversed()
    assert (again.kind, again.start, again.end) == (plan.kind, plan.start, plan.end)
    assert again.scaling.control == pytest.approx(plan.scaling.control, abs=1e-15)


@given(plans())
@settings(max_examples=25)
def test_an_addition_is_a_removal_backwards(plan: rg.Transition) -> None:
    added = rg.plan_addition(
        plan.end.without("C"), plan.grasp["C"], end=plan.start, scaling=plan.scaling.reversed()
    )
    t = np.linspace(0, plan.duration, 33)
    assert added.kind == "addition"
    assert (added.forces(t) == plan.reversed().forces(t)).all()


@given(held_triples(firm), objectives)
@settings(max_examples=25)
def test_an_addition_that_chooses_both_ends_verifies(
    held: tuple[rg.Grasp, rg.Wrench], objective: str
) -> None:
    grasp, load = held
    added = rg.plan_addition(grasp.without("C"), grasp["C"], load=load, objective=objective)
    assert rg.verify(added).ok
    assert [c.end for c in added.record.choices] == ["start", "end"]
    assert not added.start.force("C").any()


# -- verification with zero tolerance ---------------------------------------------------------------------


@given(held_triples(firm), objectives, POWERS, POWERS)
@settings(max_examples=60)
def test_what_is_planned_verifies(
    held: tuple[rg.Grasp, rg.Wrench], objective: str, length: float, force: float
) -> None:
    grasp = rg.Grasp(rg.Contact(c.position * length, c.normal, c.friction, name=c.name) for c in held[0])
    load = rg.Wrench(held[1].force * force, float(held[1].torque[0]) * length * force)
    plan = rg.plan_removal(grasp, "C", load=load, objective=objective)
    verdict = rg.verify(plan)
    assert verdict.ok, str(verdict)
    assert verdict.least_cone_slack >= 0


@given(held_pairs(slippery, uneven_sizes), objectives, POWERS, POWERS, st.sampled_from([0.0, 1.0, 1e3, 1e6]))
@settings(max_examples=200)
def test_what_is_planned_verifies_down_to_almost_no_friction(
    pair: Pair, objective: str, length: float, force: float, far: float
) -> None:
    """Two fingers hold, a third, idle one is taken away; small forces beside large ones, far contacts."""
    away = (pair.r1[0] + far, pair.r1[1] + 0.7 * far), (pair.r2[0] + far, pair.r2[1] + 0.7 * far)
    torque = pair.torque + far * pair.force[1] - 0.7 * far * pair.force[0]
    moved = Pair(away[0], pair.n1, pair.mu1, away[1], pair.n2, pair.mu2, pair.force, torque)
    moved = moved.scaled(length, force)
    grasp = rg.Grasp([*moved.grasp, rg.Contact([-50 * length, 0], [1, 0], 0.5)])
    chosen = rg.choose_state(moved.grasp, moved.load, "effort", reserve=1e-6)
    start = rg.GraspState(grasp, moved.load, [*chosen.forces, [0, 0]])
    plan = rg.plan_removal(start, "P3", objective=objective)
    verdict = rg.verify(plan)
    assert verdict.ok, str(verdict)


@given(grooves(), POWERS, POWERS, objectives)
@settings(max_examples=60)
def test_a_frictionless_groove_holds_and_verifies(
    groove: tuple[rg.Grasp, rg.Wrench], length: float, force: float, objective: str
) -> None:
    grasp = rg.Grasp(rg.Contact(c.position * length, c.normal, c.friction, name=c.name) for c in groove[0])
    load = rg.Wrench(groove[1].force * force, float(groove[1].torque[0]) * length * force)
    plan = rg.plan_removal(grasp, "C", load=load, objective=objective)
    verdict = rg.verify(plan)
    assert verdict.ok, str(verdict)


@given(held_triples(firm), objectives, st.sampled_from([0.05, 0.1]))
@settings(max_examples=40)
def test_a_reserve_is_kept(held: tuple[rg.Grasp, rg.Wrench], objective: str, reserve: float) -> None:
    """The loads take at most nine tenths of the friction, so a tenth can be kept back."""
    grasp, load = held
    plan = rg.plan_removal(grasp, "C", load=load, objective=objective, reserve=reserve)
    assert plan.record.reserve == reserve
    narrow = [
        rg.Contact(c.position, c.normal, c.friction * (1 - reserve) * (1 + 1e-9), name=c.name) for c in grasp
    ]
    for t in np.linspace(0, plan.duration, 17):
        assert held_exactly(rg.Grasp(narrow), load.vector, plan.forces(t).tolist()) == (True, True, True)


@given(held_pairs(firm))
@settings(max_examples=40)
def test_typed_in_forces_are_balanced_and_the_change_is_recorded(pair: Pair) -> None:
    """Four printed decimals, as in the paper: refused beyond the tolerance, repaired within it."""
    grasp = rg.Grasp([*pair.grasp, rg.Contact([-9.0, 0.5], [1, 0], 0.5, name="C")])
    chosen = rg.choose_state(pair.grasp, pair.load, "force", reserve=1e-3)
    printed = rg.GraspState(grasp, pair.load, np.round([*chosen.forces, [0, 0]], 4))
    largest = float(printed.magnitudes.max())
    plan = rg.plan_removal(printed, "C", balance_tolerance=1e-2)
    assert rg.verify(plan).ok
    change = float(abs(plan.start.forces - printed.forces).max())
    assert plan.record.balancing == pytest.approx(change, abs=1e-15 * largest)
    assert change <= 1e-2 * largest
