"""Whether any regrasp exists on an outline, decided without sampling of places."""

from itertools import combinations
from math import pi

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, instance, number, read_only
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.outline.polygon import PolygonBoundary
from regrasp.planning.anywhere.cut import excluded_boxes, reached_arcs
from regrasp.planning.anywhere.fewest import fewest_layers, fewest_walk
from regrasp.planning.anywhere.forbidden import parted_outline
from regrasp.planning.anywhere.hold_map import TIE, HoldMap, Place, TooLarge, flooded
from regrasp.planning.anywhere.polygons import width
from regrasp.planning.anywhere.results import OutlineRegrasps
from regrasp.planning.anywhere.walk import Hold, walk_through
from regrasp.planning.states.batch import locus_intervals
from regrasp.planning.states.choosing import choose_state
from regrasp.plans.outline_cut import OutlineCut

MOST_SIDES = 500
_ORIENTATIONS = 3, 9, 33
_ROOMS = 3e-2, 3e-3, 1e-4, 1e-6, TIE
_LESS = 1e-9  # of two sides that meet one where fingers may touch is taken
_ON_SIDE = 1e-6  # of the size: farther from every side a contact is not on the outline

# Regions that a walk prefers are wider than the first of these fractions, then than the next: narrow ones
# take many holds.
_WIDTHS = (1e-2, 1e-3, 0.0)

Places = tuple[Place, ...]


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
) -> OutlineRegrasps:
    """Whether any regrasp of three fingers exists on a polygon, while the object stays or turns.

    Every place on the outline counts, none is sampled. Where two fingers on two sides hold the load is a
    finite set of convex polygons in their arc lengths (docs/facts.md, 10), and regrasps lead from one to
    another where their projections on a side overlap. That a regrasp exists is shown by a walk of holds,
    each checked again; that none exists by a certificate, which ``verify`` decides in rationals, for all
    orientations between the ends of the turns at once. The holds of walks are looked for at up to 33 of them.
    Force limits, least normal forces and corners that fingers keep away from are not looked at: with them
    there may be none where one exists here.

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

    Raises:
        InvalidInput: For arguments that are not what they must be.
        Infeasible: Where the object turns and all three fingers of an end cannot hold the load there.
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
    lo, hi = _turns(turns, number(goal_orientation, "goal_orientation"))
    ends = tuple(
        _places(vertices, free, grasp, mu, name) for grasp, name in ((start, "start"), (goal, "goal"))
    )
    if lo < hi:
        for grasp, angle in ((start, 0.0), (goal, goal_orientation)):
            choose_state(grasp, load.rotated(-angle), "force")
    walk, holds, neighbours, certificate = None, None, [], None
    for count in _ORIENTATIONS if lo < hi else (1,):
        angles = np.unique([*np.linspace(lo, hi, count), 0.0, goal_orientation])
        forces = np.array([load.rotated(-a).force for a in angles.tolist()])
        try:
            holds = HoldMap.of(vertices, mu, forces, free)
            neighbours = holds.neighbours(TIE)
            walk = _walk(holds, neighbours, *ends)
            certificate = _certificate(holds, *ends) if walk is None else None
        except TooLarge:
            holds = None
            break
        if walk is not None or certificate is not None:
            break
    lengths = np.hypot(*(np.roll(vertices, -1, axis=0) - vertices).T)
    starts = np.concatenate([[0.0], np.cumsum(lengths)])

    def along(side: int, fraction: float) -> float:
        return float(starts[side] + fraction * lengths[side])

    fewest = None
    if holds is not None and walk is not None:
        walk, fewest = _fewest(holds, walk, *ends)
    return OutlineRegrasps(
        outline,
        start,
        goal,
        load,
        mu,
        True if walk is not None else None if certificate is None else False,
        tuple(
            read_only(np.array([[along(r.sides[0], f), along(r.sides[1], g)] for f, g in r.polygon]))
            for r in (holds.regions if holds else ())
        ),
        _components(neighbours) if holds else (),
        read_only(np.array([[along(*p), along(*q)] for p, q, _ in walk or []]).reshape(-1, 2)),
        certificate,
        read_only(angles[[turn for _, _, turn in walk or []]]),
        fewest,
        (lo, hi),
    )


def _turns(turns: ArrayLike, goal_orientation: float) -> tuple[float, float]:
    lo, hi = array(turns, "turns", (2,)).tolist()
    if not lo <= min(0.0, goal_orientation) <= max(0.0, goal_orientation) <= hi or hi - lo >= pi:
        raise InvalidInput(
            f"turns must be a least and a largest angle less than pi apart, with 0 and goal_orientation "
            f"between them, got {shown((lo, hi))} and {goal_orientation:g}"
        )
    return lo, hi


def _fewest(
    holds: HoldMap, walk: list[Hold], start: Places, goal: Places
) -> tuple[list[Hold], tuple[int, int]]:
    """The walk of fewest exchanges that is sure, and between what bounds their number is."""
    low = fewest_layers(holds, start, goal, -TIE)
    least = len(low) if low is not None else 0
    for room in _ROOMS:  # well inside regions, if that takes no more
        layers = fewest_layers(holds, start, goal, room)
        few = None if layers is None else fewest_walk(holds, start, goal, layers, room)
        if few is not None and len(few) < len(walk) and _held(holds, few):
            walk = few
        if len(walk) - 1 <= least:
            break
    return walk, (least, max(len(walk) - 1, 0))


def _places(vertices: Array, free: np.ndarray, grasp: Grasp, friction: float, name: str) -> Places:
    """The sides of three contacts, by point and normal, and the fractions passed."""
    if not isinstance(grasp, Grasp) or grasp.dimension != 2 or len(grasp) != 3:
        raise InvalidInput(f"{name} must be a planar Grasp of three contacts, got {shown(grasp)}")
    refuse_limits(grasp, "a search on a whole outline")
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


def _walk(holds: HoldMap, neighbours: list[set[int]], start: Places, goal: Places) -> list[Hold] | None:
    """Holds from the start to the goal, through fewest wide regions; None where none is sure."""
    if sorted(start) == sorted(goal):
        return []
    leave, arrive = (
        {k: at for p, q in combinations(end, 2) for k, at in holds.at(p, q, TIE)} for end in (start, goal)
    )
    for least in _WIDTHS:
        wide = {k for k, region in enumerate(holds.regions) if width(region.polygon) > least}
        wide |= leave.keys() | arrive.keys()
        before = flooded([near & wide for near in neighbours], set(leave))
        last = next((k for k in before if k in arrive), None)
        if last is None:
            continue
        path = [last]
        while (previous := before[path[-1]]) is not None:
            path.append(previous)
        path.reverse()
        walk = walk_through(holds, path, leave[path[0]], arrive[last])
        if walk is not None and _held(holds, walk):
            return walk
    return None


def _held(holds: HoldMap, walk: list[Hold]) -> bool:
    """Whether the closed form of two contacts says so, too, hold by hold."""
    vertices = holds.vertices
    along = np.roll(vertices, -1, axis=0) - vertices
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    sides = np.array([[p[0], q[0]] for p, q, _ in walk])
    fractions = np.array([[p[1], q[1]] for p, q, _ in walk])
    forces = holds.forces[[turn for _, _, turn in walk]]
    points, n = vertices[sides] + fractions[..., None] * along[sides], normals[sides]
    mu = holds.friction
    lo, hi = locus_intervals(points[:, 0], n[:, 0], mu, points[:, 1], n[:, 1], mu, forces)
    return bool((lo < hi).all())


def _certificate(holds: HoldMap, start: Places, goal: Places) -> OutlineCut | None:
    """The proof that none exists, where there is one, nearly touching regions taken to be joined."""
    leave = {k for p, q in combinations(start, 2) for k, _ in holds.at(p, q, -TIE)}
    arrive = {k for p, q in combinations(goal, 2) for k, _ in holds.at(p, q, -TIE)}
    arcs, inside = reached_arcs(holds, leave)
    if inside & arrive:
        return None
    if not arrive:  # the goal cannot be held by two: the start may reach everything
        arcs = [(side, 0.0, 1.0) for side in np.flatnonzero(holds.free).tolist()]
    found = excluded_boxes(holds, arcs, start, goal)
    if found is None:
        return None
    return OutlineCut(
        holds.vertices,
        holds.friction,
        holds.forces[0],
        np.array(start),
        np.array(goal),
        np.array(arcs),
        np.array(found[0]),
        np.array(found[1]),
        holds.forces[-1],
        np.flatnonzero(~holds.free).astype(np.float64),
    )


def _components(neighbours: list[set[int]]) -> tuple[int, ...]:
    """A number for every region."""
    found: dict[int, int] = {}
    for region in range(len(neighbours)):
        if region not in found:
            number_of = len(set(found.values()))
            found |= dict.fromkeys(flooded(neighbours, {region}), number_of)
    return tuple(found[k] for k in range(len(neighbours)))
