"""The check of a proof that no placement of fingers on a shape is better than a bound.

It is a tree of boxes. A finger at p on a straight side of normal n and tangent t, with force f in its
cone K = { n.f >= 0, |t.f| <= mu n.f }, does work v . f along a twist y = (v0, v1, omega),

    v = (v0 - omega p_y, v1 + omega p_x),

affine in p. With sigma(v) the most of v . f over f in K of size 1, a convex function,

    (-w) . y = sum_i v_i . f_i <= sum_i sigma(v_i) size(f_i) <= N*(sigma(v_1), ...) N(size(f_1), ...)

for the norm N and its dual N*: so N is at least (-w) . y / N*(largest sigma of each arc), and the largest
sigma of an arc is at an end of one of its sides. Everything is decided in rationals; 1 / |edge| and roots are
rounded up.
"""

from fractions import Fraction
from math import inf, isqrt
from typing import Any, Protocol

import numpy as np

from regrasp.mechanics.checks import Array

_BITS = 96  # of roots
_ROUNDING = 1e-13  # of the terms of a sum of a few products: more than a hundred roundings
_SMALL = 1e-140  # squares of less lose digits, and doubles of less than 1e-308 all of them


class Proof(Protocol):
    """What is needed to know of a proof, whoever made it; the words are those of ``PlacementProof``."""

    @property
    def vertices(self) -> Array:
        """(k, 2) of the polygon [m]."""

    @property
    def centre_of_mass(self) -> Array:
        """(2,) [m]."""

    @property
    def sides(self) -> Array:
        """(m, 3) edge, least and largest u."""

    @property
    def fingers(self) -> int:
        """How many."""

    @property
    def friction(self) -> float:
        """Coefficient [-]."""

    @property
    def loads(self) -> Array:
        """(L, 3) [N, N m]."""

    @property
    def size(self) -> str:
        """``normal`` or ``force``."""

    @property
    def norm(self) -> str:
        """``sum``, ``squares`` or ``largest``."""

    @property
    def min_distance(self) -> float:
        """Between fingers [m]."""

    @property
    def bound(self) -> float:
        """No placement is better."""

    @property
    def arcs(self) -> Any:
        """Of each finger."""

    @property
    def ends(self) -> Array:
        """(n, fingers, 2) u."""

    @property
    def children(self) -> Any:
        """(n, 2) first box and how many."""

    @property
    def number(self) -> Any:
        """(n,) of the load, or -1."""

    @property
    def twists(self) -> Array:
        """(n, 3)."""


Arc = tuple[int, int, Fraction, Fraction]


def check_proof(proof: Proof) -> list[str]:
    """What is wrong with the tree of boxes or with what excludes them, in words; nothing for a proof."""
    broken = _shapes(proof)
    if broken:
        return broken
    try:
        return _Checked(proof).violations()
    except (ValueError, OverflowError, ZeroDivisionError) as error:
        return [f"proof: its numbers are none to compute with: {error}"]


def _shapes(proof: Proof) -> list[str]:
    n, k, m = len(proof.children), proof.fingers, len(proof.sides)
    wanted: list[tuple[str, Any, tuple[int, ...]]] = [
        ("vertices", proof.vertices, (len(proof.vertices), 2)),
        ("centre_of_mass", proof.centre_of_mass, (2,)),
        ("sides", proof.sides, (m, 3)), ("loads", proof.loads, (len(proof.loads), 3)),
        ("arcs", proof.arcs, (n, k, 2)), ("ends", proof.ends, (n, k, 2)),
        ("children", proof.children, (n, 2)), ("number", proof.number, (n,)),
        ("twists", proof.twists, (n, 3)),
    ]  # fmt: skip
    broken = [f"proof: {name} must have shape {shape}" for name, a, shape in wanted if np.shape(a) != shape]
    finite = all(np.isfinite(a).all() for _, a, _ in wanted) and np.isfinite(proof.bound)
    if not finite:
        broken.append("proof: its numbers must be finite")
    if not (n and k and m and len(proof.loads) and proof.friction >= 0):
        broken.append("proof: boxes, fingers, sides, loads and friction are needed")
    if not 0 <= proof.min_distance < inf:
        broken.append("proof: min_distance must be 0 or more")
    if proof.size not in ("normal", "force") or proof.norm not in ("sum", "squares", "largest"):
        broken.append("proof: size or norm has no meaning")
    return broken


class _Doubles:
    """The sides of a proof in doubles, for what rounding cannot decide."""

    def __init__(self, proof: Proof) -> None:
        points = np.asarray(proof.vertices - proof.centre_of_mass)
        self.edges = proof.sides[:, 0].astype(int)
        self.start = points[self.edges]
        # of the vertices: less the centre of mass they are rounded, which short sides would not stand
        self.along = (np.roll(proof.vertices, -1, axis=0) - proof.vertices)[self.edges]
        self.unit = self.along / np.hypot(*self.along.T)[:, None]
        self.reach = float(np.hypot(*np.abs(proof.vertices).max(axis=0)) + np.hypot(*proof.centre_of_mass))

    def largest(self, first: int, last: int, lo: Array, hi: Array, y: Array, proof: Proof) -> float:
        """The largest sigma over ends (m,) of sides."""
        part = slice(first, last + 1)
        most = 0.0
        for u in (lo, hi):
            p = self.start[part] + (u - self.edges[part])[:, None] * self.along[part]
            vx, vy = y[0] - y[2] * p[:, 1], y[1] + y[2] * p[:, 0]
            tx, ty = self.unit[part].T
            ahead, aside = tx * vy - ty * vx, np.abs(tx * vx + ty * vy)
            value = ahead + proof.friction * aside
            if proof.size == "force":
                value = value / np.sqrt(1 + proof.friction**2)
                # inside the cone, and a little around it, the whole of v
                value = np.where(aside <= proof.friction * ahead, np.hypot(vx, vy), value)
            most = max(most, float(value.max(initial=0.0)))
        return most


class _Checked:
    """One proof in exact numbers."""

    def __init__(self, proof: Proof) -> None:
        self.proof = proof
        self.mu = Fraction(proof.friction)
        centre = [Fraction(c) for c in proof.centre_of_mass.tolist()]
        points = [[Fraction(x) - c for x, c in zip(p, centre, strict=True)] for p in proof.vertices.tolist()]
        self.points = points
        self.along = [
            [b - a for a, b in zip(p, q, strict=True)]
            for p, q in zip(points, points[1:] + points[:1], strict=True)
        ]
        self.sides = [(int(e), Fraction(lo), Fraction(hi)) for e, lo, hi in proof.sides.tolist()]
        # 1 / |edge|, rounded up
        self.per = [1 / _root_below(x * x + y * y) for x, y in self.along]
        self.slant = 1 / _root_below(1 + self.mu**2)
        self.filtered = _Doubles(proof)

    def violations(self) -> list[str]:
        """What is wrong, in words."""
        broken = [
            f"proof: side {i} is no stretch of an edge"
            for i, (e, lo, hi) in enumerate(self.sides)
            if not (0 <= e < len(self.points) and e <= lo < hi <= e + 1)
        ]
        broken += [
            f"proof: side {i + 1} does not come after the one before"
            for i, (a, b) in enumerate(zip(self.sides, self.sides[1:], strict=False))
            if b[1] < a[2]
        ]
        if broken:
            return broken
        everything = (0, len(self.sides) - 1, self.sides[0][1], self.sides[-1][2])
        if self._arcs(0) != [everything] * self.proof.fingers:
            return ["proof: box 0 must give every finger the whole boundary"]
        seen, waiting = {0}, [0]
        while waiting:
            box = waiting.pop()
            first, count = (int(c) for c in self.proof.children[box])
            if count == 0:
                broken += self._excluded(box)
                continue
            inside = range(first, first + count)
            if first <= box or first + count > len(self.proof.children) or not seen.isdisjoint(inside):
                return [*broken, f"proof: box {box} is split into boxes that are not there, or not its own"]
            seen.update(inside)
            waiting += inside
            broken += self._covered(box, inside)
        if len(seen) < len(self.proof.children):
            broken.append("proof: some boxes belong to no other")
        return broken

    def _arcs(self, box: int) -> list[Arc]:
        pairs = zip(self.proof.arcs[box].tolist(), self.proof.ends[box].tolist(), strict=True)
        return [(a, b, Fraction(lo), Fraction(hi)) for (a, b), (lo, hi) in pairs]

    def _covered(self, box: int, inside: range) -> list[str]:
        """That the boxes inside are all ways to share out the fingers on one arc to its two parts."""
        arcs, parts = self._arcs(box), [self._arcs(b) for b in inside]
        wrong = [f"proof: box {box} is not covered by the boxes it is split into"]
        split = [f for f, arc in enumerate(arcs) if any(part[f] != arc for part in parts)]
        count = len(inside) - 1
        if not split or len(split) != count or split != list(range(split[0], split[0] + count)):
            return wrong
        at = split[0]
        if any(arcs[f] != arcs[at] for f in split):
            return wrong
        left, right = parts[0][at], parts[-1][at]
        if not self._halves(arcs[at], left, right):
            return wrong
        for part, lefts in zip(parts, range(count, -1, -1), strict=True):
            if [part[f] for f in split] != [left] * lefts + [right] * (count - lefts):
                return wrong
        return []

    def _halves(self, arc: Arc, left: Arc, right: Arc) -> bool:
        """Whether two arcs make one: at a place within a side, or between two sides."""
        a, b, lo, hi = arc
        if left[0] != a or left[2] != lo or right[1] != b or right[3] != hi:
            return False
        if a == b:
            return left[1] == right[0] == a and left[3] == right[2] and lo < left[3] < hi
        c = left[1]
        return (
            a <= c < b
            and right[0] == c + 1
            and left[3] == self.sides[c][2]
            and right[2] == self.sides[c + 1][1]
        )

    def _excluded(self, box: int) -> list[str]:
        number, arcs = int(self.proof.number[box]), self._arcs(box)
        if number == -1:
            return [] if self._near(arcs) else [f"proof: fingers of box {box} may be far enough apart"]
        if not 0 <= number < len(self.proof.loads):
            return [f"proof: box {box} has no load"]
        y = [Fraction(c) for c in self.proof.twists[box].tolist()]
        work = -sum(Fraction(w) * c for w, c in zip(self.proof.loads[number].tolist(), y, strict=True))
        bound = Fraction(self.proof.bound)
        if bound <= 0 or self._is_clear(box, number):
            return []
        most = [self._most(arc, y) for arc in arcs]
        if self.proof.norm == "sum":
            dual = max(most)
        elif self.proof.norm == "largest":
            dual = sum(most, start=Fraction(0))
        else:
            dual = _root_above(sum((s * s for s in most), start=Fraction(0)))
        if work < bound * dual or (dual == 0 and work <= 0):
            return [f"proof: the twist of box {box} does not exclude it"]
        return []

    def _is_clear(self, box: int, number: int) -> bool:
        """Whether doubles show that a box is excluded, by more than all of their rounding together."""
        proof, filtered = self.proof, self.filtered
        y = proof.twists[box]
        terms = -proof.loads[number] * y
        most, room = (
            [],
            _ROUNDING * (abs(y[0]) + abs(y[1]) + abs(y[2]) * filtered.reach) * (1 + proof.friction),
        )
        if not min(room, _ROUNDING * np.abs(terms).sum()) > _SMALL:
            return False
        for (first, last), (lo, hi) in zip(proof.arcs[box].tolist(), proof.ends[box].tolist(), strict=True):
            least, largest = proof.sides[first : last + 1, 1].copy(), proof.sides[first : last + 1, 2].copy()
            least[0], largest[-1] = lo, hi
            most.append(filtered.largest(first, last, least, largest, y, proof) + room)
        if proof.norm == "sum":
            dual = max(most)
        else:
            dual = sum(most) if proof.norm == "largest" else float(np.sqrt(np.square(most).sum()))
        work = float(terms.sum() - _ROUNDING * np.abs(terms).sum())
        return bool(work > proof.bound * dual * (1 + _ROUNDING))

    def _most(self, arc: Arc, y: list[Fraction]) -> Fraction:
        """An upper bound of sigma over an arc, 0 or more."""
        first, last, lo, hi = arc
        most = Fraction(0)
        for j in range(first, last + 1):
            edge, least, largest = self.sides[j]
            for u in (lo if j == first else least, hi if j == last else largest):
                most = max(most, self._sigma(edge, u - edge, y))
        return most

    def _sigma(self, edge: int, fraction: Fraction, y: list[Fraction]) -> Fraction:
        (ax, ay), (dx, dy) = self.points[edge], self.along[edge]
        px, py = ax + fraction * dx, ay + fraction * dy
        vx, vy = y[0] - y[2] * py, y[1] + y[2] * px
        ahead, aside = dx * vy - dy * vx, abs(dx * vx + dy * vy)  # times |edge|
        if self.proof.size == "force" and aside <= self.mu * ahead:
            return _root_above(vx * vx + vy * vy)
        value = ahead + self.mu * aside
        if value <= 0:
            return Fraction(0)
        return value * self.per[edge] * (self.slant if self.proof.size == "force" else 1)

    def _near(self, arcs: list[Arc]) -> bool:
        """Whether two fingers on one side each are nearer than they must be, wherever they are."""
        least2 = Fraction(self.proof.min_distance) ** 2
        single = [arc for arc in arcs if arc[0] == arc[1]]
        corners = [[self._point(arc[0], u) for u in arc[2:]] for arc in single]
        for i, one in enumerate(corners):
            for other in corners[:i]:
                if all((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 < least2 for p in one for q in other):
                    return True
        return False

    def _point(self, side: int, u: Fraction) -> tuple[Fraction, Fraction]:
        edge = self.sides[side][0]
        (ax, ay), (dx, dy) = self.points[edge], self.along[edge]
        return ax + (u - edge) * dx, ay + (u - edge) * dy


def _root_above(value: Fraction) -> Fraction:
    """A rational at or above the root, nearly equal to it."""
    if value == 0:
        return value
    root, scale = _root(value)
    return (root + 1) / scale


def _root_below(value: Fraction) -> Fraction:
    """A rational at or below the root of a positive value, nearly equal to it."""
    root, scale = _root(value)
    return root / scale


def _root(value: Fraction) -> tuple[Fraction, Fraction]:
    """(r, s) with r / s at or just below the root of a positive value: r an integer of many bits."""
    shift = _BITS - (value.numerator.bit_length() - value.denominator.bit_length()) // 2
    scale = Fraction(2) ** shift
    return Fraction(isqrt(int(value * scale * scale))), scale
