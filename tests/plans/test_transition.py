"""A transition is one value whatever its path: what it derives, reverses, prints and needs of friction."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD, STATE
from places import TESTS
from regrasp.files import read_plan, write_plan
from space import soft_random

pytestmark = pytest.mark.laws

REMOVAL = rg.plan_removal(STATE, "P3")
BALL = rg.Grasp(
    rg.Contact([np.cos(a), np.sin(a), z], [-np.cos(a), -np.sin(a), -z], 0.7)
    for a, z in ((0.0, 0.2), (2.1, -0.1), (4.2, 0.1), (1.0, 0.4))
)
DOWN = rg.Wrench([0, 0, -1.0])
PRESSING = {"objective": "force", "max_force": 3.0}  # every finger works: none carries a solver's dust


def shaken(t: float) -> rg.Wrench:
    return rg.Wrench([-1.5, -3.5 + np.sin(2 * np.pi * t)])


def soft_rotation() -> rg.Transition:
    rng = np.random.default_rng(3)
    while True:
        try:
            return rg.plan_rotation(
                soft_random(rng, 5), 1.2, axis=[0.2, 1, 0.1], load=rg.Wrench([0, 0.3, -1.0])
            )
        except rg.Infeasible:
            continue


PLANS = {
    "straight": REMOVAL,
    "sampled": rg.plan_removal(GRASP, "P3", load=shaken, rate_limit=15.0, instants=21),
    "turn": rg.plan_rotation(GRASP, -2.0, load=LOAD),
    "turn with a torque": rg.plan_rotation(GRASP, 1.3, load=rg.Wrench([-1.5, -3.5], 0.8)),
    "turn in space": rg.plan_rotation(BALL, 1.5, axis=[0, 1, 1], load=DOWN, **PRESSING),
    "soft turn": soft_rotation(),
}


def use(plan: rg.Transition, t: np.ndarray) -> np.ndarray:
    """The least friction of each force at many times, contact by contact, from the limit surface."""
    needed = np.zeros((t.size, len(plan.grasp)))
    for k, forces in enumerate(plan.forces(t)):
        for i, contact in enumerate(plan.grasp):
            d = contact.dimension
            normal = float(forces[i][:d] @ contact.normal)
            tangential = float(np.linalg.norm(forces[i][:d] - normal * contact.normal))
            twist = float(forces[i][3]) / contact.torsion if contact.torsion else 0.0
            if np.linalg.norm(forces[i][:d]) > 1e-9:
                needed[k, i] = tangential / np.sqrt(normal**2 - twist**2)
    return needed


@pytest.mark.parametrize("name", PLANS)
def test_friction_needed_is_the_most_on_the_way(name: str) -> None:
    plan = PLANS[name]
    dense = use(plan, np.linspace(0, plan.duration, 2001)).max()
    assert dense <= plan.friction_needed * (1 + 1e-9)
    assert plan.friction_needed == pytest.approx(dense, rel=1e-5)


@pytest.mark.parametrize("name", [name for name in PLANS if name != "soft turn"])
def test_friction_needed_is_where_verify_stops(name: str) -> None:
    def with_friction(mu: float) -> rg.Transition:
        plan = PLANS[name]
        grasp = rg.Grasp(c.changed(friction=mu) for c in plan.grasp)
        ends = (rg.GraspState(grasp, s.load, s.forces) for s in (plan.start, plan.end))
        return replace(plan, **dict(zip(("start", "end"), ends, strict=True)))

    needed = PLANS[name].friction_needed
    assert rg.verify(with_friction(needed * (1 + 1e-9))).ok
    if name != "turn with a torque":  # there verify asks it of the middle states, which is sufficient only
        assert not rg.verify(with_friction(needed * (1 - 1e-9))).ok


@pytest.mark.parametrize("seed", range(40))
def test_most_friction_inside_an_arc(seed: int) -> None:
    """Of any forces, pressing or not quite: the highest is found between the states, too."""
    rng = np.random.default_rng(seed)
    plan = PLANS[["turn with a torque", "turn in space", "soft turn"][seed % 3]]
    turn = plan.turn
    assert turn is not None
    assert turn.middles is not None
    forces = turn.forces * rng.uniform(0.8, 1.2, turn.forces.shape)
    forces[:, :, :2] += 0.02 * rng.uniform(size=(len(forces), len(plan.grasp), 2))  # none nearly vanishes
    middles = turn.middles * rng.uniform(0.8, 1.2, turn.middles.shape)
    changed = replace(plan, path=rg.TurningPath(turn.angles, forces, turn.axis, middles))
    with np.errstate(invalid="ignore"):
        dense = np.nanmax(use(changed, np.linspace(0, plan.duration, 2001)))
    assert dense <= changed.friction_needed * (1 + 1e-9)
    if np.isfinite(changed.friction_needed) and dense < 10:
        assert changed.friction_needed == pytest.approx(dense, rel=1e-4)


def test_a_force_without_normal_needs_infinite_friction() -> None:
    pulled = rg.GraspState(GRASP, LOAD, -STATE.forces)
    assert replace(REMOVAL, start=pulled).friction_needed == np.inf
    idle = rg.GraspState(GRASP, rg.Wrench([0, 0]), np.zeros((3, 2)))
    assert rg.Transition(idle, idle, REMOVAL.scaling, REMOVAL.record).friction_needed == 0


def test_kind_and_words_come_from_the_fingers() -> None:
    ends = REMOVAL.start, REMOVAL.start, REMOVAL.scaling, REMOVAL.record
    kinds = [
        ((), (), "hold", "hold", None, None),
        (("P1", "P2"), (), "removal", "removal of P1, P2", "P1", None),
        ((), ("P2",), "addition", "addition of P2", "P2", None),
        (("P1",), ("P2", "P3"), "exchange", "exchange of P1 for P2, P3", "P1", "P2"),
    ]
    for leaving, arriving, kind, words, contact, arrival in kinds:
        plan = rg.Transition(*ends, leaving, arriving)
        assert (plan.kind, plan.in_words, plan.contact, plan.arrival) == (kind, words, contact, arrival)
        back = plan.reversed()
        assert (back.leaving, back.arriving, back.reversed()) == (arriving, leaving, plan)
    assert PLANS["turn"].kind == PLANS["turn"].in_words == "rotation"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"leaving": "P3"}, "leaving must be a tuple of different contact names, got 'P3'"),
        ({"leaving": ("P3", "P3")}, "leaving must be a tuple of different contact names"),
        ({"arriving": ("P3",)}, "a finger leaves or arrives, not both: P3"),
        ({"arriving": ("P9",)}, "no contact 'P9' in this grasp; it has P1, P2, P3"),
        ({"path": None}, "path must be a StraightPath, a SampledPath or a TurningPath, got None"),
    ],
)
def test_wrong_fingers_and_paths(changes: dict, words: str) -> None:
    with pytest.raises(rg.InvalidInput, match=words):
        replace(REMOVAL, **changes)


@pytest.mark.parametrize("name", PLANS)
def test_every_path_answers_alike(name: str, tmp_path: Path) -> None:
    plan = PLANS[name]
    t = np.linspace(0, plan.duration, 13)
    forces = plan.forces(t)
    back = plan.reversed()
    assert back.forces(plan.duration - t) == pytest.approx(forces, abs=1e-12 * abs(forces).max())
    assert plan.wrenches(t) == pytest.approx(plan.grasp.wrenches(forces), abs=1e-12)
    total = forces.reshape(13, -1) @ plan.grasp.matrix.T + plan.load(t)
    assert total == pytest.approx(0, abs=1e-11 * abs(forces).max())
    size = np.linalg.norm(plan.grasp.cones.measured(forces), axis=-1)
    assert (size <= plan.peaks * (1 + 1e-12)).all()
    moved = np.linalg.norm(plan.rates(t)[..., : plan.grasp.dimension], axis=-1)
    assert (moved <= plan.steepest * (1 + 1e-9)).all()
    if plan.grasp.dimension == 3:
        assert plan.rotations(0.0) == pytest.approx(np.eye(3), abs=1e-15)
    else:
        with pytest.raises(rg.InvalidInput, match="ask for orientation"):
            plan.rotations(0.0)
    write_plan(plan, tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json") == plan


@pytest.mark.parametrize("path", sorted((TESTS / "data" / "plans").glob("*.json")), ids=lambda p: p.stem)
def test_plans_of_the_first_version_still_verify(path: Path) -> None:
    plan = read_plan(path)
    assert rg.verify(plan).ok
    assert rg.verify(plan.reversed()).ok
