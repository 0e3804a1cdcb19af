"""What plans are judged to withstand, where limits can be read off: arcs of turns, springs, fingers lost."""

from dataclasses import replace
from fractions import Fraction
from math import cos, pi, sin
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, course, cross, soft_pair, turn
from regrasp.verification.withstood import judge
from regrasp.verification.withstood.contacts import Body, Touch
from regrasp.verification.withstood.plans import Asked, check_promised, check_withstood

pytestmark = pytest.mark.oracle

NEAR, STILL = 1e-9, rg.Wrench([0, 0])


def asked(grasp, disturbance=None, stiffness=None, friction=None, position=None, surface=None, early=False):
    return Asked.of(grasp, disturbance, stiffness, friction, position, surface, early)


def found(plan, **what) -> list[str]:
    return check_withstood(plan, asked(plan.start.grasp, **what))


def one(size: float, angle: float) -> np.ndarray:
    """Forces of which only that of A is none."""
    forces = np.zeros((4, 2))
    forces[0] = size * cos(angle), size * sin(angle)
    return forces


def turning(angles, rows, middles=None) -> Plan:
    """A turn whose finger A is limited by 1."""
    grasp = rg.Grasp(c.changed(max_force=1.0) for c in cross((10.0,) * 4)[0])
    state = rg.GraspState(grasp, STILL, np.zeros((4, 2)))
    return Plan("rotation", None, state, state, turn=turn(angles, rows, middles=middles))


def test_limits_of_arcs_between_angles() -> None:
    """By cos(Delta / 2) of limits where forces stand, by where tangents meet where they turn more."""
    for step in 0.2, 1.0, 2.5, -1.0:
        most = cos(step / 2)
        for size, good in (most * (1 - NEAR), True), (most * (1 + NEAR), False):
            said = found(turning([0, step], [one(size, 0)] * 2), friction=1.0)
            assert (said == []) == good, (step, size)
            words = f"between 0 and {step:g} rad: force of A exceeds its limit"
            assert good or [x[: len(words)] for x in said] == [words]
            later = found(turning([1, 1 + step], [one(size, 0)] * 2), friction=1.0)
            assert (later == []) == good
    # an end over its part is enough, where tangents meet beyond the limit
    for sizes, good in ((0.95, 0.8), False), ((0.8, 0.95), False), ((0.87, 0.87), True), ((0.95, 0.5), True):
        rows = [one(size, 0) for size in sizes]
        assert (found(turning([0, 1], rows), friction=1.0) == []) == good
    half = np.arccos(0.8)  # of the angle between both forces, which is more than the turn by 1 rad
    most = cos(0.5) ** 2 / 0.8
    for size, good in (most * (1 - NEAR), True), (most * (1 + NEAR), False):
        assert (found(turning([0, 1], [one(size, -half), one(size, half)]), friction=1.0) == []) == good
        given = [one(0, 0), one(size, -half), one(size, half), one(0, 0)]
        said = found(turning([0, 0.5, 1.5, 2], given), friction=1.0)
        assert [x[:23] for x in said] == ([] if good else ["between 0.5 and 1.5 rad"])
    for step, size in (pi, 1e-3), (4.0, 0.3):  # no turn at once
        assert found(turning([0, step], [one(size, 0)] * 2), friction=1.0)
    assert found(turning([0, pi], [one(0, 0)] * 2), friction=1.0) == []
    assert found(turning([0, pi], [one(1e-13, 0)] * 2), friction=1.0)


def test_angles_and_states_between_them_decide() -> None:
    over = one(1.0 + NEAR, 0.0)
    rest = one(0.1, 0.0)
    plan = turning([0, 1, 2], [rest, rest, rest], [rest, rest])
    assert found(plan, friction=1.0) == []
    # with states between the angles arcs are no matter
    assert found(turning([0, 1], [one(0.99, 0)] * 2, [one(0.99, 0)]), friction=1.0) == []
    for rows, between, words in (
        ([over, rest, rest], [rest, rest], "angle 0 rad"),
        ([rest, rest, over], [rest, rest], "angle 2 rad"),
        ([rest, rest, rest], [over, rest], "between 0 and 1 rad"),
        ([rest, rest, rest], [rest, over], "between 1 and 2 rad"),
    ):
        said = found(turning([0, 1, 2], rows, between), friction=1.0)
        assert [x.split(":")[0] for x in said] == [words]


def test_instants_and_ends_decide() -> None:
    grasp = rg.Grasp(c.changed(max_force=1.0) for c in cross((10.0,) * 4)[0])
    rest = one(0.5, 0)
    state = rg.GraspState(grasp, STILL, rest)
    plan = Plan("rotation", None, state, state)
    assert found(plan, friction=1.0) == []
    for kind in "removal", "addition":  # whether there is such a finger is another's matter
        assert found(replace(plan, kind=kind, contact="nobody"), friction=1.0) == []
    for end in "start", "end":
        spoilt = replace(plan, **{end: rg.GraspState(grasp, STILL, one(1 + NEAR, 0))})
        assert [x.split(":")[0] for x in found(spoilt, friction=1.0)] == [end]
    for k in range(3):
        rows = np.array([rest] * 3)
        rows[k] = one(1 + NEAR, 0)
        bent = replace(plan, course=course([0, 0.5, 1], rows, np.zeros((3, 3))))
        said = found(bent, friction=1.0)
        assert len(said) == 1
        words = (
            f"instant {k}: force of A exceeds its limit under the deviation Wrench(force=(0, 0), torque=0)"
        )
        assert said[0] == words


def test_shares_of_linear_limits() -> None:
    """Of a bound of 2 a part of 1 / 2 is what a push of 1 needs; no force needs any, however idle."""
    limited = cross()[0]["A"].changed(limits=rg.ForceLimits([[1.0, 0.0]], [2.0]))
    touch, still = Touch(limited, Fraction(1), 2), Body(rg.LoadSet.hull([STILL]))
    none = [[Fraction(0)] * 3 for _ in range(2)]
    for push, share, good in (
        (1, Fraction(1), True), (1, Fraction(1, 2), True), (1, Fraction(1, 2) - Fraction(1, 10**9), False),
        (2, Fraction(1), True), (2 + Fraction(1, 10**9), Fraction(1), False), (0, Fraction(0), True),
    ):  # fmt: skip
        assert (touch.broken([Fraction(push), Fraction(0)], none, still, share) is None) == good


def test_fingers_without_a_force_take_no_deviation() -> None:
    """A carries nothing at the start and 1 at the end: at the start every answer of it breaks."""
    grasp, forces = cross((0.5,) * 4)
    forces[:, 1] = 0
    rest = forces * [[0], [1], [0], [1]]
    start, end = (rg.GraspState(grasp, STILL, f) for f in (rest, forces))
    small = rg.LoadSet.ellipsoid(STILL, [[0], [1e-9], [0]])
    said = found(Plan("rotation", None, start, end), disturbance=small)
    assert {x.split(" leaves")[0] for x in said} == {"start: force of A", "start: force of C"}
    assert (
        found(Plan("rotation", None, start, start), disturbance=small) == []
    )  # of idle ones nothing is asked
    assert found(Plan("rotation", None, end, end), disturbance=small) == []
    along = [[1.0, 0.0], *[[1.0, 1.0]] * 3]  # A gives way but along its normal
    for q in np.eye(3)[:, :, None]:
        said = found(Plan("rotation", None, start, end), disturbance=rg.LoadSet.ellipsoid(STILL, 1e-9 * q),
                     stiffness=along)  # fmt: skip
        assert any("start: force of A" in x for x in said)


def test_springs_share_what_deviates() -> None:
    """Four equal springs take a quarter each: 4 d at most for each contact's room."""
    grasp, forces = cross((0.5,) * 4, limits=(1.5, None, None, None))
    forces[:, 1] = 0
    state = rg.GraspState(grasp, STILL, forces)
    plan = Plan("rotation", None, state, state)
    for most, along, limited in (
        (2.0, [1.0, 0, 0], True),
        (4.0, [1.0, 0, 0], False),
        (2.0, [0, 1.0, 0], False),
    ):
        judged = plan if limited else replace(plan, **dict.fromkeys(("start", "end"), free(state)))
        for size, good in (most * (1 - NEAR), True), (most * (1 + NEAR), False):
            axis = size * np.array(along)[:, None]
            for loads in (
                rg.LoadSet.ellipsoid(STILL, axis),
                rg.LoadSet.hull([rg.Wrench.from_vector(s * axis[:, 0]) for s in (1, -1)]),
            ):
                said = found(judged, disturbance=loads)
                assert (said == []) == good, (most, along, said)
                assert good or said[0].startswith("start: force of ")
    # springs of A and B three times as stiff: three eighths each of what goes along
    stiff = [[3.0, 1.0], [3.0, 1.0], [1.0, 1.0], [1.0, 1.0]]
    for size, good in (4 / 3 * (1 - NEAR), True), (4 / 3 * (1 + NEAR), False):
        loads = rg.LoadSet.ellipsoid(STILL, [[size], [0], [0]])
        assert (found(plan, disturbance=loads, stiffness=stiff) == []) == good


def free(state):
    return rg.GraspState(rg.Grasp(c.changed(max_force=None) for c in state.grasp), state.load, state.forces)


def test_springs_that_do_not_hold_are_refused() -> None:
    grasp, forces = cross()
    state = rg.GraspState(grasp, STILL, forces)
    plan = Plan("rotation", None, state, state)
    soft = [[1.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]]
    ball = rg.LoadSet.ball(STILL, force=0.1)
    with pytest.raises(rg.InvalidInput, match="does not resist every motion"):
        found(plan, disturbance=ball, stiffness=soft)
    # of friction alone nothing answers
    assert found(plan, friction=1.0, stiffness=soft) == []
    with pytest.raises(rg.InvalidInput, match="does not resist every motion"):
        found(plan, friction=1.0, stiffness=soft, position=[0.0] * 4)
    with pytest.raises(rg.InvalidInput, match="does not resist every motion"):
        found(replace(plan, end=rg.GraspState(grasp, STILL, forces)), stiffness=soft, early=True)


def test_contacts_that_are_off_turn_the_forces_they_answer_with() -> None:
    """A is off by s along y: the torque -s of its push of 1 is shared by four springs at 45 degrees."""
    grasp, forces = cross((0.2,) * 4)
    forces[:, 1] = 0
    state = rg.GraspState(grasp, STILL, forces)
    plan = Plan("rotation", None, state, state)
    lengths = np.linspace(0.1, 1.9, 13)
    good = [found(plan, position=[s, 0, 0, 0]) == [] for s in lengths]
    expected = []
    for s in lengths:
        moved = np.array([[-1, 1 - s], [-1, -1], [1, 1], [1, -1]], dtype=float)
        g = np.zeros((3, 8))
        for i, (x, y) in enumerate(moved):
            g[:, 2 * i : 2 * i + 2] = [[1, 0], [0, 1], [-y, x]]
        after = forces - (g.T @ np.linalg.solve(g @ g.T, g @ forces.ravel())).reshape(4, 2)
        push = after[:, 0] * np.array([1, 1, -1, -1])
        expected.append(bool((0.2 * push - abs(after[:, 1]) >= 0).all()))
    other = [found(plan, position=[-s, 0, 0, 0]) == [] for s in lengths]
    assert expected in (good, other)
    assert 0 < sum(expected) < len(expected)
    rows = found(plan, position=[[0, 0, 0, 0], [1.9, 0, 0, 0], [-1.9, 0, 0, 0]])
    assert {x.split(", contacts off as in row ")[1] for x in rows} <= {"1", "2"}
    assert "contacts off" not in "".join(found(plan, position=[[1.9, 0, 0, 0]]))


def test_what_is_asked_in_words_and_what_covers_it() -> None:
    grasp, ball = cross()[0], rg.LoadSet.ball(STILL, force=0.1)
    none = asked(grasp, position=[0.0] * 4)
    assert none.words == "contacts off along their tangents"
    assert asked(grasp, position=[[0.0] * 4] * 2).words == "contacts off along their tangents, in 2 ways"
    assert asked(grasp, friction=0.9).words == "0.9 times the friction"
    assert asked(grasp, disturbance=ball).words == f"every deviation of the {ball}"
    assert asked(grasp, early=True).words == "the early loss of a finger that leaves or arrives"
    every = asked(grasp, disturbance=ball, friction=0.5, early=True).words
    assert every == (
        f"every deviation of the {ball}, with 0.5 times the friction, "
        "with the early loss of a finger that leaves or arrives"
    )
    assert asked(grasp) is None
    promised = asked(grasp, disturbance=ball)
    for other, good in (
        (asked(grasp, disturbance=ball), True), (asked(grasp, disturbance=ball, friction=0.9), True),
        (asked(grasp, disturbance=ball, friction=1.1), False),
        (asked(grasp, disturbance=ball, early=True), True),
        (asked(grasp, disturbance=ball, position=[0.0] * 4), False), (asked(grasp, friction=1.0), False),
        (asked(grasp, disturbance=ball, stiffness=2.0), False),
        (asked(grasp, disturbance=ball.scaled(2)), False),
    ):  # fmt: skip
        assert other.covers(promised) == good
    assert not promised.covers(asked(grasp, disturbance=ball, early=True))


def test_what_is_asked_is_checked_before_any_work() -> None:
    grasp, solid = cross()[0], soft_pair()[0]
    for given, words in (
        ({"position": []}, "position must have shape"), ({"position": np.empty((0, 4))}, "must have"),
        ({"position": [0.0] * 3}, r"\(n,\) or \(m, n\)"),
        ({"position": [[[0.0] * 2] * 2] * 1}, r"\(n,\) or \(m, n\) with n = 4"),
        ({"position": [0.0] * 8}, "position must have shape"), ({"friction": -1e-9}, "friction"),
        ({"surface": [0.0] * 3, "friction": 1.0}, "surface must be one curvature or 4"),
        ({"early": 1}, "early_loss must be True or False"), ({"disturbance": 3}, "must be a LoadSet"),
        ({"stiffness": 1.0}, "stiffness and surface say"), ({"surface": 0.0}, "stiffness and surface say"),
    ):  # fmt: skip
        with pytest.raises(rg.InvalidInput, match=words):
            asked(grasp, **given)
    with pytest.raises(rg.InvalidInput, match=r"\(n, 2\) or \(m, n, 2\) with n = 2"):
        asked(solid, position=[0.0, 0.0])
    assert asked(grasp, position=[0.0] * 4).positions.shape == (1, 4, 1)
    assert asked(grasp, position=[[0.0] * 4] * 3).positions.shape == (3, 4, 1)
    alone = rg.Grasp([cross()[0]["A"]])
    assert asked(alone, position=[0.1]).positions.shape == (1, 1, 1)
    with pytest.raises(rg.InvalidInput, match="must have shape"):
        asked(alone, position=np.empty((0, 1)))
    assert asked(solid, position=[[0.0] * 2] * 2).positions.shape == (1, 2, 2)
    assert asked(solid, position=[[[0.0] * 2] * 2] * 3).positions.shape == (3, 2, 2)
    assert asked(grasp, friction=0.0).friction == 0
    assert asked(grasp, friction=1.0, surface=0.5).surface.tolist() == [0.5] * 4
    assert asked(grasp, friction=1.0, surface=[1.0, 2, 3, 4]).surface.tolist() == [1, 2, 3, 4]
    assert asked(grasp, friction=1.0).surface.tolist() == [0] * 4


def test_what_a_record_says_is_checked_unless_it_is_asked_for() -> None:
    grasp, forces = cross((0.5,) * 4)
    forces[:, 1] = 0
    state = rg.GraspState(grasp, STILL, forces)
    for size, good in (1.99, True), (2.01, False):
        ball = rg.LoadSet.ellipsoid(STILL, [[0], [size], [0]])
        said = SimpleNamespace(disturbance=ball, stiffness=1.0, early_loss=False)
        plan = Plan("rotation", None, state, state, record=SimpleNamespace(withstands=said))
        broken, words = check_promised(plan, None)
        assert (broken == []) == good
        assert all(x.startswith("record: start: force") or x.startswith("record: end: force") for x in broken)
        assert words == f"every deviation of the {ball}"
        assert check_promised(plan, asked(grasp, disturbance=ball)) == ([], "")
        assert check_promised(plan, asked(grasp, friction=1.0)) == (broken, words)
    wrong = SimpleNamespace(disturbance=3, stiffness=1.0, early_loss=False)
    plan = Plan("rotation", None, state, state, record=SimpleNamespace(withstands=wrong))
    assert check_promised(plan, None)[0][0].startswith("record: disturbance must be a LoadSet")
    assert check_promised(Plan("rotation", None, state, state), None) == ([], "")


def test_sizes_are_no_less_than_the_numbers_they_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """What doubles are told of contacts off and fingers lost is what rationals say, of either sign."""
    grasp, forces = cross((0.5,) * 4)
    after = forces.copy()
    after[[1, 3]] = 0
    plan = Plan("rotation", None, *(rg.GraspState(grasp, STILL, f) for f in (forces, after)))
    values = {name: getattr(plan, name) for name in (*Plan.__dataclass_fields__, "forces")}
    leaving, told, exact = SimpleNamespace(**values, leaving=("B", "D"), arriving=()), [], []

    def seen(touch, given, *_):
        told.append(given)
        return np.zeros(len(given.values), bool)

    class Spied(Touch):
        def broken(self, force, *_):
            exact.append([float(x) for x in force])

    monkeypatch.setattr(judge, "surely_withstood", seen)
    monkeypatch.setattr(judge, "Touch", Spied)
    assert found(leaving, position=[0.3, -0.2, 0.1, 0.4], early=True) == []
    assert all((x.sizes >= abs(x.values)).all() for x in told)
    assert min(x.values.min() for x in told) < -0.1
    given = sorted(tuple(row) for x in told for row in x.values.round(9))
    assert len(given) == 2 * (4 + 3 + 3 + 2) + 4
    given = [row for row in given if any(row)]  # of no force that nothing changes nothing is asked
    assert np.allclose(given, sorted(map(tuple, np.round(exact, 9))))


def test_what_neither_breaks_nor_is_proven_is_said_so() -> None:
    """A load of 1 tilted to within 1e-5 of what friction takes, which the polytope around it exceeds."""
    contact = rg.Contact([0, 0, 0], [0, 0, 1], 0.5, name="floor")
    state = rg.GraspState(rg.Grasp([contact]), rg.Wrench([0, 0, 0]), np.zeros((1, 3)))
    tilted = rg.LoadSet.tilted(rg.Wrench([0, 0, -1]), float(np.arctan(0.5)) * (1 - 1e-5))
    rows = SimpleNamespace(start=SimpleNamespace(grasp=state.grasp))
    made = judge.Judge(rows, state.grasp, Body(tilted), 1.0, 1.0, early_loss=False)
    answer = [[Fraction(-(i == j)) for j in range(6)] for i in range(3)]
    said = list(made._contacts("now", [Fraction(0)] * 3, answer, [False], Fraction(1)))
    assert said == ["now: it is not proven that floor withstands all, nor found what it does not"]
