"""How good a grasp is, by every measure of the literature that needs nothing but the grasp."""

from collections.abc import Iterable, Sequence
from math import inf

from regrasp.errors import InvalidInput, shown
from regrasp.measures.closure import taken
from regrasp.measures.geometry_measures import geometry_measures
from regrasp.measures.limit_measures import FACETS, limit_measures
from regrasp.measures.matrix_measures import hand_measures, matrix_measures
from regrasp.measures.measure import Quality
from regrasp.measures.task_measures import task_measure
from regrasp.measures.wrench_ball import GAP, length_of, normal_limits
from regrasp.mechanics.checks import ArrayLike, array, items, number, whole
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.state import check_load
from regrasp.mechanics.wrench import Wrench

MOST_FACETS = 256
"""Edges of a pyramid: the wrenches of all are enumerated."""


def quality(
    grasp: Grasp | Iterable[Contact],
    *,
    limit: ArrayLike = 1.0,
    length: float | None = None,
    load: Wrench | None = None,
    loads: LoadSet | None = None,
    jacobians: Sequence[ArrayLike] | None = None,
    gap: float = GAP,
    facets: int = FACETS,
) -> Quality:
    """A table of the measures of Roa and Suarez (2015), each with unit, range and which way is better.

    A polygon's measures are of three contacts or more in one plane.

    Args:
        grasp: the contacts that hold.
        limit: each finger's largest normal force [N], a number or (n,); where the sum is limited, their mean.
            Linear limits of contacts count where ``load`` and ``loads`` do, and nowhere else.
        length: by which torques are divided [m], the grasp's size if not given.
        load: adds the least sum of normal forces that balances it.
        loads: adds the largest factor by which the set may be scaled, of round ones between bounds (the
            contacts' own ``max_force`` count there, ``limit`` does not).
        jacobians: of each finger, (d, q_i) its velocity per joint speed, in the object's frame: adds the
            measures of the hand.
        gap: of what is searched for in space.
        facets: edges of the pyramids of the wrench volume and min-weight in space; everything else has round
            cones; 3 to 256.

    Raises:
        InvalidInput: For bad input.
    """
    grasp = taken(grasp)
    limits = normal_limits(limit, len(grasp), total=False)
    if grasp.out_of_range:
        raise InvalidInput(grasp.out_of_range)
    length = length_of(grasp, length)
    if not (isinstance(gap, float) and gap == inf):
        number(gap, "gap", above=0)
    whole(facets, "facets", least=3, most=MOST_FACETS)
    if load is not None:
        check_load(grasp, load)
    measures = [
        *matrix_measures(grasp, length),
        *geometry_measures(grasp),
        *limit_measures(grasp, limits, length, gap, facets, load),
    ]
    if loads is not None:
        if not isinstance(loads, LoadSet) or loads.dimension != grasp.dimension:
            raise InvalidInput(f"loads must be a LoadSet of the grasp's dimension, got {shown(loads)}")
        measures.append(task_measure(grasp, loads, gap))
    if jacobians is not None:
        jacobians = items(jacobians, "jacobians")
        if len(jacobians) != len(grasp):
            raise InvalidInput(
                f"jacobians must be one for each of {len(grasp)} fingers, got {len(jacobians)}"
            )
        given = [array(j, "jacobian", (grasp.dimension, None)) for j in jacobians]
        measures += hand_measures(grasp, length, given)
    return Quality(grasp, length, tuple(measures))
