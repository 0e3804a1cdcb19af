"""The verifier finds every kind of violation and agrees with an exact check written apart from it."""

from collections import Counter
from dataclasses import dataclass, field, replace
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from oracle import is_held
from regrasp import verification
from regrasp.plans.record import Record
from strategies import held_triples

pytestmark = pytest.mark.oracle

POSITIONS = {"P1": [-4, -4], "P2": [4, -5], "P3": [0, 8]}
NORMALS = {"P1": [1, 1], "P2": [-1, 2], "P3": [0, -1]}


def paper_grasp(friction: float = 0.3, max_force: float | None = None) -> rg.Grasp:
    return rg.Grasp(
        rg.Contact(POSITIONS[n], NORMALS[n], friction, max_force=max_force, name=n) for n in POSITIONS
    )


@pytest.fixture(scope="module")
def plan() -> rg.Transition:
    return rg.plan_removal(paper_grasp(), "P3", load=rg.Wrench([-1.5, -3.5]))


def with_state(plan: rg.Transition, where: str, **changes: object) -> rg.Transition:
    """The plan with another grasp, load or forces at one end or, for a grasp or load, at both."""
    ends = {}
    for end in ("start", "end"):
        state = getattr(plan, end)
        mine = {k: v for k, v in changes.items() if k != "forces" or end == where}
        ends[end] = rg.GraspState(
            mine.get("grasp", state.grasp), mine.get("load", state.load), mine.get("forces", state.forces)
        )
    return replace(plan, **ends)


def violations(plan: object) -> str:
    result = rg.verify(plan)
    assert result.ok == (not result.violations)
    assert result.ok or str(result).startswith("not verified:\n")
    return "\n".join(result.violations)


def test_a_good_plan_has_no_violations(plan: rg.Transition) -> None:
    result = rg.verify(plan)
    assert result.ok
    assert result.violations == ()
    assert result.worst_residual <= 1e-14
    assert result.least_angle == pytest.approx(
        min(plan.start.margins.least_angle, plan.end.margins.least_angle)
    )
    assert str(result).startswith("verified in exact arithmetic")
    assert f"{result.least_angle:.6g} rad" in str(result)


@pytest.mark.parametrize("end", ["start", "end"])
def test_a_force_outside_its_cone_by_one_part_in_1e8(end: str) -> None:
    """Forces at the edge of the cone less a billionth, judged with friction less a hundred-millionth."""
    at_the_edge = rg.plan_removal(
        paper_grasp(), "P3", load=rg.Wrench([-1.5, -3.5]), objective="effort", whole_objective="effort"
    )
    state = getattr(at_the_edge, end)
    edge = state.grasp.names[int(np.nanargmax(state.margins.friction_use))]
    assert state.margins.largest_friction_use == pytest.approx(1, abs=4e-9)
    assert rg.verify(at_the_edge).ok
    slippery = with_state(at_the_edge, end, grasp=paper_grasp(0.3 * (1 - 1e-8)))
    assert f"{end}: force of {edge} is outside its friction cone: it uses 1.00000000" in violations(slippery)
    assert rg.verify(slippery).least_cone_slack < 0


@pytest.mark.parametrize("end", ["start", "end"])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_residual_of_one_part_in_1e11(plan: rg.Transition, end: str, axis: int) -> None:
    forces = getattr(plan, end).forces.copy()
    forces[0, axis] += 1e-11 * abs(forces).max()
    assert f"{end}: not in equilibrium, G f + w_ext is " in violations(with_state(plan, end, forces=forces))


def test_a_torque_out_of_balance(plan: rg.Transition) -> None:
    load = rg.Wrench([-1.5, -3.5], 1e-9)
    found = violations(with_state(plan, "start", load=load))
    assert "start: not in equilibrium" in found
    assert "end: not in equilibrium" in found


def test_a_force_above_its_limit(plan: rg.Transition) -> None:
    largest = float(plan.start.magnitudes.max())
    assert rg.verify(with_state(plan, "start", grasp=paper_grasp(max_force=largest * (1 + 1e-15)))).ok
    found = violations(with_state(plan, "start", grasp=paper_grasp(max_force=largest * (1 - 1e-15))))
    name = plan.grasp.names[int(plan.start.magnitudes.argmax())]
    assert found.startswith(f"start: force of {name} is ")
    assert "above its limit" in found


def test_an_idle_finger_that_is_not_idle(plan: rg.Transition) -> None:
    forces = plan.end.forces.copy()
    forces[2, 1] = -1e-300
    assert "end: P3 must carry no force, it carries [0.0, -1e-300]" in violations(
        with_state(plan, "end", forces=forces)
    )
    assert "start: P3 must carry no force" in violations(replace(plan, leaving=(), arriving=("P3",)))
    assert "end: P2 must carry no force" in violations(replace(plan, leaving=("P3", "P2")))
    assert "start: P1 must carry no force" in violations(replace(plan, arriving=("P1",)))
    with pytest.raises(rg.InvalidInput, match="a finger leaves or arrives, not both: P3"):
        replace(plan, arriving=("P3",))
    claimed = Claimed(plan.start, plan.end, plan.scaling, ("P3",), ("P3",))
    assert "contact 'P3' leaves and arrives" in violations(claimed)


def test_a_pulling_force(plan: rg.Transition) -> None:
    """Turned about together with the load: balanced as before, but every finger pulls."""
    pulling = replace(
        plan,
        start=rg.GraspState(plan.grasp, -plan.start.load, -plan.start.forces),
        end=rg.GraspState(plan.grasp, -plan.start.load, -plan.end.forces),
    )
    found = violations(pulling)
    assert found.count("pulls: normal component -") == 5
    assert "equilibrium" not in found


@dataclass(frozen=True)
class Scaling:
    """A time function as a file may claim it; ``TimeScaling`` itself refuses most of these."""

    duration: float
    control: tuple[float, ...]


@dataclass(frozen=True)
class Claimed:
    """A plan as a file may claim it."""

    start: rg.GraspState
    end: rg.GraspState
    scaling: Scaling
    leaving: tuple[str, ...] = ()
    arriving: tuple[str, ...] = ()
    record: Record = field(default_factory=lambda: Record(0.0))
    course: None = None
    turn: None = None


@pytest.mark.parametrize(
    ("duration", "control", "words"),
    [
        (1.0, (1.0, 1.0 + 2**-52, 0.0), "time scaling may leave [0, 1]"),
        (1.0, (1.0, -1e-300, 0.0), "time scaling may leave [0, 1]"),
        (1.0, (0.9, 0.5, 0.0), "time scaling runs from 0.9 to 0, not from 1 to 0"),
        (1.0, (1.0, 0.5, 0.1), "time scaling runs from 1 to 0.1"),
        (0.0, (1.0, 0.0), "duration is 0 s, not greater than 0"),
        (-1.0, (1.0, 0.0), "duration is -1 s"),
    ],
)
def test_a_time_function_off_its_path(
    plan: rg.Transition, duration: float, control: tuple[float, ...], words: str
) -> None:
    claimed = Claimed(plan.start, plan.end, Scaling(duration, control), plan.leaving)
    assert words in violations(claimed)
    assert rg.verify(replace(claimed, scaling=Scaling(1.0, (1.0, 0.2, 0.7, 0.0)))).ok  # stays in [0, 1]


def test_ends_of_different_problems(plan: rg.Transition) -> None:
    claimed = Claimed(plan.start, plan.end, Scaling(1.0, (1.0, 0.0)), plan.leaving)
    elsewhere = rg.GraspState(paper_grasp(0.31), plan.end.load, plan.end.forces)
    assert violations(replace(claimed, end=elsewhere)) == "start and end have different contacts"
    loaded = rg.GraspState(plan.grasp, rg.Wrench([-1.5, -3.5 - 1e-14]), plan.end.forces)
    assert "different loads, so the straight path keeps no equilibrium" in violations(
        replace(claimed, end=loaded)
    )
    assert "contact 'P9' is not one of P1, P2, P3" in violations(replace(claimed, leaving=("P9",)))


def test_the_rule_for_no_friction_is_documented_and_kept() -> None:
    """Friction below 2^-40 counts as 2^-40: doubles cannot express a direction more finely."""
    assert verification.RESOLUTION == 2**-40
    assert "Friction below 2^-40 counts as 2^-40" in verification.exact.__doc__
    up = rg.Grasp([rg.Contact([0, 0], [0, 1], 0.0), rg.Contact([1, 0], [0, 1], 0.0)])
    for slope, fine in ((0.0, True), (2.0**-41, True), (2.0**-39, False)):
        load = rg.Wrench([-slope, -1.0])
        state = rg.GraspState(up, load, [[slope, 1.0], [0, 0]])
        claimed = Claimed(state, state, Scaling(1.0, (1.0, 0.0)), ("P2",))
        assert rg.verify(claimed).ok == fine, slope


# -- against the tests' own exact check ------------------------------------------------------------------


@st.composite
def tampered(draw: st.DrawFn) -> rg.GraspState:
    """A state in equilibrium with an idle finger, spoiled by nothing, a little or a lot."""
    grasp, load = draw(held_triples(st.sampled_from([0.0, 1e-8, 0.1, 0.5, 1.0])))
    rest = grasp.without("C")
    try:
        forces = rg.choose_state(rest, load, draw(st.sampled_from(["angle", "effort"]))).forces.copy()
    except rg.RegraspError:  # frictionless, at the limit
        forces = np.ones((2, 2))
    how = draw(st.sampled_from(["not", "scaled", "turned", "shifted", "limited"]))
    amount = draw(st.sampled_from([1e-15, 1e-13, 1e-12, 1e-11, 1e-9, 1e-8, 1e-3, 1.0])) * draw(
        st.sampled_from([-1, 1])
    )
    limit = None
    if how == "scaled":
        forces, load = forces * (1 + amount), load * (1 + amount * draw(st.booleans()))
    elif how == "turned":
        c, s = np.cos(amount * pi), np.sin(amount * pi)
        forces[0] = [c * forces[0, 0] - s * forces[0, 1], s * forces[0, 0] + c * forces[0, 1]]
    elif how == "shifted":
        forces[:, 0] += amount
    elif how == "limited":
        limit = max(float(np.linalg.norm(forces, axis=1).max()) * (1 + amount), 1e-3)
    contacts = [rg.Contact(c.position, c.normal, c.friction, max_force=limit, name=c.name) for c in grasp]
    return rg.GraspState(rg.Grasp(contacts), load, [*forces, [0, 0]])


def test_verdicts_are_those_of_an_exact_check() -> None:
    seen: Counter[tuple[bool, bool, bool]] = Counter()

    @given(tampered())
    @settings(max_examples=400)
    def check(state: rg.GraspState) -> None:
        limits = [c.max_force for c in state.grasp]
        grasp, load = state.grasp, state.load.vector
        exact = is_held(grasp.positions, grasp.normals, grasp.frictions, limits, load, state.forces.tolist())
        found = violations(Claimed(state, state, Scaling(1.0, (1.0, 0.0)), ("C",)))
        inside = "outside its friction cone" not in found and "pulls" not in found
        assert ("not in equilibrium" not in found, inside, "above its limit" not in found) == exact
        seen[exact] += 1

    check()
    assert seen[True, True, True] > 20
    for condition in range(3):
        assert sum(n for verdict, n in seen.items() if not verdict[condition]) > 3


@given(held_triples(st.sampled_from([0.1, 0.5, 1.0])))
@settings(max_examples=30)
def test_set_points_get_the_verdict_of_their_states(held: tuple[rg.Grasp, rg.Wrench]) -> None:
    grasp, load = held
    plan = rg.plan_removal(grasp, "C", load=load, objective="effort")
    forces = plan.forces(np.linspace(0, 1, 21))
    assert verification.verify_setpoints(plan, forces).ok
    spoiled = forces.copy()
    spoiled[7, 0] += 1e-6 * abs(forces).max()
    assert "set-point 7" in "\n".join(verification.verify_setpoints(plan, spoiled).violations)
