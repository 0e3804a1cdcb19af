"""Plans carried out in MuJoCo do what their computation says."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from executed_plans import PLANS, bracket, ellipse, paper, removal, turned
from regrasp.execution import Execution, Setup, critical_friction, simulate

pytestmark = pytest.mark.laws

pytest.importorskip("mujoco")


@cache
def plan(name: str) -> Any:
    return PLANS[name]()


@cache
def run(name: str) -> Execution:
    return simulate(plan(name))


@pytest.mark.parametrize("name", PLANS)
def test_a_plan_holds_from_the_friction_it_needs_on_within_3_percent(name: str) -> None:
    needed = plan(name).friction_needed
    assert simulate(plan(name), friction=1.03 * needed).held
    below = simulate(plan(name), friction=0.97 * needed)
    assert not below.held
    assert below.slipped or below.dropped


@pytest.mark.parametrize("name", ["removal of the paper", "solid, removal", "turn"])
def test_measured_forces_are_the_planned_ones(name: str) -> None:
    execution = run(name)
    assert execution.held
    peak = np.linalg.norm(execution.planned, axis=2).max()
    assert abs(execution.forces - execution.planned).max() < 0.02 * peak
    assert execution.error < 1e-3
    assert execution.tilt.max() < np.radians(0.1)


def test_measured_margins_are_the_planned_ones() -> None:
    execution = run("removal of the paper")
    last = execution.margins.angle[-1], execution.planned_margins.angle[-1]
    assert np.isnan(last[0][2])  # P3 has left
    assert last[0][:2] == pytest.approx(last[1][:2], abs=5e-4)
    assert not execution.touching[-1, 2]
    assert execution.touching[:, :2].all()


def test_runs_repeat_to_the_bit() -> None:
    assert simulate(plan("removal of the paper")) == run("removal of the paper")


def test_critical_friction_is_the_friction_needed() -> None:
    found = critical_friction(plan("removal of the paper"), tolerance=0.01)
    assert found == pytest.approx(plan("removal of the paper").friction_needed, rel=0.03)
    assert simulate(plan("removal of the paper"), friction=found).held
    assert not simulate(plan("removal of the paper"), friction=found / 1.01 / 1.0001).held


@pytest.mark.parametrize(("length", "force", "time"), [(1e3, 1.0, 1.0), (1e-6, 1e-6, 1.0), (1e4, 1e6, 100.0)])
def test_units_change_nothing(length: float, force: float, time: float) -> None:
    """The same grasp in other units of length, force and time slips at the same friction and moves alike."""
    grasp = rg.Grasp(rg.Contact(length * c.position, c.normal, 0.3, name=c.name) for c in paper())
    start = plan("removal of the paper").start
    moved = rg.GraspState(grasp, force * start.load, force * start.forces)
    other = rg.plan_removal(moved, "P3", duration=time)
    mass = run("removal of the paper").mass * force * time**2 / length
    there, here = simulate(other, mass=mass, friction=0.18), simulate(removal(), friction=0.18)
    assert there.forces == pytest.approx(force * here.forces, rel=1e-3, abs=1e-4 * force)
    assert there.slip == pytest.approx(length * here.slip, rel=0.02, abs=1e-7 * length)
    assert there.times == pytest.approx(time * here.times, rel=1e-9)


def test_a_whole_regrasp_holds_and_every_finger_is_where_it_should_be() -> None:
    outline = rg.Outline.ellipse(0.04, 0.02)
    ends = ellipse(0.02, 0.35, 0.7), ellipse(0.2, 0.5, 0.85)
    regrasp = rg.plan_regrasp(outline, *ends, rg.Wrench([0, -3.0]), friction=0.5, orientations=1)
    execution = simulate(regrasp, shape=outline)
    assert execution.held
    assert execution.touching.sum(axis=1).min() >= 2
    assert execution.names == tuple(dict.fromkeys(n for step in regrasp.steps for n in step.grasp.names))
    assert execution.tips.shape[1] == 3
    ends = [regrasp.steps[-1].grasp[n].position for n in regrasp.steps[-1].grasp.names]
    away = np.linalg.norm(execution.tips[-1][:, None] - np.array(ends), axis=2).min(axis=0)
    assert away == pytest.approx(0.04 / 16, rel=0.02)  # a tip's radius from the contact


def test_a_whole_regrasp_in_space_holds_on_three_fingers() -> None:
    solid, first = bracket()
    tips = ((0.01, 0.02, -0.0105), (-0.0156, 0.02, 0.025), (0.02, -0.02, -0.0105), (-0.0156, -0.02, 0.005))
    last = rg.Grasp(solid.contact_at(solid.centre_of_mass + tip, friction=0.8) for tip in tips)
    options = {"friction": 0.8, "candidates": 12, "orientations": 1}
    regrasp = rg.plan_regrasp(solid, first, last, rg.Wrench([0, 0, -1.82]), **options)
    assert len(regrasp.moves) == 4
    execution = simulate(regrasp, shape=solid)
    assert execution.held
    assert execution.touching.sum(axis=1).min() >= 3


def test_fingers_that_push_with_a_share_of_the_load_do_not_drop_it() -> None:
    outline = rg.Outline.ellipse(0.04, 0.02)
    ends = ellipse(0.02, 0.35, 0.7), ellipse(0.2, 0.5, 0.85)
    for least, falls in ((0.0, True), (None, False)):
        regrasp = rg.plan_regrasp(outline, *ends, rg.Wrench([0, -3.0]), friction=0.5, min_normal=least)
        execution = simulate(regrasp, shape=outline)
        assert execution.dropped == falls
    assert execution.slip.max() < 1e-4
    assert execution.error < 2e-3


def test_tips_that_roll_wander_and_those_that_turn_along_do_not() -> None:
    along, rolling = run("turn"), simulate(turned(), rolling=True)
    assert rolling.error > 10 * along.error
    assert rolling.slip[:50].max() < 1e-5  # rolling is no slip


def test_errors_on_purpose_are_felt() -> None:
    plain = run("removal of the paper")
    late = simulate(removal(), delays=[0.0, 0.0, 0.1])
    assert late.error > 5 * plain.error
    off = simulate(removal(), contact_errors=1e-3 * paper().tangents)
    assert off.error > 5 * plain.error
    assert off.tips[0] - plain.tips[0] == pytest.approx(1e-3 * paper().tangents, abs=4e-4)
    # 0.05 N m on the object turn it against the springs of the fingers
    pushed = simulate(removal(), disturbance=lambda t: rg.Wrench([0, 0], 0.05 if t > 0.5 else 0.0))
    before, after = pushed.times < 0.45, pushed.times > 0.7
    assert pushed.tilt[before].max() < 1e-4 < pushed.tilt[after].max()
    stiff = simulate(removal(), disturbance=lambda t: rg.Wrench([0.2, 0]), stiffness=5000.0)
    weak = simulate(removal(), disturbance=lambda t: rg.Wrench([0.2, 0]))
    assert stiff.drift.max() < 0.3 * weak.drift.max()


def test_a_squeezed_object_on_weak_springs_turns_out() -> None:
    """Two fingers 60 mm apart that squeeze with 10 N need more than 2 x / L = 333 N/m (tips of no radius)."""
    grasp = rg.Grasp([rg.Contact([-0.03, 0], [1, 0], 0.8), rg.Contact([0.03, 0], [-1, 0], 0.8)])
    load = rg.Wrench([0, -1.0])
    held = rg.GraspState(grasp, load, [[10, 0.5], [-10, 0.5]])
    third = rg.Grasp([*grasp, rg.Contact([0, -0.02], [0, 1], 0.8)])
    state = rg.GraspState(third, load, [[10, 0.45], [-10, 0.45], [0, 0.1]])
    leaving = rg.plan_removal(state, "P3", end=held)

    def push(t: float) -> rg.Wrench:
        return rg.Wrench([0, 0], 1e-3 if t < 0.2 else 0.0)

    kept = Setup(tip_radius=0.001, disturbance=push, hold=1.5)
    assert simulate(leaving, kept, stiffness=450.0).tilt.max() < 0.1
    assert simulate(leaving, kept, stiffness=220.0).tilt.max() > 0.5


def test_inertia_comes_from_the_shape() -> None:
    solid, _ = bracket()
    inertia = Setup(shape=solid).inertia(2.0, 1.0, 3)
    assert inertia == pytest.approx(2.0 * solid.inertia / solid.volume)
    disc = rg.Outline.ellipse(0.1, 0.1)
    assert Setup(shape=disc).inertia(2.0, 1.0, 2)[2, 2] == pytest.approx(0.01, rel=1e-6)  # m r^2 / 2
    assert Setup().inertia(2.0, 0.1, 2)[2, 2] == pytest.approx(0.01)
    with pytest.raises(rg.InvalidInput, match="the shape of a planar plan is an Outline, got a Mesh"):
        Setup(shape=solid).inertia(2.0, 1.0, 2)


REFUSED = [
    ({"stifness": 3.0}, "no option 'stifness'; there are contact_errors"),
    ({"stiffness": -1.0}, "stiffness must be greater than 0, got -1.0"),
    ({"timestep": 5e-3}, "timestep must be at most 0.00"),
    ({"friction": [0.3, 0.3]}, "friction must be a number or have shape \\(3,\\)"),
    ({"contact_errors": [[0.0, 0.0]]}, "contact_errors must have shape \\(3, 2\\), got \\(1, 2\\)"),
    ({"delays": [0.1]}, "delays must have shape \\(3,\\), one for each finger"),
    (
        {"mass": 1e-8},
        "this run takes .* steps of .* s, .* so small or light an object .* 500,000 are",
    ),
    ({"shape": "box"}, "shape must be an Outline or a Mesh, got str"),
    ({"disturbance": 3.0}, "disturbance must be a function of time that returns a Wrench"),
]


@pytest.mark.parametrize(("options", "said"), REFUSED, ids=[next(iter(o)) for o, _ in REFUSED])
def test_what_is_refused_says_what_to_give(options: dict[str, Any], said: str) -> None:
    with pytest.raises(rg.InvalidInput, match=said):
        simulate(removal(), **options)


def test_a_plan_without_weight_asks_for_a_mass() -> None:
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    third = rg.Grasp([*grasp, rg.Contact([0, 1], [0, -1], 0.5)])
    state = rg.choose_state(third, rg.Wrench([0, 0], 0.1), "force", max_force=5)
    leaving = rg.plan_removal(state, "P3", max_force=5)
    with pytest.raises(rg.InvalidInput, match="no mass follows from it: give mass="):
        simulate(leaving)
    assert simulate(leaving, mass=0.5).held
    with pytest.raises(
        rg.InvalidInput, match="a Transition or a RegraspPlan can be simulated, got ChosenState"
    ):
        simulate(state)  # type: ignore[arg-type]


def soft(contact: rg.Contact, torsion: float) -> rg.Contact:
    return rg.Contact(contact.position, contact.normal, contact.friction, torsion=torsion, name=contact.name)


@pytest.mark.parametrize("torsion", [0.002, 0.01])
def test_soft_fingers_hold_down_to_the_friction_predicted(torsion: float) -> None:
    _, four = bracket()
    grasp = rg.Grasp(soft(c, torsion) for c in four)
    leaving = rg.plan_removal(grasp, "P4", load=rg.Wrench([0, 0, -1.82]), objective="force")
    execution = simulate(leaving)
    assert execution.held
    away = abs(execution.torques - execution.planned_torques).max()
    assert away < 0.1 * torsion * leaving.peak
    assert simulate(leaving, friction=1.03 * leaving.friction_needed).held
    assert not simulate(leaving, friction=0.97 * leaving.friction_needed).held


def test_two_soft_fingers_hold_a_torque_about_their_line() -> None:
    places = (([0, -0.02, 0], 1, "A"), ([0, 0.02, 0], -1, "B"), ([0.02, -0.02, 0], 1, "C"))
    three = rg.Grasp(rg.Contact(p, [0, n, 0], 0.6, torsion=0.008, name=name) for p, n, name in places)
    plan = rg.plan_removal(three, "C", load=rg.Wrench([0, 0, -1.0], [0, 0.004, 0]), objective="force")
    execution = simulate(plan)
    assert execution.held
    assert abs(execution.planned_torques[-1]) == pytest.approx([0.002, 0.002, 0], abs=1e-9)
    assert execution.torques[-1] == pytest.approx(execution.planned_torques[-1], abs=2e-5)
    assert simulate(plan, friction=1.03 * plan.friction_needed).held
    assert not simulate(plan, friction=0.9 * plan.friction_needed).held
    with pytest.raises(rg.InvalidInput, match="soft fingers turn along with the object: leave rolling out"):
        simulate(plan, rolling=True)


def test_text_table_and_figures_say_the_same(tmp_path: Any) -> None:
    from PIL import Image

    from regrasp.plots import animate_execution, execution_figure

    slipping = simulate(removal(), friction=0.15)
    said = str(slipping)
    assert said.startswith("slips at P3") or said.startswith("dropped")
    assert "the plan needs 0.1837" in said
    assert str(run("removal of the paper")).startswith("holds, true friction 0.3")
    table = slipping.to_dataframe()
    assert list(table.columns[:4]) == ["clock", "drift", "tilt", "P1_planned_fx"]
    assert table["P3_slip"].max() == slipping.slip[:, 2].max()
    assert table["P1_fy"].to_numpy() == pytest.approx(slipping.forces[:, 0, 1])
    assert len(execution_figure(slipping).axes) == 3
    assert slipping._repr_png_().startswith(b"\x89PNG")  # type: ignore[union-attr]
    film = animate_execution(run("solid, removal"), path=tmp_path / "run.gif", frames_per_second=3)
    with Image.open(film) as frames:
        assert frames.n_frames >= 4
    with pytest.raises(rg.InvalidInput, match=r"path must end in \.gif or \.mp4"):
        animate_execution(slipping, path=tmp_path / "run.avi")


def test_the_setup_given_is_changed_by_options_and_kept() -> None:
    setup = Setup(friction=0.25, hold=0.3)
    execution = simulate(removal(), setup, friction=0.3)
    assert (execution.setup.friction, execution.setup.hold) == (0.3, 0.3)
    assert setup == replace(execution.setup, friction=0.25)
