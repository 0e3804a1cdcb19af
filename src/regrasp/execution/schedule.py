"""The set-points of a whole run: settling, steps, fingers that change places, holding."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.execution.setup import Setup
from regrasp.execution.units import Units, steps_of
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.motions.value import Motions
from regrasp.plans.regrasp_plan import RegraspPlan, rotation_before
from regrasp.plans.transition import Transition

MOST_STEPS = 500_000
"""Steps of a simulation; some fifty thousand take a second."""
# A finger in the air keeps this far from where it touched, as a fraction of the object's size.
_LIFT = 0.12


@dataclass(frozen=True)
class Place:
    """Where a finger is: at a contact, or lifted off it."""

    name: str
    touches: bool


@dataclass(frozen=True)
class Phase:
    """A stretch of a run: a step of the plan, or fingers that wait or change places before or after one.

    step: its number. part: of it, its start, whole way or end. length: [s].
    before, after: the place of every finger at both ends.
    """

    step: int
    part: Literal["start", "way", "end"]
    length: float
    before: tuple[Place, ...]
    after: tuple[Place, ...]


@dataclass(frozen=True)
class Schedule:
    """Set-points at the steps of a simulation; m instants, k fingers, n contacts.

    clock: (m,) the plan's own time [s]. planned: (m, n, d) forces, object frame [N].
    twists: (m, n) planned torques about the normals of soft fingers [N m].
    forces: (m, k, d) fed forward, world frame. spins: (m, k, d) torques fed forward in space, object frame.
    targets, velocities: (m, k, d) of the tips' centres, world. at: (m, k) the number of the contact a finger
    may touch, -1 in the air. rotations: (m, d, d) the object's planned orientation. loads: (m, 3) or (m, 6)
    in the world frame. gripping: steps before the run, in which forces and load grow together from nothing.
    """

    contacts: tuple[Contact, ...]
    clock: Array
    planned: Array
    twists: Array
    forces: Array
    spins: Array
    targets: Array
    velocities: Array
    at: NDArray[np.intp]
    rotations: Array
    loads: Array
    gripping: int


def contacts_of(plan: Transition | RegraspPlan) -> tuple[Contact, ...]:
    """All contacts of a plan, in the order of their first use."""
    found: dict[str, Contact] = {}
    for step in steps_of(plan):
        for name, contact in zip(step.grasp.names, step.grasp, strict=True):
            if not found.setdefault(name, contact).position.tolist() == contact.position.tolist():
                raise InvalidInput(
                    f"two contacts of this plan are called {shown(name)}: give them different names"
                )
    return tuple(found.values())


def phases(plan: Transition | RegraspPlan, units: Units, motions: Motions | None = None) -> Iterator[Phase]:
    """What happens in a run, in order."""
    steps = steps_of(plan)
    fingers = plan.fingers if isinstance(plan, RegraspPlan) else (plan.grasp.names,)
    settle, move, hold = (units.time * t for t in (units.settle, units.move, units.hold))
    last = [str(name) for name in fingers[0]]
    now: tuple[Place, ...] = tuple(Place(name, name not in steps[0].arriving) for name in last)
    yield Phase(0, "start", settle, now, now)
    for k, step in enumerate(steps):
        last = [old if name is None else name for name, old in zip(fingers[k], last, strict=True)]
        there = tuple(Place(name, at is not None) for name, at in zip(last, fingers[k], strict=True))
        if there != now:
            yield Phase(k, "start", move if motions is None else motions.pause(k), now, there)
        yield Phase(k, "way", step.duration, there, there)
        now = there
    gone = tuple(Place(p.name, p.touches and p.name not in steps[-1].leaving) for p in now)
    if gone != now:
        yield Phase(len(steps) - 1, "end", move if motions is None else motions.pause(len(steps)), now, gone)
    yield Phase(len(steps) - 1, "end", hold, gone, gone)


def schedule(plan: Transition | RegraspPlan, setup: Setup, units: Units) -> Schedule:
    """The set-points of a plan's run, in the plan's units."""
    contacts, steps = contacts_of(plan), steps_of(plan)
    dt = units.timestep * units.time
    tips = {str(c.name): c.position - units.tip_radius * units.length * c.normal for c in contacts}
    if setup.contact_errors is not None:
        if setup.contact_errors.shape != (len(contacts), contacts[0].dimension):
            raise InvalidInput(
                f"contact_errors must have shape {(len(contacts), contacts[0].dimension)}, "
                f"got {setup.contact_errors.shape}"
            )
        for c, error in zip(contacts, setup.contact_errors, strict=True):
            tips[str(c.name)] = tips[str(c.name)] + error - (error @ c.normal) * c.normal
    starts = np.cumsum([0.0, *(step.duration for step in steps)])
    lift = _LIFT * max(step.grasp.size for step in steps)
    blocks, done, motions = [], -1.0, setup.motions  # done: on the clock of motions, which does not settle
    if motions is not None and motions.plan != plan:
        raise InvalidInput("motions must be those of the plan that is simulated")
    run = list(phases(plan, units, motions))
    _refuse_long(sum(phase.length for phase in run) / dt, dt)
    for phase in run:
        ways = _Ways(tips, {str(c.name): c.normal for c in contacts}, lift, motions, done)
        local, *rest = _block(plan, phase, contacts, ways, dt)
        done = 0.0 if done < 0 else done + phase.length
        blocks.append((starts[phase.step] + local, *rest))
    clock, planned, twists, forces, spins, targets, at, rotations, loads = (
        np.concatenate(p) for p in zip(*blocks, strict=True)
    )
    forces, spins, targets, at = _late(setup.delays, dt, forces, spins, targets, at)
    velocities = np.diff(targets, axis=0, prepend=targets[:1]) / dt
    gripping = max(1, round(units.settle / units.timestep / 2))
    grown = _smooth(np.minimum(np.arange(1, len(clock) + 1) / gripping, 1.0))
    forces, spins = forces * grown[:, None, None], spins * grown[:, None, None]
    loads = loads * grown[:, None]
    return Schedule(
        contacts, clock, planned, twists, forces, spins, targets, velocities, at, rotations, loads, gripping
    )


def _refuse_long(steps: float, dt: float) -> None:
    """Raise ``InvalidInput`` for a run of more than ``MOST_STEPS``."""
    if steps > MOST_STEPS:
        raise InvalidInput(
            f"this run takes {steps:.3g} steps of {dt:.3g} s, a thousandth of the time in which so small or "
            f"light an object swings; at most {MOST_STEPS:,} are done: give the plan less time, or the "
            "object a larger mass, which adds inertia and no weight"
        )


def _block(
    plan: Transition | RegraspPlan,
    phase: Phase,
    contacts: tuple[Contact, ...],
    ways: "_Ways",
    dt: float,
) -> tuple[Array, Array, Array, Array, Array, Array, NDArray[np.intp], Array, Array]:
    """Time in the step, planned forces and twists, forces, spins, targets, places, orientations, loads."""
    step = steps_of(plan)[phase.step]
    m = max(1, round(phase.length / dt))
    s = np.arange(1, m + 1) / m
    local = step.duration * {"start": np.zeros(m), "way": s, "end": np.ones(m)}[phase.part]
    turned = _rotations(plan, phase.step, step, local)
    index = {str(c.name): i for i, c in enumerate(contacts)}
    d = step.grasp.dimension
    planned = np.zeros((m, len(contacts), d))
    twists, own = np.zeros((m, len(contacts))), [index[name] for name in step.grasp.names]
    pushed = step.forces(local)
    planned[:, own] = pushed[..., :d]
    if pushed.shape[2] > d:
        twists[:, own] = pushed[..., d]
    k = len(phase.before)
    forces, spins, targets = np.zeros((m, k, d)), np.zeros((m, k, d)), np.zeros((m, k, d))
    at = np.full((m, k), -1)
    for i, (a, b) in enumerate(zip(phase.before, phase.after, strict=True)):
        way, contact = ways.of(i, a, b, s, phase.length)
        targets[:, i] = np.einsum("mij,mj->mi", turned, way)
        at[:, i] = [index[name] if name else -1 for name in contact]
        if a == b and a.touches:
            forces[:, i] = np.einsum("mij,mj->mi", turned, planned[:, index[a.name]])
            spins[:, i] = twists[:, index[a.name], None] * contacts[index[a.name]].normal
    load = step.load(local)
    if d == 2:
        loads = np.column_stack([np.einsum("mij,mj->mi", turned, load[:, :2]), load[:, 2:]])
    else:
        loads = np.concatenate([np.einsum("mij,mj->mi", turned, load[:, j : j + 3]) for j in (0, 3)], axis=1)
    return local, planned, twists, forces, spins, targets, at, turned, loads


@dataclass(frozen=True)
class _Ways:
    """Where tips are in the object's frame: at contacts, off them, on ways of their own or of ``motions``.

    tips, normals: by contact. lift: how far off. begins: of this phase, on the clock of the motions, below
    zero while fingers settle [s].
    """

    tips: dict[str, Array]
    normals: dict[str, Array]
    lift: float
    motions: Motions | None
    begins: float

    def of(self, finger: int, a: Place, b: Place, s: Array, length: float) -> tuple[Array, list[str]]:
        """(m, d) where a tip is in the object's frame, and the contact it may touch there."""
        if self.motions is None:
            return _way(a, b, self.tips, self.normals, self.lift, s)
        t = np.zeros_like(s) if self.begins < 0 else self.begins + s * length
        where = self.motions.positions(np.minimum(t, self.motions.duration))[:, finger]
        away = np.linalg.norm(where[:, None] - np.array(list(self.tips.values())), axis=2)
        near, names = away < self.motions.tip_radius, list(self.tips)
        first = zip(near.argmax(axis=1).tolist(), near.any(axis=1).tolist(), strict=True)
        return where, [names[n] if there else "" for n, there in first]


def _way(
    a: Place, b: Place, tips: dict[str, Array], normal: dict[str, Array], lift: float, s: Array
) -> tuple[Array, list[str]]:
    """(m, d) where a tip is in the object's frame, and the contact it may touch there."""
    if a == b:
        at = tips[a.name] - (0.0 if a.touches else lift) * normal[a.name]
        return np.broadcast_to(at, (s.size, at.size)), [a.name if a.touches else ""] * s.size
    above = [tips[p.name] - lift * normal[p.name] for p in (a, b)]
    stops = [*([tips[a.name]] if a.touches else []), above[0]]
    legs = [a.name] if a.touches else []
    if a.name != b.name:
        stops.append(above[1])
        legs.append("")
    if b.touches:
        stops.append(tips[b.name])
        legs.append(b.name)
    part = np.minimum(s * len(legs), len(legs) * (1 - 1e-12))
    leg = part.astype(int)
    u, where = _smooth(part - leg), np.array(stops)
    return where[leg] + u[:, None] * (where[leg + 1] - where[leg]), [legs[k] for k in leg]


def _smooth(u: Array) -> Array:
    """From 0 to 1, at rest at both ends."""
    return np.asarray(u**3 * (10 - 15 * u + 6 * u**2))


def _rotations(plan: Transition | RegraspPlan, k: int, step: Transition, local: Array) -> Array:
    """(m, d, d) from the object's frame to the world's, which is the object's frame at the start."""
    if step.grasp.dimension == 3:
        before = rotation_before(plan, k)
        return np.asarray(before @ step.rotations(local))
    begun = plan.orientations[k] if isinstance(plan, RegraspPlan) else 0.0
    angle = begun + step.orientation(local)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)


def _late(
    delays: Array | None, dt: float, forces: Array, spins: Array, targets: Array, at: NDArray[np.intp]
) -> tuple[Array, Array, Array, NDArray[np.intp]]:
    """The set-points of every finger as late as its clock."""
    if delays is None:
        return forces, spins, targets, at
    m, k = at.shape
    if delays.shape != (k,):
        raise InvalidInput(f"delays must have shape ({k},), one for each finger, got {delays.shape}")
    rows = np.maximum(np.arange(m)[:, None] - np.round(delays / dt).astype(int), 0)
    columns = np.arange(k)
    return forces[rows, columns], spins[rows, columns], targets[rows, columns], at[rows, columns]
