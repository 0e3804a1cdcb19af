"""The verdict on a whole regrasp: every step, and every joint between two steps."""

from fractions import Fraction
from typing import Protocol

from regrasp.mechanics.state import GraspState
from regrasp.verification.exact import RESOLUTION, Vector, dot, exact
from regrasp.verification.protocols import Plan
from regrasp.verification.turned import cosine_sine

Matrix = list[Vector]
# No more fingers than these touch the object at once, in the plane and in space.
FINGERS = {2: 3, 3: 4}


class Regrasp(Protocol):
    """What ``verify`` needs to know of a regrasp."""

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
    broken = []
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
        for label, state, at in (("start", step.start, k), ("end", step.end, k + 1)):
            seen, angle = loads[at], plan.orientations[at]
            given = exact(state.load.force.tolist())
            off = [a - b for a, b in zip(given, seen, strict=True)]
            if dot(off, off) > RESOLUTION**2 * dot(seen, seen) or state.load.torque.any():
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
    if rotations is None or rotations.shape != (len(plan.steps) + 1, 3, 3):
        return f"{len(plan.steps)} steps in space need {len(plan.steps) + 1} rotations"
    matrices = [[exact(row) for row in matrix.tolist()] for matrix in rotations]
    first = _product(matrices[0], [[Fraction(x)] for x in plan.steps[0].start.load.force.tolist()])
    for k, matrix in enumerate(matrices):
        square = _product(_transposed(matrix), matrix)
        if _differ(square, [[Fraction(a == b) for b in range(3)] for a in range(3)]):
            return f"rotation {k + 1} is not orthonormal"
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


def _where(contact: object) -> tuple[float, ...]:
    return (*contact.position.tolist(), *contact.normal.tolist(), contact.friction)  # type: ignore[attr-defined]


def _held(state: GraspState) -> dict[tuple[float, ...], tuple[float, ...]]:
    """The contacts that carry force and their forces, bit for bit."""
    return {
        _where(contact): tuple(force.tolist())
        for contact, force in zip(state.grasp.contacts, state.forces, strict=True)
        if force.any()
    }
