"""How far a load can grow before no forces balance it."""

from dataclasses import dataclass, field
from math import inf

import numpy as np

from regrasp.errors import InvalidInput, SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState, check_load
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.escape import infeasible
from regrasp.planning.states.linear.row_duals import escape_by_rows
from regrasp.planning.states.separation import cleared
from regrasp.planning.states.solving import force_unit
from regrasp.planning.surveys.extremes.load_reach import Reached, farthest, half_plane, held_state

_NOTHING = 1e-9
_FAR = 1e3
_ABOVE = (1e-12, 1e-9, 1e-7, 1e-5)


@dataclass(frozen=True, eq=False, repr=False)
class LargestLoad(ArrayValue):
    """The largest factor by which the wrench ``direction`` may be scaled, on top of ``base``.

    Args:
        grasp: the contacts that hold.
        direction: of the load, object frame, of any length but zero.
        base: external wrench that stays as it is, object frame [N, N m]; None for none.
        factor: [-], proven by ``state``, which balances base + factor direction; infinite where it has no
            limit, ``state`` then balances the direction alone.
        bounds: (factor, upper): forces beyond are proven not to exist.
        state: a state.
        escape: the twist that proves it just above the upper bound; None where there is no bound.
    """

    grasp: Grasp
    direction: Wrench
    base: Wrench | None
    factor: float
    bounds: tuple[float, float]
    state: GraspState = field(compare=False)
    escape: EscapeTwist | None = field(compare=False)

    @property
    def load(self) -> Wrench:
        """The largest load; raises ``InvalidInput`` where there is none."""
        if self.factor == inf:
            raise InvalidInput("the load has no largest value in this direction; give max_force")
        scaled = self.factor * self.direction
        return scaled if self.base is None else self.base + scaled

    def __float__(self) -> float:
        return self.factor

    def __str__(self) -> str:
        most = "any factor" if self.factor == inf else f"factors up to {self.factor:.6g}"
        why = "" if self.escape is None else f"; beyond, the object escapes by {self.escape}"
        return f"{', '.join(self.grasp.names)} hold {most} of {self.direction!r}{why}"

    def __repr__(self) -> str:
        return f"LargestLoad({self})"


def largest_load(
    grasp: Grasp, direction: Wrench, base: Wrench | None = None, *, max_force: float | None = None
) -> LargestLoad:
    """The largest factor of the wrench ``direction`` that forces balance, on top of ``base``.

    Args:
        grasp: the contacts that hold.
        direction: of the load, object frame, of any length but zero.
        base: external wrench that stays as it is, object frame [N, N m].
        max_force: limits every force besides the contacts' own limits [N]. Friction counts in full. Of two
            planar contacts without limits in closed form, else by one conic program; forces prove the factor
            from below and a twist, the program's dual, the bound from above, both checked.

    Raises:
        Infeasible: Where no factor above 0 is held and the base is not.
        InvalidInput: For bad input.
    """
    check_load(grasp, direction)
    if not direction.vector.any():
        raise InvalidInput("direction must not be zero: the load would not change")
    if base is not None:
        check_load(grasp, base)
    limits = Criteria("effort", max_force, reserve=0.0).limits(grasp)
    one = force_unit(grasp, direction)  # of the factor
    unit = _unit_of_forces(grasp, base, limits, one)
    start = (base.vector if base is not None else np.zeros_like(direction.vector)) / unit
    along = direction.vector[:, None] / one
    scaled = [limit / unit for limit in limits]
    found = farthest(grasp, start, along, np.ones(1), scaled, unit=unit)
    if found.k is not None and found.is_unbounded and _is_held_somewhere(grasp, start, along, scaled, unit):
        ray = Reached(np.ones(1), found.forces / float(found.k[0]), found.twist)
        of_one = [limit / one for limit in limits]
        if (held := held_state(grasp, 0 * start, along, ray, np.ones(1), of_one, one)) is not None:
            return LargestLoad(grasp, direction, base, inf, (inf, inf), held[1], None)
    k = found.k
    held = None
    if k is not None and not found.is_unbounded:
        found = found._replace(k=np.zeros(1)) if abs(k[0]) < _NOTHING else found
        if found.k is not None and found.k[0] >= 0:
            held = held_state(grasp, start, along, found, np.zeros(1), scaled, unit)
    if held is None:  # there may still be one factor, where base and direction cancel
        reason = infeasible(
            grasp, direction if base is None else base, Criteria("effort", max_force, reserve=0.0)
        )
        if reason.certificate is None and k is not None:
            raise SolverFailed(
                f"no forces were found for the largest factor, about {float(k[0]) * (unit / one):.6g}"
            )
        raise reason
    factor = float(held[0][0]) * (unit / one)
    normal, upper = half_plane(grasp, start, along, found.twist, scaled, found.row_duals, unit)
    upper = max(upper * (unit / one), factor) if normal[0] > 0 else inf
    escape = None if upper == inf else _escape(grasp, direction, base, found, limits, upper)
    return LargestLoad(grasp, direction, base, factor, (factor, upper), held[1], escape)


def _unit_of_forces(grasp: Grasp, base: Wrench | None, limits: list[float], one: float) -> float:
    """Of what the largest load will be [N]: ``one``, unless limits of all forces, or the base, are far."""
    finite = [limit for limit in limits if limit < inf]
    if len(finite) == len(limits):
        size = max(finite)
    elif base is not None and base.vector.any():
        size = force_unit(grasp, base)
    else:
        size = max(finite, default=one)
    return one if one / _FAR <= size <= one * _FAR else size


def _is_held_somewhere(grasp: Grasp, base: Array, along: Array, limits: list[float], unit: float) -> bool:
    """Whether base + k direction is balanced for some k."""
    if not base.any():
        return True
    found = farthest(grasp, base, along, np.zeros(1), limits, unit=unit)
    return (
        found.k is not None and held_state(grasp, base, along, found, found.k + 1, limits, unit) is not None
    )


def _escape(
    grasp: Grasp, direction: Wrench, base: Wrench | None, found: Reached, limits: list[float], upper: float
) -> EscapeTwist | None:
    """The proof that a load just above the upper bound is not balanced."""
    mu, twist = tuple(grasp.frictions.tolist()), found.twist
    for step in _ABOVE:
        load = (upper * (1 + step) or step) * direction
        load = load if base is None else base + load
        if grasp.limit_rows is not None:
            by_rows = escape_by_rows(grasp, load, twist, found.row_duals, list(mu), limits)
            if by_rows is not None:
                return by_rows
            continue
        for motion in (twist, cleared(grasp, twist, list(mu), limits)):
            proof = EscapeTwist(grasp, load, motion / float(abs(motion).max()), mu, tuple(limits))
            if proof.is_proof:
                return proof
    return None
