"""Form and force closure: whether contacts balance every wrench, decided in rational arithmetic."""

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.measures.rationals import Vector, neutral, vanishing
from regrasp.measures.rays import is_inside, rays, wrench
from regrasp.measures.separating import Family, clearest, cuts, deepest, least_opposed, opposition
from regrasp.mechanics.checks import Array, items, read_only
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp, touching
from regrasp.mechanics.opposition import dot
from regrasp.mechanics.value import ArrayValue, numbers

Kind = Literal["form", "force", "none"]

ROUNDING = Fraction(1, 10**12)
"""Closure that a change of this fraction of the unit forces ends is an accident of rounding, and none."""
SMALL = 1e-9
"""Closure is strict where it survives this change of every unit force, relative to it."""
_FACETS = 8
_CUTS = 40


@dataclass(frozen=True, eq=False, repr=False)
class Closure(ArrayValue):
    """Whether contacts without force limits balance every wrench, and the witness that proves it.

    The witness of closure: forces (k, w) inside the cones (of soft fingers with g, see below) at
    ``contacts``, whose wrenches span the space and vanish with positive ``weights``. Of ``none``: a
    ``twist`` (velocity of the centre of mass, then angular velocity) along which no contact, pushing
    anywhere in its cone, does negative work, so that a wrench that does negative work along it is never
    made. Both are rational; ``is_proof`` decides them again, on the numbers stored here.

    In the place of a soft finger's torque m stands g = mu m / torsion, as in its cone |(f_t, g)| <= mu f_n.

    Args:
        grasp: the contacts that hold.
        kind: ``form``, the normals alone do (first-order form closure); ``force``, only with friction;
            ``none``.
        room: of a closure, how far the wrench of every unit force below may change, relative to the force and
            with torques divided by the grasp's size, so that closure is sure to last [-]; a lower bound, 0
            for ``none``.
        contacts: places of the contacts whose forces are the witness, k of them.
        forces: (k, w) forces inside the cones, rational.
        weights: (k,) positive, rational.
        twist: (3,) or (6,), rational, where there is no closure; None otherwise.
    """

    grasp: Grasp
    kind: Kind
    room: float
    contacts: tuple[int, ...]
    forces: tuple[tuple[Fraction, ...], ...]
    weights: tuple[Fraction, ...]
    twist: tuple[Fraction, ...] | None

    @property
    def strict(self) -> bool:
        """Whether closure is sure to survive small changes: of 1e-9 of each unit force."""
        return self.room >= SMALL

    @property
    def escape(self) -> Array | None:
        """The separating twist in doubles, (3,) or (6,), its largest speed at the grasp's size 1; or None."""
        if self.twist is None:
            return None
        y = np.array([float(value) for value in self.twist]) * self.grasp.lengths
        return read_only(y / abs(y).max() / self.grasp.lengths)

    @cached_property
    def opposition(self) -> Fraction:
        """The most work against ``twist`` that one newton can do, per speed of the twist; 0 of a closure.

        Zero where the twist separates exactly; below 1e-12 where it does but for rounding of the contacts.
        """
        return Fraction(0) if self.twist is None else opposition(self._cones, list(self.twist))

    @property
    def is_proof(self) -> bool:
        """Whether the witness proves the kind, in rational arithmetic."""
        if self.twist is not None:
            return any(self.twist) and self.opposition <= ROUNDING
        cones = self._cones
        used = [(cones[i], list(force)) for i, force in zip(self.contacts, self.forces, strict=True)]
        wrenches = [wrench(contact, force) for contact, force in used]
        total = [dot(list(self.weights), list(row)) for row in zip(*wrenches, strict=True)]
        inside = all(is_inside(contact, force) for contact, force in used)
        return inside and min(self.weights) > 0 and not any(total) and neutral(wrenches) is None

    @cached_property
    def _cones(self) -> Grasp:
        return frictionless(self.grasp) if self.kind == "form" else self.grasp

    def __bool__(self) -> bool:
        return self.kind != "none"

    def __str__(self) -> str:
        names = ", ".join(self.grasp.names)
        if self.twist is None:
            survives = f"survives changes of {self.room:.2g}" if self.strict else "a small change ends it"
            return f"{self.kind} closure by {names}: {survives}"
        shown = numbers(np.where(abs(self.escape) < 1e-12, 0.0, self.escape) + 0.0)  # type: ignore[arg-type]
        return f"no closure by {names}: no contact opposes the twist {shown}"

    def __repr__(self) -> str:
        return f"Closure({self})"


def closure(grasp: Grasp | Iterable[Contact]) -> Closure:
    """The strongest of form closure, force closure and none, of contacts without force limits.

    Force closure: the total wrenches of forces inside the cones are all wrenches. It is then open: it
    survives small enough changes, whose size ``room`` bounds; ``strict`` says that it is not a matter of
    rounding. What holds at the limit only (two fingers without friction that face each other; an edge of a
    friction cone along the line of two fingers) is none. Source: Roa and Suarez, Autonomous Robots 38
    (2015), section 2; Lynch and Park, Modern Robotics, chapter 12.

    Args:
        grasp: a ``Grasp``, or contacts, which may then coincide, as two fingers at the sides of a corner do.
    """
    return _verdict(taken(grasp))


@lru_cache(maxsize=64)
def _verdict(grasp: Grasp) -> Closure:
    found = _decided(frictionless(grasp), grasp, "form")
    if not isinstance(found, Closure) and grasp.frictions.any():
        found = _decided(grasp, grasp, "force")
    return found if isinstance(found, Closure) else Closure(grasp, "none", 0.0, (), (), (), tuple(found))


def taken(grasp: Grasp | Iterable[Contact]) -> Grasp:
    """A grasp, or the grasp of contacts that may coincide."""
    if isinstance(grasp, Grasp):
        return grasp
    if isinstance(grasp, Contact):
        raise InvalidInput(f"grasp must be a Grasp or several contacts, got {shown(grasp)}")
    return touching(items(grasp, "grasp"))


def frictionless(grasp: Grasp) -> Grasp:
    """The same contacts without friction."""
    return touching(c.changed(friction=0.0, torsion=None) for c in grasp)


def _decided(grasp: Grasp, shown: Grasp, kind: Kind) -> "Closure | Vector":
    """The closure of these contacts, or the twist that separates, exactly or but for rounding."""
    family: Family = [
        (i, ray) for i, c in enumerate(grasp) for ray in rays(c, grasp.cones.tangents[i], _FACETS)
    ]
    columns = [wrench(grasp[i], force) for i, force in family]
    if (y := neutral(columns)) is not None:
        return y
    refused: list[Vector] = []
    while len(refused) < _CUTS:
        weights, y = vanishing(columns)
        if weights is not None:
            room = _room(grasp, columns, weights)
            twist = least_opposed(grasp, deepest(grasp, _scaled(grasp, columns))) if room < SMALL else None
            if twist is not None and opposition(grasp, twist) <= ROUNDING:
                return twist
            contacts, forces = zip(*family, strict=True)
            return Closure(shown, kind, room, contacts, tuple(map(tuple, forces)), tuple(weights), None)
        refused.append(y or [])
        added = cuts(grasp, refused[-1])
        if not added:
            break
        if len(refused) == 1 and (clear := clearest(grasp)) and opposition(grasp, clear) <= ROUNDING:
            return clear
        family += added
        columns += [wrench(grasp[i], force) for i, force in added]
    return least_opposed(grasp, [*reversed(refused)])


def _room(grasp: Grasp, columns: list[Vector], weights: list[Fraction]) -> float:
    """How far the wrench of every unit force may move: l sigma_min(W (1 - 1 1' / N)), l the least weight.

    With weights of sum 1 and b_j = max_k u . w_k - u . w_j >= 0 for a unit u, the largest u . w_k is the
    weighted mean of the b_j, at least l |b| and so at least l |(1 - 11'/N) W'u|. A change of less leaves it
    positive.
    """
    w = _scaled(grasp, columns)
    lengths = np.linalg.norm(w[: grasp.dimension], axis=0)
    shares = np.array([float(weight) for weight in weights]) * lengths
    w = w / lengths
    centred = w - w.mean(axis=1, keepdims=True)
    return float(shares.min() / shares.sum() * np.linalg.svd(centred, compute_uv=False)[-1])


def _scaled(grasp: Grasp, columns: list[Vector]) -> Array:
    """(m, k) wrenches in doubles, torques divided by the grasp's size."""
    return np.array([[float(value) for value in column] for column in columns]).T / grasp.lengths[:, None]
