"""The states a turn goes through: at steps of the angle, nearer where forces would grow too large between.

Between two states Delta apart forces grow by 1 / cos(Delta / 2) at most (docs/facts.md, 6), so that halving a
step ends wherever the limits leave any room at all.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from math import cos, inf, pi
from typing import NamedTuple

import numpy as np

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.rotated import load_between, turned_load
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.given_ends import eased
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import ChosenForces, Criteria
from regrasp.plans.turning import TurningPath

STEP = pi / 3
"""Largest angle between two states of a turn if there are any: forces grow by 1 / cos(pi / 6) = 1.155."""

FINEST = STEP / 2**10
"""Where forces between two states are too large the step is halved, down to this: they grow by 1e-7 there."""

# A step this near to pi lets forces grow without bound.
_NEARLY_PI = 0.95 * pi

Knot = tuple[float, Array]
"""An angle of the object [rad] and the forces (n, w) there [N]."""


class Chooser(NamedTuple):
    """Chooses states of one grasp at angles of the object."""

    grasp: Grasp
    load: Wrench
    criteria: Criteria
    how: tuple[str, int | None]
    """Method and facets."""
    ease: float
    """Fraction of the force limits that leaves room for the growth of forces between two states."""
    axis: Array | None

    def at(self, angle: float) -> ChosenForces:
        """The best forces after a turn by ``angle``, within eased limits if there are any."""
        return self.under(turned_load(self.load, angle, self.axis))

    def under(self, load: Wrench) -> ChosenForces:
        """The best forces under a load, within eased limits if there are any."""
        grasp, criteria = self.grasp, self.criteria
        if any(contact.max_force is not None or contact.limits is not None for contact in grasp):
            less = eased(grasp, self.ease)
            try:
                return choose_forces(less, load, replace(criteria, max_force=None), *self.how)
            except Infeasible:
                pass  # the whole limits may do, and the path is checked in the end
        return choose_forces(grasp, load, criteria, *self.how)


def on_the_way(chooser: Chooser, turn: float, count: int, first: Array, last: Array) -> list[Knot]:
    """Angles and forces at ``count`` equal steps, without those at which no state exists."""
    knots = [(0.0, first)]
    reason: Infeasible | None = None
    for k in range(1, count):
        try:
            knots.append((turn * k / count, reached(chooser, turn * k / count)))
        except Infeasible as refusal:
            reason = reason or refusal
    knots.append((turn, last))
    widest = max(abs(b - a) for (a, _), (b, _) in pairwise(knots))
    if widest > _NEARLY_PI and reason is not None:
        raise reason
    return knots


Between = Callable[[Chooser, Knot, Knot], Array | None]
"""The state between two, or None where none is needed; ``Infeasible`` where these are too far apart."""


def halved(chooser: Chooser, knots: list[Knot], between: Between) -> TurningPath:
    """The path through states, and more of them between two where ``between`` finds those too far apart."""
    done, middles, ahead = [knots[0]], [], knots[:0:-1]
    while ahead:
        (a, _), (b, _) = before, after = done[-1], ahead[-1]
        try:
            middles.append(between(chooser, before, after))
            done.append(ahead.pop())
        except Infeasible:
            if abs(b - a) <= FINEST:
                raise
            # Beside a force at its limit, one that is smaller by the cosine of the step makes no crest.
            closer = chooser._replace(ease=cos((b - a) / 2) * (1 - 1e-9))
            ahead.append(((a + b) / 2, reached(closer, (a + b) / 2)))
    arcs = [middle for middle in middles if middle is not None]
    return TurningPath([a for a, _ in done], [f for _, f in done], chooser.axis, arcs or None)


def within_limits(chooser: Chooser, before: Knot, after: Knot) -> None:
    """Raise ``Infeasible`` where a force between two states exceeds its limit; no state is needed there."""
    limits, rows = chooser.grasp.max_forces, chooser.grasp.limit_rows
    if not (limits < inf).any() and rows is None:
        return
    (a, f), (b, g) = before, after
    ends = [
        GraspState(chooser.grasp, turned_load(chooser.load, x, chooser.axis), y) for x, y in (before, after)
    ]
    path = TurningPath([0.0, b - a], [f, g], chooser.axis)
    spare = path.spare(ends[0], ends[1])
    if (spare < 0).any():
        who = chooser.grasp.names[int(spare.argmin())]
        raise Infeasible(
            f"{who} would break its linear limits by {-spare.min():.4g} between turns of {a:.6g} and {b:.6g} "
            f"rad; choose states with less force, or loosen them"
        )
    _refuse_what_gives_between(chooser, before, after)
    peaks = path.peaks(ends[0], ends[1])
    for contact, peak in zip(chooser.grasp, peaks.tolist(), strict=True):
        if contact.max_force is not None and peak > contact.max_force:
            raise Infeasible(
                f"{contact.name} would need {peak:.6g} between turns of {a:.6g} and {b:.6g} rad, above its "
                f"limit {contact.max_force:g}; choose states with less force, or allow more"
            )


def _refuse_what_gives_between(chooser: Chooser, before: Knot, after: Knot) -> None:
    """Raise ``Infeasible`` where forces between two states and a deviation exceed a limit.

    The arc lies in the triangle of both states and m = (f + g) / (1 + cos Delta), where its tangents meet,
    and what withstands a set is convex. So do limits with the part cos(Delta / 2) of them at both states, by
    which forces grow at most. Cones need neither: both states keep to them.
    """
    criteria, grasp = chooser.criteria, chooser.grasp
    demand = criteria.demand(grasp) if criteria.withstands else None
    if demand is None:
        return
    (a, f), (b, g) = before, after
    limits = np.array(criteria.limits(grasp))
    spare = demand.spare(grasp.cones.measured((f + g) / (1 + cos(b - a))), limits)
    if spare >= 0:
        return
    less = eased(grasp, cos((b - a) / 2) * (1 - 1e-9))
    by_part = replace(criteria, max_force=None).demand(less)
    assert by_part is not None
    part = np.array(replace(criteria, max_force=None).limits(less))
    if min(by_part.spare(grasp.cones.measured(x), part) for x in (f, g)) < 0:
        raise Infeasible(
            f"some finger would miss its limit under the disturbance by {-spare:.4g} N between turns of "
            f"{a:.6g} and {b:.6g} rad; choose states with less force, or allow more"
        )


def middle(chooser: Chooser, before: Knot, after: Knot) -> Array:
    """Forces under the load where the tangents of its arc at two angles meet."""
    (a, _), (b, _) = before, after
    return reached(chooser, (a + b) / 2, load_between(chooser.load, a, b, chooser.axis))


def reached(chooser: Chooser, angle: float, load: Wrench | None = None) -> Array:
    """The forces chosen after a turn by ``angle`` [rad], or under a load of its own there."""
    try:
        return np.array((chooser.at(angle) if load is None else chooser.under(load)).forces)
    except Infeasible as refusal:
        raise Infeasible(f"after a turn of {angle:.6g} rad: {refusal}", refusal.certificate) from None
