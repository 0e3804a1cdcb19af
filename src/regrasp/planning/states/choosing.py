"""Choosing the forces of a grasp under a load."""

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import RESERVE
from regrasp.mechanics.state import check_load
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import PEAK_RATIO, ChosenForces, ChosenState, Criteria, criteria_of
from regrasp.planning.states.two_fingers import best_forces

MOST_FACETS = 10_000
"""Sides of a polygon that stands for a circle: one of so many is a circle to eight digits."""
DEFAULT_BACKEND = "clarabel"


def choose_state(
    grasp: Grasp,
    load: Wrench,
    objective: str = "angle",
    *,
    method: str = "auto",
    facets: int | None = None,
    max_force: float | None = None,
    peak_ratio: float = PEAK_RATIO,
    reserve: float = RESERVE,
) -> ChosenState:
    """The best forces of a grasp under a load.

    objective: ``angle`` or ``force``, the widest least margin; ``effort``, the least sum of squares;
    ``peak``, the least largest force; ``peak_normal``, the least largest normal force; ``friction_use``, the
    least largest fraction of the friction available.
    method: ``closed-form`` (two planar contacts), a back end's name, or ``auto``: the closed form where it
    exists, else Clarabel.
    facets: let an inner polygon of so many sides stand for every circle, for back ends that take no
    second-order cones: in the plane that of a force limit and of ``peak``; in space those across the friction
    cones, too (inner pyramids, see ``pyramid_losses``). Safe; limits lose up to the fraction
    1 - cos(pi / facets).
    max_force, peak_ratio, reserve: limits of the choice, see ``Criteria``; what they came to is in the
    result's ``force_limits``.

    Returns a ``GraspState`` with the record of its choice. Raises ``Infeasible`` with the escape twist when
    no forces exist, ``InvalidInput`` for arguments that are not what they must be.
    """
    if not isinstance(grasp, Grasp):
        raise InvalidInput(f"grasp must be a Grasp, got {grasp!r}")
    check_load(grasp, load)
    criteria = criteria_of(objective, max_force, peak_ratio, reserve)
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
        raise InvalidInput(f"method must be text, such as 'auto', got {method!r}")
    planar_pair = len(grasp) == 2 and grasp.dimension == 2
    if method == "closed-form" and not planar_pair:
        raise InvalidInput(
            f"the closed form chooses for two planar contacts, got {len(grasp)} of dimension "
            f"{grasp.dimension}; use method='auto'"
        )
    if len(grasp) < 2:
        raise InvalidInput(f"a grasp needs two contacts or more to hold a load, got {len(grasp)}")
    if method == "closed-form" and facets is not None:
        raise InvalidInput("the closed form takes force limits as they are; leave facets out")
    if method == "closed-form" or (method == "auto" and planar_pair and facets is None):
        return best_forces(grasp, load, criteria)
    from regrasp.programs.backends import available_backends, is_available

    if method != "auto" and not is_available(method):
        known = ", ".join(("auto", "closed-form", *available_backends()))
        raise InvalidInput(f"method must be one of {known}; got {method!r}")
    from regrasp.planning.states.many_contacts import solved_forces

    return solved_forces(grasp, load, criteria, DEFAULT_BACKEND if method == "auto" else method, facets)
