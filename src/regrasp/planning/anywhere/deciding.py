"""Whether any regrasp exists on an outline, decided without sampling of places."""

from math import inf, pi

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, instance, number, read_only
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.outline.polygon import PolygonBoundary
from regrasp.planning.anywhere.forbidden import parted_outline
from regrasp.planning.anywhere.hold_map import flooded
from regrasp.planning.anywhere.limits import Limits
from regrasp.planning.anywhere.results import OutlineRegrasps
from regrasp.planning.anywhere.search import Asked, End, Places, decided

MOST_SIDES = 500
_LESS = 1e-9  # of two sides that meet one where fingers may touch is taken
_ON_SIDE = 1e-6  # of the size: farther from every side a contact is not on the outline


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
    if not isinstance(outline, Outline) or not isinstance(outline.boundary, PolygonBoundary):
        raise InvalidInput(f"outline must be an Outline that is a polygon, got {shown(outline)}")
    vertices, free = parted_outline(outline.polygon(), forbidden)
    if len(vertices) > MOST_SIDES:
        raise InvalidInput(f"outline must have at most {MOST_SIDES} sides, got {len(vertices)}")
    mu = number(friction, "friction", above=0)
    instance(load, "load", Wrench)
    if load.dimension != 2 or not load.force.any() or load.torque.any():
        raise InvalidInput(
            f"load must be a planar force through the centre of mass, not zero, got {shown(load)}"
        )
    limits = _limits(min_normal, max_force)
    lo, hi = _turns(turns, number(goal_orientation, "goal_orientation"))
    ends = tuple(
        _places(vertices, free, grasp, mu, max_force, name)
        for grasp, name in ((start, "start"), (goal, "goal"))
    )
    whole = End(start, ends[0], 0.0), End(goal, ends[1], float(goal_orientation))
    if lo < hi:
        _refuse_unheld(whole, load, limits.max_force)
    found = decided(Asked(vertices, free, mu, load, limits, (lo, hi)), *whole)
    if found.walk is not None and limits.min_normal > 0:
        _refuse_unheld(whole, load, *limits[::-1])
    walk = found.walk or []
    lengths = np.hypot(*(np.roll(vertices, -1, axis=0) - vertices).T)
    starts = np.concatenate([[0.0], np.cumsum(lengths)])

    def along(side: int, fraction: float) -> float:
        return float(starts[side] + fraction * lengths[side])

    return OutlineRegrasps(
        outline,
        start,
        goal,
        load,
        mu,
        True if found.walk is not None else None if found.certificate is None else False,
        tuple(
            read_only(np.array([[along(r.sides[0], f), along(r.sides[1], g)] for f, g in r.polygon]))
            for r in (found.holds.regions if found.holds else ())
        ),
        _components(found.neighbours),
        read_only(np.array([[along(*p), along(*q)] for p, q, _ in walk]).reshape(-1, 2)),
        found.certificate,
        read_only(found.angles[[turn for _, _, turn in walk]]),
        found.exchanges,
        (lo, hi),
        limits.min_normal,
        max_force,
        float(goal_orientation),
    )


def _limits(min_normal: float, max_force: float | None) -> Limits:
    least = number(min_normal, "min_normal", least=0)
    most = inf if max_force is None else number(max_force, "max_force", above=0)
    if least > most:
        raise InvalidInput(f"min_normal must be at most max_force, got {least:g} and {most:g}")
    return Limits(least, most)


def _refuse_unheld(ends: tuple[End, End], load: Wrench, max_force: float, min_normal: float = 0.0) -> None:
    """Raise ``Infeasible`` where all three fingers of an end do not hold the load."""
    for name, end in zip(("start", "goal"), ends, strict=True):
        reason = end.unheld(load, max_force, min_normal)
        if reason is not None:
            raise Infeasible(
                f"the three fingers of the {name} cannot hold the load: {reason}", reason.certificate
            )


def _turns(turns: ArrayLike, goal_orientation: float) -> tuple[float, float]:
    lo, hi = array(turns, "turns", (2,)).tolist()
    if not lo <= min(0.0, goal_orientation) <= max(0.0, goal_orientation) <= hi or hi - lo >= pi:
        raise InvalidInput(
            f"turns must be a least and a largest angle less than pi apart, with 0 and goal_orientation "
            f"between them, got {shown((lo, hi))} and {goal_orientation:g}"
        )
    return lo, hi


def _places(
    vertices: Array, free: np.ndarray, grasp: Grasp, friction: float, max_force: float | None, name: str
) -> Places:
    """The sides of three contacts, by point and normal, and the fractions passed."""
    if not isinstance(grasp, Grasp) or grasp.dimension != 2 or len(grasp) != 3:
        raise InvalidInput(f"{name} must be a planar Grasp of three contacts, got {shown(grasp)}")
    refuse_limits(grasp, "a search on a whole outline")
    if any(c.max_force not in (None, max_force) for c in grasp):
        raise InvalidInput(
            f"contacts of the {name} have force limits of their own; all fingers have the one limit max_force"
        )
    if (grasp.frictions != friction).any():
        raise InvalidInput(
            f"all contacts of the {name} must have the friction {friction:g} of the outline, "
            f"got {shown(grasp.frictions.tolist())}"
        )
    along = np.roll(vertices, -1, axis=0) - vertices
    lengths = np.hypot(*along.T)
    unit, size = along / lengths[:, None], float(np.hypot(*vertices.T).max())
    found = []
    for contact in grasp:
        away = contact.position - vertices
        f = np.clip((away * unit).sum(axis=1) / lengths, 0.0, 1.0)
        distance = np.hypot(*(away - f[:, None] * along).T) / size
        turned = np.hypot(contact.normal[0] + unit[:, 1], contact.normal[1] - unit[:, 0])
        side = int(np.argmin(distance + turned + _LESS * ~free))
        if distance[side] + turned[side] > _ON_SIDE:
            raise InvalidInput(
                f"contact {shown(contact.name)} of the {name} is on no side of the outline, "
                f"with its inward normal"
            )
        if not free[side]:
            raise InvalidInput(f"contact {shown(contact.name)} of the {name} is on a forbidden arc")
        found.append((side, float(f[side])))
    return tuple(found)


def _components(neighbours: list[set[int]]) -> tuple[int, ...]:
    """A number for every region."""
    found: dict[int, int] = {}
    for region in range(len(neighbours)):
        if region not in found:
            number_of = len(set(found.values()))
            found |= dict.fromkeys(flooded(neighbours, {region}), number_of)
    return tuple(found[k] for k in range(len(neighbours)))
