"""What ``verify`` finds in transitions of plain values: ends, time functions, fingers, instants."""

from dataclasses import replace
from math import inf, nan, nextafter
from types import SimpleNamespace

import pytest

import regrasp as rg
from foreign import EPS, Plan, Record, Scaling, course, cross, said, turn
from foreign.crosses import FINGERS, LOWER, UPPER, WHOLE

pytestmark = pytest.mark.contract


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
