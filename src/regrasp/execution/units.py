"""The units in which a plan is simulated.

MuJoCo's settings of contacts are in metres and seconds. So that a plan in centimetres or of a microgripper
runs as one in metres does, it is simulated in units of its own: the size of the grasp is 0.08, the largest
force 5, the mass 0.4. Every law of mechanics keeps its form.
"""

from dataclasses import dataclass
from math import sqrt

from regrasp.errors import InvalidInput
from regrasp.execution.setup import Setup
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

SIZE, PEAK, MASS = 0.08, 5.0, 0.4
TIMESTEP = 1e-3
_STIFFNESS = 4.0  # of the largest force over the size
_DAMPING = 0.6  # of critical
_FINGER = 1 / 8  # of the mass
_TIP = 1 / 16  # of the size
_SETTLE, _HOLD, _MOVE = 0.4, 0.6, 0.6


@dataclass(frozen=True)
class Units:
    """The plan's units of length, force and time in one of the simulation's, and what a run needs in them."""

    length: float
    force: float
    time: float
    mass: float
    stiffness: float
    damping: float
    finger_mass: float
    tip_radius: float
    timestep: float
    settle: float
    hold: float
    move: float


def units_of(plan: Transition | RegraspPlan, setup: Setup) -> Units:
    """The units of a plan's run; everything in the result but ``length``, ``force``, ``time`` is in them."""
    steps = steps_of(plan)
    size, peak = max(step.grasp.size for step in steps), max(step.peak for step in steps)
    if peak == 0:
        raise InvalidInput("no finger of this plan carries a force: there is nothing to simulate")
    if setup.rolling and any(step.grasp.is_soft for step in steps):
        raise InvalidInput("soft fingers turn along with the object: leave rolling out")
    mass = setup.mass if setup.mass is not None else _weight(steps) / setup.gravity
    length, force = size / SIZE, peak / PEAK
    time = sqrt(mass * length / (MASS * force))
    stiffness = _STIFFNESS * PEAK / SIZE if setup.stiffness is None else setup.stiffness * length / force
    damping = setup.damping
    radius = setup.tip_radius if setup.motions is None else setup.motions.tip_radius
    step = TIMESTEP if setup.timestep is None else setup.timestep / time
    if step > TIMESTEP * (1 + 1e-9):
        raise InvalidInput(
            f"timestep must be at most {TIMESTEP * time:.4g} s here, got {setup.timestep:g}: contacts creep "
            "under longer ones"
        )
    return Units(
        length, force, time, MASS, stiffness,
        _DAMPING * 2 * sqrt(stiffness * MASS) if damping is None else damping * length / (force * time),
        _FINGER * MASS if setup.finger_mass is None else setup.finger_mass / mass * MASS,
        _TIP * SIZE if radius is None else radius / length,
        step,
        *(
            default if given is None else given / time
            for default, given in ((_SETTLE, setup.settle), (_HOLD, setup.hold), (_MOVE, setup.move_time))
        ),
    )  # fmt: skip


def steps_of(plan: Transition | RegraspPlan) -> tuple[Transition, ...]:
    """The transitions of a plan, in order."""
    if not isinstance(plan, (Transition, RegraspPlan)):
        raise InvalidInput(f"a Transition or a RegraspPlan can be simulated, got {type(plan).__name__}")
    return (plan,) if isinstance(plan, Transition) else plan.steps


def _weight(steps: tuple[Transition, ...]) -> float:
    """The load's force [N], from which the mass follows."""
    first = steps[0].start.load.force
    weight = float((first @ first) ** 0.5)
    if weight == 0:
        raise InvalidInput("the load has no force, so no mass follows from it: give mass=")
    return weight
