"""A state or a plan as the states that decide: forces, load, and whose stiffness answers."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import cos, inf

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, number, read_only
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.loads.rotated import load_between, turned_load
from regrasp.mechanics.robust.stiffness import Stiffness, response
from regrasp.mechanics.robust.withstanding import Withstanding, measured_response
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

Subject = GraspState | Transition | RegraspPlan


@dataclass(frozen=True, eq=False)
class View(ArrayValue):
    """Forces of a grasp under a load at one instant.

    label: when, in words; empty for a state alone. controlled: places of the fingers whose force is
    controlled. limits: (n,) [N], infinite for none. share: of the contacts' linear limits that may be used.
    """

    label: str
    state: GraspState
    controlled: tuple[int, ...]
    stiffness: Stiffness
    limits: Array
    share: float = 1.0

    @property
    def grasp(self) -> Grasp:
        """Every contact in play."""
        return self.state.grasp

    @cached_property
    def response(self) -> Array:
        """R, (n w, 3) or (n w, 6)."""
        return response(self.grasp, self.stiffness, self.controlled)

    def withstanding(self, base: LoadSet | None, friction: float = 1.0) -> Withstanding:
        """The forces as they answer, with a factor on all coefficients."""
        grasp = self.grasp
        return Withstanding(
            grasp.cones,
            grasp.cones.measured(self.state.forces),
            measured_response(grasp, self.response),
            friction * grasp.frictions,
            self.limits,
            base,
            None if grasp.limit_rows is None else grasp.limit_rows.scaled(self.share),
        )

    @cached_property
    def at_work(self) -> "View":
        """The same without the fingers that carry no force."""
        used = [i for i, force in enumerate(self.state.forces) if force.any()]
        if len(used) in (0, len(self.grasp)):
            return self
        rest = self.grasp.subset(used)
        state = GraspState(rest, self.state.load, self.state.forces[used][:, : rest.width])
        return replace(self, state=state, controlled=(), limits=read_only(self.limits[used]))


def views_of(subject: Subject, stiffness: Stiffness, max_force: float | None) -> list[View]:
    """The states between which all others are combinations, so that the worst of them is the worst of all."""
    if max_force is not None:
        number(max_force, "max_force", above=0)
    if isinstance(subject, GraspState):
        return [View("", subject, _idle(subject.forces[None]), stiffness, _limits(subject.grasp, max_force))]
    if isinstance(subject, RegraspPlan):
        springs = _of_fingers(subject, stiffness)
        return [
            replace(view, label=f"step {k + 1}, {view.label}")
            for k, step in enumerate(subject.steps)
            for view in _of_transition(step, springs[k], max_force)
        ]
    if not isinstance(subject, Transition):
        raise InvalidInput(
            f"tolerances are of a GraspState, a Transition or a RegraspPlan, got {shown(subject)}"
        )
    return list(_of_transition(subject, stiffness, max_force))


def _of_fingers(plan: RegraspPlan, stiffness: Stiffness) -> list[Stiffness]:
    """The stiffness of each step's contacts, from that of each finger."""
    if not isinstance(stiffness, tuple):
        return [stiffness] * len(plan.steps)
    fingers = plan.fingers
    if len(stiffness) != len(fingers[0]):
        raise InvalidInput(
            f"stiffness must be one number or have a row for each of {len(fingers[0])} fingers, in the order "
            f"of the start, got {len(stiffness)}"
        )
    return [
        tuple(stiffness[held.index(name)] for name in step.grasp.names)
        for step, held in zip(plan.steps, fingers, strict=True)
    ]


def _of_transition(plan: Transition, stiffness: Stiffness, max_force: float | None) -> Iterator[View]:
    grasp = plan.grasp
    limits = _limits(grasp, max_force)
    places = [tuple(grasp.index(name) for name in names) for names in (plan.leaving, plan.arriving)]
    idle = _idle(plan.path.deciding(plan.start, plan.end))
    moving = tuple(sorted({*places[0], *places[1], *idle}))
    if plan.turn is not None:
        yield from _of_turn(plan, stiffness, limits, moving)
    elif plan.course is not None:
        for t, forces, load in zip(plan.course.times, plan.course.forces, plan.course.loads, strict=True):
            state = GraspState(grasp, Wrench.from_vector(load), forces)
            yield View(f"t = {t:.6g} s", state, moving, stiffness, limits)
    else:
        yield View("start", plan.start, moving, stiffness, limits)
        yield View("end", plan.end, moving, stiffness, limits)
    for label, state, away in (("start", plan.start, places[1]), ("end", plan.end, places[0])):
        controlled = tuple(sorted({*away, *idle}))
        if controlled != moving:
            yield View(f"{label}, all at work answering", state, controlled, stiffness, limits)


def _of_turn(
    plan: Transition, stiffness: Stiffness, limits: Array, moving: tuple[int, ...]
) -> Iterator[View]:
    turn, grasp, load = plan.turn, plan.grasp, plan.start.load
    assert turn is not None
    angles = turn.angles.tolist()
    share = 1.0 if turn.middles is not None else cos(max(abs(b - a) for a, b in pairwise(angles)) / 2)
    for angle, forces in zip(angles, turn.forces, strict=True):
        state = GraspState(grasp, turned_load(load, angle, turn.axis), forces)
        yield View(f"angle {angle:.6g} rad", state, moving, stiffness, read_only(share * limits), share)
    for (a, b), forces in zip(pairwise(angles), () if turn.middles is None else turn.middles, strict=False):
        state = GraspState(grasp, load_between(load, a, b, turn.axis), forces)
        yield View(f"between {a:.6g} and {b:.6g} rad", state, moving, stiffness, limits)


def _idle(forces: Array) -> tuple[int, ...]:
    """Places of the fingers that carry no force in any of (K, n, w): nobody commands them another."""
    idle = ~forces.any(axis=(0, 2))
    return () if idle.all() else tuple(np.flatnonzero(idle).tolist())


def _limits(grasp: Grasp, max_force: float | None) -> Array:
    return read_only(np.minimum(grasp.max_forces, inf if max_force is None else max_force))


def names_of(views: Sequence[View]) -> tuple[str, ...]:
    """All contacts, in the order in which they come."""
    return tuple(dict.fromkeys(name for view in views for name in view.grasp.names))
