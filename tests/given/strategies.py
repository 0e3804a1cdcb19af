"""Random planar contacts and loads, shared by the tests of the mathematics.

``Pair`` is two contacts and a load as plain numbers, in the order the closed forms take them.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import cos, hypot, sin

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

import regrasp as rg

Point = tuple[float, float]
POWERS = st.integers(-6, 6).map(lambda k: 10.0**k)
"""Units from 1e-6 to 1e6."""


@dataclass(frozen=True)
class Pair:
    """Two planar contacts and a load."""

    r1: Point
    n1: Point
    mu1: float
    r2: Point
    n2: Point
    mu2: float
    force: Point
    torque: float

    @property
    def plain(self) -> tuple[float, ...]:
        """The 13 numbers of ``squeeze_interval``."""
        return (*self.r1, *self.n1, self.mu1, *self.r2, *self.n2, self.mu2, *self.force, self.torque)

    @property
    def arguments(self) -> tuple[Point, Point, float, Point, Point, float, Point, float]:
        """The 8 arguments of ``oracle.locus`` and ``locus_intervals``."""
        return (self.r1, self.n1, self.mu1, self.r2, self.n2, self.mu2, self.force, self.torque)

    def scaled(self, length: float = 1.0, force: float = 1.0, normals: Point = (1.0, 1.0)) -> "Pair":
        """In other units, normals of other lengths."""
        return Pair(
            _times(self.r1, length),
            _times(self.n1, normals[0]),
            self.mu1,
            _times(self.r2, length),
            _times(self.n2, normals[1]),
            self.mu2,
            _times(self.force, force),
            self.torque * length * force,
        )

    def swapped(self) -> "Pair":
        """The contacts in the other order."""
        return Pair(self.r2, self.n2, self.mu2, self.r1, self.n1, self.mu1, self.force, self.torque)

    def loaded_through(self, point: Point, force: Point) -> "Pair":
        """The load a force through a point makes."""
        return replace(self, force=force, torque=point[0] * force[1] - point[1] * force[0])

    @property
    def grasp(self) -> rg.Grasp:
        return rg.Grasp([rg.Contact(self.r1, self.n1, self.mu1), rg.Contact(self.r2, self.n2, self.mu2)])

    @property
    def load(self) -> rg.Wrench:
        return rg.Wrench(self.force, self.torque)


def _times(v: Point, factor: float) -> Point:
    return v[0] * factor, v[1] * factor


# -- with a numpy generator: thousands of cases quickly -----------------------------------------------


def random_pair(rng: np.random.Generator, *, facing: float = 0.7, far: float = 0.0) -> Pair:
    """Contacts of order 1; ``facing`` of them roughly opposed, so that many loci are not empty.

    ``far`` is the largest distance of both from the origin, as a power of ten.
    """
    r1, r2 = rng.normal(size=(2, 2))
    n1, n2 = rng.normal(size=(2, 2))
    if rng.random() < facing:
        u = (r2 - r1) / np.linalg.norm(r2 - r1)
        inward = rng.choice([1, 1, -1])  # or pushing apart, as inside a ring
        n1, n2 = inward * u + 0.5 * n1, -inward * u + 0.5 * n2
    if far:
        offset = 10.0 ** rng.uniform(0, far) * rng.normal(size=2)
        r1, r2 = r1 + offset, r2 + offset
    mu1, mu2 = rng.choice([1e-8, 1e-3, 0.1, 0.3, 0.5, 1.0, 5.0, rng.random()], 2)
    force, torque = rng.normal(size=2), rng.normal()
    kind = rng.integers(5)
    if kind == 0:
        force = 0 * force  # pure torque
    if kind == 1:
        torque = 0.0
    return Pair(
        _pair(r1), _pair(n1), float(mu1), _pair(r2), _pair(n2), float(mu2), _pair(force), float(torque)
    )


def comfortable_pair(rng: np.random.Generator) -> tuple[rg.Grasp, rg.Wrench]:
    """Two contacts that hold a load with room to spare: a solver's tolerance stays in the seventh digit."""
    while True:
        pair = random_pair(rng, facing=1.0)
        locus = rg.EquilibriumLocus(pair.grasp, pair.load)
        lo, hi = locus.interval
        if min(pair.mu1, pair.mu2) >= 0.1 and hi - lo > 0.1 and min(abs(lo), abs(hi)) < 10:
            return pair.grasp, pair.load


LATTICE_FRICTIONS = (0.0, 0.25, 0.5, 1.0, 2.0, 3.0)


def lattice_pair(rng: np.random.Generator) -> Pair:
    """Small integers: cone edges exactly along the line of contacts, loads exactly through contacts."""
    while True:
        r1, r2, n1, n2 = rng.integers(-4, 5, (4, 2)).astype(float)
        if (r1 != r2).any() and n1.any() and n2.any():
            break
    mu1, mu2 = rng.choice(LATTICE_FRICTIONS, 2)
    force = rng.integers(-3, 4, 2).astype(float) * rng.choice([0, 1, 1, 1])
    pair = Pair(_pair(r1), _pair(n1), float(mu1), _pair(r2), _pair(n2), float(mu2), _pair(force), 0.0)
    kind = rng.integers(4)
    if kind == 0:
        return replace(pair, torque=float(rng.integers(-6, 7)))
    return pair.loaded_through([pair.r1, pair.r2, (0.0, 0.0)][kind - 1], pair.force)


def _pair(v: np.ndarray) -> Point:
    return float(v[0]), float(v[1])


# -- with hypothesis: shrinking to the simplest failure -------------------------------------------------

_coordinate = st.floats(-4, 4).map(lambda x: round(x, 3) + 0.0)
_plain = st.integers(-4, 4).map(float)
coordinates = st.one_of(_coordinate, _plain)
points = st.tuples(coordinates, coordinates)
angles = st.floats(-3.14, 3.14)
directions = points.filter(lambda v: hypot(*v) > 0.1)
frictions = st.one_of(
    st.sampled_from([1e-8, 1e-3, 0.1, 0.25, 0.3, 0.5, 1.0, 2.0, 5.0]),
    st.floats(0.01, 2.0).map(lambda x: round(x, 3)),
)

ordinary_sizes = st.floats(0.1, 4.0).map(lambda x: round(x, 2))
uneven_sizes = st.one_of(ordinary_sizes, st.sampled_from([0.0, 1e-6, 1e-5, 1e-3]))


@st.composite
def pairs(draw: Callable, frictions: st.SearchStrategy[float] = frictions, zero_load: bool = True) -> Pair:
    """Two planar contacts under any load, degenerate ones often: whole numbers, loads through contacts."""
    r1 = draw(points)
    r2 = draw(points.filter(lambda r: hypot(r[0] - r1[0], r[1] - r1[1]) > 0.1))
    pair = Pair(r1, draw(directions), draw(frictions), r2, draw(directions), draw(frictions), (0.0, 0.0), 0.0)
    force = draw(points if zero_load else directions)
    through = draw(st.sampled_from(["free", "first", "second", "origin"]))
    if through == "free":
        return replace(pair, force=force, torque=draw(coordinates))
    return pair.loaded_through({"first": r1, "second": r2, "origin": (0.0, 0.0)}[through], force)


@st.composite
def held_pairs(
    draw: Callable,
    frictions: st.SearchStrategy[float] = frictions,
    sizes: st.SearchStrategy[float] = ordinary_sizes,
) -> Pair:
    """Two contacts and a load they hold, made from forces inside the cones, so that no draw is lost."""
    pair = draw(pairs(frictions))
    forces = [draw(forces_in_cone(n, mu, sizes)) for n, mu in ((pair.n1, pair.mu1), (pair.n2, pair.mu2))]
    if not sum(forces).any():
        forces = [np.array(pair.n1), 0 * forces[1]]
    torque = sum(r[0] * f[1] - r[1] * f[0] for r, f in zip((pair.r1, pair.r2), forces, strict=True))
    return replace(pair, force=_pair(-sum(forces)), torque=-float(torque))


@st.composite
def forces_in_cone(
    draw: Callable, n: Point, mu: float, sizes: st.SearchStrategy[float] = ordinary_sizes
) -> np.ndarray:
    """A force inside the cone of normal n, at most nine tenths of the way to its edges."""
    size = draw(sizes)
    share = draw(st.floats(-0.9, 0.9).map(lambda x: round(x, 2)))
    normal = np.array(n) / hypot(*n)
    return size * (normal + share * mu * np.array([-normal[1], normal[0]]))


@st.composite
def held_triples(
    draw: Callable, frictions: st.SearchStrategy[float] = frictions
) -> tuple[rg.Grasp, rg.Wrench]:
    """Three contacts, A, B and C, of which A and B alone hold the load."""
    pair = draw(held_pairs(frictions))
    away = points.filter(lambda r: min(_distance(r, pair.r1), _distance(r, pair.r2)) > 0.1)
    return (
        rg.Grasp(
            [
                rg.Contact(pair.r1, pair.n1, pair.mu1, name="A"),
                rg.Contact(pair.r2, pair.n2, pair.mu2, name="B"),
                rg.Contact(draw(away), draw(directions), draw(frictions), name="C"),
            ]
        ),
        pair.load,
    )


@st.composite
def grooves(draw: Callable) -> tuple[rg.Grasp, rg.Wrench]:
    """An object pressed into a frictionless V by its load, and a finger C with friction on top.

    The two rays meet the line of contacts at 0.05 rad or more: nearer, rounding of the coordinates decides
    whether they meet one another at all.
    """
    left, right, turn = draw(st.floats(0.3, 1.2)), draw(st.floats(0.3, 1.2)), draw(angles)
    places = (
        ("A", (-draw(st.floats(0.5, 2)), -0.5), (sin(left), cos(left)), 0.0),
        ("B", (draw(st.floats(0.5, 2)), 0.2), (-sin(right), cos(right)), 0.0),
        ("C", (0.1, 2.0), (0.1, -1.0), 0.5),
    )
    (ax, ay), (bx, by) = places[0][1], places[1][1]
    for _, _, n, _ in places[:2]:
        assume(abs((bx - ax) * n[1] - (by - ay) * n[0]) > 0.05 * hypot(bx - ax, by - ay))
    contacts = [rg.Contact(turned(r, turn), turned(n, turn), mu, name=name) for name, r, n, mu in places]
    load = rg.Wrench([0, 0])
    for contact in contacts[:2]:
        f, r = draw(st.floats(0.5, 2)) * contact.normal, contact.position
        load -= rg.Wrench(f, float(r[0] * f[1] - r[1] * f[0]))
    return rg.Grasp(contacts), load


def _distance(a: Point, b: Point) -> float:
    return hypot(a[0] - b[0], a[1] - b[1])


def turned(v: Point, angle: float) -> Point:
    return cos(angle) * v[0] - sin(angle) * v[1], sin(angle) * v[0] + cos(angle) * v[1]


def comfortable_triple(rng: np.random.Generator) -> tuple[rg.Grasp, rg.Wrench]:
    """Three contacts around a disc, roughly facing its middle."""
    angles = 2 * np.pi * (np.arange(3) + 0.3 * rng.uniform(-1, 1, 3)) / 3
    contacts = [
        rg.Contact([np.cos(a), np.sin(a)], [-np.cos(a + d), -np.sin(a + d)], mu)
        for a, d, mu in zip(angles, 0.2 * rng.normal(size=3), rng.uniform(0.3, 1.0, 3), strict=True)
    ]
    return rg.Grasp(contacts), rg.Wrench(rng.normal(size=2), 0.1 * rng.normal())
