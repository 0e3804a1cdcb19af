"""Planning the forces of a grasp that stays under a load that changes."""

from typing import Unpack

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import instance
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.asked import Asked
from regrasp.planning.changes.ends import End
from regrasp.planning.changes.joining import LoadFunction
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import ChangeOptions, takes, with_objective
from regrasp.plans.loads import LoadSeries
from regrasp.plans.transition import Transition


@takes(ChangeOptions)
def plan_hold(
    start: GraspState | Grasp,
    load: Wrench | LoadSeries | LoadFunction | None = None,
    *,
    end: GraspState | None = None,
    objective: str | Objective | Criteria = "angle",
    start_objective: str | Objective | Criteria | None = None,
    **options: Unpack[ChangeOptions],
) -> Transition:
    """Forces over time of a grasp that stays, under a load that changes: a hand that accelerates or tilts.

    The path goes through instants, by a convex program, and is proven between them (docs/paths.md); under a
    constant load it is the straight one of Eq. 1-3 from one state to another, a squeeze that grows. Soft
    fingers are planned, too. Everything else is as for ``plan_removal``.

    Args:
        start: the state at the start; or the grasp, whose state is then chosen.
        load: object frame [N, N m]: constant, a ``LoadSeries``, or a function of time [s] that returns a
            ``Wrench``, such as ``carried_load`` makes.
        end: the state at the end, of the same contacts; chosen if not given.
        objective: what the state at the end is chosen for.
        start_objective: what the state at the start is chosen for; the same if not given.
        options

    Raises:
        Infeasible: With the escape twist where the fingers cannot hold the load at some instant, or with the
            limit that no path keeps.
        InvalidInput: For given states that are no equilibrium inside the cones.
    """
    asked = Asked.of(start, load, objective, options)
    grasp, criteria = asked.grasp, asked.criteria
    if end is not None:
        instance(end, "end", GraspState)
        if end.grasp != grasp or end.load != asked.last:
            raise InvalidInput(
                f"end must be a state of the start's contacts under the load at the end, {asked.last!r}; got "
                f"{end!r}"
            )
    chosen_for = criteria if start_objective is None else with_objective(criteria, start_objective)
    held = End("start", asked.first, asked.state, chosen_for, ())
    return asked.joined(grasp, held, End("end", asked.last, end, criteria, ()))
