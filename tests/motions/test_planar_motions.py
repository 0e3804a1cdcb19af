"""Free fingers pass through nothing: checked by dense sampling with lines of its own."""

from collections.abc import Iterator
from functools import cache
from itertools import count

import numpy as np
import pytest

import regrasp as rg
from executed_plans import ellipse
from finger_moves import moved
from regrasp.motions import Motions, plan_motions
from regrasp.outline import parts

pytestmark = pytest.mark.laws

RADIUS, CLEARANCE = 0.003, 0.002
HUNDRED = 100

STAR = np.array(
    [[(0.05 if k % 2 else 0.028) * f(np.pi * k / 5) for f in (np.cos, np.sin)] for k in range(10)]
)
SHAPES = {
    "ellipse": rg.Outline.ellipse(0.04, 0.02),
    "star": rg.Outline(STAR),
    "hook": rg.Outline([[0, 0], [0.09, 0], [0.09, 0.02], [0.02, 0.02], [0.02, 0.07], [0, 0.07]]),
    "bracket": parts.bracket(),
}


@cache
def endless(name: str) -> tuple[list[tuple[rg.RegraspPlan, Motions]], Iterator[int]]:
    """What ``planned`` has found, and the seeds to go on with."""
    return [], count()


def planned(name: str, least: int) -> list[tuple[rg.RegraspPlan, Motions]]:
    """Moves from random places to random places of a shape, until ``least`` have motions."""
    shape, (found, seeds) = SHAPES[name], endless(name)
    while len(found) < least:
        seed = next(seeds)
        rng = np.random.default_rng(seed)
        s = shape.length * rng.uniform(size=6)
        try:
            plan = moved([shape.contact_at(x, friction=0.8, name=f"C{k}") for k, x in enumerate(s)])
            found.append((plan, plan_motions(plan, shape, tip_radius=RADIUS, clearance=CLEARANCE)))
        except (rg.Infeasible, rg.InvalidInput):
            continue
    return found[:least]


def to_boundary(points: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """(m,) distances of points from the sides of a polygon; negative inside."""
    a, b = ring, np.roll(ring, -1, axis=0)
    best, inside = np.full(len(points), np.inf), np.zeros(len(points), dtype=bool)
    for p, q in zip(a, b, strict=True):
        u = np.clip(((points - p) @ (q - p)) / ((q - p) @ (q - p)), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - p - u[:, None] * (q - p), axis=1))
        x, y = points.T
        crosses = (p[1] > y) != (q[1] > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            inside ^= crosses & (x < (q[0] - p[0]) * (y - p[1]) / (q[1] - p[1]) + p[0])
    return np.where(inside, -best, best)


def sampled(motions: Motions) -> np.ndarray:
    """Times at which no tip has moved by more than a tenth of the clearance since the one before."""
    times = [np.array([0.0, motions.duration])]
    for m in motions.motions:
        number = int(np.ceil(15 / 8 * m.way.length / (CLEARANCE / 10))) + 1
        times.append(m.start + np.linspace(0, m.duration, number))
    return np.unique(np.concatenate(times))


@pytest.mark.parametrize("name", SHAPES)
def test_no_finger_passes_through_anything(name: str) -> None:
    """A hundred regrasps: no tip in the object or another tip, the clearance kept away from contacts."""
    shape = SHAPES[name]
    ring = shape.polygon(1e-5)
    for plan, motions in planned(name, HUNDRED // len(SHAPES)):
        t = sampled(motions)
        at = motions.positions(t)
        steps = np.linalg.norm(np.diff(at, axis=0), axis=2)
        assert steps.max() <= CLEARANCE / 10 * (1 + 1e-9)
        places = np.array([c.position for step in plan.steps for c in step.grasp])
        for i in range(at.shape[1]):
            tip = np.unique(at[:, i], axis=0)  # it stands most of the time
            away = to_boundary(tip, ring)
            assert away.min() > RADIUS - 1.1e-5
            own = np.linalg.norm(tip[:, None] - places, axis=2).min(axis=1) < 2 * (RADIUS + CLEARANCE) + 0.01
            assert (away[~own] >= RADIUS + CLEARANCE - 1e-9).all()
            for j in range(i):
                between = np.linalg.norm(at[:, i] - at[:, j], axis=1)
                moves = ~(motions.touching(t)[:, i] & motions.touching(t)[:, j])
                assert (between[moves] >= 2 * RADIUS + CLEARANCE - 1e-9).all()


def test_no_capsule_passes_through_anything() -> None:
    """Fingers 80 mm long, two from below, one from the right."""
    bar = rg.Outline([[-0.05, -0.01], [0.05, -0.01], [0.05, 0.01], [-0.05, 0.01]])
    places = ([-0.03, -0.01], [0.03, -0.01], [0.05, 0.0], [-0.05, 0.0], [-0.01, -0.01], [0.05, 0.004])
    contacts = [bar.contact_at(bar.nearest(p), friction=0.8, name=f"C{k}") for k, p in enumerate(places)]
    capsules = np.array([[0, -0.08], [0, -0.08], [0.08, 0]])
    motions = plan_motions(moved(contacts), bar, tip_radius=RADIUS, clearance=CLEARANCE, capsules=capsules)
    ring = bar.polygon()
    t = np.linspace(0, motions.duration, 3000)
    at = motions.positions(t)
    s = np.linspace(0, 1, 161)[:, None]
    fingers = [at[:, i, None] + s * v for i, v in enumerate(capsules)]
    for i, axis in enumerate(fingers):
        assert to_boundary(axis.reshape(-1, 2), ring).min() > RADIUS - 1e-6
        for j in range(i):
            moves = ~(motions.touching(t)[:, i] & motions.touching(t)[:, j])
            between = np.linalg.norm(axis[moves][:, ::4, None] - fingers[j][moves][:, None, ::4], axis=-1)
            assert between.min() >= 2 * RADIUS + CLEARANCE - 1e-9


@pytest.mark.parametrize("name", ["ellipse", "hook"])
def test_the_gaps_told_are_kept_and_no_larger_than_asked_for(name: str) -> None:
    ring = SHAPES[name].polygon(1e-5)
    for _, motions in planned(name, 5):
        for m in motions.motions:
            assert m.to_object >= CLEARANCE - 1e-12
            assert m.to_tips >= CLEARANCE - 1e-12
            x = np.linspace(0, 1, 2001)
            places, _ = m.way.over_time(x, m.duration)
            free = to_boundary(places, ring) - RADIUS
            middle = (x > 0.5 - 0.05) & (x < 0.5 + 0.05)
            assert free[middle].min() >= m.to_object - 1e-9


@pytest.mark.parametrize("name", ["ellipse", "star"])
def test_motions_begin_and_end_at_contacts_along_the_normal(name: str) -> None:
    for plan, motions in planned(name, 3):
        contacts = {str(c.name): c for step in plan.steps for c in step.grasp}
        for m in motions.motions:
            for place, contact, way in (
                (m.way.points[0], contacts[m.origin], -m.way.directions[0]),
                (m.way.points[-1], contacts[m.target], m.way.directions[-1]),
            ):
                assert place == pytest.approx(contact.position - RADIUS * contact.normal, abs=1e-12)
                assert way == pytest.approx(contact.normal, abs=1e-9)


def test_a_planned_regrasp_has_its_ways() -> None:
    shape = SHAPES["ellipse"]
    plan = rg.plan_regrasp(
        shape, ellipse(0.02, 0.35, 0.7), ellipse(0.2, 0.5, 0.85), rg.Wrench([0, -3.0]), friction=0.5
    )
    motions = plan_motions(plan, shape, tip_radius=RADIUS, clearance=CLEARANCE)
    assert [(m.step, m.finger, m.origin, m.target) for m in motions.motions if m.origin != m.target] == [
        (m.step, m.finger, m.origin_name, m.target_name) for m in plan.moves
    ]
    said = str(motions).splitlines()
    assert said[0] == f"{len(motions.motions)} motions, {motions.duration:.4g} s with the plan's steps"
    assert said[1].startswith("before step 2: finger ")


def test_speed_and_acceleration_keep_their_limits_and_velocities_are_those_of_the_positions() -> None:
    plan, _ = planned("star", 3)[0]
    motions = plan_motions(
        plan, SHAPES["star"], tip_radius=RADIUS, clearance=CLEARANCE, speed=0.2, acceleration=0.5
    )
    for m in motions.motions:
        t = m.start + np.linspace(0, m.duration, 20001)
        position, velocity = motions.positions(t)[:, m.finger], motions.velocities(t)[:, m.finger]
        dt = m.duration / 20000
        assert np.linalg.norm(velocity, axis=1).max() <= 0.2 * (1 + 1e-9)
        assert np.linalg.norm(np.diff(velocity, axis=0), axis=1).max() / dt <= 0.5 * (1 + 1e-3)
        assert np.diff(position, axis=0) / dt == pytest.approx((velocity[1:] + velocity[:-1]) / 2, abs=1e-5)


def test_two_fingers_touch_at_every_instant() -> None:
    for name in SHAPES:
        for _, motions in planned(name, 3):
            assert motions.touching(np.linspace(0, motions.duration, 500)).sum(axis=1).min() >= 2


def test_the_plans_clock_stands_while_fingers_move() -> None:
    plan, motions = planned("ellipse", 3)[0]
    t = np.linspace(0, motions.duration, 4001)
    clock = motions.plan_time(t)
    assert (clock[0], clock[-1]) == (0.0, pytest.approx(plan.duration))
    rates = np.diff(clock) / np.diff(t)
    assert ((abs(rates) < 1e-9) | (abs(rates - 1) < 1e-9)).mean() > 0.99
    assert motions.duration == pytest.approx(plan.duration + sum(m.duration for m in motions.motions))


def test_a_shorter_way_than_around_everything_is_found() -> None:
    """From side to side of a bar, around the nearer end, with the round corners of the offset."""
    bar = rg.Outline([[-0.1, -0.01], [0.1, -0.01], [0.1, 0.01], [-0.1, 0.01]])
    places = ([0.09, -0.01], [-0.02, -0.01], [0, 0.01], [0.09, 0.01], [-0.05, -0.01], [-0.05, 0.01])
    plan = moved([rg.Contact(p, [0, -np.sign(p[1])], 0.8, name=f"C{k}") for k, p in enumerate(places)])
    motion = plan_motions(plan, bar, tip_radius=0.003, clearance=0.002).motions[0]
    assert (motion.origin, motion.target) == ("C0", "C3")
    off, reach = 0.01 + 0.003 + 2 * 0.002, 0.005 + 0.0005  # about: lifted, and around the corners
    assert motion.way.length < 2 * 0.005 + 2 * (0.01 + reach) + np.pi * reach + 4 * off
    assert motion.way.points[:, 0].max() == pytest.approx(0.1 + 0.005, abs=1e-3)


def test_a_contact_in_a_slot_is_shut_in() -> None:
    """A slot of 8 mm does not take a tip of 3 mm that keeps 2 mm on either side."""
    comb = rg.Outline(
        [[0, 0], [0.1, 0], [0.1, 0.06], [0.054, 0.06], [0.054, 0.02], [0.046, 0.02], [0.046, 0.06], [0, 0.06]]
    )
    inside = comb.contact_at(comb.nearest([0.05, 0.02]), friction=0.8, name="deep")
    grasp = rg.Grasp(
        [
            inside,
            comb.contact_at(comb.nearest([0.03, 0.0]), friction=0.8, name="A"),
            comb.contact_at(comb.nearest([0.07, 0.06]), friction=0.8, name="B"),
        ]
    )
    plan = rg.plan_removal(grasp, "deep", load=rg.Wrench([0, -1.0]))
    with pytest.raises(rg.Infeasible, match=r"a tip of radius 0\.003 is shut in at deep"):
        plan_motions(plan, comb, tip_radius=0.003, clearance=0.002)
    assert plan_motions(plan, comb, tip_radius=0.002, clearance=0.001).motions[0].origin == "deep"


def test_tips_that_stand_in_the_way_are_named() -> None:
    ellipse = SHAPES["ellipse"]
    near = [ellipse.contact_at(s * ellipse.length, friction=0.8) for s in (0.25, 0.285, 0.75)]
    plan = rg.plan_removal(rg.Grasp(near), "P1", load=rg.Wrench([0, -1.0]))
    said = "no way from P1 to P1: at P1, .*, the tip of finger 2 is too near"
    with pytest.raises(rg.Infeasible, match=said):
        plan_motions(plan, ellipse, tip_radius=RADIUS, clearance=CLEARANCE)


def test_fingers_in_one_another_are_refused() -> None:
    ellipse = SHAPES["ellipse"]
    places = enumerate((0.5, 0.25, 0.26, 0.75, 0.6, 0.9))
    plan = moved([ellipse.contact_at(s * ellipse.length, friction=0.8, name=f"C{k}") for k, s in places])
    said = r"during step 1 fingers 2 and 3 of radius 0\.003 are in one another, 0\.00201 apart at C1 and C2"
    with pytest.raises(rg.Infeasible, match=said):
        plan_motions(plan, ellipse, tip_radius=RADIUS, clearance=CLEARANCE)


def test_two_rooms_without_a_door_are_told_apart() -> None:
    """Tips that stand at the mouth of a pocket shut the finger inside in."""
    pocket = rg.Outline(
        [[0, 0], [0.1, 0], [0.1, 0.05], [0.06, 0.05], [0.06, 0.01], [0.04, 0.01], [0.04, 0.05], [0, 0.05]]
    )
    com = pocket.centre_of_mass
    places = [[0.05, 0.01], [0.04, 0.045], [0.06, 0.045], [0.02, 0.0], [0.05, 0.0], [0.08, 0.0]]
    contacts = [
        rg.Contact(np.array(p) - com, n, 0.8, name=f"C{k}")
        for k, (p, n) in enumerate(
            zip(places, ([0, -1], [-1, 0], [1, 0], [0, 1], [0, 1], [0, 1]), strict=True)
        )
    ]
    with pytest.raises(rg.Infeasible, match="no way from C0 to C3: the object and other tips shut C3 in"):
        plan_motions(moved(contacts), pocket, tip_radius=RADIUS, clearance=CLEARANCE)
    wide = plan_motions(moved(contacts), pocket, tip_radius=0.001, clearance=0.001)
    assert wide.motions[0].way.points[:, 1].max() > 0.05 - com[1]


def test_what_is_not_planar_is_refused() -> None:
    plan, _ = planned("ellipse", 3)[0]
    with pytest.raises(
        rg.InvalidInput, match=r"ways of this plan are in the plane, around an Outline, got .disc."
    ):
        plan_motions(plan, "disc", tip_radius=1, clearance=1)  # type: ignore[arg-type]
    with pytest.raises(rg.InvalidInput, match="clearance must be greater than 0, got 0"):
        plan_motions(plan, SHAPES["ellipse"], tip_radius=1, clearance=0)


def test_the_object_is_that_of_the_plan():
    plan, _ = planned("ellipse", 1)[0]
    for other in (rg.Outline.ellipse(0.02, 0.02), rg.Outline.ellipse(40, 20)):  # another one, other units
        with pytest.raises(
            rg.InvalidInput, match=r"away from the outline, farther than the clearance 0\.002"
        ):
            plan_motions(plan, other, tip_radius=RADIUS, clearance=CLEARANCE)
