"""Random drawings with areas known by Green's theorem, to test readers with: nothing of theirs is used."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator


@dataclass(frozen=True)
class Line:
    """From a to b."""

    a: np.ndarray
    b: np.ndarray

    def area(self) -> float:
        return cross(self.a, self.b) / 2

    def mapped(self, m: np.ndarray, s: np.ndarray) -> "Line":
        return Line(m @ self.a + s, m @ self.b + s)


@dataclass(frozen=True)
class Cubic:
    """Bezier of four control points (4, 2)."""

    control: np.ndarray

    @property
    def a(self) -> np.ndarray:
        return self.control[0]

    @property
    def b(self) -> np.ndarray:
        return self.control[3]

    def area(self) -> float:
        """x dy - y dx is of degree 5 in t: six Gauss points are exact."""
        t, w = np.polynomial.legendre.leggauss(6)
        t, w = (t + 1) / 2, w / 2
        p, s = self.control, 1 - t
        x = (
            np.outer(s**3, p[0])
            + np.outer(3 * s**2 * t, p[1])
            + np.outer(3 * s * t**2, p[2])
            + np.outer(t**3, p[3])
        )
        dx = 3 * (
            np.outer(s**2, p[1] - p[0]) + np.outer(2 * s * t, p[2] - p[1]) + np.outer(t**2, p[3] - p[2])
        )
        return float((w * (x[:, 0] * dx[:, 1] - x[:, 1] * dx[:, 0])).sum() / 2)

    def mapped(self, m: np.ndarray, s: np.ndarray) -> "Cubic":
        return Cubic(self.control @ m.T + s)


@dataclass(frozen=True)
class Arc:
    """centre + u cos t + v sin t."""

    centre: np.ndarray
    u: np.ndarray
    v: np.ndarray
    start: float
    end: float

    def at(self, t: float) -> np.ndarray:
        return self.centre + self.u * np.cos(t) + self.v * np.sin(t)

    @property
    def a(self) -> np.ndarray:
        return self.at(self.start)

    @property
    def b(self) -> np.ndarray:
        return self.at(self.end)

    def area(self) -> float:
        return (cross(self.u, self.v) * (self.end - self.start) + cross(self.centre, self.b - self.a)) / 2

    def mapped(self, m: np.ndarray, s: np.ndarray) -> "Arc":
        return replace(self, centre=m @ self.centre + s, u=m @ self.u, v=m @ self.v)


Segment = Line | Cubic | Arc


def cross(a: np.ndarray, b: np.ndarray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def area(loop: list[Segment]) -> float:
    """Of the inside of a closed loop."""
    return abs(sum(segment.area() for segment in loop))


def mapped(loop: list[Segment], m: np.ndarray, s: np.ndarray) -> list[Segment]:
    return [segment.mapped(m, s) for segment in loop]


def random_loop(
    rng: Generator, size: float, at: tuple[float, float] = (0, 0), kinds: str = "LCA"
) -> list[Segment]:
    """A simple closed loop around ``at`` of half extent ``size``, that contains a disc of 0.4 times that.

    kinds: L lines, C cubics, A elliptical arcs, B circular arcs.
    """
    n = int(rng.integers(5, 9))
    angle = 2 * np.pi * (np.arange(n) + 0.3 * rng.uniform(-1, 1, n)) / n
    radius = size * rng.uniform(0.75, 1, n)
    corners = np.array(at) + radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    loop: list[Segment] = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        kind = rng.choice(list(kinds))
        if kind == "L":
            loop.append(Line(a, b))
        elif kind == "C":
            side = 0.2 * np.array([-(b - a)[1], (b - a)[0]])
            bends = rng.uniform(-1, 1, 2)
            loop.append(
                Cubic(np.array([a, a + (b - a) / 3 + bends[0] * side, b - (b - a) / 3 + bends[1] * side, b]))
            )
        else:
            loop.append(_bow(rng, a, b, np.eye(2) if kind == "B" else _stretch(rng)))
    return loop


def _stretch(rng: Generator) -> np.ndarray:
    t = rng.uniform(0, np.pi)
    turn = np.array([[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]])
    return turn @ np.diag([1.0, rng.uniform(0.6, 1.6)])


def _bow(rng: Generator, a: np.ndarray, b: np.ndarray, stretch: np.ndarray) -> Arc:
    """An arc of a stretched circle from a to b, bent by up to 0.2 of the chord to either side."""
    p, q = np.linalg.solve(stretch, a), np.linalg.solve(stretch, b)
    half, bulge = (q - p) / 2, float(rng.choice([-1, 1]) * rng.uniform(0.1, 0.35))
    centre = (p + q) / 2 + np.array([-half[1], half[0]]) * (1 - bulge**2) / (2 * bulge)
    u = p - centre
    return Arc(stretch @ centre, stretch @ u, stretch @ np.array([-u[1], u[0]]), 0.0, 4 * np.arctan(bulge))


def ellipse(centre: tuple[float, float], a: float, b: float) -> list[Segment]:
    return [Arc(np.array(centre), np.array([a, 0.0]), np.array([0.0, b]), 0.0, 2 * np.pi)]


def rectangle(x: float, y: float, w: float, h: float) -> list[Segment]:
    corners = np.array([(x, y), (x + w, y), (x + w, y + h), (x, y + h)])
    return [Line(a, b) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]


# -- SVG ----------------------------------------------------------------------------------------------------


def path_data(rng: Generator, loop: list[Segment], close: str = "Z") -> str:
    """``d`` of a loop, in absolute or relative commands at random."""
    at = loop[0].a
    words = [f"M{_n(at)}"]
    for segment in loop:
        relative = bool(rng.integers(2))
        base = at if relative else np.zeros(2)
        if isinstance(segment, Line):
            word = f"L{_n(segment.b - base)}"
        elif isinstance(segment, Cubic):
            word = "C" + " ".join(_n(p - base) for p in segment.control[1:])
        else:
            word = _arc_words(segment, base)
        words.append(word[0].lower() + word[1:] if relative else word)
        at = segment.b
    return " ".join(words) + close


def _arc_words(arc: Arc, base: np.ndarray) -> str:
    """One command, or two for more than half a turn."""
    turn = arc.end - arc.start
    if abs(turn) > 6:
        middle = (arc.start + arc.end) / 2
        parts = [replace(arc, end=middle), replace(arc, start=middle)]
    else:
        parts = [arc]
    axes, radii, other = np.linalg.svd(np.column_stack([arc.u, arc.v]))
    degrees = np.degrees(np.arctan2(axes[1, 0], axes[0, 0]))
    counter = np.linalg.det(axes) * np.linalg.det(other) * turn > 0
    ellipse = f"{float(radii[0])!r} {float(radii[1])!r} {float(degrees)!r}"
    words = [f"{ellipse} {int(abs(p.end - p.start) > np.pi)} {int(counter)} {_n(p.b - base)}" for p in parts]
    return "A" + (words[0] if len(parts) == 1 else words[0] + "A" + words[1])


def _n(point: np.ndarray) -> str:
    return f"{float(point[0])!r},{float(point[1])!r}"


def random_transform(rng: Generator) -> tuple[str, np.ndarray]:
    """One SVG transform function and its matrix (2, 3)."""
    kind = rng.integers(5)
    x, y = (float(v) for v in rng.uniform(0.4, 2.5, 2) * rng.choice([-1, 1], 2))
    t = rng.uniform(-np.pi, np.pi)
    if kind == 0:
        return f"translate({x!r} {y!r})", np.array([[1, 0, x], [0, 1, y]])
    if kind == 1:
        return f"scale({x!r},{y!r})", np.array([[x, 0, 0], [0, y, 0]])
    if kind == 2:
        c, s = np.cos(t), np.sin(t)
        return f"rotate({float(np.degrees(t))!r})", np.array([[c, -s, 0], [s, c, 0]])
    if kind == 3:
        k = rng.uniform(-0.8, 0.8)
        return f"skewX({float(np.degrees(np.arctan(k)))!r})", np.array([[1, k, 0], [0, 1, 0]])
    m = rng.uniform(-1, 1, (2, 2)) + 1.5 * np.eye(2)
    a, b, c, d = (float(v) for v in m.T.ravel())
    return (
        f"matrix({a!r} {b!r} {c!r} {d!r} {x!r} {y!r})",
        np.array([[m[0, 0], m[0, 1], x], [m[1, 0], m[1, 1], y]]),
    )
