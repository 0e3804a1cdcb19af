"""Mechanics of planar contacts in exact rational arithmetic, written from the mathematics.

Doubles are rationals, so nothing here rounds. Independent of the source: no name of regrasp is imported.

Two contacts. With d = P_2 - P_1 and p = (-d_y, d_x), not normalised, equilibrium leaves

    f_1 = X d + A p,    f_2 = -F - f_1,    A = (tau - r_2 x F) / |d|^2,

X free: the squeeze per unit of |P_1 P_2|. For a normal n of any length and t = (-n_y, n_x) the cone is
mu n.f - t.f >= 0, mu n.f + t.f >= 0, n.f >= 0: linear in X.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, sqrt

Vector = list[Fraction]

PARALLEL = Fraction(1, 10**12)
"""Sine below which an edge of a cone is parallel to the line of contacts."""


@dataclass(frozen=True)
class Bound:
    """A bound on the squeeze: ``value`` per unit of |P_1 P_2|, the sine of its edge with the line."""

    value: Fraction
    sine: float


@dataclass(frozen=True)
class ExactLocus:
    """The interval of X; an end without bound is None. ``empty`` may be true with both ends given.

    ``miss`` is how far [force] an edge parallel to the line of contacts excludes every X; 0 if none does.
    """

    lo: Bound | None
    hi: Bound | None
    empty: bool
    length: float
    """|P_1 P_2|."""
    miss: float
    terms: float
    """Size of the terms the ends are made of, in force: |F| + (|tau| + |r| |F|) / |P_1 P_2|."""

    @property
    def verdict(self) -> str:
        if self.empty:
            return "empty"
        return {(True, True): "bounded", (True, False): "above", (False, True): "below"}.get(
            (self.lo is not None, self.hi is not None), "unbounded"
        )

    @property
    def width(self) -> float:
        """Length of the interval in force, negative for the gap of an empty one; infinite without ends."""
        if self.lo is None or self.hi is None:
            return inf
        return float(self.hi.value - self.lo.value) * self.length

    def ends(self) -> tuple[float, float]:
        """(lo, hi) of the squeeze [N], to rounding."""
        lo = -inf if self.lo is None else float(self.lo.value) * self.length
        hi = inf if self.hi is None else float(self.hi.value) * self.length
        return (inf, -inf) if self.empty else (lo, hi)


def exact(values: Iterable[float]) -> Vector:
    return [Fraction(float(v)) for v in values]


def dot(a: Vector, b: Vector) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), start=Fraction(0))


def cross(a: Vector, b: Vector) -> Fraction:
    return a[0] * b[1] - a[1] * b[0]


def turned(a: Vector) -> Vector:
    return [-a[1], a[0]]


def rows_of_cone(n: Vector, mu: Fraction) -> tuple[Vector, Vector, Vector]:
    """The three vectors m with m.f >= 0 for every force in the cone."""
    t = turned(n)
    return (
        [mu * a - b for a, b in zip(n, t, strict=True)],
        [mu * a + b for a, b in zip(n, t, strict=True)],
        n,
    )


def in_cone(f: Vector, n: Vector, mu: Fraction) -> bool:
    return all(dot(m, f) >= 0 for m in rows_of_cone(n, mu))


def pair_forces(
    r1: Sequence[float], r2: Sequence[float], force: Sequence[float], torque: float, X: Fraction
) -> tuple[Vector, Vector]:
    """(f_1, f_2) at a squeeze of X per unit of |P_1 P_2|."""
    d, p, A, F = _frame(exact(r1), exact(r2), exact(force), Fraction(float(torque)))
    f1 = [X * a + A * b for a, b in zip(d, p, strict=True)]
    return f1, [-a - b for a, b in zip(F, f1, strict=True)]


def locus(
    r1: Sequence[float],
    n1: Sequence[float],
    mu1: float,
    r2: Sequence[float],
    n2: Sequence[float],
    mu2: float,
    force: Sequence[float],
    torque: float,
    parallel: Fraction = PARALLEL,
) -> ExactLocus:
    """The exact interval, edges within ``parallel`` of the line of contacts taken as parallel to it."""
    p1, p2, load = exact(r1), exact(r2), exact(force)
    d, p, A, F = _frame(p1, p2, load, Fraction(float(torque)))
    dd = dot(d, d)
    lo: Bound | None = None
    hi: Bound | None = None
    miss = 0.0
    for slope, offset, size, sine2 in _bounds(d, p, A, F, (n1, mu1), (n2, mu2)):
        if sine2 <= parallel**2:
            miss = max(miss, float(-offset) / size)
            continue
        bound = Bound(-offset / slope, sqrt(sine2))
        if slope > 0 and (lo is None or bound.value > lo.value):
            lo = bound
        if slope < 0 and (hi is None or bound.value < hi.value):
            hi = bound
    empty = miss > 0 or (lo is not None and hi is not None and lo.value > hi.value)
    length = sqrt(dd)
    weight = sqrt(dot(F, F))
    reach = max(sqrt(dot(p1, p1)), sqrt(dot(p2, p2)))
    return ExactLocus(lo, hi, empty, length, miss, weight + (abs(float(torque)) + reach * weight) / length)


def sines(
    r1: Sequence[float],
    n1: Sequence[float],
    mu1: float,
    r2: Sequence[float],
    n2: Sequence[float],
    mu2: float,
) -> list[float]:
    """Sines of the angles between the four cone edges and the line of contacts."""
    d = [b - a for a, b in zip(exact(r1), exact(r2), strict=True)]
    rows = [
        m
        for n, mu in ((n1, mu1), (n2, mu2))
        for m in rows_of_cone(exact(n), Fraction(float(mu)))[:2]  # edges only
    ]
    return [sqrt(dot(m, d) ** 2 / (dot(m, m) * dot(d, d))) for m in rows]


def _frame(r1: Vector, r2: Vector, F: Vector, tau: Fraction) -> tuple[Vector, Vector, Fraction, Vector]:
    d = [b - a for a, b in zip(r1, r2, strict=True)]
    return d, turned(d), (tau - cross(r2, F)) / dot(d, d), F


def _bounds(
    d: Vector, p: Vector, A: Fraction, F: Vector, *cones: tuple[Sequence[float], float]
) -> Iterator[tuple[Fraction, Fraction, float, Fraction]]:
    """(slope, offset, length of the row, sine^2) of every row slope X + offset >= 0."""
    for i, (normal, friction) in enumerate(cones):
        n, mu = exact(normal), Fraction(float(friction))
        edges = rows_of_cone(n, mu)
        for m in edges if mu == 0 else edges[:2]:  # with friction the edges imply n.f >= 0
            slope, offset = dot(m, d), A * dot(m, p)
            if i == 1:
                slope, offset = -slope, -offset - dot(m, F)
            yield slope, offset, sqrt(dot(m, m)), slope * slope / (dot(m, m) * dot(d, d))


def is_held(
    positions: Iterable[Sequence[float]],
    normals: Iterable[Sequence[float]],
    frictions: Iterable[float],
    limits: Iterable[float | None],
    load: Sequence[float],
    forces: Iterable[Sequence[Fraction | float]],
    resolution: Fraction = Fraction(1, 2**40),
) -> tuple[bool, bool, bool]:
    """(balanced, inside the cones, within the limits), each decided exactly.

    Forces, and torques per largest |r_i|, balance to ``resolution`` of the largest of load and forces;
    friction below the resolution counts as the resolution.
    """
    r = [exact(p) for p in positions]
    f = [[Fraction(x) for x in force] for force in forces]
    F, tau = exact(load[:2]), Fraction(float(load[2]))
    arm2 = max(dot(p, p) for p in r) or Fraction(1)
    total = [sum((x[k] for x in f), start=F[k]) for k in (0, 1)]
    torque = sum((cross(p, x) for p, x in zip(r, f, strict=True)), start=tau)
    scale2 = max(dot(F, F), tau * tau / arm2, *(dot(x, x) for x in f))
    balanced = max(dot(total, total), torque * torque / arm2) <= resolution**2 * scale2
    inside = all(
        in_cone(x, exact(n), max(Fraction(float(mu)), resolution))
        for x, n, mu in zip(f, normals, frictions, strict=True)
    )
    within = all(
        limit is None or dot(x, x) <= Fraction(float(limit)) ** 2 for x, limit in zip(f, limits, strict=True)
    )
    return balanced, inside, within


def opposition(twist: Sequence[float], r: Sequence[float], n: Sequence[float], mu: float) -> float:
    """The most work one newton inside the cone can do against a planar motion (v_x, v_y, omega); 0 if none.

    From the definition: minus the least f . (v + omega x r) over unit f in the cone, exact before the roots.
    """
    vx, vy, omega = exact(twist)
    place = exact(r)
    velocity = [vx - omega * place[1], vy + omega * place[0]]
    normal, friction = exact(n), Fraction(float(mu))
    if any(velocity) and in_cone([-x for x in velocity], normal, friction):
        return sqrt(dot(velocity, velocity))
    t = turned(normal)
    edges = [[a + s * friction * b for a, b in zip(normal, t, strict=True)] for s in (1, -1)]
    return max(0.0, *(float(-dot(e, velocity)) / sqrt(dot(e, e)) for e in edges))


def power(twist: Sequence[float], wrench: Sequence[float]) -> Fraction:
    """Work of a wrench along a motion."""
    return dot(exact(twist), exact(wrench))
