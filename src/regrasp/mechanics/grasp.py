"""A set of contacts and its grasp matrix."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, finite, items, read_only
from regrasp.mechanics.cones import Cones
from regrasp.mechanics.contact import MOST, Contact, contacts_table, fits
from regrasp.mechanics.limits.limit_rows import LimitRows, stacked
from regrasp.mechanics.orientation.tangents import tangents_of
from regrasp.mechanics.plain import entries, listed
from regrasp.mechanics.together import named, refuse_coincident, refuse_equal_names
from regrasp.mechanics.value import ArrayValue, kept, one_line
from regrasp.mechanics.wrench import torque

_IN_RANGE = attrgetter("_is_in_range")


@dataclass(frozen=True, eq=False)
class Grasp(ArrayValue):
    """Contacts on one object, addressed by name or by index.

    Unnamed contacts are named P1, P2, ... by their place, or the next such name that is free.

    Args:
        contacts: one or more, of one dimension.

    Raises:
        InvalidInput: For an empty grasp, contacts of different dimension, equal names and contacts at one
            point with one normal.
    """

    contacts: tuple[Contact, ...]
    _repr_html_ = contacts_table

    def __init__(self, contacts: Iterable[Contact]) -> None:
        given = items(contacts, "contacts of a grasp")
        if not given:
            raise InvalidInput("a grasp needs at least one contact, got none")
        for contact in given:
            if not isinstance(contact, Contact):
                raise InvalidInput(f"a grasp is made of Contacts, got {shown(contact)}")
            if len(contact.plain) != len(given[0].plain):  # worked out once for all grasps of a contact
                raise InvalidInput(
                    f"contacts of one grasp must have one dimension, got {given[0].dimension} "
                    f"and {contact.dimension}"
                )
        together = named(given)
        refuse_equal_names(together)
        refuse_coincident(together)
        object.__setattr__(self, "contacts", together)

    @cached_property
    def _hash(self) -> int:
        return super().__hash__()

    def __hash__(self) -> int:
        return self._hash

    def to_dict(self) -> dict[str, Any]:
        """The grasp as plain data, which JSON can hold; ``from_dict`` gives back the equal grasp."""
        return {"contacts": [contact.to_dict() for contact in self.contacts]}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Grasp":
        """The grasp of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``Grasp`` does.
        """
        contacts = listed(entries(data, "a grasp", ("contacts",))["contacts"], "contacts of a grasp")
        return cls(map(Contact.from_dict, contacts))

    @cached_property
    def out_of_range(self) -> str:
        """What is too large or too small for its products to be numbers, in words; empty where nothing is.

        Values may be of any size, and proofs are exact; what is worked out from them may not.
        """
        if all(map(_IN_RANGE, self.contacts)):  # worked out once for all grasps of a contact
            return ""
        d = self.dimension
        reach = max([max(map(abs, c.plain[:d])) for c in self.contacts])
        sizes = [("positions must reach", reach)]
        for c in self.contacts:
            label = f"{shown(c.name)} must be"
            sizes += [(f"friction of {label}", c.friction), (f"torsion of {label}", c.torsion or 0.0)]
        for what, size in sizes:
            if not fits(size):
                return f"{what} 0 or between {1 / MOST:g} and {MOST:g}, got {size:g}"
        return ""

    # -- lookup ---------------------------------------------------------------------------------------

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The contacts' names, in order."""
        return tuple(str(contact.name) for contact in self.contacts)

    def index(self, contact: str | int) -> int:
        """The place of a contact given by name or by index (negative counts from the end).

        Args:
            contact: name or index; a negative one counts from the end.
        """
        if isinstance(contact, str):
            if contact in self.names:
                return self.names.index(contact)
            names = ", ".join(map(one_line, self.names))
            raise InvalidInput(f"no contact {shown(contact)} in this grasp; it has {names}")
        if isinstance(contact, bool) or not isinstance(contact, (int, np.integer)):
            raise InvalidInput(f"a contact is addressed by name or index, got {shown(contact)}")
        if not -len(self) <= contact < len(self):
            raise InvalidInput(f"no contact {contact} in this grasp; it has {len(self)}, counted from 0")
        return int(contact) % len(self)

    def __getitem__(self, contact: str | int) -> Contact:
        return self.contacts[self.index(contact)]

    def __contains__(self, contact: object) -> bool:
        return contact in self.names if isinstance(contact, str) else contact in self.contacts

    def __len__(self) -> int:
        return len(self.contacts)

    def __iter__(self) -> Iterator[Contact]:
        return iter(self.contacts)

    # -- other grasps ---------------------------------------------------------------------------------

    def subset(self, contacts: Iterable[str | int]) -> "Grasp":
        """The grasp of the contacts named, in the order named.

        Args:
            contacts: names or indices.
        """
        return Grasp(self[contact] for contact in items(contacts, "contacts"))

    def without(self, contact: str | int) -> "Grasp":
        """The grasp after one finger left.

        Args:
            contact: name or index of the finger that leaves.
        """
        gone = self.index(contact)
        if len(self) == 1:
            raise InvalidInput(f"the last contact, {shown(self.names[0])}, cannot be taken from a grasp")
        return kept(self, gone, Grasp._without)

    def _without(self, gone: int) -> "Grasp":
        return self._of(self.contacts[:gone] + self.contacts[gone + 1 :])

    def with_contact(self, contact: Contact) -> "Grasp":
        """The grasp after one finger arrived; its contact comes last.

        Args:
            contact: of the finger that arrives.
        """
        return Grasp((*self.contacts, contact))

    def replaced(self, contact: str | int, by: Contact) -> "Grasp":
        """The grasp with one contact in the place of another.

        Args:
            contact: name or index of the one that goes.
            by: the one that takes its place.
        """
        gone = self.index(contact)
        return Grasp(by if i == gone else c for i, c in enumerate(self.contacts))

    @classmethod
    def _of(cls, contacts: tuple[Contact, ...]) -> "Grasp":
        """A grasp of contacts known to be valid together."""
        grasp = object.__new__(cls)
        object.__setattr__(grasp, "contacts", contacts)
        return grasp

    # -- arrays ---------------------------------------------------------------------------------------

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return self.contacts[0].dimension

    @cached_property
    def is_soft(self) -> bool:
        """Whether any finger is soft."""
        return any(contact.torsion is not None for contact in self.contacts)

    @property
    def width(self) -> int:
        """Numbers per force: d; 4 where a finger is soft, the last one its torque about the normal [N m]."""
        return 4 if self.is_soft else self.dimension

    @cached_property
    def cones(self) -> Cones:
        """The friction cones, soft fingers' limit surfaces included, as circular cones."""
        return Cones(self.matrix, self.normals, self.frictions, self.torsions)

    @cached_property
    def positions(self) -> Array:
        """(n, d) [m]."""
        return read_only(np.array([c.position for c in self.contacts]))

    @cached_property
    def normals(self) -> Array:
        """(n, d), unit, into the object."""
        return read_only(np.array([c.normal for c in self.contacts]))

    @cached_property
    def tangents(self) -> Array:
        """(n, 2), the normals turned left by a right angle; in space two of each, (n, 2, 3) (``frames``)."""
        across = tangents_of(self.normals)
        return read_only(across if self.dimension == 3 else across[:, 0])

    @cached_property
    def frictions(self) -> Array:
        """(n,) Coulomb coefficients."""
        return read_only(np.array([c.friction for c in self.contacts]))

    @cached_property
    def torsions(self) -> Array | None:
        """(n,) torsion coefficients [m], 0 for point contacts; None where no finger is soft."""
        if not self.is_soft:
            return None
        return read_only(np.array([c.torsion or 0.0 for c in self.contacts]))

    @cached_property
    def max_forces(self) -> Array:
        """(n,) [N], infinite where a contact has no limit."""
        return read_only(np.array([np.inf if c.max_force is None else c.max_force for c in self.contacts]))

    @cached_property
    def limit_rows(self) -> LimitRows | None:
        """The contacts' linear ``limits``, as the cones measure forces; None where there are none."""
        if not [contact for contact in self.contacts if contact.limits is not None]:
            return None  # without a look at the cones, which take longer than a plan of two fingers
        return stacked(self.contacts, self.cones)

    @cached_property
    def size(self) -> float:
        """The largest distance of a contact from the centre of mass [m]: a length to scale torques by."""
        return float(np.sqrt((self.positions**2).sum(axis=1).max()))

    @cached_property
    def matrix(self) -> Array:
        """Grasp matrix G, (3, 2n) or (6, 3n): stacked forces (f_1, ..., f_n) to total wrench.

        (6, 4n) where a finger is soft: forces are then (f_x, f_y, f_z, m) with a torque m about the normal.
        """
        n, d = self.positions.shape
        axes = np.eye(d)  # a unit force along each axis, at each contact
        arms = torque(self.positions[:, None], axes)  # (n, d, 1) or (n, d, 3)
        blocks = np.concatenate([np.broadcast_to(axes[:, None], (d, n, d)), np.moveaxis(arms, -1, 0)])
        if self.is_soft:
            about = np.concatenate([np.zeros((3, n, 1)), self.normals.T[..., None]])
            blocks = np.concatenate([blocks, about], axis=2)
        return read_only(blocks.reshape(-1, n * self.width))

    @cached_property
    def lengths(self) -> Array:
        """(3,) or (6,) what makes a wrench comparable: 1 for forces, ``size`` for torques."""
        lengths = np.full(len(self.matrix), self.size or 1.0)
        lengths[: self.dimension] = 1.0
        return read_only(lengths)

    @cached_property
    def scaled_matrix(self) -> Array:
        """``cones.matrix`` with torques divided by ``size``, so that all rows are forces."""
        return read_only(self.cones.matrix / self.lengths[:, None])

    def wrenches(self, forces: Array) -> Array:
        """(..., n, 3) or (..., n, 6) wrenches (f_i, r_i x f_i), with m_i n_i of soft fingers, of forces.

        Args:
            forces: (..., n, d) of the fingers on the object, object frame [N]; (..., n, 4) with soft fingers.
        """
        if not isinstance(forces, np.ndarray) or forces.shape[-2:] != (len(self), self.width):
            forces = finite(forces, "forces", (len(self), self.width))
        pushed = forces[..., : self.dimension]
        torques = torque(self.positions, pushed)
        if self.is_soft:
            torques = torques + forces[..., 3:] * self.normals
        return np.concatenate([pushed, torques], axis=-1)

    @cached_property
    def internal_forces(self) -> Array:
        """(k, n, d): an orthonormal basis of the forces with G f = 0, those that squeeze the object only.

        k = 2n - 3 in the plane, 3n - 6 in space (one more where all contacts lie on one line).
        """
        scaled = self.matrix / self.lengths[:, None]  # so that the rank does not depend on the length unit
        _, values, rows = np.linalg.svd(scaled)
        rank = int((values > 1e-12 * values[0]).sum())
        return read_only(rows[rank:].reshape(-1, len(self), self.width))

    @cached_property
    def free_twists(self) -> Array:
        """(k, 3) or (k, 6): motions of the object that move no contact; orthonormal for lengths of ``size``.

        No such motion for two contacts in the plane or three in space that do not lie on one line. Two point
        contacts in space leave the turn about their line free: no force of theirs resists a torque about it.
        """
        left, values, _ = np.linalg.svd(self.matrix / self.lengths[:, None])
        rank = int((values > 1e-12 * values[0]).sum())
        return read_only(left[:, rank:].T / self.lengths)

    @property
    def freedom(self) -> str | None:
        """In words, what motion no force of these contacts resists; None where there is none."""
        if not len(self.free_twists):
            return None
        if len(self) == 1:
            return f"turning about {self.names[0]}"
        return f"turning about the line through {self.names[0]} and {self.names[1]}"

    def __repr__(self) -> str:
        inside = "".join(f"\n  {contact!r}," for contact in self.contacts)
        return f"Grasp([{inside}\n])"


def touching(contacts: Iterable[Contact]) -> Grasp:
    """A grasp whose contacts may coincide, as two at a corner do: for measures; planning takes none such."""
    given = tuple(contacts)
    if len(given) < 2 or not all(isinstance(contact, Contact) for contact in given):
        return Grasp(given)
    apart = Grasp(given[:1])
    for contact in given[1:]:
        if contact.dimension != apart.dimension:
            return Grasp(given)  # which says what is wrong
    together = named(given)
    refuse_equal_names(together)
    return apart._of(together)
