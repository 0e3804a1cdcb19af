"""What ``verify`` finds in turns of plain values: between angles, at their ends, of no form."""

from dataclasses import replace
from math import cos, nan, pi

import numpy as np
import pytest

import regrasp as rg
from foreign import EPS, Plan, cross, said, solid_cross, turn
from foreign.crosses import CROSSES, WHOLE, squeezed

pytestmark = pytest.mark.contract


def turned(step=1.0, forces=None, grasp=None, axis=None, **changes) -> Plan:
    """A cross without load turns with the same forces at both angles: between they grow by 1 / cos."""
    state = WHOLE if grasp is None else rg.GraspState(grasp, rg.Wrench([0.0] * grasp.dimension), forces)
    rows = [state.forces, state.forces]
    return replace(Plan("rotation", None, state, state, turn=turn([0, step], rows, axis)), **changes)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("step", [1e-12, 1e-6, 0.1, 1.0, 2.0, 3.0])
@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
def test_forces_between_two_angles_at_their_limit(make, step, sign) -> None:
    """The crest is |f| / cos(step / 2): a limit a bit above it is kept, one a bit below is not."""
    for finger in range(4):
        grasp, forces = make((0.75,) * 4)
        crest = float(np.linalg.norm(forces[finger])) / cos(step / 2)
        for limit, good in (crest * (1 + 1e-14), True), (crest * (1 - 1e-14), False):
            limits = [None] * 4
            limits[finger] = limit
            grasp, forces = make((0.75,) * 4, limits)
            axis = None if grasp.dimension == 2 else [0, 0, 1.0]
            assert (said(turned(sign * step, forces, grasp, axis)) == "") == good


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("size", [2.0**-300, 2.0**-90, 1.0, 2.0**300])
def test_crests_at_every_scale(sign, size) -> None:
    grasp, forces = cross((0.75,) * 4, (1.25 * size,) * 4, force=size)
    assert "reaches" in said(turned(sign * 1.0, forces, grasp))
    assert said(turned(sign * 0.5, forces, grasp)) == ""


@pytest.mark.parametrize("sign", [1, -1])
def test_a_crest_beside_ends_of_unequal_size(sign) -> None:
    """f from 1 to 1.1 over 1 rad: its crest by a fine sampling of the same formula."""
    grasp, forces = cross((0.75,) * 4)
    first, last = forces, 1.1 * forces
    theta = np.linspace(0, 1, 100_001)[:, None]
    path = (np.sin(1 - theta) * first[0] + np.sin(theta) * last[0]) / np.sin(1)
    crest = float(np.linalg.norm(path, axis=1).max())
    for limit, good in (crest * (1 + 1e-9), True), (crest * (1 - 1e-9), False):
        grasp, _ = cross((0.75,) * 4, (limit,) * 4)
        start, end = (rg.GraspState(grasp, rg.Wrench([0, 0]), f) for f in (first, last))
        plan = Plan("rotation", None, start, end, turn=turn([0, sign * 1.0], [first, last]))
        assert (said(plan) == "") == good


def test_a_soft_finger_over_its_limit_between_two_angles() -> None:
    """Push 3 and a torque that counts as 4: 5 at both angles, 5 / cos(1/2) between."""
    for limit, good in (5 / cos(0.5) * (1 + 1e-12), True), (5 / cos(0.5) * (1 - 1e-12), False), (5.0, False):
        grasp = rg.Grasp(
            rg.Contact([x, 0, 0], [-x, 0, 0], 2.0, torsion=0.5, max_force=limit, name=name)
            for x, name in ((-1, "A"), (1, "B"))
        )
        plan = turned(1.0, [[3, 0, 0, 1.0], [-3, 0, 0, 1.0]], grasp, [0, 1.0, 0])
        assert (said(plan) == "") == good


def test_forces_with_middles_grow_to_no_more_than_these() -> None:
    grasp, forces = cross((0.75,) * 4, (1.12,) * 4)  # |f| is 1.118
    plan = turned(1.0, forces, grasp)
    assert "reaches" in said(plan)
    assert said(replace(plan, turn=turn([0, 1.0], [forces] * 2, middles=[forces]))) == ""
    found = said(replace(plan, turn=turn([0, 1.0], [forces] * 2, middles=[1.01 * forces])))
    assert "between 0 and 1 rad: force of A is 1.129" in found


@pytest.mark.parametrize(
    ("angles", "words"),
    [
        ([0.0, 3.14159], ""),
        ([0.0, -3.14159], ""),
        ([0.0, 3.1416], "a step of the turn is pi or more"),
        ([0.0, -3.1416], "a step of the turn is pi or more"),
        ([0.0, 1.0, 5.0], "a step of the turn is pi or more"),
        ([5e-324, 1.0], "must go one way from 0"),
        ([0.0, 0.0], "must go one way from 0"),
        ([0.0, 1.0, 0.5], "must go one way from 0"),
        ([0.0, -1.0, -0.5], "must go one way from 0"),
        ([0.0, 1.0, 2.0], ""),
        ([0.0, nan], "must be finite numbers"),
        ([0.0], "a turn has two angles or more"),
    ],
)
def test_angles_of_a_turn(angles, words) -> None:
    plan = replace(turned(), turn=turn(angles, [WHOLE.forces] * len(angles)))
    found = said(plan)
    assert words in found
    assert bool(words) == bool(found)


def test_turns_of_no_form() -> None:
    forces, solid = WHOLE.forces, squeezed(solid_cross)
    for bad, words in [
        (turn([0, 1.0], [forces] * 3), "a turn has two angles or more"),
        (turn([0, 1.0], [forces[:3]] * 2), "a turn has two angles or more"),
        (turn([[0, 1.0]], [forces] * 2), "a turn has two angles or more"),
        (turn([0, 1.0], [forces, nan * forces]), "must be finite numbers"),
        (turn([0, 1.0], [forces] * 2, middles=[forces] * 2), "1 steps of a turn need as many middles"),
        (turn([0, 1.0], [forces] * 2, middles=[nan * forces]), "must be finite numbers"),
        (
            turn([0, 1.0], [forces] * 2, [0, 0, 1.0]),
            "a turn in space needs its axis, and one in the plane has none",
        ),
    ]:
        assert words in said(replace(turned(), turn=bad))
    for axis, words in [
        (None, "a turn in space needs its axis, and one in the plane has none"),
        ([1.0, 0], "the axis of a turn must have three numbers"),
        ([1.0, 0, nan], "the axis of a turn must have three numbers"),
        ([1 + 0.49 * EPS, 0, 0], ""),
        ([1 + 0.51 * EPS, 0, 0], "the axis of a turn must have length 1"),
        ([1 - 0.51 * EPS, 0, 0], "the axis of a turn must have length 1"),
        ([0.0, 0, 0], "the axis of a turn must have length 1"),
    ]:
        found = said(Plan("rotation", None, solid, solid, turn=turn([0, 1.0], [solid.forces] * 2, axis)))
        assert words in found
        assert bool(words) == bool(found)


def test_the_ends_are_the_first_and_the_last_state_of_the_turn() -> None:
    other = rg.GraspState(WHOLE.grasp, WHOLE.load, 2 * WHOLE.forces)
    for end in ("start", "end"):
        assert "start and end are not the first and the last state" in said(replace(turned(), **{end: other}))


@pytest.mark.parametrize("step", [1.0, -1.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_load_at_the_end_is_the_first_one_turned(step, axis, sign) -> None:
    """Forces, and in the plane torque, to 2^-40 of each: the torque is not hidden behind the force."""
    grasp = rg.Grasp(rg.Contact([x, y], [-x, 0], 1e3, name=f"{x} {y}") for x in (-1, 1) for y in (-1, 1))
    load = rg.Wrench([1.0, 0.5], 2.0**-20)
    states = []
    for angle in (0.0, step):
        seen = load.rotated(-angle)
        forces = np.array([[-10.0 * c.position[0], 0.0] for c in grasp]) - seen.force / 4
        for f, c in zip(forces, grasp, strict=True):
            f += seen.torque[0] / 8 * np.array([c.position[1], -c.position[0]])
        states.append(rg.GraspState(grasp, seen, forces))
    stretched = rg.Wrench(load.rotated(-step / 2).force / cos(step / 2), load.torque[0])
    middle = np.array([[-10.0 * c.position[0], 0.0] for c in grasp]) - stretched.force / 4
    for f, c in zip(middle, grasp, strict=True):
        f += stretched.torque[0] / 8 * np.array([c.position[1], -c.position[0]])
    path = turn([0, step], [s.forces for s in states], middles=[middle])
    good = Plan("rotation", None, *states, turn=path)
    assert said(good) == ""
    size = 2.0**-20 if axis == 2 else float(np.hypot(1, 0.5))
    for times, holds in (0.9, True), (1.1, False):
        vector = states[1].load.vector.copy()
        vector[axis] += sign * times * EPS * size
        end = rg.GraspState(grasp, rg.Wrench.from_vector(vector), states[1].forces)
        found = said(replace(good, end=end))
        assert (found == "") == holds
        assert holds or found == "end: the load is not the start's, seen from the turned object"
    assert "not in equilibrium" in said(
        replace(good, turn=turn([0, step], [s.forces for s in states], middles=[0 * middle]))
    )
    assert "no states between angles hold it" in said(replace(good, turn=turn([0, step], path.forces)))


@pytest.mark.parametrize("whole", [2 * pi, -2 * pi, 4 * pi])
def test_loads_turn_the_other_way(whole) -> None:
    """A weight held along the way of a whole turn, in steps of a quarter and a bit; mirrored it is not."""
    grasp = rg.Grasp(rg.Contact([x, y], [-x, 0], 1e3, name=f"{x} {y}") for x in (-1, 1) for y in (-1, 1))
    load, angles = rg.Wrench([0.0, -1.0]), np.linspace(0, whole, 11)
    squeeze = np.array([[-10.0 * c.position[0], 0.0] for c in grasp])
    for way, good in (-1, True), (1, False):
        rows = [squeeze - load.rotated(way * float(a)).force / 4 for a in angles]
        start = rg.GraspState(grasp, load, rows[0])
        end = rg.GraspState(grasp, load.rotated(way * float(angles[-1])), rows[-1])
        found = said(Plan("rotation", None, start, end, turn=turn(angles, rows)))
        assert (found == "") == good
        assert good or "not in equilibrium" in found
