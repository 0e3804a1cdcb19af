"""A moment of a plan in the world frame: how the object is turned, who touches it, and with which forces."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch, Wedge
from matplotlib.path import Path

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.outline.outline import Outline
from regrasp.plans.regrasp_plan import RegraspPlan, accumulated
from regrasp.plans.transition import Transition
from regrasp.plots.look.arrows import arrow
from regrasp.plots.look.style import INK, PALE, PALETTE, literal, note, quantity, round_below
from regrasp.plots.look.units import Units

# As fractions of the object's size.
_FINGER, _CONE, _LONGEST = 0.035, 0.2, 0.4


@dataclass(frozen=True, eq=False)
class Finger:
    """One finger, in the world frame. at: (d,) its contact point, or where it is in the air [m].

    normal (d,) and half_angle [rad] of its contact; None in the air. force: (d,) [N].
    """

    number: int
    name: str
    at: Array
    normal: Array | None
    half_angle: float
    force: Array


@dataclass(frozen=True, eq=False)
class Moment:
    """turn: (d, d) from the object frame to the world. load: (d,) force in the world [N]."""

    turn: Array
    load: Array
    fingers: tuple[Finger, ...]

    @property
    def angle(self) -> float:
        """Of the object in the plane [rad], within half a turn of 0."""
        return float(np.arctan2(self.turn[1, 0], self.turn[0, 0]))

    @property
    def touching(self) -> tuple[Array, Array]:
        """(n, d) positions [m] and normals of the fingers in touch."""
        pairs = [(finger.at, finger.normal) for finger in self.fingers if finger.normal is not None]
        return np.array([at for at, _ in pairs]), np.array([normal for _, normal in pairs])


class Stage:
    """What every moment of a plan is drawn with: the object's shape, and scales that fit all of it."""

    def __init__(self, steps: Sequence[Transition], outline: Outline | None, heads: float = 9.0) -> None:
        self.heads = heads
        points = np.concatenate([step.grasp.positions for step in steps])
        if outline is None:
            self.rings: list[Array] = []
        else:
            size = float(np.ptp(outline.polygon(), axis=0).max())
            self.rings = [
                outline.polygon(2e-4 * size),
                *(h[::-1] for h in outline.hole_polygons(2e-4 * size)),
            ]
            points = np.concatenate([points, self.rings[0]])
        self.positions = points
        self.radius = float(np.hypot(*points.T).max()) or 1.0
        self.size = 2 * self.radius
        forces = [step.forces(np.linspace(0, step.duration, 33)) for step in steps]
        longest = max(
            float(np.hypot(*np.moveaxis(f, -1, 0)).max())
            for f in [*forces, *(s.load(0.0)[:2] for s in steps)]
        )
        self.scale = _LONGEST * self.size / (longest or 1.0)
        reached = [step.grasp.positions + self.scale * f for step, f in zip(steps, forces, strict=True)]
        out = max(float(np.hypot(*np.moveaxis(h, -1, 0)).max()) for h in reached)
        load = self.scale * max(float(np.hypot(*s.load(0.0)[:2])) for s in steps)
        self.reach = 1.06 * max(self.radius * 1.2, out, load)

    def draw(self, ax: Axes, moment: Moment) -> None:
        """The object, its load, the fingers with their cones, and forces with their tails at the contacts."""
        ax.set(xlim=(-self.reach, self.reach), ylim=(-self.reach, self.reach))
        ax.set_aspect("equal", adjustable="box")
        self._object(ax, moment)
        ax.plot(0, 0, "o", color="white", markeredgecolor=INK, markersize=4, zorder=4)
        if moment.load.any():
            arrow(
                ax,
                (0, 0),
                self.scale * moment.load,
                gid="load",
                color=INK,
                zorder=4,
                mutation_scale=self.heads,
            )
        for finger in moment.fingers:
            self._finger(ax, finger)

    def _object(self, ax: Axes, moment: Moment) -> None:
        turn = moment.turn
        if self.rings:
            paths = [Path(np.vstack([ring, ring[:1]]) @ turn.T, closed=True) for ring in self.rings]
            look = {"facecolor": PALE, "edgecolor": INK, "linewidth": 0.8}
        else:  # only where it is touched is known: the hull of all contacts suggests it
            hull = _hull(self.positions) @ turn.T
            paths = [Path(np.vstack([hull, hull[:1]]), closed=True)]
            look = {"facecolor": PALE, "edgecolor": "none", "linewidth": 0.0}
        patch = PathPatch(Path.make_compound_path(*paths), zorder=0, gid="object")
        patch.set(**look)
        ax.add_patch(patch)
        mark = np.array([[0, 0], [0.12 * self.size, 0]]) @ turn.T  # the object's x axis
        ax.plot(*mark.T, color=INK, linewidth=0.8, linestyle=":", zorder=3, gid="object x")

    def _finger(self, ax: Axes, finger: Finger) -> None:
        colour, radius = PALETTE[finger.number % len(PALETTE)], _FINGER * self.size
        if finger.normal is None:
            ring = Wedge(tuple(finger.at), radius, 0, 360, zorder=5, gid=f"idle {finger.number}")
            ring.set(facecolor="white", edgecolor=colour, linewidth=1.2, linestyle="--")
            ax.add_patch(ring)
            return
        n = finger.normal
        middle, half = degrees(np.arctan2(n[1], n[0])), degrees(finger.half_angle)
        cone = Wedge(tuple(finger.at), _CONE * self.size, middle - half, middle + half, zorder=1)
        cone.set(facecolor=colour, edgecolor=colour, alpha=0.25, linewidth=0.5, gid=f"cone {finger.number}")
        ax.add_patch(cone)
        tip = Wedge(tuple(finger.at - radius * n), radius, 0, 360, zorder=5, gid=f"finger {finger.number}")
        pushes = np.hypot(*finger.force) * self.scale > 1e-3 * self.size
        tip.set(facecolor=colour if pushes else "white", edgecolor=colour, linewidth=1.2)
        ax.add_patch(tip)
        if pushes:
            arrow(
                ax,
                finger.at,
                finger.at + self.scale * finger.force,
                gid=f"force {finger.number}",
                color=colour,
                zorder=6,
                mutation_scale=self.heads,
            )

    def scale_key(self, ax: Axes, units: Units) -> None:
        """A bar below the object as long as a round force, and what it means."""
        force = round_below(0.35 * self.reach / self.scale)
        x, y = -0.93 * self.reach, -0.95 * self.reach
        ax.plot([x, x + self.scale * force], [y, y], color=INK, linewidth=2.2, gid="scale", zorder=7)
        note(ax, quantity(force, units.force), (x, y), (0.1, 1.0), gap=2.0, gid="scale name", ha="left")

    @property
    def hull(self) -> Array:
        """(k, 2) corners of the convex hull of all contacts, object frame [m]."""
        return np.asarray(_hull(self.positions))

    @property
    def finger(self) -> float:
        """The radius of a finger's tip [m]."""
        return _FINGER * self.size

    def tip(self, finger: Finger) -> Array:
        """(2,) the middle of a finger's tip in the world frame [m]."""
        return finger.at if finger.normal is None else finger.at - self.finger * finger.normal


def as_regrasp(plan: RegraspPlan | Transition) -> RegraspPlan:
    """A transition as a regrasp of one step."""
    if isinstance(plan, RegraspPlan):
        return plan
    if plan.grasp.dimension == 3:
        turned, rotations = accumulated([plan])
        return RegraspPlan((plan,), turned, 0.0, rotations=rotations)
    turn = float(plan.orientation(plan.duration)) + 0.0
    return RegraspPlan((plan,), (0.0, turn), 0.0)


def moment_of(plan: RegraspPlan, step: int, t: float, idle: dict[int, Array] | None = None) -> Moment:
    """The moment at time ``t`` of a step, from its start [s].

    idle: (d,) places, in the object frame, of fingers in the air, by number.
    """
    now = plan.steps[step]
    turn, d = turn_of(plan, step, t), now.grasp.dimension
    forces, fingers = now.forces(t)[:, :d], []
    for number, name in enumerate(plan.fingers[step]):
        if name is None:
            if idle and number in idle:
                fingers.append(Finger(number, "", turn @ idle[number], None, 0.0, np.zeros(d)))
            continue
        contact = now.grasp[name]
        fingers.append(
            Finger(
                number,
                literal(name),
                turn @ contact.position,
                turn @ contact.normal,
                contact.half_angle,
                turn @ forces[now.grasp.index(name)],
            )
        )
    return Moment(turn, turn @ now.load(t)[:d], tuple(fingers))


def turn_of(plan: RegraspPlan, step: int, t: float) -> Array:
    """(d, d) from the object frame to the world at time ``t`` of a step, from its start [s]."""
    now = plan.steps[step]
    if plan.rotations is None:
        return rotation(plan.orientations[step] + float(now.orientation(t)))
    before: Array = plan.rotations[step]
    return before @ now.rotations(t)


def rotation(angle: float) -> Array:
    """(2, 2) from the object frame to the world."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def joined(grasps: Sequence[Grasp]) -> dict[str, Array]:
    """Normals (d,) of all contacts by name, object frame."""
    return {name: grasp[name].normal for grasp in grasps for name in grasp.names}


def _hull(points: Array) -> Array:
    """Corners of the convex hull, counter-clockwise (Andrew's chains)."""
    ordered = sorted(set(map(tuple, points.tolist())))

    def chain(ps: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
        out: list[tuple[float, ...]] = []
        for p in ps:
            while len(out) > 1 and (
                (out[-1][0] - out[-2][0]) * (p[1] - out[-2][1])
                <= (out[-1][1] - out[-2][1]) * (p[0] - out[-2][0])
            ):
                out.pop()
            out.append(p)
        return out[:-1]

    return np.array(chain(ordered) + chain(ordered[::-1])) if len(ordered) > 1 else points
