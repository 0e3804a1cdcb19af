"""What ``verify`` finds in transitions of plain values: ends, time function, instants, turns, records."""

from dataclasses import replace
from math import cos, inf, nan, nextafter, pi
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, Record, Scaling, course, cross, places, solid_cross, turn

pytestmark = pytest.mark.contract

CROSSES = {"plane": cross, "space": solid_cross}
EPS = 2.0**-40


def said(plan) -> str:
    verdict = rg.verify(plan)
    assert verdict.ok == (not verdict.violations)
    return "; ".join(verdict.violations)


def squeezed(make=cross, frictions=(0.75,) * 4, idle=()):
    """A state of a cross, without the pairs named in ``idle``: A and D, B and C are diagonal pairs."""
    grasp, forces = make(frictions)
    forces[:, 1:] = 0
    for i in idle:
        forces[i] = 0
    return rg.GraspState(grasp, rg.Wrench([0.0] * grasp.dimension), forces)


# A and C, and B and D, face each other: either pair holds the object alone.
WHOLE, UPPER, LOWER = squeezed(), squeezed(idle=(1, 3)), squeezed(idle=(0, 2))
FINGERS = "removal", "B", WHOLE, UPPER


def test_good_ones_verify() -> None:
    for plan in (
        Plan("removal", "B", WHOLE, UPPER),
        Plan("addition", "B", UPPER, WHOLE),
        Plan("exchange", "B", LOWER, UPPER, arrival="A"),
        Plan("rotation", None, WHOLE, WHOLE),
    ):
        assert said(plan) == ""


@pytest.mark.parametrize(
    ("kind", "contact", "arrival", "start", "end", "words"),
    [
        ("removal", "A", None, WHOLE, UPPER, "end: A must carry no force"),
        ("removal", "B", None, WHOLE, WHOLE, "end: B must carry no force"),
        ("addition", "A", None, UPPER, WHOLE, "start: A must carry no force"),
        ("addition", "B", None, WHOLE, WHOLE, "start: B must carry no force"),
        ("exchange", "B", "C", LOWER, LOWER, "end: B must carry no force"),
        ("exchange", "A", "B", LOWER, LOWER, "start: B must carry no force"),
        ("exchange", "B", "A", WHOLE, UPPER, "start: A must carry no force"),
        ("exchange", "B", "A", LOWER, WHOLE, "end: B must carry no force"),
        ("removal", "E", None, WHOLE, UPPER, "contact 'E' is not one of A, B, C, D"),
        ("exchange", "B", "E", LOWER, UPPER, "contact 'E' is not one of A, B, C, D"),
        ("exchange", "B", "B", UPPER, UPPER, "contact 'B' leaves and arrives"),
    ],
)
def test_fingers_that_are_not_idle_as_named(kind, contact, arrival, start, end, words) -> None:
    assert words in said(Plan(kind, contact, start, end, arrival=arrival))


def test_the_least_force_of_an_idle_finger_counts() -> None:
    for axis in range(2):
        forces = UPPER.forces.copy()
        forces[1, axis] = 5e-324
        assert "B must carry no force" in said(
            Plan("removal", "B", WHOLE, rg.GraspState(UPPER.grasp, UPPER.load, forces))
        )


@pytest.mark.parametrize(
    ("duration", "control", "words"),
    [
        (1.0, (1.0, 0.0), ""),
        (1.0, (1.0, 1.0, 0.0, 0.0), ""),
        (1.0, (nextafter(1, 0), 0.0), "runs from 1 to 0, not from 1 to 0"),
        (1.0, (1.0, 5e-324), "not from 1 to 0"),
        (1.0, (1.0, nextafter(1, 2), 0.0), "may leave [0, 1]"),
        (1.0, (1.0, -5e-324, 0.0), "may leave [0, 1]"),
        (1.0, (1.0,), "two control values or more"),
        (1.0, (), "two control values or more"),
        (1.0, (1.0, nan, 0.0), "two control values or more, all of them numbers"),
        (1.0, (1.0, inf, 0.0), "two control values or more, all of them numbers"),
        (0.0, (1.0, 0.0), "duration is 0 s, not greater than 0"),
        (nan, (1.0, 0.0), "duration is nan s"),
        (inf, (1.0, 0.0), "duration is inf s, not a number"),
        (5e-324, (1.0, 0.0), "in which no force changes at a finite rate"),
        (2.3e-308, (1.0, 0.0), ""),
        (2.2e-308, (1.0, 0.0), "in which no force changes at a finite rate"),
        (1e308, (1.0, 0.0), ""),
        (1.4e-307, (1.0, 1.0, 0.5, 0.0, 0.0), ""),
        (1.38e-307, (1.0, 1.0, 0.5, 0.0, 0.0), "in which no force changes at a finite rate"),
    ],
)
def test_time_functions(duration, control, words) -> None:
    found = said(Plan(*FINGERS, scaling=Scaling(duration, control)))
    assert words in found
    assert bool(words) == bool(found)


def test_a_duration_is_short_for_its_forces() -> None:
    grasp, forces = cross((0.75,) * 4, force=1e30)
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    for duration, good in (2.3e-278, True), (2.2e-278, False):
        assert (said(Plan("rotation", None, state, state, scaling=Scaling(duration))) == "") == good


def test_ends_of_two_problems() -> None:
    other = rg.GraspState(cross((0.76,) * 4)[0], WHOLE.load, UPPER.forces)
    assert said(Plan("removal", "B", WHOLE, other)) == "start and end have different contacts"
    few = UPPER.without("B")
    assert "start and end have different contacts" in said(Plan("removal", "B", WHOLE, few))
    loaded = rg.GraspState(WHOLE.grasp, rg.Wrench([0, EPS / 2]), UPPER.forces)
    assert said(Plan("removal", "B", WHOLE, loaded)).startswith("start and end have different loads")


@pytest.mark.parametrize(
    ("leaving", "arriving", "words"),
    [
        ("B", (), "the fingers of which each leaves must be a tuple of different names, got 'B'"),
        (("B", "B"), (), "the fingers of which each leaves must be a tuple"),
        (None, (), "the fingers of which each leaves must be a tuple"),
        ((), ["D"], "the fingers of which each arrives must be a tuple"),
        (("B", "E"), (), "contact 'E' is not one of A, B, C, D"),
        (("B", "A"), (), "end: A must carry no force"),
        (("B",), ("D",), "start: D must carry no force"),
    ],
)
def test_fingers_that_cannot_be_named_so(leaving, arriving, words) -> None:
    plan = Plan(*FINGERS)
    names = (*Plan.__dataclass_fields__, "forces")
    values = {name: getattr(plan, name) for name in names}
    assert words in said(SimpleNamespace(**values, leaving=leaving, arriving=arriving))


@pytest.mark.parametrize(
    "missing", ["leaving", "arriving", "start", "end", "scaling", "course", "turn", "record"]
)
def test_what_is_no_plan(missing) -> None:
    names = (*Plan.__dataclass_fields__, "leaving", "arriving")
    values = {name: getattr(Plan(*FINGERS), name) for name in names if name != missing}
    with pytest.raises(rg.InvalidInput, match="verify needs a plan"):
        rg.verify(SimpleNamespace(**values))
    if missing in ("start", "end"):
        with pytest.raises(rg.InvalidInput, match="verify needs a plan"):
            rg.verify(SimpleNamespace(**values, **{missing: [1.0, 2.0]}))


# -- instants -------------------------------------------------------------------------------------------


def along(
    times=(0.0, 0.5, 1.0), start=WHOLE, middle=None, end=UPPER, loads=None, record=None, duration=1.0
) -> Plan:
    middle = (start.forces + end.forces) / 2 if middle is None else middle
    loads = [start.load.vector] * len(times) if loads is None else loads
    rows = [start.forces, *[middle] * (len(times) - 2), end.forces]
    found = course(times, rows, loads)
    return Plan("removal", "B", start, end, Scaling(duration), record or Record(), course=found)


def test_instants_rise_from_0_to_the_duration() -> None:
    assert said(along()) == ""
    for times in (
        (5e-324, 0.5, 1.0), (-0.1, 0.5, 1.0), (0.0, 0.5, nextafter(1, 0)), (0.0, 0.5, nextafter(1, 2)),
        (0.0, 0.0, 1.0), (0.0, 1.0, 1.0), (0.0, -0.5, 1.0), (0.0, 1.5, 1.0),
    ):  # fmt: skip
        assert said(along(times)) == "the instants must rise from 0 to the duration 1.0 s", times
    assert "the instants must rise" in said(along(duration=2.0))


def test_the_ends_are_the_first_and_the_last_instant() -> None:
    for k, name in (0, "start"), (-1, "end"):
        for change in ("forces", "loads"):
            plan = along()
            values = getattr(plan.course, change)
            values[k].flat[0] = nextafter(values[k].flat[0], 2)
            assert f"{name}: its forces or its load are not those of the path" in said(plan)


def test_courses_of_no_form() -> None:
    times, forces, loads = (getattr(along().course, name) for name in ("times", "forces", "loads"))
    for *given, words in [
        ([0.0], forces[:1], loads[:1], "a course has two instants or more"),
        (times, forces[:2], loads, "a course has two instants or more"),
        (times, forces[:, :3], loads, "a course has two instants or more"),
        (times[None], forces, loads, "a course has two instants or more"),
        (times, forces, loads[:2], "a load at every instant"),
        (times, forces, loads[:, :2], "a load at every instant"),
    ]:
        assert words in said(replace(along(), course=course(*given)))
    for name in ("times", "forces", "loads"):
        for bad in (nan, inf):
            plan = along()
            getattr(plan.course, name)[1] = bad
            assert "must be finite numbers" in said(plan)
    both = replace(along(), turn=turn([0, 1], [WHOLE.forces, UPPER.forces]))
    assert "a plan has a course or a turn, not both" in said(both)


def test_loads_at_instants() -> None:
    """A load that nothing holds at one instant only."""
    for axis in range(3):
        for sign in (1, -1):
            plan = along()
            plan.course.loads[1, axis] = sign * 2 * EPS * 1.5
            assert said(plan).startswith("instant 1: not in equilibrium")


# -- records --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
@pytest.mark.parametrize("finger", range(4))
def test_least_normal_forces_at_their_limit(make, finger) -> None:
    """Fingers push with 1 (5/4 in space), everywhere; the record allows the last 2^-40 for rounding."""
    grasp, forces = make()
    push = abs(forces[finger, 0])
    for least, good in (
        (0.0, True), (push, True), (push * (1 + 0.99 * EPS), True), (push * (1 + 1.01 * EPS), False),
        (2 * push, False),
    ):  # fmt: skip
        limits = [0.0] * 4
        limits[finger] = least
        for where, plan in places(grasp, forces):
            found = said(replace(plan, record=Record(least_normals=tuple(limits))))
            assert (found == "") == good, (where, least)
            assert good or found.startswith(f"{'ABCD'[finger]} pushes with {push:g} along its normal, below ")


def test_least_normal_forces_are_looked_for_in_every_state() -> None:
    """One state pushes with 1, the others with 2."""
    from foreign import spoilt

    grasp, forces = cross()
    for where, plan in places(grasp, 2 * forces):
        demanding = replace(plan, record=Record(least_normals=(1.5,) * 4))
        assert said(demanding) == ""
        for at in ("start", "end") if where == "ends" else (where,):
            assert "pushes with 1 along its normal, below 1.5" in said(spoilt(demanding, at, forces))


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("stretch", [0, 1])
def test_rates_at_their_limit(sign, stretch) -> None:
    """All fingers grow, or fade, by 1 along the normal in half a second: 2 N/s on one stretch."""
    forces = WHOLE.forces
    first, last = (1.0, 2.0)[::sign]
    sizes = [first, *[(last, first)[stretch]], last]
    start, end = (rg.GraspState(WHOLE.grasp, WHOLE.load, size * forces) for size in (first, last))
    for finger in range(4):
        for limit, good in (
            (2.0, True),
            (2 / (1 + 0.99 * EPS), True),
            (2 / (1 + 1.01 * EPS), False),
            (1.0, False),
        ):
            rates = [inf] * 4
            rates[finger] = limit
            plan = Plan(
                "rotation", None, start, end, record=Record(rate_limits=tuple(rates)),
                course=course([0, 0.5, 1], [size * forces for size in sizes], [[0, 0, 0]] * 3),
            )  # fmt: skip
            found = said(plan)
            assert (found == "") == good
            assert (
                good
                or found == f"{'ABCD'[finger]} changes faster than {limit:.9g} after t = {stretch / 2:g} s"
            )


@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
def test_rates_across_the_normals(make) -> None:
    """Tangential forces fade: 1/2 in the plane, (3/8, 1/2) of length 5/8 in space, in a second."""
    grasp, forces = make((0.75,) * 4)
    load = rg.Wrench([0.0] * grasp.dimension)
    bent = forces.copy()
    bent[:, 1:] = 0
    start, end = (rg.GraspState(grasp, load, f) for f in (forces, bent))
    size = 0.5 if grasp.dimension == 2 else 0.625
    for limit, good in (size, True), (size * (1 - 1e-9), False):
        record, path = Record(rate_limits=(limit,) * 4), course([0, 1], [forces, bent], [load.vector] * 2)
        assert (said(Plan("rotation", None, start, end, record=record, course=path)) == "") == good


def test_rates_are_those_of_forces_without_torques() -> None:
    """A soft pair whose torques change by 1 and whose pushes by 1/2 in a second."""
    grasp = rg.Grasp(rg.Contact([x, 0, 0], [-x, 0, 0], 0.5, torsion=1.0) for x in (-1, 1))
    first, last = np.array([[4, 0, 0, 0.0], [-4, 0, 0, 0.0]]), np.array([[4.5, 0, 0, 1.0], [-4.5, 0, 0, 1.0]])
    start, end = (rg.GraspState(grasp, rg.Wrench([0, 0, 0]), f) for f in (first, last))
    path = course([0, 1], [first, last], [[0.0] * 6] * 2)
    for limit, good in (0.5, True), (0.499, False):
        plan = Plan("rotation", None, start, end, record=Record(rate_limits=(limit,) * 2), course=path)
        assert (said(plan) == "") == good


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"reserve": 0.0}, ""),
        ({"reserve": nextafter(1, 0)}, ""),
        ({"reserve": 1.0}, "reserve is 1, not a fraction"),
        ({"reserve": -5e-324}, "not a fraction"),
        ({"reserve": -1.0}, "reserve is -1, not a fraction"),
        ({"reserve": 1e300}, "reserve is 1e+300, not a fraction"),
        ({"reserve": nan}, "reserve is nan"),
        ({"balancing": 1e300}, ""),
        ({"balancing": -5e-324}, "which is no change of a force"),
        ({"balancing": inf}, "which is no change of a force"),
        ({"balancing": nan}, "which is no change of a force"),
        ({"rate_limits": (inf,) * 3}, "4 contacts need as many rate limits or none, got 3"),
        ({"rate_limits": (inf,) * 5}, "4 contacts need as many rate limits or none, got 5"),
        ({"rate_limits": (inf, inf, 0.0, inf)}, "every rate limit must be greater than 0"),
        ({"rate_limits": (inf, inf, nan, inf)}, "every rate limit must be greater than 0"),
        ({"least_normals": (0.0,) * 4}, ""),
        ({"least_normals": (0.0,) * 5}, "4 contacts need as many least normal forces or none, got 5"),
        ({"least_normals": (0.0, 0.0, -5e-324, 0.0)}, "every least normal force must be at least 0"),
        ({"least_normals": (0.0, nan, 0.0, 0.0)}, "every least normal force must be at least 0"),
        ({"least_normals": (0.0, inf, 0.0, 0.0)}, "every least normal force must be a number"),
    ],
)
def test_records_of_impossible_numbers(changes, words) -> None:
    found = said(Plan(*FINGERS, record=Record(**changes)))
    assert words in found
    assert bool(words) == bool(found)


def chosen(end="end", limits=(1.0, 1.0, 1.0)) -> tuple:
    return (SimpleNamespace(end=end, objective="angle", method="clarabel", force_limits=limits),)


@pytest.mark.parametrize(
    ("end", "limits", "words"),
    [
        ("end", (1.0,) * 3, ""),
        ("end", (inf,) * 3, ""),
        ("start", (1.0,) * 4, ""),
        ("end", (1 / (1 + 0.99 * EPS), 1.0, 1.0), ""),
        ("end", (1 / (1 + 1.01 * EPS), 1.0, 1.0), "end was chosen with forces of A up to 1, it has 1"),
        ("end", (1.0, 0.9, 1.0), "end was chosen with forces of C up to 0.9, it has 1"),
        ("start", (1.0, 0.9, 1.0, 1.0), "start was chosen with forces of B up to 0.9, it has 1"),
        ("end", (1.0,) * 4, "3 fingers in use, but 4 force limits"),
        ("start", (1.0,) * 3, "4 fingers in use, but 3 force limits"),
        ("end", (1.0, -1.0, 1.0), "force limits must be greater than 0"),
        ("end", (1.0, 0.0, 1.0), "force limits must be greater than 0"),
        ("end", (1.0, nan, 1.0), "force limits must be greater than 0"),
        ("middle", (1.0,) * 3, "chosen for 'middle', which is neither start nor end"),
    ],
)
def test_limits_that_states_were_chosen_under(end, limits, words) -> None:
    found = said(Plan(*FINGERS, record=Record(choices=chosen(end, limits))))
    assert words in found
    assert bool(words) == bool(found)


# -- turns ----------------------------------------------------------------------------------------------


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


def test_verdicts_say_what_is_proven() -> None:
    plan = Plan(*FINGERS)
    measured = rg.verify(plan, lambda t: WHOLE.load)
    assert not measured.load_gap_is_proven
    assert "measured between instants, not proven" in str(measured)
    proven = rg.verify(plan, lambda t: WHOLE.load, curvature=0.0)
    assert proven.load_gap_is_proven
    assert "(proven)" in str(proven)
    assert (measured.load_gap, proven.load_gap) == (0.0, 0.0)
    wrong = Plan("removal", "E", WHOLE, UPPER)
    assert str(rg.verify(wrong)).startswith("not verified:\n  contact 'E' is not one of")
    assert rg.verify(plan).load_gap is None
