"""Curves of drawings as chords."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.value import numbers

# Half of what two neighbouring chords may turn by: the turn from a chord's first half to its second.
_HALF_TURN = np.radians(1.0)
_FIRST, _HALVINGS = 4, 14
_QUARTERS = np.array([0.25, 0.5, 0.75])


@dataclass(frozen=True)
class Curve:
    """A piece of a drawing: points ``at`` (m, d) for parameters (m,) from start to end.

    inner: parameters in between, where it need not be smooth. straight: whether it is so between them.
    """

    at: Callable[[Array], Array]
    start: float = 0.0
    end: float = 1.0
    straight: bool = False
    inner: tuple[float, ...] = ()

    def mapped(self, matrix: Array, shift: Array) -> "Curve":
        """The curve of the points matrix x + shift."""
        at = self.at
        return replace(self, at=lambda t: at(t) @ matrix.T + shift)

    @property
    def breaks(self) -> Array:
        """(k,) parameters between which the curve is smooth."""
        return np.array([self.start, *self.inner, self.end])

    def rough(self) -> Array:
        """(m, d) some points, to see how large it is."""
        breaks = self.breaks
        return self.at(breaks if self.straight else np.linspace(breaks[0], breaks[-1], 9))


def line(a: Array, b: Array) -> Curve:
    """The straight piece from a (d,) to b (d,)."""
    return Curve(lambda t: a + t[:, None] * (b - a), straight=True)


def polyline(points: Array) -> Curve:
    """The straight pieces through points (k, d), k at least 2."""
    last = len(points) - 1

    def at(t: Array) -> Array:
        i = np.clip(t.astype(int), 0, last - 1)
        u = (t - i)[:, None]
        result: Array = points[i] * (1 - u) + points[i + 1] * u
        return result

    return Curve(at, 0.0, float(last), straight=True, inner=tuple(range(1, last)))


def arc(centre: Array, u: Array, v: Array, start: float, end: float) -> Curve:
    """The points centre + u cos t + v sin t: an ellipse's, with u and v any two conjugate radii (d,)."""
    return Curve(lambda t: centre + np.cos(t)[:, None] * u + np.sin(t)[:, None] * v, start, end)


def bezier(control: Array) -> Curve:
    """The Bezier curve of control points (k, d), by de Casteljau's averages."""

    def at(t: Array) -> Array:
        points, s = control[:, None, :], t[:, None]
        while len(points) > 1:
            points = (1 - s) * points[:-1] + s * points[1:]
        result: Array = points[0] + 0 * s
        return result

    return Curve(at)


def flattened(curve: Curve, tolerance: float) -> Array:
    """(k, 2) points from end to end: chords within ``tolerance`` of the curve, turning 2 degrees at most.

    A chord is compared with the curve at its quarters, so that an S of one inflection does not look straight.
    Raises ``InvalidInput`` for points that are not finite.
    """
    breaks = curve.breaks
    if curve.straight:
        points = curve.at(breaks)
        check_finite(points)
        return points
    t = np.interp(np.arange(_FIRST * (breaks.size - 1) + 1) / _FIRST, np.arange(breaks.size), breaks)
    points = curve.at(t)
    check_finite(points)
    doubtful = np.arange(t.size - 1)  # chords not yet found good
    for _ in range(_HALVINGS):
        begin, step = t[doubtful], t[doubtful + 1] - t[doubtful]
        inside = curve.at((begin[:, None] + step[:, None] * _QUARTERS).ravel()).reshape(-1, 3, 2)
        rough = _rough(points[doubtful], inside, points[doubtful + 1], tolerance)
        if not rough.any():
            break
        halved = doubtful[rough] + 1
        t = np.insert(t, halved, (begin + step / 2)[rough])
        points = np.insert(points, halved, inside[rough, 1], axis=0)
        first = halved - 1 + np.arange(halved.size)
        doubtful = np.stack([first, first + 1], axis=1).ravel()
    check_finite(points)
    return points


def _rough(start: Array, inside: Array, end: Array, tolerance: float) -> np.ndarray:
    """Which chords (k, 2), (k, 2) are too far off or turn too much; inside: (k, 3, 2) at their quarters."""
    chord = end - start
    length = np.maximum(np.hypot(*chord.T), 1e-300)
    away = inside - start[:, None]
    across = chord[:, None, 0] * away[..., 1] - chord[:, None, 1] * away[..., 0]
    sagitta = abs(across).max(axis=1) / length
    middle = inside[:, 1]
    turn = _turn(middle - start, end - middle)
    for k, (a, b) in enumerate(((start, middle), (middle, end))):
        turn = np.maximum(turn, 2 * _turn(inside[:, 2 * k] - a, b - inside[:, 2 * k]))
    result: np.ndarray = (turn > _HALF_TURN) | (sagitta > tolerance)
    return result


def _turn(first: Array, second: Array) -> Array:
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    result: Array = abs(np.arctan2(cross, (first * second).sum(axis=1)))
    return result


def check_finite(points: Array) -> None:
    """Raise ``InvalidInput`` for points (k, 2) that are not."""
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if bad.size:
        raise InvalidInput(f"coordinates must be finite numbers, got {numbers(points[bad[0]])}")
