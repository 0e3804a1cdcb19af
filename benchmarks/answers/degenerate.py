"""Small degenerate and badly scaled choices of forces, with the verdict known from how they are made."""

from dataclasses import dataclass
from math import cos, pi, sin, sqrt

from regrasp import Contact, Grasp, Wrench

Point = tuple[float, float]


@dataclass(frozen=True)
class Degenerate:
    """contacts: (position, normal, friction, force limit or None) each. load: force and torque.

    held: whether forces exist; None right at the limit, where rounding of the data decides.
    """

    name: str
    contacts: tuple[tuple[Point, Point, float, float | None], ...]
    load: tuple[float, float, float]
    held: bool | None

    @property
    def grasp(self) -> Grasp:
        """The contacts as regrasp takes them."""
        return Grasp([Contact(r, n, mu, max_force=limit) for r, n, mu, limit in self.contacts])

    @property
    def wrench(self) -> Wrench:
        """The load as regrasp takes it."""
        return Wrench(self.load[:2], self.load[2])


def degenerate_cases() -> list[Degenerate]:
    """Every case, names unique."""
    return [
        *_parallel(),
        *_collinear(),
        *_no_load(),
        *_frictionless(),
        *_at_the_limit(),
        *_close(),
        *_scaled(),
    ]


UP, DOWN, LEFT, RIGHT = (0.0, 1.0), (0.0, -1.0), (-1.0, 0.0), (1.0, 0.0)


def _at(places: list[Point], normals: list[Point], mu: float, limit: float | None = None) -> tuple:
    return tuple((r, n, mu, limit) for r, n in zip(places, normals, strict=True))


def _parallel() -> list[Degenerate]:
    below = _at([(-1.0, -1.0), (0.0, -1.0), (1.0, -1.0)], [UP] * 3, 0.5)
    alike = _at([(-1.0, -1.0), (1.0, -1.0)], [UP] * 2, 0.5)
    return [
        Degenerate("parallel cones under a weight", below, (0.0, -1.0, 0.0), True),
        Degenerate("parallel cones and a pull", below, (0.0, 1.0, 0.0), False),
        Degenerate("parallel cones and a push aside", below, (0.6, -1.0, 0.6), False),
        Degenerate("parallel cones and a moment alone", below, (0.0, 0.0, 1.0), False),
        Degenerate("parallel cones and a weight beyond them", alike, (0.0, -1.0, -1.5), False),
        Degenerate("parallel cones and a weight over one of them", alike, (0.0, -1.0, -1.0), None),
    ]


def _collinear() -> list[Degenerate]:
    row = [(-1.0, 0.0), (0.0, 0.0), (1.0, 0.0)]
    facing = _at(row, [RIGHT, RIGHT, LEFT], 0.5)
    across = _at(row, [UP, DOWN, UP], 0.0)
    return [
        Degenerate("three on a line, facing along it", facing, (0.0, -1.0, 0.0), True),
        Degenerate("three on a line and a moment", facing, (0.0, 0.0, 1.0), True),
        Degenerate("three smooth ones across a line", across, (0.0, 0.5, 0.5), True),
        Degenerate("three smooth ones and a push along the line", across, (0.1, 0.0, 0.0), False),
        Degenerate("two facing, a load along their line", facing[1:], (1.0, 0.0, 0.0), True),
    ]


def _no_load() -> list[Degenerate]:
    pair = [(-1.0, 0.0), (1.0, 0.0)]
    apart = _at(pair, [LEFT, RIGHT], 0.5, 2.0)
    return [
        Degenerate("no load, limits", _at(pair, [RIGHT, LEFT], 0.5, 2.0), (0.0, 0.0, 0.0), True),
        Degenerate("no load, no limits", _at(pair, [RIGHT, LEFT], 0.5), (0.0, 0.0, 0.0), True),
        Degenerate("no load, fingers that pull apart", apart, (0.0, 0.0, 0.0), True),
        Degenerate("no load, parallel cones", _at(pair, [UP, UP], 0.5, 2.0), (0.0, 0.0, 0.0), True),
    ]


def _frictionless() -> list[Degenerate]:
    angles = [0.5 * pi + 2 * pi * k / 3 for k in range(3)]
    ring = _at([(cos(a), sin(a)) for a in angles], [(-cos(a), -sin(a)) for a in angles], 0.0)
    square = _at([(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0)], [RIGHT, LEFT, UP], 0.0)
    groove = (((-1.0, 0.0), (1.0, 1.0), 0.0, None), ((1.0, 0.0), (-1.0, 1.0), 0.0, None))
    return [
        Degenerate("smooth ring, a moment", ring, (0.0, 0.0, 0.1), False),
        Degenerate("smooth ring, a weight", ring, (0.0, -1.0, 0.0), None),  # rounded normals miss the centre
        Degenerate("smooth square, a weight", square, (0.0, -1.0, 0.0), True),
        Degenerate("smooth groove, a weight", groove, (0.0, -1.0, 0.0), True),
        Degenerate("smooth groove and a rough finger", (*groove, ((0.0, 2.0), DOWN, 0.5, None)),
                   (0.1, -1.0, -0.2), True),
    ]  # fmt: skip


def _at_the_limit() -> list[Degenerate]:
    pair = [(-1.0, 0.0), (1.0, 0.0)]
    cases = []
    for name, by in (("exactly", 0.0), ("a 1e-12 inside", -1e-12), ("a 1e-6 inside", -1e-6)):
        below = _at([(-1.0, -1.0), (1.0, -1.0)], [UP, UP], 0.5)
        held = True if by == -1e-6 else None
        cases.append(Degenerate(f"edge of the cones, {name}", below, (0.5 + by, -1.0, 0.5 + by), held))
        limit = sqrt(1.25) * (1 - by)
        squeezed = _at(pair, [RIGHT, LEFT], 0.5, limit)
        cases.append(Degenerate(f"squeeze of no length, {name}", squeezed, (0.0, -1.0, 0.0), held))
    below = _at([(-1.0, -1.0), (1.0, -1.0)], [UP, UP], 0.5)
    cases.append(Degenerate("edge of the cones, a 1e-6 outside", below, (0.5 + 1e-6, -1.0, 0.5), False))
    short = _at(pair, [RIGHT, LEFT], 0.5, sqrt(1.25) * (1 - 1e-6))
    cases.append(Degenerate("squeeze of no length, a 1e-6 outside", short, (0.0, -1.0, 0.0), False))
    return cases


def _close() -> list[Degenerate]:
    cases = []
    for gap in (1e-3, 1e-6, 1e-9):
        pair = _at([(0.0, 1.0), (gap, 1.0)], [RIGHT, LEFT], 0.5)
        cases.append(Degenerate(f"contacts {gap:g} apart, a weight", pair, (0.0, -1.0, 0.0), True))
        cases.append(Degenerate(f"contacts {gap:g} apart, a moment", pair, (0.0, 0.0, gap), True))
        above = _at([(-gap, -1.0), (gap, -1.0), (0.0, 1.0)], [UP, UP, DOWN], 0.5)
        cases.append(Degenerate(f"two of three contacts {2 * gap:g} apart", above, (0.1, -1.0, 0.0), True))
    return cases


def _scaled() -> list[Degenerate]:
    places, normals = [(-4.0, -4.0), (4.0, -5.0), (0.0, 8.0)], [(1.0, 1.0), (-1.0, 2.0), DOWN]
    cases = []
    for length in (1e-6, 1.0, 1e6):
        for force in (1e-6, 1e6):
            moved = _at([(x * length, y * length) for x, y in places], normals, 0.3)
            load = (-1.5 * force, -3.5 * force, 0.0)
            cases.append(Degenerate(f"paper, lengths {length:g}, forces {force:g}", moved, load, True))
            pulled = (0.0, 3.5 * force, 40.0 * force * length)
            cases.append(Degenerate(f"paper's pair, pulled, lengths {length:g}, forces {force:g}",
                                    moved[:2], pulled, False))  # fmt: skip
    facing = _at([(-1.0, 0.0), (1.0, 0.0)], [RIGHT, LEFT], 1e-6)
    weak = (((-1.0, -1.0), UP, 0.5, 1e-6), ((0.0, -1.0), UP, 0.5, 1e6), ((1.0, -1.0), UP, 0.5, None))
    return [
        *cases,
        Degenerate("hardly any friction", facing, (0.0, -1.0, 0.0), True),
        Degenerate("limits a million million apart", weak, (0.0, -1.0, 0.0), True),
        Degenerate("a tiny load beside huge limits",
                   _at([(-1.0, 0.0), (1.0, 0.0)], [RIGHT, LEFT], 0.5, 1e6), (0.0, -1e-6, 0.0), True),
        Degenerate("a moment huge beside the force", _at([(-1.0, 0.0), (1.0, 0.0)], [RIGHT, LEFT], 0.5),
                   (0.0, -1e-6, 1e3), True),
    ]  # fmt: skip
