"""Linear limits of a finger's force, and those that the torques of its joints make."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, number, numbers_in, point
from regrasp.mechanics.orientation.tangents import tangents_of
from regrasp.mechanics.plain import entries
from regrasp.mechanics.value import ArrayValue


@dataclass(frozen=True, eq=False, repr=False)
class ForceLimits(ArrayValue):
    """Linear limits A f <= b of a finger's force f in the frame of its contact, for ``Contact(limits=)``.

    The frame is (normal, tangent) in the plane, the tangent the normal turned left by a right angle, and
    (normal, first tangent, second tangent) in space, as ``Grasp.tangents`` has them; of a soft finger its
    torque about the normal may come last.

    Args:
        rows: A, (m, k): m limits of k = d numbers, or d + 1 of a soft finger [any unit per N, N m].
        bounds: b, (m,), in the rows' units; greater than 0, so that a finger may rest: a least normal force
            is ``min_normal``.

    Raises:
        InvalidInput: For other shapes, rows of zeros, and bounds that are not greater than 0.
    """

    rows: Array
    bounds: Array

    def __init__(self, rows: ArrayLike, bounds: ArrayLike) -> None:
        given = array(rows, "rows of limits", (None, None))
        most = array(bounds, "bounds of limits", (len(given),))
        if not len(given):
            raise InvalidInput("limits must have one row or more; leave them out for none")
        if not given.any(axis=1).all():
            raise InvalidInput(f"rows of limits must not be zero, got {shown(given.tolist())}")
        if not (most > 0).all():
            raise InvalidInput(
                f"bounds of limits must be greater than 0, so that a finger may rest, got "
                f"{shown(most.tolist())}; a least normal force is min_normal"
            )
        object.__setattr__(self, "rows", given)
        object.__setattr__(self, "bounds", most)

    def scaled(self, factor: float) -> "ForceLimits":
        """The same limits with bounds times a factor.

        Args:
            factor: greater than 0 [-].
        """
        return ForceLimits(self.rows, number(factor, "factor", above=0) * self.bounds)

    def to_dict(self) -> dict[str, Any]:
        """The limits as plain data, which JSON can hold; ``from_dict`` gives back the equal limits."""
        return {"rows": self.rows.tolist(), "bounds": self.bounds.tolist()}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "ForceLimits":
        """The limits of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``ForceLimits`` does.
        """
        return cls(**entries(data, "limits", ("rows", "bounds")))

    def __repr__(self) -> str:
        return f"ForceLimits({self.rows.tolist()}, {self.bounds.tolist()})"


def torque_limits(jacobian: ArrayLike, torques: ArrayLike, *, normal: ArrayLike | None = None) -> ForceLimits:
    """The limits of a finger's force that the torques of its joints make: lower <= J' f <= upper.

    A finger that pushes with f holds tau = J' f at its joints, J the rates of its tip per joint rate. What
    the joints need besides, for the finger's own weight, is taken from the torques given.

    Args:
        jacobian: (d, joints) tip velocity per joint rate [m/rad]; (d + 1, joints) of a soft finger, the last
            row its spin about the normal [-]. In the frame of the contact (``ForceLimits``), or in the
            object's frame if ``normal`` is given.
        torques: the largest torque of every joint either way [N m]: a number, (joints,), or (joints, 2) with
            a lower one below 0 and an upper one above 0; infinite for none.
        normal: (d,) of the contact, object frame, of any length but zero: if the Jacobian is in that frame.

    Raises:
        InvalidInput: For other shapes, torques that leave no room around 0, and no limits at all.
    """
    given = array(jacobian, "jacobian", (None, None))
    rows, joints = given.shape
    if rows not in (2, 3, 4) or not joints:
        raise InvalidInput(
            f"jacobian must have 2, 3 or 4 rows and a column for each joint, got {given.shape}"
        )
    if normal is not None:
        across = point(normal, "normal")
        d = across.size
        if rows not in (d, d + 1) or not across.any():
            raise InvalidInput(
                f"normal must be (d,), not zero, for a jacobian of d rows, or d + 1 of a soft finger, got "
                f"{d} and {rows}"
            )
        unit = across / np.linalg.norm(across)
        frame = np.vstack([unit, tangents_of(unit[None])[0]])
        given = np.vstack([frame @ given[:d], given[d:]])
    lower, upper = _both_ways(torques, joints)
    whole = np.vstack([given.T, -given.T])
    bounds = np.concatenate([upper, -lower])
    binds = (bounds < inf) & whole.any(axis=1)
    if not binds.any():
        raise InvalidInput("torques limit no force: all are infinite, or no joint moves the tip")
    return ForceLimits(whole[binds], bounds[binds])


def _both_ways(torques: ArrayLike, joints: int) -> tuple[Array, Array]:
    values = numbers_in(torques, "torques must be numbers")
    if values.shape not in ((), (joints,), (joints, 2)):
        raise InvalidInput(
            f"torques must be a number, ({joints},) or ({joints}, 2), one for each joint, got {values.shape}"
        )
    if np.isnan(values).any():
        raise InvalidInput("torques must be numbers, got some that are none")
    if values.ndim == 2:
        lower, upper = values.T
    else:
        upper = np.broadcast_to(values, joints)
        lower = -upper
    if not ((lower < 0) & (upper > 0)).all():
        raise InvalidInput(
            f"torques must be greater than 0, or pairs of a lower one below 0 and an upper one above 0, got "
            f"{shown(values.tolist())}"
        )
    return lower, upper
