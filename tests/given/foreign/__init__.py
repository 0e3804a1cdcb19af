"""Plans as anybody may make them: plain values with the attributes that ``verify`` reads.

``cross`` and ``solid_cross`` are grasps whose forces balance one another exactly in binary, each force on the
edge of its cone, so that every condition can be tried at its limit to the last bit.
"""

from dataclasses import dataclass, field
from math import sin
from types import SimpleNamespace

import numpy as np

import regrasp as rg

EPS = 2.0**-40
"""What checks allow for rounding, of the largest number."""


@dataclass(frozen=True)
class Scaling:
    duration: float = 1.0
    control: tuple[float, ...] = (1.0, 0.0)


@dataclass(frozen=True)
class Record:
    reserve: float = 0.0
    balancing: float = 0.0
    choices: tuple = ()
    rate_limits: tuple[float, ...] = ()
    least_normals: tuple[float, ...] = ()


@dataclass(frozen=True)
class Plan:
    """A transition. Without a course or a turn its forces are linear in time, as its time function is."""

    kind: str
    contact: str | None
    start: rg.GraspState
    end: rg.GraspState
    scaling: Scaling = field(default_factory=Scaling)
    record: Record = field(default_factory=Record)
    course: SimpleNamespace | None = None
    turn: SimpleNamespace | None = None
    arrival: str | None = None

    @property
    def leaving(self) -> tuple[str, ...]:
        return (self.contact,) if self.kind in ("removal", "exchange") and self.contact else ()

    @property
    def arriving(self) -> tuple[str, ...]:
        if self.kind == "exchange":
            return () if self.arrival is None else (self.arrival,)
        return (self.contact,) if self.kind == "addition" and self.contact else ()

    def forces(self, t):
        share = np.asarray(t, dtype=float)[..., None, None] / self.scaling.duration
        if self.course is not None:
            times, flat = self.course.times, self.course.forces.reshape(self.course.times.size, -1)
            columns = [np.interp(t, times, column) for column in flat.T]
            return np.stack(columns, axis=-1).reshape(*np.shape(t), *self.start.forces.shape)
        if self.turn is not None:  # of one step
            step = self.turn.angles[-1]
            a, b = np.sin(step - share * step) / sin(step), np.sin(share * step) / sin(step)
            return a * self.turn.forces[0] + b * self.turn.forces[-1]
        return (1 - share) * self.start.forces + share * self.end.forces


def course(times, forces, loads) -> SimpleNamespace:
    return SimpleNamespace(
        times=np.array(times, dtype=float),
        forces=np.array(forces, dtype=float),
        loads=np.array(loads, dtype=float),
    )


def turn(angles, forces, axis=None, middles=None) -> SimpleNamespace:
    return SimpleNamespace(
        angles=np.array(angles, dtype=float),
        forces=np.array(forces, dtype=float),
        axis=None if axis is None else np.array(axis, dtype=float),
        middles=None if middles is None else np.array(middles, dtype=float),
    )


def cross(frictions=(0.5,) * 4, limits=(None,) * 4, length=1.0, force=1.0, slope=0.5):
    """Two fingers from the left and two from the right; each pushes with 1 and across with 1/2."""
    places = ((-1, 1, 1, 1), (-1, -1, 1, -1), (1, 1, -1, 1), (1, -1, -1, -1))  # place, push, side of the edge
    contacts = [
        rg.Contact([x * length, y * length], [push, 0], mu, max_force=limit, name=name)
        for (x, y, push, _), mu, limit, name in zip(places, frictions, limits, "ABCD", strict=True)
    ]
    return rg.Grasp(contacts), force * np.array([[push, side * slope] for _, _, push, side in places])


def solid_cross(frictions=(0.5,) * 4, limits=(None,) * 4, length=1.0, force=1.0):
    """The same in space: pushes with 5/4, across with (3/8, 1/2), whose length is 5/8."""
    places = ((-1, 0.75, 1, 1), (-1, -0.75, -1, 1), (1, 0.75, 1, -1), (1, -0.75, -1, -1))
    contacts = [
        rg.Contact(np.array([x, y, z]) * length, [push, 0, 0], mu, max_force=limit, name=name)
        for (x, y, z, push), mu, limit, name in zip(places, frictions, limits, "ABCD", strict=True)
    ]
    forces = [[1.25 * push, 0.375 * np.sign(y), 0.5 * np.sign(y)] for _, y, _, push in places]
    return rg.Grasp(contacts), force * np.array(forces)


def soft_pair(friction=0.5, torsion=0.25, limit=None):
    """Two soft fingers in space: pushes of 5, across 3/2, torques of 1: |f_t| / mu = 3, m / e = 4."""
    grasp = rg.Grasp(
        rg.Contact([x, 0, 0], [-x, 0, 0], friction, torsion=torsion, max_force=limit, name=name)
        for x, name in ((-1, "A"), (1, "B"))
    )
    load = rg.Wrench([0, -3.0, 0])
    return grasp, load, np.array([[5, 1.5, 0, 1.0], [-5, 1.5, 0, 1.0]])


def out_of_balance(grasp, residual):
    """Changes of forces, the least ones, by which G f + w becomes larger by ``residual``, (n, d or 4)."""
    return (np.linalg.pinv(grasp.matrix) @ residual).reshape(len(grasp), -1)


def places(grasp: rg.Grasp, forces, load: rg.Wrench | None = None):
    """A plan for each place where a state stands in one: (where, plan), with the same state throughout."""
    d = grasp.dimension
    load = rg.Wrench([0.0] * d) if load is None else load
    state = rg.GraspState(grasp, load, forces)
    rows, loads = np.array([forces] * 3), [load.vector] * 3
    axis = None if d == 2 else [1.0, 0, 0]
    yield "ends", Plan("rotation", None, state, state)
    yield "instant", Plan("rotation", None, state, state, course=course([0, 0.5, 1], rows, loads))
    if not load.vector.any():
        for step in (0.5, -0.5):
            turned = turn([0, step], rows[:2], axis)
            yield "angle", Plan("rotation", None, state, state, turn=turned)
            between = turn([0, step], rows[:2], axis, rows[:1])
            yield "between", Plan("rotation", None, state, state, turn=between)


def spoilt(plan: Plan, where: str, forces) -> Plan:
    """The plan with other forces at one place: an end, the middle instant, the second angle, a middle."""
    from dataclasses import replace

    forces = np.array(forces, dtype=float)
    if where in ("start", "end"):
        state = getattr(plan, where)
        return replace(plan, **{where: rg.GraspState(state.grasp, state.load, forces)})
    if where == "instant":
        rows = plan.course.forces.copy()
        rows[1] = forces
        return replace(plan, course=SimpleNamespace(**{**vars(plan.course), "forces": rows}))
    if where == "angle":
        rows = plan.turn.forces.copy()
        rows[-1] = forces
        end = rg.GraspState(plan.end.grasp, plan.end.load, forces)
        return replace(plan, end=end, turn=SimpleNamespace(**{**vars(plan.turn), "forces": rows}))
    rows = plan.turn.middles.copy()
    rows[0] = forces
    return replace(plan, turn=SimpleNamespace(**{**vars(plan.turn), "middles": rows}))


def said(plan) -> str:
    """What ``verify`` finds wrong, in one line."""
    verdict = rg.verify(plan)
    assert verdict.ok == (not verdict.violations)
    return "; ".join(verdict.violations)
