"""Grasps read from somebody else's MuJoCo model."""

from typing import Any

import numpy as np
import pytest

import regrasp as rg
from regrasp.execution import grasp_from_mujoco

pytestmark = pytest.mark.oracle

mujoco = pytest.importorskip("mujoco")

TIPS = np.array(
    [
        [-0.03, 0.01, 0.008, 1, 0, 0],
        [-0.03, -0.012, -0.006, 1, 0, 0],
        [0.03, 0.002, 0.01, -1, 0, 0],
        [0.03, -0.003, -0.012, -1, 0, 0],
    ]
)
RADIUS = 0.006


def squeezed(condim: int, *, tips_first: bool, mass: float = 0.3, angle: float = 0.0) -> tuple[Any, Any]:
    """A box between four tips on springs, at rest, turned about z by an angle."""
    body = (
        f'<body name="box" euler="0 0 {np.degrees(angle)}"><freejoint/>'
        f'<geom name="b" type="box" size=".03 .02 .025" mass="{mass}"/></body>'
    )
    R = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    fingers = motors = ""
    for i, row in enumerate(TIPS):
        at, way = R @ (row[:3] - RADIUS * row[3:]), R @ row[3:]
        slides = "".join(
            f'<joint name="j{i}{k}" type="slide" axis="{a}" damping="5" stiffness="800"/>'
            for k, a in zip("xyz", ("1 0 0", "0 1 0", "0 0 1"), strict=True)
        )
        fingers += (
            f'<body name="f{i}" pos="{at[0]} {at[1]} {at[2]}" gravcomp="1">{slides}'
            f'<geom name="tip{i}" size="{RADIUS}" mass=".05"/></body>'
        )
        motors += "".join(
            f'<general joint="j{i}{k}" biastype="affine" biasprm="{3 * way[a]} 0 0"/>'
            for a, k in enumerate("xy")
        )
    inside = fingers + body if tips_first else body + fingers
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="0.0005" cone="elliptic" impratio="100" integrator="implicitfast"/>'
        f'<default><geom condim="{condim}" friction="0.7 0.004 0" solref="0.002 1" '
        f'solimp="0.99 0.999 0.0001"/>'
        f"</default><worldbody>{inside}</worldbody><actuator>{motors}</actuator></mujoco>"
    )
    data = mujoco.MjData(model)
    for _ in range(3000):
        mujoco.mj_step(model, data)
    return model, data


@pytest.mark.parametrize("condim", [3, 4])
@pytest.mark.parametrize("tips_first", [False, True])
def test_contacts_load_and_forces_are_read(condim: int, tips_first: bool) -> None:
    """Whichever geom comes first, forces are of the fingers on the box and balance its weight."""
    model, data = squeezed(condim, tips_first=tips_first, angle=0.4)
    state = grasp_from_mujoco(model, data, "box")
    assert state.grasp.names == ("tip0", "tip1", "tip2", "tip3")
    R = data.body("box").xmat.reshape(3, 3)
    assert state.load.force == pytest.approx(R.T @ [0, 0, -0.3 * 9.81])
    assert abs(state.imbalance).max() < 1e-3
    assert (state.forces[:, :3] * state.grasp.normals).sum(axis=1) == pytest.approx(3.0, abs=0.35)
    assert state.grasp.normals == pytest.approx(TIPS[:, 3:], abs=0.01)
    assert state.grasp.positions == pytest.approx(TIPS[:, :3], abs=3e-3)
    assert state.grasp.frictions == pytest.approx(0.7)
    assert state.grasp.is_soft == (condim == 4)
    if condim == 4:
        assert state.grasp.torsions == pytest.approx(0.004)
        assert abs(state.forces[:, 3]).max() > 0


def test_torques_of_soft_fingers_have_the_right_sign() -> None:
    """A torque on the box about the line of two soft fingers is balanced by theirs alone."""
    for tips_first in (False, True):
        model, data = squeezed(4, tips_first=tips_first)
        data.xfrc_applied[model.body("box").id, 3] = 0.004
        for _ in range(2000):
            mujoco.mj_step(model, data)
        state = grasp_from_mujoco(model, data, "box")
        assert state.load.torque[0] == pytest.approx(0.004, abs=1e-4)
        assert abs(state.imbalance).max() < 1e-3
        flipped = state.forces.copy()
        flipped[:, 3] *= -1
        assert rg.GraspState(state.grasp, state.load, flipped).residual > 2 * state.residual


def test_a_plan_starts_from_what_was_measured() -> None:
    model, data = squeezed(3, tips_first=False)
    state = grasp_from_mujoco(model, data, model.body("box").id).balanced()
    plan = rg.plan_removal(state, "tip3")
    assert rg.verify(plan).ok


def test_what_is_not_there_is_refused() -> None:
    model, data = squeezed(3, tips_first=False)
    with pytest.raises(rg.InvalidInput, match="no body 'ball' in this model; it has box, f0, f1, f2, f3"):
        grasp_from_mujoco(model, data, "ball")
    with pytest.raises(rg.InvalidInput, match="body must be a name or a number from 1 to 5, got 6"):
        grasp_from_mujoco(model, data, 6)
    fresh = mujoco.MjData(model)
    with pytest.raises(rg.InvalidInput, match="nothing touches body 'box' at this instant"):
        grasp_from_mujoco(model, fresh, "box")
