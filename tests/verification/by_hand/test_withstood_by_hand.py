"""What contacts withstand of sets, against answers that can be read off: cones and limits along one axis."""

from fractions import Fraction
from itertools import chain
from math import sqrt
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, cross
from regrasp.verification.withstood.contacts import Body, Touch, _worst
from regrasp.verification.withstood.matrices import coarse, is_semidefinite, product, solved, transposed

pytestmark = pytest.mark.oracle

ONE = Fraction(1)


def exact(rows):
    return [[Fraction(float(x)) for x in row] for row in rows]


def broken(contact, force, axes=None, corners=None, share=1.0, friction=1.0):
    """What breaks of a force under deviations of itself: a ball with these half axes, or corners."""
    d = contact.dimension
    size = 3 * d - 3
    zero = rg.Wrench.from_vector(np.zeros(size))
    if corners is None:
        whole = np.zeros((size, len(axes)))
        whole[:d] = np.transpose(axes)
        loads = rg.LoadSet.ellipsoid(zero, whole)
    else:
        loads = rg.LoadSet.hull([rg.Wrench(c) for c in corners])
    answer = np.hstack([np.eye(d), np.zeros((d, size - d))])
    touch = Touch(contact, Fraction(friction), d)
    return touch.broken([Fraction(float(x)) for x in force], exact(answer), Body(loads), Fraction(share))


def judged(contact, force, most, how, axes=None, corners=None, **more) -> None:
    """The set times ``most`` is the widest."""
    for factor, good in (most * (1 - 1e-9), True), (most * (1 + 1e-9), False):
        given = (None if x is None else factor * np.array(x, dtype=float) for x in (axes, corners))
        scaled = dict(zip(("axes", "corners"), given, strict=True))
        found = broken(contact, force, **scaled, **more)
        assert (found is None) == good, (factor, found)
        if found is not None:
            assert found.how == how
            assert found.member is not None
            after = np.array(force) + found.member.force
            push = after @ contact.normal
            across = np.linalg.norm(after - push * contact.normal)
            out = {"leaves its friction cone": across - contact.friction * push, "exceeds its limit": (
                np.linalg.norm(after) - more.get("share", 1.0) * (contact.max_force or 9e9))}  # fmt: skip
            assert out.get(how, 1.0) > -1e-12


CONE, LIMIT, ROW = "leaves its friction cone", "exceeds its limit", "breaks a linear limit"
PLANE, SPACE = rg.Contact([0, 0], [1, 0], 0.5), rg.Contact([0, 0, 0], [1, 0, 0], 0.5)


def test_cones_in_the_plane_and_in_space() -> None:
    judged(PLANE, [4, 0], 2.0, CONE, axes=[[0, 1]])
    judged(PLANE, [4, 0], 4.0, CONE, axes=[[1, 0]])
    judged(PLANE, [4, 0], 2 * 2 / sqrt(5), CONE, axes=np.eye(2))  # the distance of (4, 0) from its edge
    judged(PLANE, [4, 1], 1.0, CONE, axes=[[0, 1]])
    judged(SPACE, [4, 0, 0], 2.0, CONE, axes=[[0, 1, 0]])
    judged(SPACE, [4, 0, 0], 2.0, CONE, axes=[[0, 1, 0], [0, 0, 1]])
    judged(SPACE, [4, 0, 0], 4.0, CONE, axes=[[1, 0, 0]])
    judged(SPACE, [4, 0, 0], 4 / sqrt(5), CONE, axes=np.eye(3))
    judged(SPACE, [4, 1, 0], 1.0, CONE, axes=[[0, 1, 0]])
    judged(SPACE, [4, 1, 0], sqrt(3), CONE, axes=[[0, 0, 1]])  # 1 + r^2 = 2^2, sideways
    judged(SPACE, [4, 0.5, 0], (0.5 * 4 - 0.5) * 2 / sqrt(5), CONE, axes=[[1, 0, 0], [0, 1, 0]])


def test_corners_of_sets() -> None:
    for contact in (PLANE, SPACE):
        d = contact.dimension
        force, side, up = np.eye(d)[0] * 4, np.eye(d)[1], np.eye(d)[0]
        judged(contact, force, 2.0, CONE, corners=[side, -0.5 * side, 0 * side])
        judged(contact, force, 2.0, CONE, corners=[-side, 0.5 * side, up])
        judged(contact, force, 4.0, CONE, corners=[-up, up, 0.1 * side, -0.1 * side][:2])
        for first, then in (2.1, 3.0), (3.0, 2.1):  # the first that breaks it is named
            found = broken(SPACE, [4, 0, 0], corners=np.outer([first, then, -0.1], [0, 1, 0]))
            assert found.member.force.tolist() == [0, first, 0]
        limited = contact.changed(max_force=5.0)
        judged(limited, force, 1.0, LIMIT, corners=[up, -up])
        judged(limited, force, 0.5, LIMIT, corners=[up, -up], share=0.9)
        judged(contact.changed(limits=rg.ForceLimits([[1.0, *[0.0] * (d - 1)]], [5.0])), force, 1.0, ROW,
               corners=[up, 0 * up])  # fmt: skip


@pytest.mark.parametrize("mu", [0.5, 3.0])
def test_limits_of_a_ball(mu) -> None:
    """(4 + r)^2, 16 + r^2 where nothing pulls that way at first, and both."""
    for contact, d in ((PLANE, 2), (SPACE, 3)):
        contact = contact.changed(max_force=5.0, friction=mu)
        force, (up, side) = np.eye(d)[0] * 4, np.eye(d)[:2]
        judged(contact, force, 1.0, LIMIT, axes=[up])
        judged(contact, force, 0.5, LIMIT, axes=[up], share=0.9)
        judged(contact, force, 1.0, LIMIT, axes=np.eye(d))
        if mu > 1:
            judged(contact, force, 3.0, LIMIT, axes=[side])  # the hard case: no pull along the axis
            judged(contact, force + side, 2.0, LIMIT, axes=[side])
            if d == 3:
                judged(contact, force, 3.0, LIMIT, axes=np.eye(3)[1:])
                judged(contact, force, 1.0, LIMIT, axes=[up, 0.01 * side])
        limits = rg.ForceLimits([[1.0, *[0.0] * (d - 1)]], [5.0])
        judged(contact.changed(max_force=None, limits=limits), force, 1.0, ROW, axes=[up])


def test_balls_beside_sizes_of_all_scales() -> None:
    """A force of a billionth, and one of a billion: the multiplier is found at every scale."""
    for scale in (1e-9, 1e-3, 1e9):
        judged(SPACE, [4 * scale, 0, 0], 2.0 * scale, CONE, axes=[[0, 1, 0]])
        judged(SPACE.changed(max_force=5 * scale, friction=3.0), [4 * scale, 0, 0], 3.0 * scale, LIMIT,
               axes=[[0, 1, 0]])  # fmt: skip
    assert broken(SPACE, [4, 0, 0], axes=[[0, 0, 0]]) is None
    assert broken(SPACE, [0, 0, 0], axes=[[0, 0, 0]]) is None
    assert broken(SPACE, [-1, 0, 0], axes=[[0, 0, 0]]) is not None
    assert broken(SPACE, [-1, 0, 0], axes=[[0, 1, 0]]).how == CONE


def test_friction_is_judged_by_its_factor() -> None:
    judged_at = {1.0: 2.0, 0.5: 1.0, 0.25: 0.5}
    for factor, most in judged_at.items():
        for contact in (PLANE, SPACE):
            axis = np.eye(contact.dimension)[1]
            assert (
                broken(contact, np.eye(contact.dimension)[0] * 4, axes=[axis * most * 0.999], friction=factor)
                is None
            )
            assert broken(
                contact, np.eye(contact.dimension)[0] * 4, axes=[axis * most * 1.001], friction=factor
            )


def test_soft_fingers_weigh_torques_by_their_reach() -> None:
    """mu / e = 2: a torque of 1 uses what a tangential force of 2 does."""
    contact = rg.Contact([0, 0, 0], [1, 0, 0], 0.5, torsion=0.25, max_force=5.0)
    touch = Touch(contact, ONE, 4)
    answer = exact(np.array([[0.0] * 6, [0.0] * 6, [0.0] * 6, [0, 0, 0, 1.0, 0, 0]]))
    for most, force, how in ((1.0, [4.0, 0, 0, 0], CONE), (1.5, [4.0, 0, 0, 0], LIMIT)):
        judge = touch if how == CONE else Touch(contact.changed(friction=3.0, torsion=1.5), ONE, 4)
        for factor, good in (most * (1 - 1e-9), True), (most * (1 + 1e-9), False):
            for loads in (
                rg.LoadSet.ball(rg.Wrench([0, 0, 0]), torque=factor),
                rg.LoadSet.hull([rg.Wrench([0, 0, 0], [s * factor, 0, 0]) for s in (1, -1)]),
            ):
                found = judge.broken([Fraction(x) for x in force], answer, Body(loads))
                assert (found is None) == good
                assert found is None or found.how == how
    point = Touch(
        contact.changed(torsion=None), ONE, 4
    )  # beside soft ones: its torque is none, and weighs none
    assert point.weights[-1] == 0


def test_what_matrices_do() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        a, b = rng.integers(-3, 4, (4, 4)), rng.integers(-3, 4, (4, 2))
        found = solved(exact(a), exact(b))
        if abs(np.linalg.det(a)) < 0.5:
            assert found is None
        else:
            assert product(exact(a), found) == exact(b)
    assert solved(exact([[0, 1], [1, 0]]), exact([[2], [3]])) == exact([[3], [2]])
    assert transposed(exact([[1, 2], [3, 4]])) == exact([[1, 3], [2, 4]])
    for rows, good in (
        ([[1, 0], [0, 0]], True), ([[0, 0], [0, 1]], True), ([[0, 1], [1, 5]], False),
        ([[0, 0], [0, -1]], False), ([[1, 2], [2, 4]], True), ([[1, 2], [2, 3.999]], False),
        ([[-1, 0], [0, 1]], False), ([[0, 0], [0, 0]], True),
        ([[0, 0, 0], [0, 1, 2], [0, 2, 4]], True), ([[0, 0, 0], [0, 1, 2], [0, 2, 3]], False),
        ([[4, 2, 2], [2, 1, 1], [2, 1, 1]], True), ([[4, 2, 2], [2, 1, 2], [2, 2, 1]], False),
    ):  # fmt: skip
        assert is_semidefinite(exact(rows)) == good, rows
    third = Fraction(1, 3)
    rows = [[third * 2**300, -third / 2**300, Fraction(0)], [Fraction(5), Fraction(2**120 + 1), -third]]
    for x, y in zip(chain(*rows), chain(*coarse(rows)), strict=True):  # each in its own unit
        assert abs(x - y) <= abs(x) / 2**99
        assert y.denominator & (y.denominator - 1) == 0  # a binary fraction, of not many digits
        assert y == 0 or (y / Fraction(2) ** round(np.log2(float(abs(y))))).denominator <= 2**101
    assert coarse(rows)[1] == [5, 2**120, coarse([[-third]])[0][0]]


def leaves(gone: str, extra: float, early: bool, more: str | None = None) -> str:
    """Four fingers push with 1, those of ``gone`` leave; ``more`` may push with 1 + extra at most."""
    grasp, forces = cross((2.0,) * 4)
    forces[:, 1:] = 0
    after = forces.copy()
    after[["ABCD".index(x) for x in gone]] = 0
    grasp = rg.Grasp(c.changed(max_force=1 + extra if c.name == more else None) for c in grasp)
    start, end = (rg.GraspState(grasp, rg.Wrench([0, 0]), f) for f in (forces, after))
    made = Plan("rotation", None, start, end)
    values = {name: getattr(made, name) for name in (*Plan.__dataclass_fields__, "forces")}
    plan = SimpleNamespace(**values, leaving=tuple(gone), arriving=())
    return "; ".join(rg.verify(plan, early_loss=early).violations)


def test_losing_fingers_that_leave_one_by_one_and_all_at_once() -> None:
    """B and D face each other, as A and C do: both at once leave a balance, one alone does not."""
    for more in "AC":
        found = leaves("BD", 0.01, True, more)
        for gone in "BD":
            assert f"start, {gone} lost: force of {more} exceeds its limit" in found
        assert found.count("lost") == 2
        assert leaves("BD", 9.0, True, more) == ""
        assert leaves("BD", 0.01, False, more) == ""
        tight = leaves("BD", -0.5, True, more)
        for label in ("start", "end"):
            for gone in ("B", "D", "B, D"):
                assert tight.count(f"{label}, {gone} lost: force of {more} exceeds its limit") == 1
        assert "start, all fingers at work answering: force of" in tight
    assert "start: force of B" in leaves("BD", -0.5, True, "B")
    assert "B lost: force of B" not in leaves("BD", -0.5, True, "B")
    assert leaves("B", -0.5, True, "A").count("start, B lost: force of A") == 1
    assert leaves("B", -0.5, True, "A").count("start: force of A exceeds") == 1


def test_fingers_that_nothing_is_lost_of() -> None:
    grasp, forces = cross((2.0,) * 4)
    start = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    assert rg.verify(Plan("rotation", None, start, start), early_loss=True).ok


def test_contacts_after_one_that_is_gone_are_looked_at() -> None:
    """A, the first, leaves with C: of those after it one is over its limit."""
    for more in "BD":
        assert f"A lost: force of {more} exceeds its limit" in leaves("AC", 0.01, True, more)


@pytest.mark.parametrize("contact", [PLANE, SPACE])
def test_loads_that_tilt_are_looked_at_from_outside(contact) -> None:
    """A force of 1 within an angle of the normal: what only the polytope around them breaks is not proven."""
    d, edge = contact.dimension, float(np.arctan(0.5))
    push = rg.Wrench(np.eye(d)[0])
    answer = exact(np.hstack([np.eye(d), np.zeros((d, 2 * d - 3))]))

    def found(angle, limit=None):
        touch = Touch(contact.changed(max_force=limit), ONE, d)
        return touch.broken([Fraction(0)] * d, answer, Body(rg.LoadSet.tilted(push, angle)))

    behind = Touch(contact, ONE, d).broken(
        [Fraction(-3 * k) for k in np.eye(d, dtype=int)[0].tolist()],
        answer,
        Body(rg.LoadSet.tilted(push, 0.0)),
    )
    assert behind.how == CONE
    assert behind.member is not None
    assert found(0.9 * edge) is None
    over = found(edge * (1 + 1e-5))
    assert over.how == CONE
    assert np.linalg.norm(over.member.force[1:]) > 0.5 * over.member.force[0]
    assert np.linalg.norm(over.member.force) == pytest.approx(1)
    near = found(edge * (1 - 1e-5))
    assert near is None if d == 2 else (near.how, near.member) == (CONE, None)
    for bound, good in (1 + 1e-9, True), (1 - 1e-9, False):  # a row along the normal: the farthest member
        row = contact.changed(limits=rg.ForceLimits([[1.0, *[0.0] * (d - 1)]], [bound]))
        judged = Touch(row, ONE, d).broken([Fraction(0)] * d, answer, Body(rg.LoadSet.tilted(push, 0.2)))
        assert (judged is None) == good
        assert good or (judged.how, judged.member.force[0]) == (ROW, pytest.approx(1))
    assert found(0.2, limit=1.1) is None
    assert (found(0.2, limit=1 + 1e-9).how, found(0.2, limit=1 + 1e-9).member) == (LIMIT, None)
    assert found(0.2, limit=0.999).how == LIMIT
    assert np.linalg.norm(found(0.2, limit=0.999).member.force) == pytest.approx(1)


def test_contacts_off_are_named_where_there_are_several() -> None:
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    plan = Plan("rotation", None, state, state)
    far, none = [9.0, 0, 0, 0], [0.0] * 4
    alone = rg.verify(plan, position=far).violations
    assert alone
    assert not any("contacts off as in row" in v for v in alone)
    for rows, k in ([far, none], 0), ([none, far], 1):
        several = rg.verify(plan, position=rows).violations
        assert several == tuple(f"{v}, contacts off as in row {k}" for v in alone)
    assert rg.verify(plan, position=[none, none]).ok


def test_what_is_promised_is_judged_but_where_more_is_asked() -> None:
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    ball, small = (rg.LoadSet.ball(rg.Wrench([0, 0]), force=f) for f in (100.0, 1e-3))
    made = Plan("rotation", None, state, state)
    values = {name: getattr(made, name) for name in (*Plan.__dataclass_fields__, "forces")}
    promise = SimpleNamespace(disturbance=ball, stiffness=None, early_loss=False)
    record = SimpleNamespace(**vars(made.record) | {"withstands": promise})
    plan = SimpleNamespace(**values | {"record": record, "leaving": (), "arriving": ()})
    told = rg.verify(plan).violations
    assert told
    assert all(v.startswith("record: ") for v in told)
    assert any(v.startswith("record: ") for v in rg.verify(plan, disturbance=small).violations)
    same = rg.verify(plan, disturbance=ball).violations  # said once
    assert same == tuple(v.removeprefix("record: ") for v in told)
    off = rg.verify(
        plan, disturbance=ball, position=[0.0] * 4
    ).violations  # of other contacts than the plan's
    assert any(v.startswith("record: ") for v in off)


def test_what_was_asked_is_said() -> None:
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    plan = Plan("rotation", None, state, state)
    friction, lost = "0.9 times the friction", "the early loss of a finger that leaves or arrives"
    assert rg.verify(plan, friction=0.9, early_loss=True).withstood == f"{friction}, with {lost}"
    assert rg.verify(plan, friction=0.9).withstood == friction
    assert rg.verify(plan, early_loss=True).withstood == lost


def test_worst_members_are_in_the_ball_and_break_what_they_show() -> None:
    """Of random forms: a length that rounding leaves a last bit over one has no room left."""
    rng, found = np.random.default_rng(0), 0
    for k in [1, 2, 3] * 40:
        s = rng.normal(size=(k + 1, k + 1))
        z = _worst(exact(s + s.T))
        if z is not None:
            found += 1
            one = np.append(z, 1.0)
            assert np.linalg.norm(z) <= 1 + 1e-15
            assert one @ s @ one < 1e-12
    assert found > 60
