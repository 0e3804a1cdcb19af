"""What may be given more of, or asked less of, so that a refused call has an answer."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.force_limits import ForceLimits
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.state import GraspState
from regrasp.planning.states.criteria import ChosenForces, ChosenState, Criteria
from regrasp.planning.states.refusals.least_values import MOST_FRICTION

_MOST = 1e3  # force limits, rates and joint torques are tried up to so many times what they are
_SHORTEST, _LONGEST = 1e-3, 10.0  # torsions between so many times the size of the grasp


@dataclass(frozen=True)
class Way:
    """One way to help: by an amount, which is at contacts, in options and in ``Criteria`` alike.

    Args:
        words: with a place for the amount.
        contact: a contact with the amount.
        options: by name, which ``Criteria`` share: the option with the amount.
        now: the amount that changes nothing.
        most: the amount that helps most; for 0 less helps more.
    """

    words: str
    contact: Callable[[Contact, float], Contact] | None = None
    options: Mapping[str, Callable[[Any, float], Any]] = field(default_factory=dict)
    now: float = 1.0
    most: float = 0.0

    def applied(self, name: str, value: Any, amount: float) -> Any:
        """An argument with the amount in it.

        Args:
            name: of the argument.
            value: of any type.
            amount: between ``now`` and ``most``.
        """
        if name in self.options and value is not None:
            return self.options[name](value, amount)
        if isinstance(value, Criteria):
            given = {n: getattr(value, n) for n in self.options if getattr(value, n, None) is not None}
            return replace(value, **{n: self.options[n](v, amount) for n, v in given.items()})
        if self.contact is None and not isinstance(value, ChosenState):
            return value
        if isinstance(value, Contact):
            return self._touching(value, amount)
        if isinstance(value, Grasp):
            return Grasp(self._touching(contact, amount) for contact in value)
        if isinstance(value, ChosenState):
            grasp, criteria = (self.applied("", v, amount) for v in (value.grasp, value.criteria))
            forces = _as_wide(value.forces, grasp)
            chosen = ChosenForces(forces, value.force_limits, value.method, value.gap)
            return ChosenState(grasp, value.load, criteria, chosen)
        if isinstance(value, GraspState):
            grasp = self.applied("", value.grasp, amount)
            return GraspState(grasp, value.load, _as_wide(value.forces, grasp))
        if isinstance(getattr(value, "grasp", None), Grasp):
            return replace(value, grasp=self.applied("", value.grasp, amount))
        if isinstance(value, list | tuple):
            return [self.applied("", v, amount) for v in value]
        return value

    def _touching(self, contact: Contact, amount: float) -> Contact:
        return contact if self.contact is None else self.contact(contact, amount)


def _as_wide(forces: Array, grasp: Grasp) -> Array:
    """The forces, with no torques about the normals where fingers have become soft."""
    return np.pad(forces, ((0, 0), (0, grasp.width - forces.shape[1])))


def ways_for(
    contacts: Sequence[Contact], given: Mapping[str, Any], criteria: Sequence[Criteria]
) -> list[Way]:
    """The ways that there are, of what limits the contacts, the options and the criteria.

    Args:
        contacts: all that are in play.
        given: options by name.
        criteria: those given in their place, and those that a state was chosen by.
    """

    def asked(name: str) -> list[Any]:
        found = [given.get(name), *(getattr(c, name, None) for c in criteria)]
        return [value for value in found if value is not None]

    ways = [_friction(min(c.friction for c in contacts))]
    forces = [c.max_force for c in contacts if c.max_force is not None] + asked("max_force")
    if forces:
        ways.append(_force(min(forces), _MOST * max(forces)))
    if any(c.limits is not None for c in contacts):
        ways.append(_LINEAR)
    if any(np.any(value) for value in asked("min_normal")):
        ways.append(_NORMAL)
    if any(value > 1e-6 for value in asked("reserve")):
        ways.append(_RESERVE)
    if asked("disturbance"):
        ways.append(_DISTURBANCE)
    if asked("rate_limit"):
        ways.append(_RATE)
    return ways


def torsion(contacts: Sequence[Contact]) -> Way | None:
    """Soft fingers, in space.

    Args:
        contacts: all that are in play.
    """
    if contacts[0].dimension == 2 or all(c.friction == 0 for c in contacts):
        return None
    size = max(float(abs(c.position).max()) for c in contacts) or 1.0

    def soft(contact: Contact, amount: float) -> Contact:
        return contact.changed(torsion=max(contact.torsion or 0.0, amount) if contact.friction else None)

    return Way("a torsion of {:g} at every contact", soft, {}, _SHORTEST * size, _LONGEST * size)


def _friction(now: float) -> Way:
    def rough(contact: Contact, amount: float) -> Contact:
        return contact.changed(friction=max(contact.friction, amount))

    return Way("a friction of at least {:g} at every contact", rough, {}, now, max(MOST_FRICTION, now))


def _force(now: float, most: float) -> Way:
    def strong(contact: Contact, amount: float) -> Contact:
        return (
            contact
            if contact.max_force is None
            else contact.changed(max_force=max(contact.max_force, amount))
        )

    return Way("force limits of at least {:g}", strong, {"max_force": max}, now, most)


def _larger(value: Any, amount: float) -> Any:
    return (np.asarray(value, dtype=float) * amount).tolist()


def _less(value: Any, amount: float) -> Any:
    scaled = np.asarray(value, dtype=float) * amount
    return tuple(scaled.tolist()) if scaled.ndim else float(scaled)


def _loose(contact: Contact, amount: float) -> Contact:
    limits = contact.limits
    return contact if limits is None else contact.changed(limits=ForceLimits.scaled(limits, amount))


def _smaller(loads: LoadSet, amount: float) -> LoadSet | None:
    return loads.scaled(amount) if amount else None


_LINEAR = Way("linear limits {:g} times as large", _loose, {}, 1.0, _MOST)
_NORMAL = Way("min_normal at most {:g} times as large", None, {"min_normal": _less})
_RESERVE = Way("a reserve at most {:g} times as large", None, {"reserve": _less})
_DISTURBANCE = Way("a disturbance at most {:g} times as large", None, {"disturbance": _smaller})
_RATE = Way("rate limits {:g} times as high", None, {"rate_limit": _larger}, 1.0, _MOST)
