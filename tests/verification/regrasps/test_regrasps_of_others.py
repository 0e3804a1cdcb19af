"""What ``verify`` finds in regrasps of plain values: their steps, joints, claims and form."""

from dataclasses import replace
from math import atan, cos, inf, nan, nextafter, sin
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import EPS, Plan, said, turn
from foreign.regrasps import FRICTION, changed, contact, held, margin_of, regrasp, whole

pytestmark = pytest.mark.contract


@pytest.fixture(params=[2, 3], ids=["plane", "space"])
def d(request) -> int:
    return request.param


@pytest.mark.parametrize("angle", [0.5, -0.5, 2.0, -2.0])
def test_a_good_one_verifies(d, angle) -> None:
    verdict = rg.verify(regrasp(d, angle))
    assert verdict.violations == ()
    worst = min(step.end.margins.least_angle for step in regrasp(d, angle).steps)
    assert verdict.least_angle <= worst + 1e-12


def test_steps_are_verified_and_named(d) -> None:
    plan = regrasp(d)
    state = plan.steps[2].end
    pulled = rg.GraspState(state.grasp, state.load, -state.forces)
    assert "step 3: end: force of A pulls" in said(changed(plan, 2, end=pulled))
    assert said(changed(plan, 0, kind="addition")).startswith("step 1: start: E must carry no force")


def test_summaries_are_of_all_steps(d) -> None:
    plan = regrasp(d)
    verdicts = [rg.verify(step) for step in plan.steps]
    whole = rg.verify(plan)
    assert whole.least_angle == min(v.least_angle for v in verdicts)
    assert whole.least_cone_slack == min(v.least_cone_slack for v in verdicts)
    assert whole.worst_residual == max(v.worst_residual for v in verdicts)
    bent = plan.steps[1].turn.forces.copy()
    bent[0, 0, 0] *= 1 + EPS / 4
    spoilt = replace(
        plan.steps[1],
        start=rg.GraspState(plan.steps[1].start.grasp, plan.steps[1].start.load, bent[0]),
        turn=turn(plan.steps[1].turn.angles, bent, plan.steps[1].turn.axis),
    )
    steps = (plan.steps[0], spoilt, plan.steps[2])
    assert rg.verify(SimpleNamespace(**vars(plan) | {"steps": steps})).worst_residual > 1e-13


@pytest.mark.parametrize("joint", [0, 1])
@pytest.mark.parametrize("finger", [0, 1])
def test_a_force_that_jumps_by_one_bit(d, joint, finger) -> None:
    for axis in range(2):
        plan = regrasp(d)
        state = plan.steps[joint].end
        forces = state.forces.copy()
        forces[finger, axis] = nextafter(forces[finger, axis], 9)
        end = rg.GraspState(state.grasp, state.load, forces)
        changes = {"end": end}
        if plan.steps[joint].turn is not None:
            path = plan.steps[joint].turn
            changes["turn"] = turn(path.angles, [path.forces[0], forces], path.axis)
        words = f"between steps {joint + 1} and {joint + 2} the forces jump or a finger moves under force"
        assert said(changed(plan, joint, **changes)) == words


@pytest.mark.parametrize("what", ["position", "normal", "friction", "max_force", "name"])
def test_a_finger_that_moves_or_may_do_more_after_a_joint(d, what) -> None:
    plan = regrasp(d)
    a = plan.steps[2].start.grasp["A"]
    place, normal = a.position.copy(), a.normal.copy()
    if what == "position":
        place[0] = nextafter(-1.0, -2)
    if what == "normal":
        normal[1] = 1e-16
    more = {what: {"friction": nextafter(FRICTION, 1), "max_force": 1e9, "name": "B"}.get(what)}
    other = rg.Contact(place, normal, more.get("friction") or FRICTION, name=more.get("name") or "A",
                       max_force=more.get("max_force"))  # fmt: skip
    changes = {}
    for end in ("start", "end"):
        state = getattr(plan.steps[2], end)
        changes[end] = rg.GraspState(state.grasp.replaced("A", other), state.load, state.forces)
    assert said(changed(plan, 2, **changes)) == (
        "between steps 2 and 3 the forces jump or a finger moves under force"
    )


def test_a_finger_that_turns_soft_after_a_joint() -> None:
    """The pair is soft throughout, and one torsion a bit more in the last step."""
    first, second = (
        rg.Grasp([contact("A", -1, 0, 3, torsion=0.1), contact("C", 1, 0, 3, torsion=torsion)])
        for torsion in (0.1, nextafter(0.1, 1))
    )
    load = rg.Wrench([0, -1.0, 0])
    states = [rg.GraspState(grasp, load, [[2, 0.5, 0, 0.0], [-2, 0.5, 0, 0.0]]) for grasp in (first, second)]
    steps = [Plan("rotation", None, state, state) for state in (states[0], states[0], states[1])]
    assert said(whole(steps[:2], 3, [0.0] * 3)) == ""
    assert "the forces jump or a finger moves under force" in said(whole(steps[1:], 3, [0.0] * 3))


def test_one_finger_moves_at_a_joint() -> None:
    """Of four fingers two are idle; one of them, or both, is elsewhere in the next step."""
    a, c = contact("A", -1, 0, 3), contact("C", 1, 0, 3)
    places = [contact(name, *where, 3) for name, where in (("E", (0, -1)), ("G", (0, 1)), ("H", (0.6, 0.8)))]
    places += [contact("I", -0.6, 0.8, 3)]

    def step(*third):
        grasp = rg.Grasp([a, c, *(places[k] for k in third)])
        state = held(grasp, 0, 3)
        return Plan("rotation", None, state, state)

    words = "between steps 1 and 2 more than one finger moves"
    assert said(whole([step(0, 1), step(0, 2)], 3, [0.0] * 3)) == ""
    assert said(whole([step(0, 1), step(2, 3)], 3, [0.0] * 3)) == words
    assert said(whole([step(0, 1), step(2)], 3, [0.0] * 3)) == ""
    assert said(whole([step(0, 1), step()], 3, [0.0] * 3)) == ""


@pytest.mark.parametrize(("d", "most"), [(2, 3), (3, 4)])
def test_no_more_fingers_than_there_are(d, most) -> None:
    for count, good in (most, True), (most + 1, False):
        angles = np.linspace(0.5, 2.5, count - 2)
        more = [contact(f"X{k}", cos(x), sin(x), d) for k, x in enumerate(angles)]
        grasp = rg.Grasp([contact("A", -1, 0, d), contact("C", 1, 0, d), *more])
        state = held(grasp, 0, d)
        found = said(whole([Plan("rotation", None, state, state)] * 2, d, [0.0] * 3))
        assert (found == "") == good
        assert good or f"{count} fingers touch the object, more than {most}" in found


def test_margins_claimed(d) -> None:
    plan = regrasp(d)
    least = margin_of(plan.steps)
    for margin, good in (0.0, True), (-9.0, True), (least, True), (least + 0.9 * EPS, True), (
        least + 1.1 * EPS, False), (99.0, False):  # fmt: skip
        found = said(changed(plan, margin=margin))
        assert (found == "") == good
        assert good or found == f"it claims a margin of {margin:.6g} rad, its holds have {least:.6g}"


def test_margins_of_whole_grasps_between_steps_do_not_count(d) -> None:
    """Three fingers in the plane, four in space, are no hold: here the third is on the edge of its cone."""
    fingers = [contact("A", -1, 0, d), contact("C", 1, 0, d), contact("E", 0, -1, d), contact("G", 0, 1, d)]
    grasp = rg.Grasp(fingers[: d + 1])
    carried = 0.125 if d == 2 else 0.375
    rows = [[2.0, carried + 0.25], [-2.25, carried], [0.25, 0.5], [0.0, -0.5]][: d + 1]
    state = rg.GraspState(grasp, rg.Wrench([0, -1.0, 0][:d]), [[*row, 0.0][:d] for row in rows])
    assert state.margins.least_angle < 0.2
    plan = whole([Plan("rotation", None, state, state)] * 2, d, [0.0] * 3)
    plan.margin = atan(FRICTION)
    assert said(plan) == ""


def test_a_margin_without_holds_is_at_most_the_half_angle() -> None:
    state = held(rg.Grasp([contact("A", -1, 0, 2), contact("C", 1, 0, 2)]), 0, 2)
    plan = SimpleNamespace(steps=(Plan("rotation", None, state, state),), orientations=(0.0, 0.0), margin=0.0)
    for margin, good in (atan(FRICTION), True), (atan(FRICTION) + 2 * EPS, False), (99.0, False):
        plan.margin = margin
        assert (said(plan) == "") == good


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"steps": ()}, "one step or more"),
        ({"orientations": (0.0, 0.0)}, "3 steps need 4 orientations, got 2"),
        ({"orientations": (0.0, nan, 0.5, 0.5)}, "orientations and margin must be finite numbers"),
        ({"orientations": (0.0, inf, 0.5, 0.5)}, "orientations and margin must be finite numbers"),
        ({"margin": nan}, "orientations and margin must be finite numbers"),
        ({"margin": -inf}, "orientations and margin must be finite numbers"),
    ],
)
def test_regrasps_of_no_form(d, changes, words) -> None:
    assert words in said(changed(regrasp(d), **changes))


def test_steps_in_the_plane_and_in_space() -> None:
    plane, space = regrasp(2), regrasp(3)
    mixed = changed(plane, steps=(plane.steps[0], space.steps[1], plane.steps[2]))
    assert "some steps are in the plane and some in space" in said(mixed)


def test_a_load_function_is_none_of_a_regrasp() -> None:
    with pytest.raises(rg.InvalidInput, match="a regrasp holds the load it was planned for"):
        rg.verify(regrasp(), lambda t: rg.Wrench([0, -1.0]))
