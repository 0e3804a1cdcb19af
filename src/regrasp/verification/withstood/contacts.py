"""Whether a force f + R d stays inside its cone and limit for every d of a set, decided exactly.

With Q = (1 + mu^2) n n' - |n|^2 W, W = 1 but (mu / e)^2 for a soft finger's torque, the cone is n . f >= 0
and f'Q f >= 0, the limit L^2 - f'W f >= 0: quadratic in d. A polytope's vertices decide, since the cone is
convex. Over a ball, d = c + A z with |z| <= 1, a quadratic q(z) is never negative if and only if

    S + lambda [[1, 0], [0, -1]] is positive semidefinite for some lambda >= 0

(S-lemma: Yakubovich 1971), S the matrix of q in (z, 1). A lambda found in floating point proves it exactly;
the z of that lambda is the worst member, and refutes it exactly. In the plane the edges g of a cone decide,
g . f >= sigma(-R' g), and of any set.
"""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench
from regrasp.verification.exact import RESOLUTION, Vector, dot, exact, rounded
from regrasp.verification.withstood.matrices import (
    Matrix,
    doubles,
    in_doubles,
    is_semidefinite,
    product,
    rational,
    times,
    transposed,
)
from regrasp.verification.withstood.multipliers import multipliers

_ROUNDING, _ABOVE = 2.0**-40, 2.0**-46
"""More than a support function in doubles is off, of the size of its set; than a multiplier, of its form."""
CONE, LIMIT = "leaves its friction cone", "exceeds its limit"


@dataclass(frozen=True)
class Broken:
    """What breaks, in words; the member that does it, None where none was found and none proven absent."""

    how: str
    member: Wrench | None


class Body:
    """A set as vertices or as an ellipsoid, in rationals."""

    def __init__(self, loads: LoadSet) -> None:
        self.loads = loads
        self.vertices, self.cover, columns = (
            None if rows is None else rational(rows.tolist())
            for rows in (loads.vertices, loads.cover, loads.half_axes)
        )
        self.axes = columns
        self.center = exact(loads.center.vector.tolist())

    def allows(self, room: Fraction, twist: Vector) -> bool:
        """Whether no member works more than ``room`` along a twist."""
        if self.axes is not None:
            left = room - dot(twist, self.center)
            work = times(transposed(self.axes), twist)
            return left >= 0 and left**2 >= dot(work, work)
        if self.vertices is not None:
            return all(room >= dot(twist, v) for v in self.vertices)
        y, unit = doubles(twist), np.eye(len(twist))
        sizes = np.maximum(self.loads.support(unit), self.loads.support(-unit))
        return room >= Fraction(float(self.loads.support(y) + _ROUNDING * (abs(y) @ sizes)))


class Touch:
    """A contact with its cone and limit; ``friction``: the factor on its coefficient that is judged."""

    def __init__(self, contact: Contact, friction: Fraction, width: int) -> None:
        n = exact(contact.normal.tolist())
        self.mu = max(Fraction(contact.friction), RESOLUTION) * friction
        self.n = [*n, *[Fraction(0)] * (width - len(n))]
        self.weights = [Fraction(1)] * width
        if width > len(n):
            torsion, whole = contact.torsion, max(Fraction(contact.friction), RESOLUTION)
            self.weights[-1] = Fraction(0) if torsion is None else (whole / Fraction(torsion)) ** 2
        nn = dot(self.n, self.n)
        self.cone = [
            [(1 + self.mu**2) * a * b - (nn * self.weights[i] if i == j else 0) for j, b in enumerate(self.n)]
            for i, a in enumerate(self.n)
        ]
        self.limit = None if contact.max_force is None else Fraction(contact.max_force)
        self.rows: list[tuple[Vector, Fraction]] = []
        if contact.limits is not None and contact.limit_rows is not None:
            for a, b in zip(contact.limit_rows.tolist(), contact.limits.bounds.tolist(), strict=True):
                none = [Fraction(0)] * (width - len(a))
                self.rows.append(([*exact(a), *none], Fraction(b)))

    def broken(
        self, force: Vector, answer: Matrix, body: Body, limit_share: Fraction = Fraction(1)
    ) -> Broken | None:
        """What breaks first of f + R d, d in the set; None where nothing does.

        answer: R, (w, q). limit_share: the part of the limit that may be used.
        """
        found = self._by_rows(force, answer, body, limit_share)
        if found is None and len(force) == 2:
            found = self._edges(force, answer, body)
        limits: list[Fraction | None] = [None] if len(force) > 2 else []  # none for the cone
        if self.limit is not None:
            limits.append(self.limit * limit_share)
        if found is not None or not limits:
            return found
        if body.cover is not None:
            return self._by_vertices(force, answer, body, limits)
        return self._by_ball(force, answer, body, limits)

    def _keeps(self, f: Vector, limit: Fraction | None) -> bool:
        """Whether a force is within a limit, or within the cone."""
        if limit is None:
            return dot(f, self.n) >= 0 and dot(f, times(self.cone, f)) >= 0
        return sum(w * x * x for w, x in zip(self.weights, f, strict=True)) <= limit**2

    def _edges(self, force: Vector, answer: Matrix, body: Body) -> Broken | None:
        """In the plane: g . f >= sigma(-R' g) for both edges, and along the normal where these are one."""
        across = [-self.n[1], self.n[0]]
        for sign in (-1, 1, 0):
            g = [self.mu * a + sign * b if sign else a for a, b in zip(self.n, across, strict=True)]
            twist = [-dot(g, list(column)) for column in zip(*answer, strict=True)]
            if not body.allows(dot(g, force), twist):
                return self._with_member(force, answer, body.loads.extreme(doubles(twist)), None)
        return None

    def _by_rows(self, force: Vector, answer: Matrix, body: Body, share: Fraction) -> Broken | None:
        """Linear limits: b - a . f >= sigma(R' a), for any set."""
        for a, b in self.rows:
            twist = [dot(a, list(column)) for column in zip(*answer, strict=True)]
            if body.allows(b * share - dot(a, force), twist):
                continue
            member = body.loads.extreme(doubles(twist))
            after = _changed(force, answer, exact(member.vector.tolist()))
            return Broken("breaks a linear limit", None if dot(a, after) <= b * share else member)
        return None

    def _with_member(self, force: Vector, answer: Matrix, member: Wrench, limit: Fraction | None) -> Broken:
        """The member, where it breaks the condition exactly."""
        after = _changed(force, answer, exact(member.vector.tolist()))
        return Broken(CONE if limit is None else LIMIT, None if self._keeps(after, limit) else member)

    def _by_vertices(
        self, force: Vector, answer: Matrix, body: Body, limits: list[Fraction | None]
    ) -> Broken | None:
        for vertex in body.cover or ():
            after = _changed(force, answer, vertex)
            for limit in limits:
                if self._keeps(after, limit):
                    continue
                if body.vertices is not None:
                    return self._with_member(force, answer, Wrench.from_vector(doubles(vertex)), limit)
                twist = self._outward(after, limit) @ in_doubles(answer)
                return self._with_member(force, answer, body.loads.extreme(twist), limit)
        return None

    def _outward(self, after: Vector, limit: Fraction | None) -> Array:
        """The direction in which a force outside goes farther out."""
        f, n, weights = (doubles(x) for x in (after, self.n, self.weights))
        if limit is not None:
            return weights * f
        side = f - (f @ n) * n
        across = weights * side
        return across / (np.sqrt(across @ side) or 1.0) - rounded(self.mu) * n

    def _by_ball(
        self, force: Vector, answer: Matrix, body: Body, limits: list[Fraction | None]
    ) -> Broken | None:
        """S-lemma, in which a proof's multiplier and a member are guessed in doubles."""
        loads, axes = body.loads, body.axes or []
        b, m = _changed(force, answer, body.center), product(answer, axes)
        along, pushing = times(transposed(m), self.n), dot(b, self.n)
        for limit in limits:
            if limit is None and (pushing < 0 or pushing**2 < dot(along, along)):
                z = -doubles(along)
                z /= np.linalg.norm(z) or 1.0
            else:
                found = _worst(self._form(b, m, limit))
                if found is None:
                    continue
                z = found
            member = loads.center.vector + np.asarray(loads.half_axes) @ z
            return self._with_member(force, answer, Wrench.from_vector(member), limit)
        return None

    def _form(self, b: Vector, m: Matrix, limit: Fraction | None) -> Matrix:
        """S, of the cone or the limit at b + m z."""
        columns = [[*row, x] for row, x in zip(m, b, strict=True)]
        if limit is None:
            return product(transposed(columns), product(self.cone, columns))
        weighted = [[-w * x for x in row] for w, row in zip(self.weights, columns, strict=True)]
        s = product(transposed(columns), weighted)
        s[-1][-1] += limit**2
        return s


def _changed(force: Vector, answer: Matrix, d: Vector) -> Vector:
    return [f + x for f, x in zip(force, times(answer, d), strict=True)]


def _worst(s: Matrix) -> Array | None:
    """A z, |z| <= 1, that makes (z, 1)'S (z, 1) least; None where none makes it negative, proven."""
    size = max(abs(x) for row in s for x in row) or Fraction(1)
    s = [[x / size for x in row] for row in s]
    whole = in_doubles(s)
    values, vectors = np.linalg.eigh(whole[:-1, :-1])
    b = vectors.T @ whole[:-1, -1]
    multiplier = float(multipliers(values, b, np.maximum(0.0, -values.min(initial=0.0))))
    for shift in Fraction(multiplier), Fraction(multiplier + _ABOVE):  # at an end rounding decides: above it
        shifts = [*[shift] * len(values), -shift]
        if is_semidefinite([[*row[:k], row[k] + shifts[k], *row[k + 1 :]] for k, row in enumerate(s)]):
            return None
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.nan_to_num(-b / (values + multiplier), posinf=0.0, neginf=0.0)
    if multiplier > 0:  # on the sphere: what is left, along the lowest curvature
        k = values.argmin()
        z[k] += np.copysign(max(1 - float(z @ z), 0.0) ** 0.5, z[k])
    return np.asarray(vectors @ z / max(1.0, float(np.linalg.norm(z))))
