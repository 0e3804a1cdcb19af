"""The verdict on ways through the air: sampled at a tenth of the clearance, from the mathematics again.

Between samples a finger moves by no more than that tenth, so what the samples keep is kept less a tenth.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, items, number, point
from regrasp.mechanics.value import ArrayValue
from regrasp.verification.ways.distances import points_of_axis, to_axis, to_boundary, to_faces, within
from regrasp.verification.ways.held import contacts_of, jumps, lost, touched

_PART = 10  # of the clearance: how far fingers move between samples
_MOST = 1_000_000  # samples
_SAME = 1e-6  # of the clearance: places that are one
_NEAR = 1e-3  # of the clearance: what polygons may be off
_ROUNDING = 1e-12  # of the duration


class Moving(Protocol):
    """Ways of the fingers of a plan, whoever made them."""

    @property
    def tip_radius(self) -> float: ...  # noqa: D102
    @property
    def clearance(self) -> float: ...  # noqa: D102
    @property
    def capsules(self) -> Array: ...  # noqa: D102
    @property
    def steps(self) -> tuple[Any, ...]: ...  # noqa: D102
    @property
    def starts(self) -> Array: ...  # noqa: D102
    @property
    def duration(self) -> float: ...  # noqa: D102
    def positions(self, t: Array) -> Array: ...  # noqa: D102
    def velocities(self, t: Array) -> Array: ...  # noqa: D102
    def touching(self, t: Array) -> NDArray[np.bool_]: ...  # noqa: D102


@dataclass(frozen=True, eq=False)
class MotionsVerification(ArrayValue):
    """The verdict on ways through the air.

    Args:
        violations: each broken condition in words; none for ways that keep everything.
        to_object: the least distance of a finger's surface from the object, away from contacts [m].
        to_fingers: the least distance of two fingers' surfaces while one moves [m]; infinite without any.
        touching: how many fingers are at contacts, at the least.
        samples: how many instants were looked at.
    """

    violations: tuple[str, ...]
    to_object: float
    to_fingers: float
    touching: int
    samples: int

    @property
    def ok(self) -> bool:
        """Whether no finger passes through anything, jumps or lets go of a contact that it is needed at."""
        return not self.violations

    def __str__(self) -> str:
        if not self.ok:
            return "\n".join(["ways not verified:", *(f"  {violation}" for violation in self.violations)])
        return (
            f"ways verified at {self.samples} instants: fingers keep {self.to_object:.4g} from the object "
            f"and {self.to_fingers:.4g} from one another, {self.touching} or more touch at every instant"
        )


def verify_motions(motions: Moving, shape: Any) -> MotionsVerification:
    """Check the ways of a plan's fingers, at instants between which none moves by a tenth of the clearance.

    No finger may be in the object or another one, or nearer than the clearance but on the normal of a
    contact; positions are what velocities say; a finger that touches is at a contact of the plan, every
    contact of a step has a finger during it, and two fingers, in space three, touch at every instant.

    Args:
        motions: what ``plan_motions`` returns, or any object with the same attributes.
        shape: the ``Outline`` or ``Mesh`` that they go around.

    Raises:
        InvalidInput: For what is no motions or no shape, and for more than a million instants.
    """
    if not all(hasattr(motions, name) for name in ("positions", "velocities", "touching", "capsules")):
        raise InvalidInput(f"verify_motions needs motions, got {shown(motions)}")
    if not hasattr(shape, "polygon") and not hasattr(shape, "surface"):
        raise InvalidInput(f"verify_motions needs an Outline or a Mesh, got {shown(shape)}")
    _check_numbers(motions)
    ends = _ends(motions)
    t, at = _sampled(motions, ends)
    if len(motions.capsules) != at.shape[1]:
        raise InvalidInput(
            f"motions of {at.shape[1]} fingers need as many capsules, got {len(motions.capsules)}"
        )
    touching, keep = motions.touching(t), motions.clearance
    reach, slack, near = motions.tip_radius, _NEAR * keep, _SAME * keep
    on = touched(motions.steps, at, touching, reach, near)
    during = [(t >= begin) & (t <= end) for begin, end in ends]
    violations = [
        *jumps(t, at, motions.velocities(t), near),
        *_late(ends, float(t[-1])),
        *lost(t, motions.steps, during, touching, on, at.shape[2]),
    ]
    moving = np.ones(at.shape[:2], dtype=bool)  # from then on, or it is the end: where fingers rest, too
    moving[:-1] = (at[1:] != at[:-1]).any(axis=2)
    fingers = [points_of_axis(at[:, i], v, keep / 2) for i, v in enumerate(motions.capsules)]
    to_object = to_fingers = np.inf
    for i, axis in enumerate(fingers):
        rows = np.flatnonzero(moving[:, i])
        away = _away(shape, axis[rows], slack) - reach
        if away.min() < -_depth(shape, reach, slack):
            when = t[rows[away.argmin()]]
            violations.append(f"finger {i + 1} is in the object by {-away.min():.3g} at {when:.6g} s")
        free = away[~_lifting(motions, at[rows, i])]
        to_object = min(to_object, float(free.min(initial=np.inf)))
    if to_object < keep - slack:
        violations.append(
            f"a finger off its contacts comes within {to_object:.6g} of the object, less than {keep:g}"
        )
    for i, j in combinations(range(len(fingers)), 2):
        rows = np.flatnonzero(moving[:, i] | moving[:, j])
        between = to_axis(fingers[i][rows], at[rows, j], motions.capsules[j])
        to_fingers = min(to_fingers, float(between.min(initial=np.inf)) - 2 * reach)
    if to_fingers < keep - slack:
        violations.append(f"two fingers come within {to_fingers:.6g} of one another, less than {keep:g}")
    return MotionsVerification(
        tuple(violations), to_object, to_fingers, int(touching.sum(axis=1).min()), t.size
    )


def _check_numbers(motions: Moving) -> None:
    """Raise ``InvalidInput`` for what no distance can be compared with, or is measured from."""
    for what in ("tip_radius", "clearance", "duration"):
        number(getattr(motions, what), f"{what} of motions", above=0)
    for i, axis in enumerate(items(motions.capsules, "capsules of motions")):
        point(axis, f"capsule {i + 1} of motions")


def _sampled(motions: Moving, ends: list[tuple[float, float]]) -> tuple[Array, Array]:
    """Times between which no finger moves by more than a tenth of the clearance, and positions then.

    The middle of each step is one of them, however short it is.
    """
    middles = [m for begin, end in ends if 0 < (m := (begin + end) / 2) < motions.duration]
    count = 1025
    while count < _MOST:
        t = np.union1d(np.linspace(0.0, motions.duration, count), middles)
        at = motions.positions(t)
        if np.linalg.norm(np.diff(at, axis=0), axis=2).max() <= motions.clearance / _PART:
            return t, at
        count = 2 * count - 1
    raise InvalidInput(f"ways move or jump by more than a tenth of the clearance between {_MOST} instants")


def _ends(motions: Moving) -> list[tuple[float, float]]:
    """When each step begins and ends."""
    if len(motions.starts) < len(motions.steps):
        raise InvalidInput(
            f"motions of {len(motions.steps)} steps need as many starts, got {len(motions.starts)}"
        )
    return [(motions.starts[k], motions.starts[k] + step.duration) for k, step in enumerate(motions.steps)]


def _late(ends: list[tuple[float, float]], whole: float) -> Iterator[str]:
    """Steps that begin before the last one ends, or end after the ways."""
    over, room = 0.0, _ROUNDING * whole
    for k, (begin, end) in enumerate(ends):
        if not over - room <= begin < end <= whole + room:  # which no number fails, too
            between = f"after {over:.6g} and until {whole:.6g} s"
            yield f"step {k + 1} lasts from {begin:.6g} to {end:.6g} s, not {between}"
        over = end


def _away(shape: Any, axis: Array, slack: float) -> Array:
    """(m,) the least distance of axes (m, s, d) from the object [m]."""
    points = axis.reshape(-1, axis.shape[-1])
    if hasattr(shape, "surface"):
        vertices, faces = shape.surface()
        away = to_faces(points, vertices[faces])
        first = axis.shape[1]  # who begins outside comes through no face unseen
        away[:first][within(points[:first], vertices[faces])] *= -1
    else:
        away = to_boundary(points, shape.polygon(slack))
    return np.asarray(away.reshape(axis.shape[:2]).min(axis=1))


def _depth(shape: Any, radius: float, slack: float) -> float:
    """How far a tip may be in the object at a contact: faces of a smooth mesh lean against its normals."""
    lean = 1 - np.cos(shape.crease / 2) if hasattr(shape, "surface") and shape.smooth else 0.0
    return float(radius * lean + 2 * slack)


def _lifting(motions: Moving, tips: Array) -> NDArray[np.bool_]:
    """(m,) whether tips (m, d) are on the normal of a contact, no farther off than a lift is high."""
    high = 4 * (motions.tip_radius + 2 * motions.clearance)
    result = np.zeros(len(tips), dtype=bool)
    for contact in contacts_of(motions.steps).values():
        off = tips - (contact.position - motions.tip_radius * contact.normal)
        h = -off @ contact.normal
        aside = np.linalg.norm(off + h[:, None] * contact.normal, axis=1)
        result |= (aside <= _SAME * motions.clearance) & (h >= -_SAME * motions.clearance) & (h <= high)
    return result
