"""Choosing where the fingers go."""

from collections.abc import Sequence
from contextlib import suppress
from math import inf

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import number, whole
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline
from regrasp.planning.holds.pairs import Filter
from regrasp.planning.placement.asking import asked_distance, asked_sides, check_task, length_of, level_of
from regrasp.planning.placement.chosen import ChosenGrasp
from regrasp.planning.placement.circles import up_to_turns
from regrasp.planning.placement.constrained.constraints import (
    CONSTRAINED_BOXES,
    Constraints,
    check_constraints,
    run_constrained,
)
from regrasp.planning.placement.knife_edges import on_edges
from regrasp.planning.placement.laws import Law, law_of
from regrasp.planning.placement.levels.ball import BallLevel
from regrasp.planning.placement.levels.level import Level
from regrasp.planning.placement.levels.searching import best_level
from regrasp.planning.placement.levels.withstood import WithstoodLevel
from regrasp.planning.placement.loads import check_sizes, inner_and_outer, offset_by
from regrasp.planning.placement.results import Asked, chosen_at_level, chosen_by_norm
from regrasp.planning.placement.search import ANY_FORCE, MOST_BOXES, Progress, Search
from regrasp.planning.placement.sliding import slide_best
from regrasp.planning.placement.space.choosing import check_space, choose_on_mesh
from regrasp.planning.states.objectives import Objective

FROM_CORNERS = 1e-3
"""Default distance of fingers from corners, as a fraction of the length of the outline."""
_SPARED = 1e-6  # of the friction, where placements on edges of cones are passed over
_ON_EDGES = 5  # placements, lest others are not looked at for them
_KEPT, _FEW = 10, 1000  # placements, however those were found; boxes at the least
_SHORT = 0.25  # of the work of sliding otherwise
DISTINCT = 1e-6
"""Default distance of fingers, as a fraction of the object's farthest reach from its centre of mass."""


def choose_grasp(
    shape: Outline | Mesh,
    fingers: int,
    load: Wrench | LoadSet,
    *,
    friction: float,
    objective: str | Objective = "sum_normal",
    max_force: float | None = None,
    disturbance: LoadSet | None = None,
    length: float | None = None,
    min_normal: float = 0.0,
    keep: Filter | None = None,
    removable: bool = False,
    arcs: Sequence[Sequence[float]] | None = None,
    tip_radius: float = 0.0,
    in_holes: bool = False,
    load_offset: float = 0.0,
    tolerance: float = 1e-3,
    min_distance: float | None = None,
    from_corners: float | None = None,
    most_boxes: int | None = None,
    progress: Progress | None = None,
) -> ChosenGrasp:
    """The best places for fingers on a shape, with a proof that none are better.

    Every placement on the boundary is looked at, not a sample: boxes of placements are split until the best
    value found is within ``tolerance`` of the least bound. An interrupt from the keyboard ends the search and
    returns the best so far, with its gap.

    Args:
        shape: a polygon or a smooth outline, where contacts are on its outer boundary unless ``in_holes``, or
            a mesh of flat faces. On a mesh the objectives are the first four, ``friction_use``, ``angle`` and
            ``answered``, with ``max_force`` and ``disturbance`` for these three alone; of the options
            ``tolerance``, ``min_distance``, ``from_corners``, ``most_boxes`` and ``progress``.
        fingers: how many, 2 to 4; all alike.
        load: external wrench on the object about its centre of mass, or a set of them that one grasp, with
            forces for each load, has to hold; the value is that of the worst load [N, N m]. Under none all
            placements are worth 0, unless fingers squeeze with ``min_normal``.
        friction: coefficient of all fingers, 1e4 at most, and above 1e-9 for ``friction_use``, ``angle`` and
            ``force`` [-]. The largest component of loads is from 1e-60 to 1e60, or 0: beyond, rounding leaves
            nothing proven.
        objective: ``sum_normal``, ``peak_normal``, ``peak``, ``effort``; with ``max_force`` also
            ``friction_use``, ``angle``, ``force``, as of ``choose_state``; ``answered``, the largest factor
            of a ``disturbance`` for which forces exist; ``wrench``, that for which one set of forces does and
            fingers of equal stiffness need not notice; or ``wrench_ball``, Ferrari
            and Canny's measure, the radius of the largest ball of loads that fingers of limited normal force
            hold, for which ``load`` is zero.
        max_force: limit on every force, of ``wrench_ball`` on its normal part; the last six need it [N].
        min_normal: with which every finger pushes at the least, under every load [N].
        keep: which two fingers may hold together, as of ``plan_regrasp``: a function of points (k, 2) of the
            one and (k, 2) of the other, relative to the centre of mass [m], and the object's angle, here 0,
            that returns (k,) booleans; it is asked for every two fingers of a grasp.
        removable: whether one finger at least must be free to leave: the others hold all the loads, too, with
            forces of at most ``max_force``, or of a thousand times the loads without it.
        disturbance: a hull of deviations, added to the load, for ``answered`` and ``wrench``.
        length: by which torques are divided, for ``wrench_ball`` [m]; the farthest reach of the outline from
            its centre of mass if not given.
        arcs: the only stretches where fingers may be: pairs of arc lengths, counter-clockwise from the first
            to the second [m], once around at most, and one length before the first vertex or past it; the
            whole outline if not given.
        tip_radius: of round fingertips, which do not reach into corners and slots where they would meet
            another part of the outline [m]; on a curve as seen at 2,000 points of it.
        in_holes: whether fingers may be in the holes of a polygon, too, whose arc lengths go on after the
            outline's, clockwise around one after the other.
        load_offset: each load may act this far beside its line, to either side [m]; not with deviations,
            of ``answered``, ``wrench`` and ``wrench_ball``. Without it the best
            placement may be one where loads balance on a knife's edge: the search tells no places apart that
            are closer than a fraction of ``tolerance``, and leaves a gap there.
        tolerance: gap at which the search ends, as a fraction of the value [-]; under a round set of loads at
            least 5e-6 is left, for no more than a thousand loads stand for it.
        min_distance: least distance between two fingers [m]; a millionth of the object's size if not given,
            for two fingers at one point are one.
        from_corners: least distance of a finger from a corner, along the boundary, or from a sharp edge of a
            mesh, along the face [m]; a thousandth of the length, or of the root of the area, if not given;
            0 lets a finger be on a corner or edge with the normal of either side, as on any vertex
            of a polygon that turns too little for a corner.
        most_boxes: boxes after which the search ends with the gap it has; they bound its memory. If not given
            200,000, or 20,000 with ``keep`` or ``removable``, of which bounds know nothing, and fewer on a
            mesh of many faces: such for which 1.5 billion corners and groups of faces were looked at.
        progress: called with the bound and the best value so far as the search goes on, at last with those of
            the result: of the four norms the norm of forces behind the objective [N], infinite while none is
            found; of the others the objective itself, NaN while none is, with a bound that comes near at the
            end of the search alone.

    Raises:
        Infeasible: Where no placement holds the loads; the certificate is the proof.
        InvalidInput: For arguments that are not what they must be.
    """
    if not isinstance(shape, Mesh):
        check_task(shape, load)
    if progress is not None and not callable(progress):
        raise InvalidInput(f"progress must be a function of bound and value, got {shown(progress)}")
    whole(fingers, "fingers", least=2, most=4)
    mu = number(friction, "friction", least=0)
    if isinstance(load, Wrench | LoadSet):
        check_sizes(mu, load)
    goal, law = law_of(objective)
    if number(tolerance, "tolerance", above=0) >= 1:
        raise InvalidInput(f"tolerance is a fraction below 1, got {shown(tolerance)}")
    points = shape.polygon() if isinstance(shape, Outline) else shape.surface()[0]
    apart = asked_distance(min_distance, points)
    away = None if from_corners is None else number(from_corners, "from_corners", least=0)
    limit = None if max_force is None else number(max_force, "max_force", above=0)
    constraints = Constraints(limit, number(min_normal, "min_normal", least=0), keep, removable)
    check_constraints(constraints, goal, fingers)
    if isinstance(shape, Mesh):
        cap = None if most_boxes is None else whole(most_boxes, "most_boxes", least=64, most=10_000_000)
        named: dict[str, object] = {
            "max_force": limit,
            "min_normal": min_normal,
            "keep": keep,
            "removable": removable,
        }
        named |= {"arcs": arcs, "tip_radius": tip_radius, "in_holes": in_holes, "load_offset": load_offset}
        named |= {"disturbance": disturbance, "length": length}
        unused = {name: value is not None and value != 0 for name, value in named.items()}
        loads, reach = check_space(shape, load, goal, unused), float(np.linalg.norm(points, axis=1).max())
        chosen = choose_on_mesh(
            shape, fingers, loads, mu, goal, law, tolerance=tolerance,
            apart=DISTINCT * reach if apart is None else apart, away=away, most=cap, progress=progress,
            level=level_of(goal, mu, load, max_force, disturbance, reach),
        )  # fmt: skip
        return _told(chosen, law, progress)
    most = CONSTRAINED_BOXES if constraints.unbounded else MOST_BOXES
    if most_boxes is not None:
        most = whole(most_boxes, "most_boxes", least=64, most=10_000_000)
    offset = number(load_offset, "load_offset", least=0)
    if offset and goal in ("answered", "wrench", "wrench_ball"):
        raise InvalidInput(f"load_offset is of loads that are given; {goal} has deviations: put it there")
    level = level_of(goal, mu, load, max_force, disturbance, length_of(goal, length, shape))
    sides = asked_sides(
        shape, FROM_CORNERS * shape.length if away is None else away, arcs, tip_radius, in_holes
    )
    inner, outer = (offset_by(loads, offset) for loads in inner_and_outer(load, tolerance / 4 / law.power))
    if isinstance(level, BallLevel):
        inner = outer = level.loads(level.max_force)
    distance = DISTINCT * sides.size if apart is None else apart
    # a box so narrow moves no value by more, unless it is on a knife's edge
    narrow = (Level.narrow if level is None else level.narrow) * tolerance
    limits = (inf if limit is None else limit, constraints.min_normal) if level is None else ANY_FORCE
    search = Search(sides, fingers, mu, inner, law, distance, narrow, limits)
    asked = Asked(shape, goal, law, mu, outer, limit, constraints.min_normal, constraints.unbounded)
    if level is not None:
        around = 1.0 if np.array_equal(inner, outer) else 0.5  # the rest is for loads around a round set
        search, best, beyond = best_level(search, level, around * tolerance, most, progress)
        if isinstance(level, WithstoodLevel) and best is not None and not search.interrupted:
            search, beyond = level.climb(search, tolerance, most, progress, beyond)
        return _told(chosen_at_level(search, asked, level, best, beyond), law, progress)
    # half of the tolerance is for loads around a round set and for friction kept back
    half = 0.5 * tolerance / law.power
    if limits == ANY_FORCE and not (constraints.unbounded or offset):
        search, half = up_to_turns(search, load, half)
    if constraints.unbounded:
        run_constrained(search, constraints, half, most, progress)
    else:
        search.run(half, most, progress)
        if not search.closed:
            slide_best(search)
        if not search.closed and mu > 0:
            _spare_friction(search, half, max(most // 10, _FEW))
        if search.bound < (1 - half) * search.best:
            _try_edges(search)
    return _told(chosen_by_norm(search, asked), law, progress)


def _told(chosen: ChosenGrasp, law: Law, progress: Progress | None) -> ChosenGrasp:
    """The result, which is the last that progress is told: forces come out a little better than searched."""
    if progress is not None:
        with suppress(KeyboardInterrupt):
            progress(chosen.bound ** (1 / law.power), chosen.value ** (1 / law.power))
    return chosen


def _try_edges(search: Search) -> None:
    """Take placements on a knife's edge, too."""
    with suppress(KeyboardInterrupt):
        more = on_edges(search)[:_ON_EDGES]
        if more:
            search.take(search.placements() + more)
            if more[0][0] < search.best:
                search.note(*more[0])


def _spare_friction(search: Search, tolerance: float, most: int) -> None:
    """Take placements that hold with a little less friction.

    Where loads are on edges of cones, boxes lead to placements that rounding decides on, and past others.
    """
    less = search.anew((1 - _SPARED) * search.friction)
    with suppress(KeyboardInterrupt):
        if not search.interrupted:  # else nobody waits for boxes
            less.run(tolerance, most, None)
        slide_best(less, _SHORT)
    search.take(search.placements()[:_KEPT] + less.placements())
