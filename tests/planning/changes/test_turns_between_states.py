"""What lies between the states of a turn: which may be missing, which are too far apart, what is refused."""

from math import cos, pi, sin

import numpy as np
import pytest

import regrasp as rg
import regrasp.planning.changes.rotation as rotation
import regrasp.planning.changes.turn_states as turn_states
from regrasp.mechanics.loads.rotated import turned_load
from regrasp.planning.changes.turn_states import Chooser, middle, on_the_way, within_limits
from regrasp.planning.states.criteria import Criteria
from regrasp.plans.record import Record
from regrasp.plans.transition import Transition
from regrasp.plans.turning import TurningPath

pytestmark = pytest.mark.contract

WEIGHT = rg.Wrench([0, -2])
MOST_PUSH = 4.25**0.5  # the largest 2 sin a + cos(a) / 2


def pair(**limits) -> rg.Grasp:
    """A and B with a rough hold of an object between them, the limits of each by its name."""
    return rg.Grasp(
        rg.Contact([x, 0], [-x, 0], 2.0, name=name).changed(**limits.get(name, {}))
        for x, name in ((-1, "A"), (1, "B"))
    )


def least_push(angle: float) -> np.ndarray:
    """The effort of a pair that is turned: B pushes against the rest of the weight, and against A."""
    c, s = cos(angle), sin(angle)
    push = [abs(c) / 2 + max(2 * s, 0), abs(c) / 2 + max(-2 * s, 0)]
    return np.array([[push[0], c], [-push[1], c]])


def chooser(grasp: rg.Grasp) -> Chooser:
    return Chooser(grasp, WEIGHT, Criteria("effort"), ("auto", None), 1.0, None)


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("over", [1e-6, -1e-6])
@pytest.mark.parametrize("kind", ["peak", "push"])
def test_the_crest_between_two_states_keeps_the_limit_of_its_finger(kind, over, way) -> None:
    """The finger that pushes against the weight has its crest between; the other has less at the ends."""
    a, b = way * 1.2, way * 1.5
    angles = np.linspace(a, b, 4001)
    crest = MOST_PUSH
    who = "A" if way > 0 else "B"
    if kind == "peak":
        crest = max(float(np.linalg.norm(least_push(x), axis=1).max()) for x in angles)
    most = (1 - over) * crest
    limit = {"max_force": most} if kind == "peak" else {"limits": ([[1.0, 0.0]], [most])}
    for named in ({who: limit}, {"A": limit, "B": limit}):
        states = [(x, least_push(x)) for x in (a, b)]
        if over < 0:
            assert within_limits(chooser(pair(**named)), *states) is None
        else:
            words = f"{who} would (need|break its linear limits).* between turns of {a:.6g} and {b:.6g} rad"
            with pytest.raises(rg.Infeasible, match=words):
                within_limits(chooser(pair(**named)), *states)


def test_what_is_exactly_at_its_limit_keeps_it() -> None:
    """4 N at the start and 1 N at the end: to the last bit."""
    ends = np.array([[4.0, 0.0], [-4.0, 0.0]]), np.array([[1.0, 0.0], [-1.0, 0.0]])
    below = 1 - 2.0**-52
    for limit, words in (
        (lambda x: {"max_force": 4.0 * x}, "A would need 4 "),
        (lambda x: {"limits": ([[1.0, 0.0]], [4.0 * x])}, "A would break its linear limits"),
    ):
        states = (0.0, ends[0]), (0.5, ends[1])
        assert within_limits(chooser(pair(A=limit(1.0))), *states) is None
        with pytest.raises(rg.Infeasible, match=words):
            within_limits(chooser(pair(A=limit(below))), *states)
        for x, kept in (1.0, True), (below, False):
            grasp, path = pair(A=limit(x)), TurningPath([0.0, 0.5], [*ends])
            loads = WEIGHT, turned_load(WEIGHT, 0.5)
            sides = [rg.GraspState(grasp, load, f) for load, f in zip(loads, ends, strict=True)]
            turn = Transition(*sides, rg.TimeScaling.spline(1.0), Record(0.0), path=path)
            if kept:
                rotation._refuse_high_forces(turn)
            else:
                with pytest.raises(rg.Infeasible, match=r"A would (need|break)"):
                    rotation._refuse_high_forces(turn)


@pytest.mark.parametrize(("limited", "way"), [("A", 1), ("B", -1), ("AB", 1)])
def test_steps_are_halved_where_linear_limits_alone_are_broken_between(limited, way) -> None:
    limit = {"limits": ([[1.0, 0.0]], [MOST_PUSH * (1 + 1e-4)])}
    grasp = pair(**dict.fromkeys(limited, limit))
    plan = rg.plan_rotation(grasp, 2.0 * way, load=WEIGHT, objective="effort")
    assert rg.verify(plan).ok
    pushes = abs(plan.forces(np.linspace(0, 1, 2001))[:, :, 0]).max(axis=0)
    for who, push in zip("AB", pushes, strict=True):
        assert who not in limited or push <= limit["limits"][1][0]


@pytest.mark.parametrize("limited", ["A", "B", "AB"])
@pytest.mark.parametrize("kind", ["peak", "push"])
@pytest.mark.parametrize("torque", [0.0, 1e-7])
def test_room_is_left_for_growth_whichever_limits_there_are(limited, kind, torque) -> None:
    """Hardly any load: forces stay, so that a step needs no state between its ends."""
    limit = {"max_force": 9.0} if kind == "peak" else {"limits": ([[1.0, 0.0]], [9.0])}
    grasp = pair(**dict.fromkeys(limited, limit))
    load = rg.Wrench([0, -1e-6], torque)
    plan = rg.plan_rotation(grasp, pi / 3, load=load, objective="force", peak_ratio=1e9)
    assert plan.turn.angles.tolist() == [0.0, pi / 3]
    assert abs(plan.start.forces[:, 0]).max() == pytest.approx(9 * cos(pi / 6), rel=1e-6)


@pytest.mark.parametrize(
    ("turn", "count", "missing", "refused"),
    [
        (2.98, 3, (1, 2), False),
        (2.99, 3, (1, 2), True),
        (-2.99, 3, (1, 2), True),
        (3.1, 3, (1,), False),
        (3.1, 1, (), False),
        (6.0, 3, (), False),
        (6.0, 3, (2,), True),
    ],
)
def test_states_may_be_missing_within_a_step_below_pi(turn, count, missing, refused, monkeypatch) -> None:
    """By 95 hundredths of pi: 2.985 rad. The first that is missing says why."""
    first, last = least_push(0.0), least_push(turn)

    def reached(_, angle):
        k = round(angle * count / turn)
        if k in missing:
            raise rg.Infeasible(f"state {k} is missing")
        return least_push(angle)

    monkeypatch.setattr(turn_states, "reached", reached)
    if refused:
        with pytest.raises(rg.Infeasible, match=f"state {missing[0]} is missing"):
            on_the_way(chooser(pair()), turn, count, first, last)
    else:
        knots = on_the_way(chooser(pair()), turn, count, first, last)
        there = [k for k in range(count + 1) if k not in missing]
        assert [angle for angle, _ in knots] == pytest.approx([turn * k / count for k in there])


def test_what_is_not_held_between_two_angles_is_said_of_the_middle() -> None:
    shelf = rg.Grasp([rg.Contact([-1, -1], [0, 1], 0.9), rg.Contact([1, -1], [0, 1], 0.9)])
    lifted = Chooser(shelf, rg.Wrench([0, 2]), Criteria("effort"), ("auto", None), 1.0, None)
    with pytest.raises(rg.Infeasible, match=r"after a turn of 0\.7 rad"):
        middle(lifted, (0.2, least_push(0.2)), (1.2, least_push(1.2)))


@pytest.mark.parametrize("who", ["A", "B"])
@pytest.mark.parametrize("kind", ["peak", "push"])
def test_what_halving_lets_through_is_refused(who, kind, monkeypatch) -> None:
    """Both ends keep the limit, and the crest between is above it."""
    way = 1 if who == "A" else -1
    turn, most = 1.5 * way, 0.999 * MOST_PUSH
    if kind == "peak":
        most = 0.999 * max(
            float(np.linalg.norm(least_push(x), axis=1).max()) for x in np.linspace(1, 1.5, 501)
        )
    limit = {"max_force": most} if kind == "peak" else {"limits": ([[1.0, 0.0]], [most])}
    grasp = pair(**{who: limit})
    ends = [rg.GraspState(grasp, rg.Wrench([0, -2]), least_push(0.0))]
    ends.append(rg.GraspState(grasp, turned_load(WEIGHT, turn), least_push(turn)))
    given = TurningPath([0.0, turn], [state.forces for state in ends])
    plan = Transition(*ends, rg.TimeScaling.spline(1.0), Record(0.0), path=given)
    words = f"{who} would need 2.* in the turn, above its limit" if kind == "peak" else f"{who} would break"
    with pytest.raises(rg.Infeasible, match=words):
        rotation._refuse_high_forces(plan)
    if kind == "peak":
        monkeypatch.setattr(rotation, "halved", lambda *_: given)
        with pytest.raises(rg.Infeasible, match=words):
            rg.plan_rotation(ends[0], turn, end=ends[1])


AIR = rg.LoadSet.hull([rg.Wrench([0, 0]), rg.Wrench([3, 0]), rg.Wrench([-3, 0]), rg.Wrench([0, 3])])


def test_a_disturbance_of_a_turn_holds_none() -> None:
    some = rg.LoadSet.hull([rg.Wrench([1, 0]), rg.Wrench([2, 0]), rg.Wrench([1, 1])])
    with pytest.raises(rg.InvalidInput, match="a disturbance of a turn must hold the deviation zero"):
        rg.plan_rotation(pair(), 0.3, load=WEIGHT, disturbance=some, max_force=30.0)


@pytest.mark.parametrize("which", ["start", "end"])
def test_given_ends_that_do_not_withstand_the_disturbance_are_refused(which) -> None:
    loads = [WEIGHT, turned_load(WEIGHT, 0.3)]
    chosen = {"disturbance": AIR, "max_force": 60.0}
    room = chosen | {"max_force": 55.0}  # for what grows between
    strong = [rg.choose_state(pair(), load, "force", **room) for load in loads]
    weak = [rg.choose_state(pair(), load, "effort") for load in loads]
    assert rg.verify(rg.plan_rotation(strong[0], 0.3, end=strong[1], **chosen)).ok
    ends = (weak[0], strong[1]) if which == "start" else (strong[0], weak[1])
    with pytest.raises(rg.InvalidInput, match=f"{which}: the forces do not withstand the disturbance"):
        rg.plan_rotation(ends[0], 0.3, end=ends[1], **chosen)


@pytest.mark.parametrize(("share", "held"), [(1.0, False), (0.985, True)])
def test_limits_under_deviations_are_judged_between_the_states_of_a_turn(share, held) -> None:
    """Both states withstand: between them forces grow by 1 / cos(0.15), 1.01."""
    chosen = {"disturbance": AIR, "max_force": 60.0 * share}
    loads = [WEIGHT, turned_load(WEIGHT, 0.3)]
    grasp = pair(A={"max_force": 60.0}, B={"max_force": 60.0})
    ends = [rg.GraspState(grasp, x, rg.choose_state(pair(), x, "force", **chosen).forces) for x in loads]
    path = TurningPath([0.0, 0.3], [state.forces for state in ends])
    plan = Transition(*ends, rg.TimeScaling.spline(1.0), Record(0.0), path=path)
    assert rg.verify(plan).ok
    verdict = rg.verify(plan, disturbance=AIR)
    assert verdict.ok == held
    assert all("between 0 and 0.3 rad: force of" in words for words in verdict.violations)


def test_options_of_states_are_checked_where_none_is_chosen() -> None:
    plan = rg.plan_rotation(pair(), 0.3, load=WEIGHT)
    assert plan.record.least_normals == ()
    with pytest.raises(rg.InvalidInput, match="facets must be"):
        rg.plan_rotation(plan.start, 0.3, end=plan.end, facets=2)


@pytest.mark.filterwarnings("ignore:angle is in radians")
@pytest.mark.parametrize("way", [1, -1])
def test_a_thousand_radians_are_allowed(way) -> None:
    assert rotation._turn_asked(way * 1000.0, None) == way * 1000.0
    with pytest.raises(rg.InvalidInput, match="at most 1000 rad to either side"):
        rotation._turn_asked(way * 1000.0001, None)
