"""The linear limits of all contacts of a grasp in one matrix: a . f_i <= b, in newtons."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.cones import Cones

if TYPE_CHECKING:
    from regrasp.mechanics.contact import Contact


@dataclass(frozen=True, eq=False)
class LimitRows:
    """a_k . f <= b_k for the force f of contact c_k, as the cones measure it; each a_k of length 1.

    contacts: (m,) c. rows: (m, w) a, object frame. bounds: (m,) b [N]. count: of contacts.
    """

    contacts: NDArray[np.intp]
    rows: Array
    bounds: Array
    count: int

    def spare(self, forces: Array) -> Array:
        """(..., n) by how much forces (..., n, w) keep each contact's limits [N]; infinite without any."""
        room = self.bounds - np.einsum("mw,...mw->...m", self.rows, forces[..., self.contacts, :])
        return self.least(room)

    def least(self, room: Array) -> Array:
        """(..., n) the least of values (..., m) of each contact; infinite where it has none."""
        result = np.full((*room.shape[:-1], self.count), inf)
        for k, i in enumerate(self.contacts.tolist()):
            result[..., i] = np.minimum(result[..., i], room[..., k])
        return result

    def scaled(self, share: float) -> "LimitRows":
        """The same with a share of the bounds."""
        return self if share == 1 else replace(self, bounds=share * self.bounds)

    def kept(self, forces: Array) -> bool:
        """Whether forces (..., n, w) keep all of them."""
        return bool((self.spare(forces) >= 0).all())


def stacked(contacts: Sequence["Contact"], cones: Cones) -> LimitRows | None:
    """The rows of all contacts; None where none has any."""
    places, rows, bounds = [], [], []
    width = cones.normals.shape[1]
    for i, contact in enumerate(contacts):
        given = contact.limit_rows
        if given is None or contact.limits is None:
            continue
        wide = np.zeros((len(given), width))
        wide[:, : given.shape[1]] = given
        wide = cones.measuring(wide, i)
        sizes = np.hypot.reduce(wide, axis=1)
        counts = sizes > 0  # of a row that limits nothing this finger can do nothing is asked
        places += [i] * int(counts.sum())
        rows.append(wide[counts] / sizes[counts, None])
        bounds.append(contact.limits.bounds[counts] / sizes[counts])
    if not places:
        return None
    return LimitRows(
        np.array(places), read_only(np.vstack(rows)), read_only(np.concatenate(bounds)), len(contacts)
    )


def refuse_limits(grasp: "Iterable[Contact]", what: str) -> None:
    """Raise ``InvalidInput`` for contacts with linear limits where these are not kept.

    what: what does not keep them, in words.
    """
    names = [str(contact.name) for contact in grasp if contact.limits is not None]
    if names:
        raise InvalidInput(
            f"{what} does not keep the linear limits of contacts, and {', '.join(names)} has some; leave "
            f"limits out of these contacts, or bound their forces by max_force"
        )
