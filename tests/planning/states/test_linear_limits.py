"""Linear limits of contacts: kept by states and plans, decided by ``verify``, and never silently ignored."""

import inspect
from collections.abc import Callable
from math import inf, pi
from typing import Any

import cvxpy as cp
import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD
from space import random_grasp, random_load
from values import SQUARE_OUTLINE, WEIGHT_IN_PLANE

pytestmark = pytest.mark.laws

MOST = 3.1
LIMITED = GRASP.replaced("P1", GRASP["P1"].changed(limits=([[1.0, 0.0]], [MOST])))
"""P1 pushes with 3.1 N along its normal at the most; without that the widest angle takes 3.22 N."""
TURNING = GRASP.replaced("P1", GRASP["P1"].changed(limits=([[1.0, 0.0]], [6.0])))


def pushed(state: rg.GraspState, name: str = "P1") -> float:
    return float(state.force(name)[: state.grasp.dimension] @ state.grasp[name].normal)


def random_limits(grasp: rg.Grasp, rng: np.random.Generator) -> rg.Grasp:
    """Rows about the size of the load for all contacts but the last."""
    d = grasp.dimension
    return rg.Grasp(
        c if i == len(grasp) - 1 else c.changed(limits=(rng.normal(size=(3, d)), rng.uniform(0.8, 4, 3)))
        for i, c in enumerate(grasp)
    )


def by_cvxpy(grasp: rg.Grasp, load: rg.Wrench, objective: str, most: float) -> float:
    """The least effort, or the widest force margin under ``most``; rows in the contact's frame."""
    n, d = grasp.positions.shape
    f, t = cp.Variable((n, d)), cp.Variable()
    held = [grasp.matrix @ cp.vec(f, order="C") + load.vector == 0]
    for i, c in enumerate(grasp):
        frame = np.vstack([c.normal, np.reshape(grasp.tangents[i], (-1, d))])
        local = frame @ f[i]
        depth = c.friction * local[0] - cp.norm(local[1:])
        held += [depth >= (t if objective == "force" else 0) * np.hypot(1, c.friction), cp.norm(f[i]) <= most]
        if c.limits is not None:
            held.append(c.limits.rows @ local <= c.limits.bounds)
    goal = cp.Maximize(t) if objective == "force" else cp.Minimize(cp.sum_squares(f))
    problem = cp.Problem(goal, held)
    problem.solve(solver="CLARABEL")
    if problem.status != "optimal" or (objective == "force" and problem.value < 0):
        return inf
    return float(problem.value)


@pytest.mark.parametrize("dimension", [2, 3])
def test_states_are_as_good_as_cvxpy_says(dimension: int) -> None:
    rng = np.random.default_rng(dimension)
    held = 0
    for k in range(24):
        objective = ("effort", "force")[k % 2]
        if dimension == 3:
            bare, load = random_grasp(rng, 4), random_load(rng)
        else:
            angles = np.sort(rng.uniform(0, 2 * pi, 3))
            arms = np.column_stack([np.cos(angles), np.sin(angles)])
            bare = rg.Grasp(rg.Contact(r, -r + 0.2 * rng.normal(size=2), 0.6) for r in arms)
            load = rg.Wrench(rng.normal(size=2), 0.1 * rng.normal())
        grasp = random_limits(bare, rng)
        wanted = by_cvxpy(grasp, load, objective, 4.0)
        try:
            state = rg.choose_state(grasp, load, objective, max_force=4.0, reserve=0.0)
        except rg.Infeasible:
            assert wanted == inf or (objective == "force" and wanted < 1e-6)
            continue
        held += 1
        assert state.value == pytest.approx(wanted, rel=1e-5, abs=1e-6)
        assert rg.verify(rg.plan_hold(state, end=state)).ok
    assert 4 <= held < 24


def test_torques_of_joints_are_rows() -> None:
    rng = np.random.default_rng(5)
    for d in (2, 3):
        normal, jacobian = rng.normal(size=d), rng.normal(size=(d, 3))
        torques = np.array([[-0.5, 1.0], [-2.0, 0.2], [-inf, 1.0]])
        contact = rg.Contact(
            np.zeros(d), normal, 0.5, limits=rg.torque_limits(jacobian, torques, normal=normal)
        )
        assert contact.limits is not None
        assert len(contact.limits.bounds) == 5  # an infinite one limits nothing
        for f in rng.normal(size=(50, d)):
            tau = jacobian.T @ f
            within = bool(((tau >= torques[:, 0]) & (tau <= torques[:, 1])).all())
            assert within == bool((contact.limit_rows @ f <= contact.limits.bounds).all())
    one = rg.torque_limits([[1.0, 0.0], [0.0, 2.0]], 3.0)  # in the contact's own frame
    assert one == rg.ForceLimits([[1, 0], [0, 2], [-1, 0], [0, -2]], [3, 3, 3, 3])


def test_verify_decides_at_the_limit() -> None:
    plan = rg.plan_removal(GRASP, "P3", load=LOAD)
    for end in (plan.start, plan.end):
        row = end.grasp["P1"].changed(limits=([[1.0, 0.0]], [1.0])).limit_rows
        assert row is not None
        exact = max(pushed_exactly(row[0], s.force("P1")) for s in (plan.start, plan.end))
    for most, ok in ((exact, True), (np.nextafter(exact, 0), False)):
        contact = GRASP["P1"].changed(limits=([[1.0, 0.0]], [most]))
        grasp = GRASP.replaced("P1", contact)
        start, end = (rg.GraspState(grasp, LOAD, s.forces) for s in (plan.start, plan.end))
        found = rg.verify(rg.Transition(start, end, plan.scaling, plan.record, ("P3",)))
        assert found.ok == ok
        assert ok or "force of P1 breaks its linear limit 0" in found.violations[0]


def pushed_exactly(row: Any, force: Any) -> float:
    """The least double that is not below the product of two vectors."""
    from fractions import Fraction

    product = sum(Fraction(a) * Fraction(b) for a, b in zip(row.tolist(), force.tolist(), strict=True))
    value = float(product)
    return value if Fraction(value) >= product else float(np.nextafter(value, inf))


def test_turns_keep_them_between_angles() -> None:
    plan = rg.plan_rotation(TURNING, 2.0, load=LOAD, max_force=20.0)
    assert plan.turn is not None
    assert rg.verify(plan).ok
    forces = plan.forces(np.linspace(0, 1, 2001))[:, 0] @ TURNING.normals[0]
    least = float(plan.turn.spare(plan.start, plan.end)[0])
    assert 6.0 - forces.max() == pytest.approx(least, abs=1e-5)
    assert least >= 0
    # the crest between two angles is what decides: a limit between it and both ends is broken
    (a, b), ends = plan.turn.angles[:2], plan.turn.forces[:2, 0] @ TURNING.normals[0]
    crest = 6.0 - float(rg.TurningPath([0, b - a], plan.turn.forces[:2]).spare(plan.start, plan.end)[0])
    if crest > ends.max() * (1 + 1e-9):
        contact = TURNING["P1"].changed(limits=([[1.0, 0.0]], [(crest + ends.max()) / 2]))
        grasp = TURNING.replaced("P1", contact)
        states = [rg.GraspState(grasp, s.load, s.forces) for s in (plan.start, plan.end)]
        broken = rg.verify(rg.Transition(*states, plan.scaling, plan.record, path=plan.turn)).violations
        assert any("between two angles" in line for line in broken)


def test_what_is_withstood_counts_them() -> None:
    ball = rg.LoadSet.ball(rg.Wrench([0, 0]), force=0.02, torque=0.05)
    state = rg.choose_state(LIMITED, LOAD, "force", disturbance=ball)
    assert pushed(state) < MOST - 1e-3
    hold = rg.plan_hold(state, end=state)
    assert rg.verify(hold, disturbance=ball).ok
    assert "breaks a linear limit" in str(rg.verify(hold, disturbance=ball.scaled(1.01)).violations)
    best = rg.choose_state(LIMITED, LOAD, "wrench", disturbance=ball, max_force=20.0)
    assert rg.verify(rg.plan_hold(best, end=best), disturbance=ball.scaled(0.999 * best.value)).ok
    assert not rg.verify(rg.plan_hold(best, end=best), disturbance=ball.scaled(1.001 * best.value)).ok
    bare = rg.choose_state(GRASP, LOAD, "wrench", max_force=20.0)
    near = GRASP["P1"].changed(limits=([[1.0, 0.0]], [pushed(bare) + 0.01]))
    seen = rg.GraspState(GRASP.replaced("P1", near), LOAD, bare.forces)
    factor = rg.Criteria("wrench", disturbance=ball).objective.value(seen)
    assert rg.verify(rg.plan_hold(seen, end=seen), disturbance=ball.scaled(0.999 * factor)).ok
    assert not rg.verify(rg.plan_hold(seen, end=seen), disturbance=ball.scaled(1.001 * factor)).ok
    first = rg.tolerances(state).first["load"]
    assert (first.finger, first.how) == ("P1", "exceeds its limit")


def _loads(t: float) -> rg.Wrench:
    return rg.Wrench([-1.5 - 0.3 * np.sin(3 * t), -3.5])


def _kept(result: Any) -> None:
    """States and plans keep the limits, as they are decided exactly and for real where they bind."""
    if isinstance(result, rg.Transition):
        assert rg.verify(result).ok
        times = np.linspace(0, result.duration, 301)
        index = result.grasp.index("P1")
        most = result.grasp["P1"].limits.bounds[0]
        assert (result.forces(times)[:, index] @ result.grasp.normals[index]).max() <= most * (1 + 1e-12)
    else:
        states = [result] if isinstance(result, rg.GraspState) else [result.state]
        for state in states:
            assert pushed(state) <= MOST * (1 + 1e-12)


_NEW = rg.Contact([-3, 6], [1, -1], 0.3, name="P4")
_ENDS = rg.Grasp(SQUARE_OUTLINE.contact_at(s, friction=0.5) for s in (5.0, 5.5, 12.0))
_SQUARE = _ENDS.replaced("P1", _ENDS["P1"].changed(limits=([[1.0, 0.0]], [MOST])))
KEEPS: dict[str, Callable[[], Any]] = {
    "choose_state": lambda: rg.choose_state(LIMITED, LOAD),
    "plan_removal": lambda: rg.plan_removal(LIMITED, "P3", load=LOAD),
    "plan_addition": lambda: rg.plan_addition(LIMITED.without("P3"), LIMITED["P3"], load=LOAD),
    "plan_exchange": lambda: rg.plan_exchange(LIMITED, "P3", _NEW, load=LOAD),
    "plan_hold": lambda: rg.plan_hold(LIMITED, _loads, duration=1.0),
    "plan_rotation": lambda: rg.plan_rotation(TURNING, 1.0, load=LOAD, max_force=20.0),
    "held_centres": lambda: rg.held_centres(LIMITED, LOAD).states[0],
    "largest_load": lambda: rg.largest_load(LIMITED, LOAD),
    "sensitivity": lambda: rg.sensitivity(LIMITED, LOAD, "force"),
    "least_friction": lambda: rg.least_friction(LIMITED, LOAD),
}
REFUSES: dict[str, Callable[[], Any]] = {
    "EquilibriumLocus": lambda: rg.EquilibriumLocus(LIMITED.without("P3"), LOAD).best(),
    "SqueezeLocus": lambda: rg.SqueezeLocus(LIMITED, LOAD),
    "HoldGraph": lambda: rg.HoldGraph(tuple(_SQUARE), WEIGHT_IN_PLANE, [0.0]),
    "regrasps_on_outline": lambda: rg.regrasps_on_outline(
        SQUARE_OUTLINE, _SQUARE, _ENDS, WEIGHT_IN_PLANE, friction=0.5
    ),
    "contact_regions": lambda: rg.contact_regions(SQUARE_OUTLINE, _SQUARE, WEIGHT_IN_PLANE),
}  # fmt: skip
ELSEWHERE = {
    # whose words say that sizes of forces do not count there
    "closure", "held_directions", "quality", "wrench_ball",
    # that choose by ``choose_state``, or judge forces as the tests above do
    "held_sphere", "pyramid_losses", "margin_curve", "tolerances", "least_stiffness", "verify",
    # that keep them by their steps, tested where regrasps are
    "plan_regrasp", "plan_regrasps", "RegraspProblem",
    # values that hold grasps and do nothing with them; a graph that refuses them at its making
    "bottleneck", "ChosenGrasp", "ChosenState", "Closure", "Contact", "ContactRegions", "Criteria",
    "EscapeTwist", "FaceRegions", "Grasp", "GraspState", "HeldCentres", "HeldSphere", "LargestLoad",
    "LeastFriction", "MarginCurve", "OutlineRegrasps", "Quality", "RegraspCut", "SampledPath", "Sensitivity",
    "StraightPath", "Transition", "TurningPath", "WrenchBall", "RegraspPlan",
    "OutlineCut", "plan_motions", "Bottleneck", "RegraspObstacle", "Tolerances",
}  # fmt: skip
_TAKES = {"grasp", "start", "goal", "contacts", "state", "state_or_plan", "graph", "plan"}


def test_every_verb_keeps_them_or_refuses_them() -> None:
    """A public name that takes grasps, states or contacts is in one of the tables."""
    known = {*KEEPS, *REFUSES, *ELSEWHERE}
    for name in rg.__all__:
        value = getattr(rg, name)
        if not callable(value) or (isinstance(value, type) and issubclass(value, BaseException)):
            continue
        if _TAKES & set(inspect.signature(value).parameters):
            assert name in known, name


@pytest.mark.parametrize("name", KEEPS)
def test_verbs_that_keep_them(name: str) -> None:
    _kept(KEEPS[name]())


@pytest.mark.parametrize("name", REFUSES)
def test_verbs_that_refuse_them(name: str) -> None:
    with pytest.raises(rg.InvalidInput, match="P1 has some; leave limits out of these contacts"):
        REFUSES[name]()


@pytest.mark.parametrize("objective", ["angle", "friction_use"])
def test_levels_within_them_are_proven(objective: str) -> None:
    state, free = rg.choose_state(LIMITED, LOAD, objective), rg.choose_state(GRASP, LOAD, objective)
    assert state.gap is not None
    assert state.gap < 1e-3
    assert abs(state.value - free.value) > 0.01


def test_squeezes_without_a_load_are_scaled_into_them() -> None:
    none = rg.Wrench([0, 0])
    for objective in ("angle", "friction_use"):
        free = rg.choose_state(GRASP, none, objective, max_force=50.0)
        kept = rg.choose_state(LIMITED, none, objective, max_force=50.0)
        assert kept.value == pytest.approx(free.value, abs=1e-6)
        assert pushed(kept) == pytest.approx(MOST, rel=1e-9)
    assert not rg.choose_state(LIMITED, none, "effort").forces.any()


def test_bad_limits_are_refused() -> None:
    for limits, words in (
        (([[1, 0]], [0]), "bounds of limits must be greater than 0"),
        (([[0, 0]], [1]), "rows of limits must not be zero"),
        (([[1, 0, 0]], [1]), "rows of limits must have 2 numbers"),
        (3, "limits must be ForceLimits or a pair"),
    ):
        with pytest.raises(rg.InvalidInput, match=words):
            rg.Contact([0, 0], [1, 0], 0.5, limits=limits)  # type: ignore[arg-type]
    with pytest.raises(rg.InvalidInput, match="the closed form does not keep"):
        rg.choose_state(LIMITED.without("P3"), LOAD, method="closed-form")


def test_refusals_are_proven_and_extremes_bounded_from_both_sides() -> None:
    rng = np.random.default_rng(8)
    weak = GRASP.replaced("P1", GRASP["P1"].changed(limits=([[1, 0]], [2.5])))
    with pytest.raises(rg.Infeasible, match="the linear limits of P1 balance") as refusal:
        rg.choose_state(weak, LOAD)
    proof = refusal.value.certificate
    assert proof is not None
    assert proof.is_proof
    assert "within its limits" in proof.explanation
    bare = rg.EscapeTwist(weak, LOAD, proof.twist, proof.frictions, proof.limits)
    assert not bare.is_proof  # the cones alone hold the load
    tight = 0
    for k in range(12):
        d = 2 + k % 2
        grasp, load = (random_grasp(rng, 4), random_load(rng)) if d == 3 else (LIMITED, LOAD)
        grasp = random_limits(grasp, rng) if d == 3 else grasp
        try:
            most = rg.largest_load(grasp, load)
        except rg.Infeasible:
            continue
        if most.factor in (0.0, inf):
            continue
        lower, upper = most.bounds
        assert upper >= lower
        if lower < 100:  # forces thousands of times the limits leave no digits
            assert upper <= lower * (1 + 1e-6)
            assert most.escape is not None
            assert most.escape.is_proof
            tight += 1
    assert tight >= 6
    tight_mu = GRASP.replaced("P1", GRASP["P1"].changed(limits=([[1, 0]], [2.6])))
    least, free = rg.least_friction(tight_mu, LOAD), rg.least_friction(GRASP, LOAD)
    assert float(least) > 1.01 * float(free)
    assert least.bounds[0] == pytest.approx(least.bounds[1], rel=1e-5)
    region = rg.held_centres(LIMITED, LOAD)
    assert np.abs(region.inner - region.outer).max() < 1e-6 * np.abs(region.outer).max()
    for state in region.states:
        assert pushed(state) <= MOST * (1 + 1e-12)
