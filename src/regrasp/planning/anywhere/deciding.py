"""Whether any regrasp exists on an outline, decided without sampling of places."""

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import ArrayLike, numbers_in, read_only
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.planning.anywhere.asking import arc_lengths_of, asked_of
from regrasp.planning.anywhere.hold_map import flooded
from regrasp.planning.anywhere.results import OutlineRegrasps
from regrasp.planning.anywhere.search import End, decided


def regrasps_on_outline(
    outline: Outline,
    start: Grasp,
    goal: Grasp,
    load: Wrench,
    *,
    friction: float,
    goal_orientation: float = 0.0,
    turns: ArrayLike = (0.0, 0.0),
    forbidden: ArrayLike = (),
    min_normal: float = 0.0,
    max_force: float | None = None,
) -> OutlineRegrasps:
    """Whether any regrasp of three fingers exists on a polygon, while the object stays or turns.

    Every place on the outline counts, none is sampled. Where two fingers on two sides hold the load is a
    finite set of convex polygons in their arc lengths (docs/facts.md, 10), and regrasps lead from one to
    another where their projections on a side overlap. That a regrasp exists is shown by a walk of holds,
    each checked again; that none exists by a certificate, which ``verify`` decides in rationals, for all
    orientations between the ends of the turns at once. The holds of walks are looked for at up to 33 of them.
    A least normal force leaves the map exact. With a force limit it lies between two sets of polygons, of
    tangents and of chords of the disc, 16 within each cone at the most: what is decided by neither is open.
    Corners that fingers keep away from are not looked at: with them there may be none where one exists here.

    Args:
        outline: a polygon of up to 500 sides; fingers touch its outer boundary.
        start: three contacts on it, relative to the centre of mass [m].
        goal: three contacts at the end.
        load: a force through the centre of mass, seen from the object before it turns [N].
        friction: Coulomb coefficient of all fingers, those of start and goal included [-].
        goal_orientation: the object's angle in the end, within ``turns`` [rad].
        turns: (2,) the least and the largest angle of the object, less than pi apart, 0 between them [rad].
        forbidden: (k, 2) arc lengths where arcs begin and end within which no finger may touch,
            counter-clockwise [m].
        min_normal: with which both fingers of every hold push at the least, and all three at the start and in
            the end [N].
        max_force: limit on the force of every finger [N]; none if not given.

    Raises:
        InvalidInput: For arguments that are not what they must be.
        Infeasible: Where all three fingers of an end cannot hold the load there, if the object turns; or with
            ``min_normal``, where there is a walk between.
    """
    asked, ends = asked_of(
        outline, start, goal, load, friction, goal_orientation, turns, forbidden, min_normal, max_force
    )
    (lo, hi), limits = asked.turns, asked.limits
    if lo < hi:
        _refuse_unheld(ends, load, limits.max_force)
    found = decided(asked, *ends)
    if found.walk is not None and limits.min_normal > 0:
        _refuse_unheld(ends, load, *limits[::-1])
    walk = found.walk or []
    return OutlineRegrasps(
        outline,
        start,
        goal,
        load,
        asked.friction,
        True if found.walk is not None else None if found.certificate is None else False,
        tuple(
            read_only(arc_lengths_of(asked.vertices, [((i, f), (j, g), 0) for f, g in polygon]))
            for (i, j), polygon, _ in (found.holds.regions if found.holds else ())
        ),
        _components(found.neighbours),
        read_only(arc_lengths_of(asked.vertices, walk)),
        found.certificate,
        read_only(found.angles[[turn for _, _, turn in walk]]),
        found.exchanges,
        (lo, hi),
        limits.min_normal,
        max_force,
        ends[1].angle,
        read_only(numbers_in(forbidden, "forbidden").reshape(-1, 2)),
    )


def _refuse_unheld(ends: tuple[End, End], load: Wrench, max_force: float, min_normal: float = 0.0) -> None:
    """Raise ``Infeasible`` where all three fingers of an end do not hold the load."""
    for name, end in zip(("start", "goal"), ends, strict=True):
        reason = end.unheld(load, max_force, min_normal)
        if reason is not None:
            raise Infeasible(
                f"the three fingers of the {name} cannot hold the load: {reason}", reason.certificate
            )


def _components(neighbours: list[set[int]]) -> tuple[int, ...]:
    """A number for every region."""
    found: dict[int, int] = {}
    for region in range(len(neighbours)):
        if region not in found:
            number_of = len(set(found.values()))
            found |= dict.fromkeys(flooded(neighbours, {region}), number_of)
    return tuple(found[k] for k in range(len(neighbours)))
