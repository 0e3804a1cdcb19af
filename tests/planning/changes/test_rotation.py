"""Turning objects: equilibrium and cones at every angle, bounds that are reached, and what verify finds."""

from dataclasses import replace
from math import cos, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from regrasp.closed_form.turning_path import turning_path, turning_peaks, turning_slope
from regrasp.mechanics.loads.rotated import turned_load
from regrasp.plans.turning import TurningPath
from regrasp.verification.turning_steps import cosine_sine

pytestmark = pytest.mark.laws

GRASP = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.8, name="A"), rg.Contact([1, 0.1], [-1, 0], 0.8, name="B")])
WEIGHT = rg.Wrench([0, -2])
FORCES = st.lists(st.floats(-1, 1).map(lambda x: x if abs(x) > 1e-100 else 0.0), min_size=2, max_size=2).map(
    np.array
)  # squares of smaller ones vanish


@given(FORCES, FORCES, st.floats(0.01, 3.1) | st.floats(-3.1, -0.01))
@settings(max_examples=200)
def test_the_crest_of_a_turn(f, g, delta):
    theta = np.linspace(0, delta, 2001)
    path = turning_path(f[None], g[None], delta, theta)[:, 0]
    slope = turning_slope(f[None], g[None], delta, theta)[:, 0]
    size = abs(np.array([f, g])).max() / abs(np.sin(delta))
    for values, crest in zip((path, slope), turning_peaks(f, g, delta), strict=True):
        sampled = np.linalg.norm(values, axis=1).max()
        assert sampled - 1e-9 * size <= crest <= sampled + 1e-5 * size
    assert path[0] == pytest.approx(f, abs=1e-12 * size)
    assert path[-1] == pytest.approx(g, abs=1e-12 * size)


@pytest.mark.filterwarnings("ignore:angle is in radians")  # whole turns are meant here
@pytest.mark.parametrize("angle", [0.3, -0.3, 1.5, pi, -4.0, 2 * pi, 9.0])
def test_a_turn_holds_at_every_time(angle):
    plan = rg.plan_rotation(GRASP, angle, load=WEIGHT, duration=2.0)
    t = np.linspace(0, 2, 1501)
    theta = plan.orientation(t)
    assert theta[[0, -1]] == pytest.approx([0, angle])
    world = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    seen = np.einsum("ijt,tj->ti", world, plan.load(t)[:, :2])  # in the world the weight stays
    assert seen == pytest.approx(np.tile([0.0, -2.0], (t.size, 1)), abs=1e-12)
    assert abs(plan.wrenches(t).sum(axis=1) + plan.load(t)).max() < 1e-13 * 10
    normal = (plan.forces(t) * GRASP.normals).sum(axis=-1)
    assert (abs((plan.forces(t) * GRASP.tangents).sum(axis=-1)) <= 0.8 * normal).all()
    sizes = np.linalg.norm(plan.forces(t), axis=-1)
    assert sizes.max() <= plan.peak * (1 + 1e-12)
    assert sizes.max() == pytest.approx(plan.peak, rel=1e-4)
    knots = [rg.GraspState(GRASP, turned_load(WEIGHT, a), f) for a, f in zip(*turn_of(plan), strict=True)]
    widest = np.diff(abs(plan.turn.angles)).max()
    assert plan.peak <= max(s.magnitudes.max() for s in knots) / cos(widest / 2) * (1 + 1e-12)
    assert plan.margins(t).least_angle >= min(s.margins.least_angle for s in knots) - 1e-12
    assert plan.margins(t).least_force >= min(s.margins.least_force for s in knots) - 1e-12
    assert np.linalg.norm(plan.rates(t), axis=-1).max() <= plan.steepest.max()
    assert rg.verify(plan).ok
    assert rg.verify(plan.reversed()).ok
    assert plan.reversed().forces(0.5) == pytest.approx(plan.forces(1.5), abs=1e-12)


def turn_of(plan):
    return plan.turn.angles, plan.turn.forces


def test_given_ends_are_kept():
    start = rg.choose_state(GRASP, WEIGHT, "effort")
    end = rg.choose_state(GRASP, turned_load(WEIGHT, 0.5), "force", max_force=9.0)
    plan = rg.plan_rotation(start, 0.5, end=end)
    assert (plan.start.forces == start.forces).all()
    assert (plan.end.forces == end.forces).all()
    assert plan.record.choices == ()


@pytest.mark.parametrize("load", [WEIGHT, turned_load(WEIGHT, -0.5), 2 * turned_load(WEIGHT, 0.5)])
def test_an_end_under_another_load_or_of_other_contacts_is_refused(load):
    for end in (
        rg.choose_state(GRASP, load),
        rg.choose_state(GRASP.subset(["B", "A"]), turned_load(WEIGHT, 0.5)),
    ):
        with pytest.raises(
            rg.InvalidInput, match="end must be a state of the same contacts under the load seen"
        ):
            rg.plan_rotation(GRASP, 0.5, load=WEIGHT, end=end)


def test_a_turn_through_orientations_that_cannot_be_held():
    """Fact 3: two states less than pi apart hold what no state chosen between them was asked for."""
    shelf = rg.Grasp([rg.Contact([-1, -1], [0, 1], 0.9), rg.Contact([1, -1], [0, 1], 0.9)])
    plan = rg.plan_rotation(shelf, 1.2, load=rg.Wrench([0.6, -1.0]))
    assert rg.verify(plan).ok
    with pytest.raises(rg.Infeasible, match=r"no forces of P1, P2 .* escapes by") as refused:
        rg.plan_rotation(shelf, pi, load=WEIGHT)
    assert refused.value.certificate.is_proof


def test_force_limits_hold_on_the_way():
    plan = rg.plan_rotation(GRASP, 2.0, load=WEIGHT, max_force=12.0)
    assert plan.peak <= 12.0
    assert rg.verify(plan).ok
    tight = [
        rg.Contact(c.position, c.normal, c.friction, max_force=0.999 * plan.peak, name=c.name) for c in GRASP
    ]
    grasp = rg.Grasp(tight)
    states = [rg.GraspState(grasp, s.load, s.forces) for s in (plan.start, plan.end)]
    claimed = replace(plan, start=states[0], end=states[1])
    assert "between two angles, above its limit" in "; ".join(rg.verify(claimed).violations)


def test_the_verifier_finds_a_wrong_turn():
    plan = rg.plan_rotation(GRASP, 2.0, load=WEIGHT)
    with pytest.raises(rg.InvalidInput, match="a turning path holds the load that turns with it"):
        rg.verify(plan, lambda t: WEIGHT)
    angles, forces = plan.turn.angles, plan.turn.forces

    def verdict(**changes):
        return "; ".join(rg.verify(replace(plan, **changes)).violations)

    assert verdict() == ""
    moved = forces.copy()
    moved[1] *= 1 + 1e-9
    assert "angle 1 rad: not in equilibrium" in verdict(path=TurningPath(angles, moved))
    assert "not the first and the last state" in verdict(path=TurningPath(angles, np.roll(forces, 1, axis=0)))
    assert "not in equilibrium" in verdict(path=TurningPath(1.001 * angles, forces))
    wide = TurningPath([0.0, 3.1415], forces[[0, -1]])
    assert "not in equilibrium" in verdict(path=wide)
    with pytest.raises(rg.InvalidInput, match="steps below pi"):
        TurningPath([0.0, 3.2], forces[[0, -1]])
    with pytest.raises(rg.InvalidInput, match="one way from 0"):
        TurningPath([0.0, 1.0, 0.5], forces[:3])


@given(st.floats(-30, 30))
def test_rational_cosines(angle):
    from fractions import Fraction

    c, s = cosine_sine(Fraction(angle))
    assert float(c) == pytest.approx(np.cos(angle), abs=1e-14)
    assert float(s) == pytest.approx(np.sin(angle), abs=1e-14)
    assert abs(c * c + s * s - 1) < Fraction(1, 2**70)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"angle": 0.0}, "angle must not be 0"),
        ({"angle": np.nan}, "angle must be finite"),
        ({"angle": 1.0, "axis": [0, 0, 1]}, "turns in the plane; leave axis out"),
        ({"angle": 1.0, "load": None}, "needs the load"),
        ({"angle": 1.0, "objective": "speed"}, "objective must be one of"),
        ({"angle": 1.0, "duration": -1}, "duration must be greater than 0"),
    ],
)
def test_bad_input(options, words):
    with pytest.raises(rg.InvalidInput, match=words):
        rg.plan_rotation(GRASP, **{"load": WEIGHT, **options})


THREE = rg.Grasp([*GRASP, rg.Contact([0, -1], [0, 1], 0.5, name="C")])


@pytest.mark.parametrize("torque", [0.0, 0.3])
@pytest.mark.parametrize("turn", [0.3, 2.0, -3.0])
def test_pieces_are_halved_until_limits_hold(turn, torque) -> None:
    """A little above what holding needs at every angle; a little below, a state proves the limit too low."""
    weight = rg.Wrench([0, -2], torque)
    seen = [turned_load(weight, a) for a in np.linspace(0, turn, 241)]
    needed = max(rg.choose_state(THREE, load, "peak").value for load in seen)
    plan = rg.plan_rotation(THREE, turn, load=weight, max_force=1.001 * needed)
    assert rg.verify(plan).ok
    assert plan.peak <= 1.001 * needed
    with pytest.raises(rg.Infeasible, match="no forces of A, B, C") as refused:
        rg.plan_rotation(THREE, turn, load=weight, max_force=0.99 * needed)
    assert refused.value.certificate.is_proof


@pytest.mark.parametrize("objective", ["angle", "effort"])
def test_halving_goes_to_a_millionth_of_a_limit(objective) -> None:
    """Both fingers carry half of what is across; one pushes against the rest, and against the other."""
    pair = rg.Grasp([rg.Contact([-1, 0], [1, 0], 2.0, name="A"), rg.Contact([1, 0], [-1, 0], 2.0, name="B")])
    s, c = np.sin(np.linspace(0, 2, 100_001)), np.cos(np.linspace(0, 2, 100_001))
    needed = np.hypot(2 * abs(s) + abs(c) / 2, c).max()
    options = {"load": rg.Wrench([0, -2]), "objective": objective}
    plan = rg.plan_rotation(pair, 2.0, **options, max_force=needed * (1 + 1e-6))
    assert rg.verify(plan).ok
    with pytest.raises(rg.Infeasible, match=r"after a turn of|above its limit"):
        rg.plan_rotation(pair, 2.0, **options, max_force=needed * (1 - 1e-6))


@pytest.mark.parametrize("torque", [0.0, 0.3])
def test_solvers_without_cones_plan_turns_with_facets(torque) -> None:
    weight = rg.Wrench([0, -2], torque)
    options = {"load": weight, "max_force": 6.0, "method": "daqp", "objective": "effort"}
    with pytest.raises(rg.InvalidInput, match="facets"):
        rg.plan_rotation(THREE, 1.0, **options)
    plan = rg.plan_rotation(THREE, 1.0, **options, facets=16)
    assert rg.verify(plan).ok
    assert {choice.method for choice in plan.record.choices} == {"daqp"}
    with pytest.raises(rg.InvalidInput, match="facets must be"):
        rg.plan_rotation(THREE, 1.0, **options, facets=2)


@pytest.mark.parametrize("off", [(1e-6, 0.0), (0.0, 2e-6), (1e-6, 3e-6), (3e-6, 1e-6)])
def test_given_ends_are_balanced_and_the_larger_change_is_recorded(off) -> None:
    """A push against one finger alone is shared by both: half of it."""
    plan = rg.plan_rotation(GRASP, 0.5, load=WEIGHT)
    given = [
        rg.GraspState(GRASP, state.load, state.forces + np.array([[size, 0], [0, 0]]))
        for state, size in zip((plan.start, plan.end), off, strict=True)
    ]
    again = rg.plan_rotation(given[0], 0.5, end=given[1])
    assert again.record.balancing == pytest.approx(max(off) / 2, rel=0.1)
    assert rg.verify(again).ok
    assert plan.record.balancing == 0.0
