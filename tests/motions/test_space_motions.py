"""Fingers in space pass through nothing: checked by dense sampling with lines of its own."""

from functools import cache

import numpy as np
import pytest

import regrasp as rg
from finger_moves import moved
from motion_checks import axes, instants, to_faces
from regrasp.mesh import parts
from regrasp.motions import Motions, plan_motions

pytestmark = pytest.mark.laws

RADIUS, CLEARANCE = 0.003, 0.002
BOX = rg.Mesh.box(0.08, 0.05, 0.03)
SOLIDS = {"box": BOX, "bracket": parts.bracket(), "ball": rg.Mesh.sphere(0.03, divisions=3)}


@cache
def planned(name: str, seed: int = 0, capsule: tuple[float, ...] = (0, 0, 0)) -> Motions:
    """Two fingers of four go from random places to random places, one after the other."""
    contacts = SOLIDS[name].contacts(6, friction=0.8, seed=seed)
    named = [rg.Contact(c.position, c.normal, 0.8, name=f"C{k}") for k, c in enumerate(contacts)]
    return plan_motions(
        moved(named), SOLIDS[name], tip_radius=RADIUS, clearance=CLEARANCE, capsules=np.array(capsule)
    )


def check(motions: Motions, mesh: rg.Mesh) -> None:
    """No finger in the object or another; the clearance kept away from contacts."""
    fine = CLEARANCE / 10
    t = instants(motions, fine)
    at, touching = motions.positions(t), motions.touching(t)
    assert np.linalg.norm(np.diff(at, axis=0), axis=2).max() <= fine * (1 + 1e-9)
    vertices, faces = mesh.surface()
    fingers = axes(motions, at, 5 * fine)
    for m in motions.motions:
        during = (t >= m.start) & (t <= m.start + m.duration)
        axis = fingers[m.finger][during]
        away = to_faces(axis.reshape(-1, 3), vertices[faces]).reshape(axis.shape[:2]).min(axis=1)
        assert away.min() > RADIUS * 0.97  # faces of a smooth mesh lean against its normals
        ends = np.array([m.way.points[0], m.way.points[-1]])
        own = np.linalg.norm(at[during][:, m.finger, None] - ends, axis=2).min(axis=1) < 4 * CLEARANCE
        assert (away[~own] >= RADIUS + CLEARANCE - 1e-9).all()
        for j in range(at.shape[1]):
            if j != m.finger:
                between = fingers[j][during][:, None] - axis[:, :, None]
                assert np.linalg.norm(between, axis=-1).min() >= 2 * RADIUS + CLEARANCE - 1e-9
    assert touching.sum(axis=1).min() >= motions.contacts.shape[1] - 1


@pytest.mark.parametrize("name", SOLIDS)
def test_no_sphere_passes_through_anything(name: str) -> None:
    motions = planned(name)
    check(motions, SOLIDS[name])
    assert all(m.to_object >= CLEARANCE and m.to_tips >= CLEARANCE for m in motions.motions)


def test_no_capsule_passes_through_anything() -> None:
    """Fingers 60 mm long that all come from above."""
    places = ([0.03, 0, 0.015], [0, 0.025, 0.01], [0, -0.025, 0.01], [-0.03, 0, 0.015], [-0.04, 0, 0.01],
              [0.04, 0, 0.01])  # fmt: skip
    contacts = [BOX.contact_at(p, friction=0.8, name=f"C{k}") for k, p in enumerate(places)]
    up = np.array([0, 0, 0.06])
    motions = plan_motions(moved(contacts), BOX, tip_radius=RADIUS, clearance=CLEARANCE, capsules=up)
    check(motions, BOX)
    assert (motions.capsules == up).all()
    below = BOX.contact_at([0, 0, -0.015], friction=0.8, name="below")
    with pytest.raises(rg.Infeasible, match=r"a capsule of radius 0\.003 is shut in at below"):
        plan_motions(
            moved([*contacts[:3], below, *contacts[4:]]),
            BOX,
            tip_radius=RADIUS,
            clearance=CLEARANCE,
            capsules=up,
        )


def test_ways_repeat_to_the_bit() -> None:
    again = planned.__wrapped__("box")
    assert again == planned("box")


def test_ways_around_a_box_are_close_to_the_shortest() -> None:
    """From the middle of one side to that of the opposite one, around the nearest edges."""
    places = (
        [0, 0, 0.015],
        [0.035, 0, 0.015],
        [-0.035, 0, 0.015],
        [0, 0, -0.015],
        [0, 0.025, 0],
        [0, -0.025, 0],
    )
    contacts = [BOX.contact_at(p, friction=0.8, name=f"C{k}") for k, p in enumerate(places)]
    motion = plan_motions(moved(contacts), BOX, tip_radius=RADIUS, clearance=CLEARANCE).motions[0]
    assert (motion.origin, motion.target) == ("C0", "C3")
    reach = RADIUS + CLEARANCE
    lift = 2 * CLEARANCE + CLEARANCE / 4
    off = RADIUS + lift
    slant = float(np.hypot(0.025, off - reach))  # about: from off the middle to over the edge
    shortest = 2 * (lift + slant + np.pi / 2 * reach) + 0.03
    assert shortest * 0.97 < motion.way.length < shortest * 1.08


def test_a_bore_too_narrow_shuts_a_tip_in() -> None:
    washer = rg.Mesh.extruded(
        rg.Outline([[-0.03, -0.03], [0.03, -0.03], [0.03, 0.03], [0.004, 0.03], [0.004, 0], [-0.004, 0],
                    [-0.004, 0.03], [-0.03, 0.03]]), 0.1)  # fmt: skip
    deep = washer.contact_at([0, 0, 0.05], friction=0.8, name="deep")
    sides = [
        washer.contact_at([x, y, 0.05], friction=0.8) for x, y in ((-0.02, -0.03), (0.02, -0.03), (-0.03, 0))
    ]
    grasp = rg.Grasp([deep, *sides])
    state = rg.GraspState(grasp, rg.Wrench([0, 0, -1]), np.zeros((4, 3)))
    clock = rg.TimeScaling.spline(1.0)
    plan = rg.Transition(state, state, clock, moved([deep, *sides]).steps[0].record, leaving=("deep",))
    with pytest.raises(rg.Infeasible, match=r"a tip of radius 0\.003 is shut in at deep, \("):
        plan_motions(plan, washer, tip_radius=0.003, clearance=0.002)
    assert plan_motions(plan, washer, tip_radius=0.002, clearance=0.001).motions[0].origin == "deep"


def test_shapes_of_the_other_dimension_are_refused() -> None:
    plan = planned("box").plan
    with pytest.raises(
        rg.InvalidInput, match="ways of this plan are in the space, around a Mesh, got Outline"
    ):
        plan_motions(plan, rg.Outline.ellipse(0.04, 0.02), tip_radius=1, clearance=1)  # type: ignore[arg-type]
    with pytest.raises(rg.InvalidInput, match=r"capsules must be finite, of shape \(3,\), or \(3, 3\)"):
        plan_motions(plan, BOX, tip_radius=1, clearance=1, capsules=[1, 2])
