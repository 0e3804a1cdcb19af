"""Planning the turn of an object in its fingers' hold."""

import warnings
from math import ceil, cos, pi, radians
from typing import Unpack

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.rotated import still_part, turned_load
from regrasp.mechanics.orientation.rotations import unit_axis
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.given_ends import (
    balanced_start,
    grasp_and_load,
    kept_limits,
    limited,
    refuse_set_without_none,
    refuse_what_gives,
    scaling_of,
)
from regrasp.planning.changes.joining import refuse_weak_ends
from regrasp.planning.changes.lost_loads import refuse_lost_load
from regrasp.planning.changes.turn_states import (
    STEP,
    Between,
    Chooser,
    halved,
    middle,
    on_the_way,
    reached,
    within_limits,
)
from regrasp.planning.states.choosing import check_facets
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import Objective, recorded
from regrasp.planning.states.options import BALANCE_TOLERANCE, PlanOptions, criteria_of, takes
from regrasp.plans.record import Choice, Record
from regrasp.plans.transition import Transition

MOST_TURN = 1000.0
"""[rad]: each piece of a turn is planned, so that time grows with it."""


@takes(PlanOptions)
def plan_rotation(
    start: GraspState | Grasp,
    angle: float | None = None,
    *,
    degrees: float | None = None,
    axis: ArrayLike | None = None,
    load: Wrench | None = None,
    end: GraspState | None = None,
    objective: str | Objective | Criteria = "angle",
    **options: Unpack[PlanOptions],
) -> Transition:
    """Forces over time while the object turns and all fingers stay.

    Everything else is as for ``plan_removal``.

    Two states less than pi apart hold everything between them (docs/facts.md, 6). States are chosen every
    ``STEP`` and left out where none exists, as long as the gap is below pi. Where a part of the load does not
    turn (a torque in the plane, a load along the axis in space), every one of them must exist, and one more
    between each two, under a turning part that is larger by 1 / cos(step / 2). Steps between which that one
    does not exist, or forces exceed a limit, are halved, down to ``FINEST``.

    Args:
        start: the state to start from; or a grasp, whose state is then chosen under ``load``.
        angle: of the object [rad], counter-clockwise, in space right-handed about ``axis``; up to 1000, with
            a warning beyond a whole turn.
        degrees: the same in degrees, in the place of ``angle``, without a warning.
        axis: (3,) through the centre of mass, of any length, the same in the object and in the world; in
            space only. The load is fixed in the world, such as a weight; in the object frame it turns the
            other way.
        load: before the turn, object frame; fixed in the world [N, N m].
        end: the state after the turn, under the load there; chosen if not given, as are the states on the
            way.
        objective: what states are chosen for.
        options

    Raises:
        Infeasible: Where no states bridge the turn or a force limit does not let them.
    """
    options = kept_limits(start, objective, options)
    criteria = criteria_of(objective, options)
    turn = _turn_asked(angle, degrees)
    tolerance = number(options.get("balance_tolerance", BALANCE_TOLERANCE), "balance_tolerance", least=0)
    clock = scaling_of(options.get("duration"), options.get("scaling"))
    given, load = grasp_and_load(start, load)
    if criteria.demands:
        refuse_set_without_none(criteria, given)
    about = _axis(axis, given)
    grasp = limited(given, criteria.max_force)
    count = max(ceil(abs(turn) / STEP - 1e-9), 1)
    check_facets(options.get("facets"))
    how = options.get("method", "auto"), options.get("facets")
    chooser = Chooser(grasp, load, criteria, how, cos(turn / count / 2) * (1 - 1e-9), about)
    choices: list[Choice] = []
    change = 0.0
    first: Array
    if isinstance(start, GraspState):
        state = GraspState(grasp, load, start.forces)
        balanced = balanced_start(state, criteria, tolerance, "start")
        refuse_what_gives(balanced, criteria, "start")
        first, change = balanced.forces, float(abs(balanced.forces - start.forces).max())
    else:
        best = chooser.at(0.0)
        first = np.array(best.forces)
        choices.append(Choice("start", recorded(criteria.objective), best.method, best.force_limits))
    last_load = turned_load(load, turn, about)
    if end is None:
        best = chooser.at(turn)
        last = np.array(best.forces)
        choices.append(Choice("end", recorded(criteria.objective), best.method, best.force_limits))
    else:
        _refuse_other_end(end, given, last_load)
        state = GraspState(grasp, last_load, end.forces)
        balanced = balanced_start(state, criteria, tolerance, "end")
        refuse_what_gives(balanced, criteria, "end")
        last, change = balanced.forces, max(change, float(abs(balanced.forces - end.forces).max()))
    if still_part(load, about) is None:
        states = on_the_way(chooser, turn, count, first, last)
        between: Between = within_limits
    else:
        angles = [turn * k / count for k in range(1, count)]
        states = [(0.0, first), *((a, reached(chooser, a)) for a in angles), (turn, last)]
        between = middle
    plan = Transition(
        GraspState(grasp, load, first),
        GraspState(grasp, last_load, last),
        clock,
        Record(
            criteria.reserve,
            tuple(choices),
            change,
            least_normals=tuple(criteria.least_normals(grasp)) if criteria.presses else (),
            withstands=criteria.withstood,
        ),
        path=halved(chooser, states, between),
    )
    _refuse_high_forces(plan)
    if criteria.presses:
        refuse_weak_ends(plan.start, plan.end, np.array(criteria.least_normals(grasp)))
    return refuse_lost_load(plan)


def _turn_asked(angle: float | None, degrees: float | None) -> float:
    """The turn [rad], from one of two units."""
    if (angle is None) == (degrees is None):
        raise InvalidInput("give the turn as angle [rad] or as degrees=..., one of them")
    if degrees is not None:
        turn = radians(number(degrees, "degrees"))
    else:
        turn = number(angle, "angle")
        if abs(turn) > 2 * pi:
            warnings.warn(
                f"angle is in radians, so {turn:g} is {turn / (2 * pi):.4g} whole turns; "
                f"write degrees={turn:g} if degrees were meant",
                stacklevel=4,
            )
    if turn == 0:
        raise InvalidInput("angle must not be 0: there is nothing to turn")
    if abs(turn) > MOST_TURN:
        raise InvalidInput(f"a turn must be at most {MOST_TURN:g} rad to either side, got {turn:.6g} rad")
    return turn


def _refuse_other_end(end: GraspState, grasp: Grasp, load: Wrench) -> None:
    same = isinstance(end, GraspState) and end.grasp == grasp
    if not same or abs(end.load.vector - load.vector).max() > 1e-9 * abs(load.vector).max():
        raise InvalidInput(
            "end must be a state of the same contacts under the load seen from the turned "
            f"object, {shown(load)}; "
            f"got {shown(end)}"
        )


def _axis(axis: ArrayLike | None, grasp: Grasp) -> Array | None:
    """The axis of a turn, checked: one in space, none in the plane."""
    if grasp.dimension == 2:
        if axis is not None:
            raise InvalidInput(
                f"an object in the plane turns in the plane; leave axis out, got {shown(axis)}"
            )
        return None
    if axis is None:
        raise InvalidInput("a turn in space needs the axis, such as axis=[1, 0, 0]")
    return unit_axis(axis)


def _refuse_high_forces(plan: Transition) -> None:
    assert plan.turn is not None
    spare = plan.turn.spare(plan.start, plan.end)
    if (spare < 0).any():
        raise Infeasible(
            f"{plan.grasp.names[int(spare.argmin())]} would break its linear limits in the turn by "
            f"{-spare.min():.4g}; choose states with less force, or loosen them"
        )
    for i, contact in enumerate(plan.grasp):
        peak = float(plan.peaks[i])
        if contact.max_force is not None and peak > contact.max_force:
            raise Infeasible(
                f"{contact.name} would need {peak:.4g} in the turn, above its limit {contact.max_force:g}; "
                f"choose states with less force, or turn in smaller steps"
            )
