"""The verdict on a cut that no hold crosses, in rational arithmetic.

A force through the origin is balanced by two contacts only if the torques of the edges of both cones have not
all one strict sign: forces that all turn the object the same way balance no such load. A pair is excluded
where they do, where it is nearer than a least distance, or where a cone less the least margin is empty and
the other contact does not hold alone.
Narrowed cones are bounded from outside: with t <= tan m, tan(atan mu - m) <= (mu - t) / (1 + mu t).
"""

from fractions import Fraction
from itertools import combinations
from math import floor, inf
from typing import Protocol

from regrasp.mechanics.contact import Contact
from regrasp.verification.exact import cross, exact
from regrasp.verification.verdict import Verification

# tan m >= the sum of the first terms of its series, all of which are positive.
_TANGENT = tuple(Fraction(a, b) for a, b in ((1, 1), (1, 3), (2, 15), (17, 315), (62, 2835)))

_DOUBLINGS, _FINE = 7, 2**80

# Components of more contacts than this are not listed: it would take longer than the proof.
_MOST_LISTED = 500


class Cut(Protocol):
    """What ``verify`` needs to know of a cut, whoever made it."""

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """Of both parts."""

    @property
    def start(self) -> tuple[int, ...]:
        """Three places."""

    @property
    def goal(self) -> tuple[int, ...]:
        """Three places."""

    @property
    def reached(self) -> tuple[int, ...]:
        """Places of the start's part."""

    @property
    def least_margin(self) -> float:
        """Of every hold [rad]."""

    @property
    def min_distance(self) -> float:
        """Of two fingers that hold [m]."""


def verify_cut(cut: Cut) -> Verification:
    """Whether no regrasp on these contacts leads from the start to the goal, at any orientation."""
    broken = []
    count = len(cut.contacts)
    places = [*cut.start, *cut.goal, *cut.reached]
    if len(set(cut.start)) != 3 or len(set(cut.goal)) != 3 or not all(0 <= k < count for k in places):
        return Verification(("start and goal must be three contacts each",), inf, 0.0, -inf)
    if set(cut.start) == set(cut.goal):
        broken.append("the start and the goal are the same contacts")
    holds = _Holds(cut)
    inside = set(cut.reached)
    outside = [k for k in range(count) if k not in inside]
    for i, j in combinations(cut.start, 2):
        if holds.may(i, j) and not {i, j} <= inside:
            broken.append(f"contacts {i} and {j} of the start may hold and are not both on its side")
    for i, j in combinations(cut.goal, 2):
        if holds.may(i, j) and {i, j} & inside:
            broken.append(f"contacts {i} and {j} of the goal may hold and are not both on the other side")
    crossing = [(i, j) for i in sorted(inside) for j in outside]
    broken += [f"contacts {i} and {j} may hold across the cut" for i, j in crossing if holds.may(i, j)]
    return Verification(
        tuple(broken),
        0.0,
        inf,
        inf,
        crossing=len(crossing),
        components=_components(cut, holds),
        asked=_asked(cut),
    )


def _components(cut: Cut, holds: "_Holds") -> str:
    """Which pairs may hold, and the components that they form, in words; empty for very many contacts."""
    count = len(cut.contacts)
    if count > _MOST_LISTED:
        return ""
    pairs = [(i, j) for i, j in combinations(range(count), 2) if holds.may(i, j)]
    first = list(range(count))  # contact of its component
    for i, j in pairs:
        one, other = first[i], first[j]
        if one != other:
            first = [min(one, other) if k in (one, other) else k for k in first]
    sizes = sorted((n for n in map(first.count, set(first)) if n > 1), reverse=True)
    of = f", in {len(sizes)} component{'s' * (len(sizes) > 1)} of {_listed(sizes)} contacts" if sizes else ""
    ends = []
    for what, places in (("start", cut.start), ("goal", cut.goal)):
        held = {first[i] for i, j in combinations(places, 2) if holds.may(i, j)}
        where = " and ".join(f"one of {first.count(k)}" for k in sorted(held))
        ends.append(f"those of the {what} in {where}" if held else f"no two fingers of the {what} do")
    return f"{len(pairs)} of {count * (count - 1) // 2} pairs may hold{of}; {', '.join(ends)}"


def _listed(sizes: list[int]) -> str:
    shown = ", ".join(map(str, sizes[:4]))
    return shown if len(sizes) <= 4 else f"{shown} and fewer"


def _asked(cut: Cut) -> str:
    """What every hold has to keep, in words; empty for nothing."""
    asked = []
    if cut.least_margin > 0:
        asked.append(f"angle margins of {cut.least_margin:.4g} rad")
    if cut.min_distance > 0:
        asked.append(f"fingers {cut.min_distance:.4g} apart")
    return f" with {' and '.join(asked)}" if asked else ""


class _Holds:
    """Which pairs of contacts may hold any load through the origin."""

    def __init__(self, cut: Cut) -> None:
        tangent = _tangent_below(Fraction(cut.least_margin))
        self.points = [exact(c.position.tolist()) for c in cut.contacts]
        self.sides = [_side(c, p, tangent) for c, p in zip(cut.contacts, self.points, strict=True)]
        self.apart = Fraction(cut.min_distance) ** 2

    def may(self, i: int, j: int) -> bool:
        one, other = self.sides[i], self.sides[j]
        if one is None or other is None:
            if one != 0 and other != 0:  # else one of them holds alone, and the other touches without force
                return False
        elif one == other and one != 0:
            return False
        if not self.apart:
            return True
        off = [a - b for a, b in zip(self.points[i], self.points[j], strict=True)]
        return off[0] ** 2 + off[1] ** 2 >= self.apart


def _tangent_below(angle: Fraction) -> Fraction:
    """At most tan(angle), to 1e-18 up to 1.5 rad, whose tangent is above 14."""
    if angle > Fraction(3, 2):
        return Fraction(14)
    small = angle / 2**_DOUBLINGS
    tangent = sum((a * small ** (2 * k + 1) for k, a in enumerate(_TANGENT)), Fraction(0))
    for _ in range(_DOUBLINGS):  # which rises with the tangent, below pi / 4
        tangent = Fraction(floor(2 * tangent / (1 - tangent**2) * _FINE), _FINE)
    return tangent


def _side(contact: Contact, point: list[Fraction], tangent: Fraction) -> int | None:
    """Which way all forces of a contact turn the object, 0 for both; None for an empty cone."""
    mu = Fraction(contact.friction)
    if mu < tangent:
        return None
    mu = (mu - tangent) / (1 + mu * tangent)
    nx, ny = exact(contact.normal.tolist())
    torques = [cross(point, [nx - side * mu * ny, ny + side * mu * nx])[0] for side in (-1, 1)]
    if all(t > 0 for t in torques):
        return 1
    return -1 if all(t < 0 for t in torques) else 0
