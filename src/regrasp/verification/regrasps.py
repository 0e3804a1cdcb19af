"""The verdict on a whole regrasp: every step, and every joint between two steps."""

from typing import Protocol

from regrasp.mechanics.state import GraspState
from regrasp.verification.exact import RESOLUTION, dot, exact
from regrasp.verification.protocols import Plan
from regrasp.verification.turned import cosine_sine

# No more fingers than these touch the object at once.
FINGERS = 3


class Regrasp(Protocol):
    """What ``verify`` needs to know of a regrasp."""

    @property
    def steps(self) -> tuple[Plan, ...]:
        """Transitions in order."""

    @property
    def orientations(self) -> tuple[float, ...]:
        """The object's angle before the first step, and after each [rad]."""


def check_joints(plan: Regrasp) -> list[str]:
    """What is wrong between the steps: forces that jump, fingers that move under force, loads that differ."""
    broken = []
    if len(plan.orientations) != len(plan.steps) + 1:
        return [
            f"{len(plan.steps)} steps need {len(plan.steps) + 1} orientations, got {len(plan.orientations)}"
        ]
    force = exact(plan.steps[0].start.load.force.tolist())
    first = plan.orientations[0]
    for k, step in enumerate(plan.steps):
        if len(step.start.grasp) > FINGERS:
            broken.append(
                f"step {k + 1}: {len(step.start.grasp)} fingers touch the object, more than {FINGERS}"
            )
        for label, state, angle in (
            ("start", step.start, plan.orientations[k]),
            ("end", step.end, plan.orientations[k + 1]),
        ):
            c, s = cosine_sine(exact([angle])[0] - exact([first])[0])
            seen = [c * force[0] + s * force[1], c * force[1] - s * force[0]]
            given = exact(state.load.force.tolist())
            off = [a - b for a, b in zip(given, seen, strict=True)]
            if dot(off, off) > RESOLUTION**2 * dot(force, force) or state.load.torque.any():
                broken.append(
                    f"step {k + 1}: its load at the {label} is not the first one seen from {angle:.6g} rad"
                )
    for k, (before, after) in enumerate(zip(plan.steps[:-1], plan.steps[1:], strict=True)):
        if _held(before.end) != _held(after.start):
            broken.append(f"between steps {k + 1} and {k + 2} the forces jump or a finger moves under force")
        shared = {_where(c) for c in before.end.grasp.contacts} & {
            _where(c) for c in after.start.grasp.contacts
        }
        if len(shared) < min(len(before.end.grasp), len(after.start.grasp)) - 1:
            broken.append(f"between steps {k + 1} and {k + 2} more than one finger moves")
    return broken


def _where(contact: object) -> tuple[float, ...]:
    return (*contact.position.tolist(), *contact.normal.tolist(), contact.friction)  # type: ignore[attr-defined]


def _held(state: GraspState) -> dict[tuple[float, ...], tuple[float, ...]]:
    """The contacts that carry force and their forces, bit for bit."""
    return {
        _where(contact): tuple(force.tolist())
        for contact, force in zip(state.grasp.contacts, state.forces, strict=True)
        if force.any()
    }
