"""What ``verify`` finds in regrasps of plain values: at joints, in orientations, loads and claims.

A and C face each other and hold a weight together; E lets go, the object turns in A and C, and G arrives.
"""

from dataclasses import replace
from math import atan, cos, inf, nan, nextafter, pi, sin
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, course, turn

pytestmark = pytest.mark.contract

EPS = 2.0**-40
AXIS = np.array([0.0, 0.0, 1.0])
FRICTION = 0.75


def contact(name, x, y, d, **more) -> rg.Contact:
    place, normal = [x, y, 0.0][:d], [-x, -y, 0.0][:d]
    return rg.Contact(place, normal, FRICTION, name=name, **more)


def seen(angle, d) -> np.ndarray:
    """A weight, 0.3 rad from -y, as seen from an object turned by ``angle``."""
    return np.array([-sin(angle + 0.3), -cos(angle + 0.3), 0.0][:d])


def held(grasp, angle, d, third=0.0) -> rg.GraspState:
    """A and C squeeze with 2 and carry half of the weight each; the third finger pushes against both."""
    load = seen(angle, d)
    forces = np.array([c.normal * (2 if c.name in "AC" else third) for c in grasp])
    rest = -(load + third * (grasp[2].normal if len(grasp) > 2 else 0)) / 2
    forces[:2] += rest
    return rg.GraspState(grasp, rg.Wrench(load), forces)


def regrasp(d=2, angle=0.5) -> SimpleNamespace:
    a, c = contact("A", -1, 0, d), contact("C", 1, 0, d)
    first, pair, last = (
        rg.Grasp([a, c, *more]) for more in ([contact("E", 0, -1, d)], [], [contact("G", 0, 1, d)])
    )
    removal = Plan("removal", "E", held(first, 0, d, 0.5), held(first, 0, d))
    start, end = held(pair, 0, d), held(pair, angle, d)
    path = turn([0, angle], [start.forces, end.forces], None if d == 2 else AXIS)
    rotation = Plan("rotation", None, start, end, turn=path)
    addition = Plan("addition", "G", held(last, angle, d), held(last, angle, d, 0.5))
    return whole([removal, rotation, addition], d, [0.0, 0.0, angle, angle])


def whole(steps, d, orientations) -> SimpleNamespace:
    margin = min(float(atan(FRICTION) - atan(0.5 / 2)), margin_of(steps))
    plan = SimpleNamespace(steps=tuple(steps), orientations=tuple(orientations), margin=margin)
    if d == 3:
        plan.rotations = np.array([matrix(angle) for angle in orientations])
    return plan


def margin_of(steps) -> float:
    return min(step.end.margins.least_angle for step in steps[:-1])


def matrix(angle) -> np.ndarray:
    return np.array([[cos(angle), -sin(angle), 0], [sin(angle), cos(angle), 0], [0, 0, 1.0]])


def changed(plan, k=None, **changes) -> SimpleNamespace:
    """The regrasp with another value, or with one of its steps changed."""
    values = vars(plan) | ({} if k is not None else changes)
    if k is not None:
        steps = list(plan.steps)
        steps[k] = replace(steps[k], **changes)
        values["steps"] = tuple(steps)
    return SimpleNamespace(**values)


def said(plan) -> str:
    verdict = rg.verify(plan)
    assert verdict.ok == (not verdict.violations)
    return "; ".join(verdict.violations)


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


@pytest.mark.parametrize("k", [0, 1, 2])
@pytest.mark.parametrize("sign", [1, -1])
def test_orientations_follow_from_the_turns(d, k, sign) -> None:
    plan = regrasp(d)
    for off, good in (0.9 * EPS, True), (1.1 * EPS, False), (1e-2, False), (2 * pi, False), (99.0, False):
        angles = list(plan.orientations)
        angles[k + 1] += sign * off
        found = said(changed(plan, orientations=tuple(angles)))
        assert ("does not lead from" not in found) == good, off
        assert good or f"step {k + 1}: its turn of" in found


def test_orientations_after_many_turns_round_by_their_size() -> None:
    plan = regrasp(2)
    for off, good in (900 * EPS, True), (1100 * EPS, False):
        angles = [1000.0 + angle for angle in plan.orientations]
        angles[1:] = [angle + off for angle in angles[1:]]
        assert ("does not lead from" not in said(changed(plan, orientations=tuple(angles)))) == good


def test_orientations_may_start_anywhere() -> None:
    for d in (2, 3):
        plan = regrasp(d)
        other = tuple(1.25 + angle for angle in plan.orientations)
        if d == 2:
            assert said(changed(plan, orientations=other)) == ""
        else:
            turned = np.array([matrix(0.25) @ r for r in plan.rotations])
            assert said(changed(plan, rotations=turned)) == ""


@pytest.mark.parametrize("step", [0, 1, 2])
@pytest.mark.parametrize("end", ["start", "end"])
def test_the_load_is_one_and_the_same_in_the_world(d, step, end) -> None:
    plan = regrasp(d)
    for axis in range(d):
        for sign in (1, -1):
            for off, good in (0.9 * EPS, True), (1.1 * EPS, False):
                state = getattr(plan.steps[step], end)
                force = state.load.force.copy()
                force[axis] += sign * off
                other = rg.GraspState(state.grasp, rg.Wrench(force), state.forces)
                at = "start" if end == "start" else "end"
                words = f"step {step + 1}: its load at the {at} is not the first one seen from"
                found = said(changed(plan, step, **{end: other}))
                if (step, end) == (0, "start"):  # by that the others are judged
                    assert ("not the first one" not in found) == good or off < EPS
                else:
                    assert (words not in found) == good


def test_a_torque_at_a_joint(d) -> None:
    """A torque far below what the balance can tell, in every state of a step."""
    plan = regrasp(d)
    for step in (0, 2):
        changes = {}
        for end in ("start", "end"):
            state = getattr(plan.steps[step], end)
            torque = 2.0**-60 if d == 2 else [0, 0, 2.0**-60]
            changes[end] = rg.GraspState(state.grasp, rg.Wrench(state.load.force, torque), state.forces)
        found = said(changed(plan, step, **changes))
        assert f"step {step + 1}: its load at the start is not the first one" in found
        assert f"step {step + 1}: its load at the end is not the first one" in found


def test_an_object_dropped_within_a_step(d) -> None:
    plan = regrasp(d)
    step = plan.steps[2]
    for axis in range(len(step.start.load.vector)):
        for off, good in (0.9 * EPS, True), (1.1 * EPS, False):
            loads = np.array([step.start.load.vector] * 3)
            loads[1, axis] += off
            rows = [step.start.forces, (step.start.forces + step.end.forces) / 2, step.end.forces]
            path = course([0, 0.5, 1], rows, loads)
            found = said(changed(plan, 2, course=path))
            assert ("step 3: its load at t = 0.5 s is not the one in the world" not in found) == good


def test_a_step_with_instants_and_a_turn(d) -> None:
    plan = regrasp(d)
    step = plan.steps[1]
    path = course([0, 1], step.turn.forces, [step.start.load.vector] * 2)
    assert "step 2: it has a course and a turn" in said(changed(plan, 1, course=path))


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


def test_rotations_are_rotations_and_follow_from_the_turns() -> None:
    plan = regrasp(3)
    good = plan.rotations

    def with_rotations(values) -> str:
        return said(changed(plan, rotations=values))

    assert with_rotations(good) == ""
    for values in (None, good[:2], good[:, :2], np.where(good == 1, nan, good)):
        assert "3 steps in space need 4 rotations" in with_rotations(values)
    without = SimpleNamespace(**{k: v for k, v in vars(plan).items() if k != "rotations"})
    assert "3 steps in space need 4 rotations" in said(without)
    for k in range(4):
        for entry in range(9):
            other = good.copy()
            other[k].flat[entry] += 1e-9
            assert with_rotations(other) != ""
        mirrored = good.copy()
        mirrored[k, :, 2] *= -1
        assert f"rotation {k + 1} is a reflection" in with_rotations(mirrored)
        for off, fine in (0.4 * EPS, True), (1.1 * EPS, False):
            turned = good.copy()
            turned[k] = matrix(off) @ good[k]
            assert (with_rotations(turned) == "") == fine
        turned = good.copy()
        turned[k] = matrix(1e-9) @ good[k]
        assert "its turn does not lead to the next rotation" in with_rotations(turned)
    everything = good * np.array([1, 1, -1.0])
    assert "rotation 1 is a reflection" in with_rotations(everything)
    assert "is not orthonormal" in with_rotations(1.001 * good)


def test_a_load_function_is_none_of_a_regrasp() -> None:
    with pytest.raises(rg.InvalidInput, match="a regrasp holds the load it was planned for"):
        rg.verify(regrasp(), lambda t: rg.Wrench([0, -1.0]))
