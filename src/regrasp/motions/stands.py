"""Where a finger is at a contact and off it."""

from collections.abc import Iterator

import numpy as np

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.motions.planar_space import PlanarSpace
from regrasp.motions.shut_in import ShutIn
from regrasp.motions.solid_space import SolidSpace
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

# A tip without clearance at this many times the height at which it has it off a straight side is shut in.
_LIFT = 4.0

Space = PlanarSpace | SolidSpace

Place = tuple[str, bool]
"""A contact, and whether the finger touches there or stands off it."""


class Stand:
    """Where a tip is at a contact and off it; how far it lifts along the normal to be in free space."""

    def __init__(self, name: str, contact: Contact, space: Space) -> None:
        self.name, self.contact = name, contact
        self._touch = contact.position - space.tip_radius * contact.normal
        heights = np.linspace(0, _LIFT, 200) * (space.reach + space.room - space.tip_radius)
        away = space.distance(self._touch - heights[:, None] * contact.normal)
        free = away >= space.reach + space.room
        self.exit = float(heights[free.argmax()]) if free.any() else np.inf
        rising = self._touch - heights[: max(1, int(free.argmax())), None] * contact.normal
        if not free.any() or space.cuts(rising, contact):
            finger = "a capsule" if space.capsule.any() else "a tip"
            raise Infeasible(
                f"{finger} of radius {space.tip_radius:g} is shut in at {name}, {self.where}: along the "
                f"normal it gets no clearance of {space.clearance:g}",
                ShutIn(-1, -1, name, contact.position, name, name, (), True),
            )
        self._off = self._touch - (self.exit + space.clearance) * contact.normal

    @property
    def where(self) -> str:
        """The contact point, in words."""
        return f"({', '.join(f'{x:.6g}' for x in self.contact.position.tolist())})"

    def tip(self, touches: bool) -> Array:
        """(d,) the tip's centre."""
        return self._touch if touches else self._off


def stops(plan: Transition | RegraspPlan, steps: tuple[Transition, ...]) -> Iterator[tuple[Place, ...]]:
    """The places of all fingers before anything, during each step and after the last."""
    fingers = plan.fingers if isinstance(plan, RegraspPlan) else (steps[0].grasp.names,)
    last = [str(name) for name in fingers[0]]
    yield tuple((name, name not in steps[0].arriving) for name in last)
    for at in fingers:
        last = [old if name is None else name for name, old in zip(at, last, strict=True)]
        yield tuple((name, here is not None) for name, here in zip(last, at, strict=True))
    yield tuple(
        (name, here is not None and name not in steps[-1].leaving)
        for name, here in zip(last, at, strict=True)
    )
