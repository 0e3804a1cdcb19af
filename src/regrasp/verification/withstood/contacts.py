"""Whether a force f + R d stays inside its cone and limit for every d of a set, decided exactly.

With Q = (1 + mu^2) n n' - |n|^2 W, W = 1 but (mu / e)^2 for a soft finger's torque, the cone is n . f >= 0
and f'Q f >= 0, the limit L^2 - f'W f >= 0: quadratic in d. A polytope's vertices decide, since the cone is
convex. Over a ball, d = c + A z with |z| <= 1, a quadratic q(z) is never negative if and only if

    S + lambda [[1, 0], [0, -1]] is positive semidefinite for some lambda >= 0

(S-lemma: Yakubovich 1971), S the matrix of q in (z, 1). A lambda found in floating point proves it exactly;
the z of that lambda is the worst member, and refutes it exactly. In the plane the edges g of a cone decide,
g . f >= sigma(-R' g), and of any set.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench
from regrasp.verification.exact import RESOLUTION, Vector, dot, exact
from regrasp.verification.withstood.matrices import (
    Matrix,
    is_semidefinite,
    product,
    rational,
    times,
    transposed,
)

_ROUNDING = 1e-12
"""Of the size of a set: more than its support function in doubles is off."""
_STEPS = 200
_ABOVE = [Fraction(0), *(Fraction(1, 10**k) for k in (15, 13, 11, 9, 7, 5))]


@dataclass(frozen=True)
class Broken:
    """What breaks, in words; the member that does it, None where none was found and none proven absent."""

    how: str
    member: Wrench | None


class Body:
    """A set as vertices or as an ellipsoid, in rationals."""

    def __init__(self, loads: LoadSet) -> None:
        self.loads = loads
        axes, around = loads.half_axes, loads.cover
        self.is_exact = loads.vertices is not None
        self.vertices = None if around is None else rational(around.tolist())
        self.center = exact(loads.center.vector.tolist())
        self.axes = None if axes is None else rational(axes.tolist())
        unit = np.eye(self.loads.center.vector.size)
        self.sizes = np.maximum(loads.support(unit), loads.support(-unit))

    def allows(self, room: Fraction, twist: Vector) -> bool:
        """Whether no member works more than ``room`` along a twist."""
        if self.axes is not None:
            left = room - dot(twist, self.center)
            work = times(transposed(self.axes), twist)
            return left >= 0 and left**2 >= dot(work, work)
        if self.is_exact and self.vertices is not None:
            return all(room >= dot(twist, v) for v in self.vertices)
        y = np.array([float(x) for x in twist])
        highest = float(self.loads.support(y)) + _ROUNDING * float(np.abs(y) @ self.sizes)
        return room >= Fraction(highest)


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
        checks = [] if len(force) == 2 else [(self._in_cone, "leaves its friction cone")]
        limit = None if self.limit is None else self.limit * limit_share
        if limit is not None:
            checks.append((lambda f: self._in_limit(f, limit), "exceeds its limit"))
        if found is not None or not checks:
            return found
        if body.vertices is not None:
            return self._by_vertices(force, answer, body, checks)
        return next(self._by_ball(force, answer, body, limit), None)

    def _in_cone(self, f: Vector) -> bool:
        return dot(f, self.n) >= 0 and dot(f, times(self.cone, f)) >= 0

    def _in_limit(self, f: Vector, limit: Fraction) -> bool:
        return sum(w * x * x for w, x in zip(self.weights, f, strict=True)) <= limit**2

    def _edges(self, force: Vector, answer: Matrix, body: Body) -> Broken | None:
        """In the plane: g . f >= sigma(-R' g) for both edges, and along the normal where these are one."""
        across = [-self.n[1], self.n[0]]
        for sign in (-1, 1, 0):
            g = [self.mu * a + sign * b if sign else a for a, b in zip(self.n, across, strict=True)]
            twist = [-dot(g, list(column)) for column in zip(*answer, strict=True)]
            if not body.allows(dot(g, force), twist):
                y = np.array([float(x) for x in twist])
                return self._with_member("leaves its friction cone", force, answer, body.loads.extreme(y))
        return None

    def _by_rows(self, force: Vector, answer: Matrix, body: Body, share: Fraction) -> Broken | None:
        """Linear limits: b - a . f >= sigma(R' a), for any set."""
        for a, b in self.rows:
            twist = [dot(a, list(column)) for column in zip(*answer, strict=True)]
            if body.allows(b * share - dot(a, force), twist):
                continue
            member = body.loads.extreme(np.array([float(x) for x in twist]))
            after = _changed(force, answer, exact(member.vector.tolist()))
            return Broken("breaks a linear limit", None if dot(a, after) <= b * share else member)
        return None

    def _with_member(
        self, how: str, force: Vector, answer: Matrix, member: Wrench, limit: Fraction | None = None
    ) -> Broken:
        """The member, where it breaks the condition exactly."""
        after = _changed(force, answer, exact(member.vector.tolist()))
        held = self._in_cone(after) if limit is None else self._in_limit(after, limit)
        return Broken(how, None if held else member)

    def _by_vertices(self, force: Vector, answer: Matrix, body: Body, checks) -> Broken | None:  # type: ignore[no-untyped-def]
        assert body.vertices is not None
        for vertex in body.vertices:
            after = _changed(force, answer, vertex)
            for holds, how in checks:
                if holds(after):
                    continue
                if body.is_exact:
                    return Broken(how, Wrench.from_vector([float(x) for x in vertex]))
                twist = np.array([float(x) for x in _outward(self, after, answer, how)])
                member = body.loads.extreme(twist)
                inside = holds(_changed(force, answer, exact(member.vector.tolist())))
                return Broken(how, None if inside else member)
        return None

    def _by_ball(self, force: Vector, answer: Matrix, body: Body, limit: Fraction | None) -> Iterator[Broken]:
        assert body.axes is not None
        b, m = _changed(force, answer, body.center), product(answer, body.axes)
        none = Fraction(0)
        forms = [] if len(force) == 2 else [(self.cone, none, "leaves its friction cone")]
        if limit is not None:
            inner = [[-w if i == j else none for j in range(len(force))] for i, w in enumerate(self.weights)]
            forms.append((inner, limit**2, "exceeds its limit"))
        for form, constant, how in forms:
            is_cone = constant == 0
            along = times(transposed(m), self.n)
            pushing = dot(b, self.n)
            if is_cone and (pushing < 0 or pushing**2 < dot(along, along)):
                z = _opposite(along)
                yield self._at(how, force, answer, body, z, None)
                return
            qm = product(form, m)
            qb = times(form, b)
            s = [
                [*row, x] for row, x in zip(product(transposed(m), qm), times(transposed(m), qb), strict=True)
            ]
            s.append([*times(transposed(m), qb), dot(b, qb) + constant])
            multiplier, z = _multiplier(s)
            step = max(abs(x) for row in s for x in row)
            # In the hard case the multiplier is an end of what there is, where rounding decides: a little
            # above.
            if any(is_semidefinite(_shifted(s, multiplier + share * step)) for share in _ABOVE):
                continue
            yield self._at(how, force, answer, body, z, None if is_cone else limit)
            return

    def _at(
        self, how: str, force: Vector, answer: Matrix, body: Body, z: Array, limit: Fraction | None
    ) -> Broken:
        axes = body.loads.half_axes
        assert axes is not None
        member = Wrench.from_vector(body.loads.center.vector + axes @ z)
        return self._with_member(how, force, answer, member, limit)


def _changed(force: Vector, answer: Matrix, d: Vector) -> Vector:
    return [f + x for f, x in zip(force, times(answer, d), strict=True)]


def _outward(touch: Touch, after: Vector, answer: Matrix, how: str) -> Vector:
    """The twist along which a member takes the force farthest out, from a force outside."""
    f = np.array([float(x) for x in after])
    n = np.array([float(x) for x in touch.n])
    weights = np.array([float(x) for x in touch.weights])
    if how == "exceeds its limit":
        g = -weights * f
    else:
        across = np.sqrt(weights) * (f - (f @ n) * n)
        g = float(touch.mu) * n - np.sqrt(weights) * across / (np.linalg.norm(across) or 1.0)
    return [-dot(exact(g.tolist()), list(column)) for column in zip(*answer, strict=True)]


def _shifted(s: Matrix, multiplier: Fraction) -> Matrix:
    k = len(s) - 1
    return [
        [x + (0 if i != j else (multiplier if i < k else -multiplier)) for j, x in enumerate(row)]
        for i, row in enumerate(s)
    ]


def _opposite(along: Vector) -> Array:
    z = np.array([-float(x) for x in along])
    size = float(np.linalg.norm(z))
    return z / size if size else z


def _multiplier(s: Matrix) -> tuple[Fraction, Array]:
    """The lambda that makes the least of q over the ball largest from below, and its z; in floating point.

    maximise c - lambda - sum b_i^2 / (e_i + lambda) over lambda >= 0, lambda >= -e_i: the derivative falls.
    """
    whole = np.array([[float(x) for x in row] for row in s])
    scale = float(np.abs(whole).max()) or 1.0
    values, vectors = np.linalg.eigh(whole[:-1, :-1] / scale)
    b, c = vectors.T @ (whole[:-1, -1] / scale), float(whole[-1, -1] / scale)
    least = max(0.0, -float(values.min()))
    low, high = least, max(least, abs(c)) + float(np.linalg.norm(b)) + 1.0

    def slope(x: float) -> float:
        with np.errstate(divide="ignore", invalid="ignore"):
            parts = np.where(b == 0, 0.0, (b / (values + x)) ** 2)
        return float(parts.sum()) - 1.0

    if slope(low * (1 + 1e-15) + 1e-300) > 0:
        for _ in range(_STEPS):
            middle = (low + high) / 2
            if slope(middle) > 0:
                low = middle
            else:
                high = middle
    chosen = high if low > least else least
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.where(b == 0, 0.0, -b / (values + chosen))
    z = np.where(np.isfinite(z), z, 0.0)
    size = float(np.linalg.norm(z))
    if size > 1:
        z = z / size
    elif chosen > 0:  # the hard case: the rest along the lowest curvature
        z[int(values.argmin())] += np.sqrt(max(1 - size**2, 0.0))
        z = z / np.linalg.norm(z)
    return Fraction(chosen) * Fraction(scale), vectors @ z
