"""The verdict on a whole regrasp: every step, and every joint between two steps."""

from fractions import Fraction
from math import isfinite
from typing import Protocol

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import ArrayLike
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.state import GraspState
from regrasp.verification.exact import RESOLUTION, Vector, cross, dot, exact, least_angle
from regrasp.verification.protocols import Plan
from regrasp.verification.rotated_loads import cosine_sine

Matrix = list[Vector]
# No more fingers than these touch the object at once, in the plane and in space.
FINGERS = {2: 3, 3: 4}


class Regrasp(Protocol):
    """What ``verify`` needs to know of a regrasp."""

    @property
    def margin(self) -> float:
        """The least angle margin of the holds between its steps [rad]."""

    @property
    def steps(self) -> tuple[Plan, ...]:
        """Transitions in order."""

    @property
    def orientations(self) -> tuple[float, ...]:
        """The object's angle before the first step, and after each [rad]; in space the sum of its turns.

        A regrasp in space has ``rotations``, too, (len(steps) + 1, 3, 3) from its frame to the world.
        """


def check_joints(plan: Regrasp) -> list[str]:
    """What is wrong between the steps: forces that jump, fingers that move under force, loads that differ."""
    if not plan.steps:
        return ["a regrasp has one step or more, this one has none"]
    broken = []
    if len({step.start.grasp.dimension for step in plan.steps}) > 1:
        return ["some steps are in the plane and some in space"]
    if not all(map(isfinite, (*plan.orientations, plan.margin))):
        return ["orientations and margin must be finite numbers"]
    if len(plan.orientations) != len(plan.steps) + 1:
        return [
            f"{len(plan.steps)} steps need {len(plan.steps) + 1} orientations, got {len(plan.orientations)}"
        ]
    dimension = plan.steps[0].start.grasp.dimension
    loads = _turned(plan) if dimension == 2 else _rotated(plan)
    if isinstance(loads, str):
        return [loads]
    for k, step in enumerate(plan.steps):
        if len(step.start.grasp) > FINGERS[dimension]:
            broken.append(
                f"step {k + 1}: {len(step.start.grasp)} fingers touch the object, more than "
                f"{FINGERS[dimension]}"
            )
        broken += _check_steadiness(step, k)
        for label, state, at in (("start", step.start, k), ("end", step.end, k + 1)):
            seen, angle = loads[at], plan.orientations[at]
            given = exact(state.load.force.tolist())
            off = [a - b for a, b in zip(given, seen, strict=True)]
            if dot(off, off) > RESOLUTION**2 * dot(seen, seen) or state.load.torque.any():
                broken.append(
                    f"step {k + 1}: its load at the {label} is not the first one seen from {angle:.6g} rad"
                )
    broken += _check_claims(plan)
    for k, (before, after) in enumerate(zip(plan.steps[:-1], plan.steps[1:], strict=True)):
        if _held(before.end) != _held(after.start):
            broken.append(f"between steps {k + 1} and {k + 2} the forces jump or a finger moves under force")
        shared = {_where(c) for c in before.end.grasp.contacts} & {
            _where(c) for c in after.start.grasp.contacts
        }
        if len(shared) < min(len(before.end.grasp), len(after.start.grasp)) - 1:
            broken.append(f"between steps {k + 1} and {k + 2} more than one finger moves")
    return broken


def of_steps(plan: Regrasp, stiffness: ArrayLike | None) -> list[ArrayLike | None]:
    """The stiffness of each step's contacts, from that of each finger; one number is of all of them.

    A contact that no step had before is of the finger that no contact of the step is of.
    """
    if np.ndim(1.0 if stiffness is None else stiffness) == 0:
        return [stiffness] * len(plan.steps)
    rows = np.asarray(stiffness)
    first = plan.steps[0].start.grasp.names
    if len(rows) != len(first):
        raise InvalidInput(
            f"stiffness must be one number or have a row for each of {len(first)} fingers, in the order of "
            f"the start, got {len(rows)}"
        )
    held: dict[str, int] = {name: k for k, name in enumerate(first)}
    result: list[ArrayLike | None] = []
    for step in plan.steps:
        names = step.start.grasp.names
        free = [finger for name, finger in held.items() if name not in names]
        for name in names:
            if name not in held:
                held = {n: f for n, f in held.items() if not free or f != free[0]}
                held[name] = free.pop(0) if free else 0
        result.append(rows[[held[name] for name in names]])
    return result


def _check_steadiness(step: Plan, k: int) -> list[str]:
    """Whether the load of a step that keeps its orientation is the same at every instant."""
    course = step.course
    if course is None:
        return []
    if step.turn is not None:
        return [f"step {k + 1}: it has a course and a turn"]
    load = exact(step.start.load.vector.tolist())
    scale = dot(load, load)
    for instant, row in zip(course.times.tolist(), course.loads.tolist(), strict=True):
        off = [a - b for a, b in zip(exact(row), load, strict=True)]
        if dot(off, off) > RESOLUTION**2 * scale:
            return [f"step {k + 1}: its load at t = {instant:.6g} s is not the one in the world"]
    return []


def _check_claims(plan: Regrasp) -> list[str]:
    """Whether orientations follow from the turns of the steps, and the margin from the holds between them."""
    broken = []
    angles = exact(list(plan.orientations))
    for k, step in enumerate(plan.steps):
        turn = Fraction(0) if step.turn is None else exact([float(step.turn.angles[-1])])[0]
        if abs(angles[k + 1] - angles[k] - turn) > RESOLUTION * max(Fraction(1), abs(turn), abs(angles[k])):
            broken.append(
                f"step {k + 1}: its turn of {float(turn):.6g} rad does not lead from "
                f"{float(angles[k]):.6g} to {float(angles[k + 1]):.6g} rad"
            )
    most = FINGERS[plan.steps[0].start.grasp.dimension] - 1  # fingers that hold while one moves
    states = [step.end for step in plan.steps[:-1]]
    between = [least_angle(state.grasp, state.forces) for state in states if len(state.in_use) <= most]
    # No force is farther inside its cone than along the normal.
    widest = max(contact.half_angle for step in plan.steps for contact in step.start.grasp.contacts)
    least = min([*between, widest])
    if not plan.margin <= least + float(RESOLUTION):
        broken.append(f"it claims a margin of {plan.margin:.6g} rad, its holds have {least:.6g}")
    return broken


def _turned(plan: Regrasp) -> list[Vector] | str:
    """The first load seen from the object at each of its angles."""
    fx, fy = exact(plan.steps[0].start.load.force.tolist())
    loads = []
    for angle in plan.orientations:
        c, s = cosine_sine(exact([angle])[0] - exact([plan.orientations[0]])[0])
        loads.append([c * fx + s * fy, c * fy - s * fx])
    return loads


def _rotated(plan: Regrasp) -> list[Vector] | str:
    """The same for the rotations of an object in space; or what is wrong with them.

    Each must be a rotation, and lead to the next by the turn of the step between.
    """
    rotations = getattr(plan, "rotations", None)
    count = len(plan.steps) + 1
    if rotations is None or rotations.shape != (count, 3, 3) or not np.isfinite(rotations).all():
        return f"{len(plan.steps)} steps in space need {count} rotations"
    matrices = [[exact(row) for row in matrix.tolist()] for matrix in rotations]
    first = _product(matrices[0], [[Fraction(x)] for x in plan.steps[0].start.load.force.tolist()])
    for k, matrix in enumerate(matrices):
        square = _product(_transposed(matrix), matrix)
        if _differ(square, [[Fraction(a == b) for b in range(3)] for a in range(3)]):
            return f"rotation {k + 1} is not orthonormal"
        if dot(cross(matrix[0], matrix[1]), matrix[2]) < 0:
            return f"rotation {k + 1} is a reflection"
    for k, step in enumerate(plan.steps):
        turn = step.turn
        turned = matrices[k]
        if turn is not None and turn.axis is not None:
            turned = _product(turned, _rotation(exact(turn.axis.tolist()), exact(turn.angles.tolist())[-1]))
        if _differ(turned, matrices[k + 1]):
            return f"step {k + 1}: its turn does not lead to the next rotation"
    return [[row[0] for row in _product(_transposed(matrix), first)] for matrix in matrices]


def _rotation(k: Vector, angle: Fraction) -> Matrix:
    """Rodrigues' formula, cos I + (1 - cos) k k' + sin [k]."""
    c, s = cosine_sine(angle)
    zero = Fraction(0)
    cross = [[zero, -k[2], k[1]], [k[2], zero, -k[0]], [-k[1], k[0], zero]]
    return [[c * (a == b) + (1 - c) * k[a] * k[b] + s * cross[a][b] for b in range(3)] for a in range(3)]


def _product(a: Matrix, b: Matrix) -> Matrix:
    return [[dot(row, list(column)) for column in zip(*b, strict=True)] for row in a]


def _transposed(a: Matrix) -> Matrix:
    return [list(column) for column in zip(*a, strict=True)]


def _differ(a: Matrix, b: Matrix) -> bool:
    pairs = zip(a, b, strict=True)
    return any(abs(x - y) > RESOLUTION for one, other in pairs for x, y in zip(one, other, strict=True))


def _where(contact: Contact) -> tuple[object, ...]:
    """Which contact it is, and all that it may do."""
    limits = (contact.friction, contact.max_force, contact.torsion, contact.limits)
    return (contact.name, *contact.position.tolist(), *contact.normal.tolist(), *limits)


def _held(state: GraspState) -> dict[tuple[object, ...], tuple[float, ...]]:
    """The contacts that carry force and their forces, bit for bit."""
    return {
        _where(contact): tuple(force.tolist())
        for contact, force in zip(state.grasp.contacts, state.forces, strict=True)
        if force.any()
    }
