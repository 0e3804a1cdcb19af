"""The least friction with which a plan holds in physics."""

from typing import Any

from regrasp.errors import InvalidInput
from regrasp.execution.setup import Setup
from regrasp.execution.simulation import changed, simulate
from regrasp.mechanics.checks import number
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

_LEAST, _MOST = 1e-4, 30.0


def critical_friction(
    plan: Transition | RegraspPlan, setup: Setup | None = None, *, tolerance: float = 0.01, **options: Any
) -> float:
    """The least coefficient of all contacts under which ``simulate`` holds [-], within a relative tolerance.

    The counterpart of ``plan.friction_needed``, by bisection from there; the number returned held. A dozen
    runs, fewer where both agree. setup, options: as for ``simulate``, but for the friction.
    Raises ``InvalidInput`` where the plan holds under no friction or under any.
    """
    setup = changed(setup, options)
    step = 1 + number(tolerance, "tolerance", above=0)

    def holds(friction: float) -> bool:
        return simulate(plan, setup, friction=friction).held

    guess = min(max(plan.friction_needed, 10 * _LEAST), _MOST / 10)
    below, above = guess / step**2, guess * step**2
    leap = step**4
    if holds(above):
        while holds(below):
            above, below, leap = below, below / leap, leap**2
            if below < _LEAST:
                raise InvalidInput(f"this plan holds in physics under any friction, even {above:.2g}")
    else:
        below = above
        while not holds(above := above * leap):
            below, leap = above, leap**2
            if above > _MOST:
                raise InvalidInput(f"this plan holds in physics under no friction, not even {above:.2g}")
    while above / below > step:
        middle = (above * below) ** 0.5
        if holds(middle):
            above = middle
        else:
            below = middle
    return above
