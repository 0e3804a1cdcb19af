"""Turns whose crests lie between two angles, loads that hardly turn, and whose stiffness a contact has."""

from fractions import Fraction
from math import cos, sin, sqrt
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, cross, turn
from regrasp.verification.regrasps import of_steps
from regrasp.verification.rotated_loads import TurningLoad

pytestmark = pytest.mark.contract

NONE = rg.Wrench([0.0, 0.0])


def said(plan) -> str:
    return "; ".join(rg.verify(plan).violations)


def turned(grasp, first, last, step) -> Plan:
    start, end = (rg.GraspState(grasp, NONE, f) for f in (first, last))
    return Plan("rotation", None, start, end, turn=turn([0.0, step], [first, last]))


def crest(p: float, q: float, step: float) -> float:
    """The largest a p + b q on the way, a = sin(step - x) / sin(step), b = sin(x) / sin(step)."""
    x = np.linspace(0, step, 100_001)
    return float(((np.sin(step - x) * p + np.sin(x) * q) / sin(step)).max())


@pytest.mark.parametrize("step", [0.5, -0.5, 2.0, -2.0])
@pytest.mark.parametrize("growth", [1.0, 1.05, 0.95])
def test_linear_limits_between_two_angles(step, growth) -> None:
    """Pushes of 1 and ``growth``, in the second of two rows; the first falls from end to end."""
    _, forces = cross((1.0,) * 4)
    forces[:, 1:] = 0
    most = crest(1.0, growth, step)
    assert most > max(1.0, growth) * 1.0001
    for factor, good in (1 + 1e-8, True), (1 - 1e-8, False):
        limits = rg.ForceLimits([[-1.0, 0.0], [1.0, 0.0]], [5.0, most * factor])
        grasp = rg.Grasp(c.changed(limits=limits) for c in cross((1.0,) * 4)[0])
        found = said(turned(grasp, forces, growth * forces, step))
        assert (found == "") == good, factor
        assert good or "force of A breaks its linear limit 1 between two angles" in found


@pytest.mark.parametrize("step", [0.5, -0.5, 2.0, -2.0])
@pytest.mark.parametrize(("growth", "size"), [(1.0, 1.0), (1.05, 2.0**-40), (0.95, 2.0**40)])
def test_force_limits_between_two_angles(step, growth, size) -> None:
    _, forces = cross((1.0,) * 4, force=size)
    most = crest(1.0, growth, step) * sqrt(1.25) * size
    for factor, good in (1 + 1e-8, True), (1 - 1e-8, False):
        grasp, _ = cross((1.0,) * 4, limits=(None, None, most * factor, None))
        found = said(turned(grasp, forces, growth * forces, step))
        assert (found == "") == good, factor
        assert good or "force of C reaches" in found


@pytest.mark.parametrize("step", [1e-3, -1e-6, 1e-9, -1e-12])
def test_small_steps_grow_forces_by_no_more_than_the_step(step) -> None:
    """By 1 / cos(step / 2) at most, which squares of sines that vanish must not blur."""
    _, forces = cross((1.0,) * 4)
    room = 1 / cos(step / 2) * (1 + 2e-15)
    for size in (1.0, 1 - 1e-13):
        grasp, _ = cross((1.0,) * 4, limits=(sqrt(1.25) * room,) * 4)
        assert said(turned(grasp, forces, size * forces, step)) == ""


def test_fingers_that_carry_nothing_on_the_way_keep_their_limits() -> None:
    grasp, forces = cross((1.0,) * 4, limits=(9.0,) * 4)
    forces[:, 1:] = 0
    forces[[1, 3]] = 0
    for step in (0.5, -0.5):
        assert said(turned(grasp, forces, forces, step)) == ""


def test_parts_of_a_load_that_stay_still_are_small_beside_those_that_turn() -> None:
    """Torques over the largest lever: of 2^10 here, so that a torque of 2^10 is a force of 1."""
    axis, arm = np.array([0.0, 0, 1]), 2.0**10
    turning_force, turning_torque = rg.Wrench([1.0, 0, 0]), rg.Wrench([0.0, 0, 0], [arm, 0, 0])
    for base in (turning_force, turning_torque):
        for off, good in (0.99 * 2.0**-40, True), (1.01 * 2.0**-40, False):
            for still in (np.array([0, 0, off, 0, 0, 0]), np.array([0, 0, 0, 0, 0, off * arm])):
                load = rg.Wrench.from_vector(base.vector + still)
                assert TurningLoad(load, axis, Fraction(arm) ** 2).turns_whole == good, (off, still)
    assert not TurningLoad(rg.Wrench([1.0, 0], 1e-3), None, Fraction(1)).turns_whole
    assert TurningLoad(rg.Wrench([1.0, 0], 0.99 * 2.0**-30), None, Fraction(arm) ** 2).turns_whole
    assert not TurningLoad(rg.Wrench([1.0, 0], 1.01 * 2.0**-30), None, Fraction(arm) ** 2).turns_whole


def steps(*names: str) -> SimpleNamespace:
    """A regrasp of steps on contacts of these names."""
    parts = (SimpleNamespace(start=SimpleNamespace(grasp=SimpleNamespace(names=tuple(n)))) for n in names)
    return SimpleNamespace(steps=tuple(parts))


def test_a_contact_has_the_stiffness_of_the_finger_that_moved_there() -> None:
    rows = [10.0, 20.0, 30.0]
    for names, wanted in (
        (("ABC", "ABC"), ([0, 1, 2], [0, 1, 2])),
        (("ABC", "AC", "ACD"), ([0, 1, 2], [0, 2], [0, 2, 1])),
        (("ABC", "AB", "ABD", "DB", "DBE"), ([0, 1, 2], [0, 1], [0, 1, 2], [2, 1], [2, 1, 0])),
        (("ABC", "DBC", "DEC", "DEF"), ([0, 1, 2], [0, 1, 2], [0, 1, 2], [0, 1, 2])),
        (("ABC", "CBD"), ([0, 1, 2], [2, 1, 0])),
        (("ABC", "DE"), ([0, 1, 2], [0, 1])),
        (("ABC", "ABCD"), ([0, 1, 2], [0, 1, 2, 0])),
    ):
        found = of_steps(steps(*names), rows)
        assert [[rows.index(x) for x in row] for row in found] == [list(w) for w in wanted], names
    assert of_steps(steps("ABC", "AB"), None) == [None, None]
    assert of_steps(steps("ABC", "AB"), 5.0) == [5.0, 5.0]
    for wrong in ([1.0, 2.0], [1.0] * 4):
        with pytest.raises(rg.InvalidInput, match="a row for each of 3 fingers"):
            of_steps(steps("ABC", "AB"), wrong)
