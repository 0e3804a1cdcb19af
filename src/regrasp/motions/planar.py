"""Ways of free fingers in the plane: along the normal, the shortest way around, along the normal."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import Array, number
from regrasp.mechanics.contact import Contact
from regrasp.motions.free_space import FreeSpace
from regrasp.motions.rounded import RoundedWay
from regrasp.motions.value import Motion, Motions
from regrasp.outline.outline import Outline
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

# A tip without clearance at this many times the height at which it has it off a straight side is shut in.
_LIFT = 4.0

Place = tuple[str, bool]
"""A contact, and whether the finger touches there or stands off it."""


def plan_motions(
    plan: Transition | RegraspPlan,
    shape: Outline,
    *,
    tip_radius: float,
    clearance: float,
    speed: float = 0.1,
    acceleration: float = 1.0,
) -> Motions:
    """The ways of the fingers that are free, from contact to contact in the object's frame.

    Tips are discs. Each lifts off along the normal, goes the shortest way around the object and the tips that
    stand, and touches down along the normal; fingers that move before the same step do so one after the
    other, in an order in which each finds its way. A finger that is not needed stands off its last contact.
    Away from its contacts a tip keeps the clearance from the object and other tips: proven of the rounded
    way's hulls, not sampled. Speed and acceleration, in the object's frame, stay within limits all the way.
    tip_radius, clearance: [m]. speed: [m/s]. acceleration: [m/s^2].
    Raises ``InvalidInput`` for plans in space, ``Infeasible`` with the finger and the place where it is shut
    in or two tips are too near.
    """
    if not isinstance(shape, Outline):
        raise InvalidInput(f"ways are planned in the plane, around an Outline, got {type(shape).__name__}")
    steps = (plan,) if isinstance(plan, Transition) else plan.steps
    if steps[0].grasp.dimension != 2:
        raise InvalidInput("ways are planned in the plane only, got a plan in space")
    radius, keep = number(tip_radius, "tip_radius", above=0), number(clearance, "clearance", above=0)
    limits = number(speed, "speed", above=0), number(acceleration, "acceleration", above=0)
    space = FreeSpace.around(shape, radius, keep)
    contacts = {str(c.name): c for step in steps for c in step.grasp}
    stands = {name: _Stand(name, c, space) for name, c in contacts.items()}
    stops = list(_stops(plan, steps))
    motions: list[Motion] = []
    clock = 0.0
    for k, (before, after) in enumerate(pairwise(stops)):
        for motion in _moved(k, before, after, stands, space, limits, clock):
            motions.append(motion)
            clock += motion.duration
        clock += steps[k].duration if k < len(steps) else 0.0
    tips = np.array([[stands[n].tip(on) for n, on in stop] for stop in stops[1:]])
    touching = np.array([[on for _, on in stop] for stop in stops[1:]])
    return Motions(plan, tuple(motions), tips, touching, radius, keep)


class _Stand:
    """Where a tip is at a contact and off it; how far it lifts along the normal to be in free space."""

    def __init__(self, name: str, contact: Contact, space: FreeSpace) -> None:
        self.name, self.contact = name, contact
        self._touch = contact.position - space.tip_radius * contact.normal
        heights = np.linspace(0, _LIFT, 200) * (space.reach + space.room - space.tip_radius)
        away = space.distance(self._touch - heights[:, None] * contact.normal)
        free = away >= space.reach + space.room
        self.exit = float(heights[free.argmax()]) if free.any() else np.inf
        rising = self._touch - heights[: max(1, int(free.argmax())), None] * contact.normal
        if not free.any() or space.within(rising):
            x, y = contact.position.tolist()
            raise Infeasible(
                f"a tip of radius {space.tip_radius:g} is shut in at {name}, ({x:.6g}, {y:.6g}): along the "
                f"normal it gets no clearance of {space.clearance:g}"
            )
        self._off = self._touch - (self.exit + space.clearance) * contact.normal

    def tip(self, touches: bool) -> Array:
        """(2,) the tip's centre."""
        return self._touch if touches else self._off


def _stops(plan: Transition | RegraspPlan, steps: tuple[Transition, ...]) -> Iterator[tuple[Place, ...]]:
    """The places of all fingers before anything, during each step and after the last."""
    fingers = plan.fingers if isinstance(plan, RegraspPlan) else (steps[0].grasp.names,)
    last = [str(name) for name in fingers[0]]
    yield tuple((name, name not in steps[0].arriving) for name in last)
    for at in fingers:
        last = [old if name is None else name for name, old in zip(at, last, strict=True)]
        yield tuple((name, here is not None) for name, here in zip(last, at, strict=True))
    yield tuple(
        (name, here is not None and name not in steps[-1].leaving)
        for name, here in zip(last, at, strict=True)
    )


def _moved(
    k: int,
    before: tuple[Place, ...],
    after: tuple[Place, ...],
    stands: dict[str, _Stand],
    space: FreeSpace,
    limits: tuple[float, float],
    clock: float,
) -> Iterator[Motion]:
    """The motions of one pause, each finger when its way is free."""
    now = list(before)
    waiting = [i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    while waiting:
        for i in waiting:
            others = np.array([stands[n].tip(on) for j, (n, on) in enumerate(now) if j != i]).reshape(-1, 2)
            way = _way(stands[now[i][0]], now[i][1], stands[after[i][0]], after[i][1], others, space)
            if way is not None:
                break
        else:
            raise Infeasible(_shut_in(k, waiting[0], now, after[waiting[0]], stands, space))
        duration = way.shortest_time(*limits)
        gaps = _gaps(
            way,
            stands[now[i][0]].exit if now[i][1] else 0.0,
            stands[after[i][0]].exit if after[i][1] else 0.0,
            others,
            space,
        )
        yield Motion(k, i, now[i][0], after[i][0], way, duration, clock, *gaps)
        clock += duration
        now[i] = after[i]
        waiting.remove(i)


def _shut_in(
    k: int, i: int, now: list[Place], target: Place, stands: dict[str, _Stand], space: FreeSpace
) -> str:
    """Which finger finds no way and where it is shut in."""
    said = f"before step {k + 1} finger {i + 1} finds no way from {now[i][0]} to {target[0]}: "
    for place in (now[i][0], target[0]):
        piece = np.array([stands[place].tip(True), stands[place].tip(False)])
        for j, (name, on) in enumerate(now):
            if j != i and not _tips_clear(piece, stands[name].tip(on)[None], space):
                x, y = stands[place].contact.position.tolist()
                return f"{said}at {place}, ({x:.6g}, {y:.6g}), the tip of finger {j + 1} is too near"
    x, y = stands[target[0]].contact.position.tolist()
    return f"{said}the object and other tips shut {target[0]} in, ({x:.6g}, {y:.6g})"


def _way(
    a: _Stand, lifts: bool, b: _Stand, lands: bool, others: Array, space: FreeSpace
) -> RoundedWay | None:
    """From one place to another; None where there is none."""
    over = space.way(a.tip(False), b.tip(False), others) if a is not b else a.tip(False)[None]
    if over is None:
        return None
    points = np.vstack([*([a.tip(True)] if lifts else []), over, *([b.tip(True)] if lands else [])])
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1)
    points = points[np.concatenate([[True], apart > 1e-9 * space.clearance])]
    for p, q in ((points[0], points[1]), (points[-2], points[-1])):  # along the normals
        if len(others) and not _tips_clear(np.array([p, q]), others, space):
            return None
    cuts = np.zeros(len(points) - 2)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    for i in range(cuts.size):
        p, u, v = points[i + 1], points[i] - points[i + 1], points[i + 2] - points[i + 1]
        most = min(lengths[i : i + 2].min() / 2, space.tip_radius + space.clearance)
        if (lifts and i == 0) or (lands and i == cuts.size - 1):
            most = min(most, space.clearance)  # the rest of these parts is along the normal
        for _ in range(30):
            corner = np.array([p + most * u / lengths[i], p, p + most * v / lengths[i + 1]])
            if space.keeps_clear(corner, others):
                break
            most /= 2
        cuts[i] = most
    return RoundedWay(points, cuts)


def _tips_clear(piece: Array, others: Array, space: FreeSpace) -> bool:
    a, b = piece
    along = np.clip(((others - a) @ (b - a)) / ((b - a) @ (b - a)), 0, 1)
    away = np.linalg.norm(others - a - along[:, None] * (b - a), axis=1)
    return bool((away >= space.apart).all())


def _gaps(
    way: RoundedWay, lifted: float, landed: float, others: Array, space: FreeSpace
) -> tuple[float, float]:
    """How far the surface of the tip keeps from the object, beyond its lift, and from other tips [m]."""
    import shapely

    free = way.points.copy()
    free[0] = free[0] + min(lifted, way.lengths[0]) * way.directions[0]
    free[-1] = free[-1] - min(landed, way.lengths[-1]) * way.directions[-1]
    hulls = [shapely.LineString(pair) for pair in pairwise(free)]
    for i, h in enumerate(way.cuts):
        p = way.points[i + 1]
        hulls.append(
            shapely.MultiPoint([p - h * way.directions[i], p, p + h * way.directions[i + 1]]).convex_hull
        )
    object_gap = float(shapely.distance(hulls, space.body).min()) - space.tip_radius - space.slack
    hulls.append(shapely.LineString(way.points))
    tip_gap = min((float(shapely.distance(hulls, shapely.Point(p)).min()) for p in others), default=np.inf)
    return object_gap, tip_gap - 2 * space.tip_radius
