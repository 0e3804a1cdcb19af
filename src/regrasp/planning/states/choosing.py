"""Choosing the forces of a grasp under a load."""

from typing import Unpack

from regrasp.errors import Infeasible, InvalidInput, RegraspError, shown
from regrasp.mechanics.checks import whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.state import check_load
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import ChosenForces, ChosenState, Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import StateOptions, criteria_of, takes
from regrasp.planning.states.refusals.asking import is_asked_only
from regrasp.planning.states.two_fingers import closed_forces, is_one_point

MOST_FACETS = 10_000
"""Sides of a polygon that stands for a circle: one of so many is a circle to eight digits."""
DEFAULT_BACKEND = "clarabel"


@takes(StateOptions)
def choose_state(
    grasp: Grasp,
    load: Wrench,
    objective: str | Objective | Criteria = "angle",
    **options: Unpack[StateOptions],
) -> ChosenState:
    """The best forces of a grasp under a load.

    What limits came to is in the result's ``force_limits``; what facets cost, ``pyramid_losses`` tells.

    Args:
        grasp: two contacts or more, in the plane or in space.
        load: external wrench on the object about its centre of mass, object frame [N, N m].
        objective: ``angle`` or ``force``, the widest least margin; ``effort``, the least sum of squares;
            ``peak``, the least largest force; ``peak_normal`` and ``sum_normal``, the least largest normal
            force and the least sum of them; ``friction_use``, the least largest fraction of the friction
            available; an objective of one's own, such as a ``ForceCost``; or ``Criteria``, which hold the
            limits, too.
        options

    Returns:
        A ``GraspState`` with the record of its choice.

    Raises:
        Infeasible: With the escape twist when no forces exist.
        InvalidInput: For arguments that are not what they must be.
    """
    if not isinstance(grasp, Grasp):
        raise InvalidInput(f"grasp must be a Grasp, got {shown(grasp)}")
    check_load(grasp, load)
    criteria = criteria_of(objective, options)
    method, facets = options.get("method", "auto"), options.get("facets")
    return ChosenState(grasp, load, criteria, choose_forces(grasp, load, criteria, method, facets))


def check_facets(facets: int | None) -> None:
    """Raise ``InvalidInput`` unless ``facets`` is a number of sides, or None."""
    if facets is not None:
        whole(facets, "facets", least=3, most=MOST_FACETS)


def choose_forces(
    grasp: Grasp, load: Wrench, criteria: Criteria, method: str = "auto", facets: int | None = None
) -> ChosenForces:
    """``choose_state`` for checked criteria, before a state is made of the forces."""
    check_facets(facets)
    if not isinstance(method, str):
        raise InvalidInput(f"method must be text, such as 'auto', got {shown(method)}")
    if method == "closed-form":
        _refuse_closed_form(grasp, criteria, facets)
    refused: Infeasible | None = None
    if method == "closed-form" or (method == "auto" and facets is None):
        try:
            found = closed_forces(grasp, load, criteria)
        except Infeasible as reason:
            if method == "closed-form" or reason.certificate is not None or is_asked_only():
                raise
            found, refused = None, reason  # without proof: contacts next to one another, or at the edge
        if found is not None:
            return found
    from regrasp.planning.states.levels.wide_limits import of_wide_limits
    from regrasp.planning.states.many_contacts import solved_forces
    from regrasp.programs.facts import available_backends, is_available

    if method != "auto" and not is_available(method):
        known = ", ".join(("auto", "closed-form", *available_backends()))
        raise InvalidInput(f"method must be one of {known}; got {shown(method)}")
    backend = DEFAULT_BACKEND if method == "auto" else method
    try:
        return of_wide_limits(
            grasp, load, criteria, lambda some: solved_forces(grasp, load, some, backend, facets)
        )
    except RegraspError:
        if refused is not None:
            raise refused from None
        raise


def _refuse_closed_form(grasp: Grasp, criteria: Criteria, facets: int | None) -> None:
    """Raise ``InvalidInput`` where the closed form was asked for and does not answer."""
    if criteria.withstands:
        raise InvalidInput("the closed form knows no disturbance; use method='auto'")
    refuse_limits(grasp, "the closed form")
    if criteria.presses:
        raise InvalidInput("the closed form keeps no least normal forces; use method='auto'")
    if len(grasp) != 2 or grasp.dimension != 2:
        raise InvalidInput(
            f"the closed form chooses for two planar contacts, got {len(grasp)} of dimension "
            f"{grasp.dimension}; use method='auto'"
        )
    if criteria.objective.closed_form is None:
        raise InvalidInput(
            f"objective {shown(criteria.objective.name)} has no closed form; use method='auto'"
        )
    if is_one_point(grasp):
        raise InvalidInput("the closed form needs contacts at two points; use method='auto'")
    if facets is not None:
        raise InvalidInput("the closed form takes force limits as they are; leave facets out")
