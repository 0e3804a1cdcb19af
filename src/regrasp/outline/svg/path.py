"""The path data of SVG, ``d="M0,0 L..."``, as curves (SVG 2, chapter 9)."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.outline.drawing import MOST_PIECES
from regrasp.outline.flatten import Curve, arc, bezier, line, polyline
from regrasp.outline.svg.transform import NUMBER, number_of

_COMMAND = re.compile(r"[\s,]*([MmZzLlHhVvCcSsQqTtAa])")
_NUMBER = re.compile(rf"[\s,]*({NUMBER})")
_FLAG = re.compile(r"[\s,]*([01])")
_COUNTS = {"M": 2, "Z": 0, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7}
_FLAGS = (3, 4)  # of the seven numbers of an arc
_MOST = 300_000
_MOST_CURVES = MOST_PIECES // 2  # more are no drawing, whatever else there is (``Budget.spend_on``)


@dataclass(frozen=True)
class Subpath:
    """Curves end to end from one M to the next; closed by Z."""

    curves: list[Curve]
    closed: bool


def subpaths(data: str) -> list[Subpath]:
    """The curves of path data. Raises ``ValueError`` where it is not what SVG says, naming the place."""
    found: list[Subpath] = []
    curves: list[Curve] = []
    corners: list[Array] = []  # of straight pieces in a row
    curved = 0
    start = at = np.zeros(2)
    handle: Array | None = None  # the last control point of a curve that S or T goes on from
    before = ""
    for count, (command, values) in enumerate(_commands(data)):
        if count > _MOST:
            raise ValueError(f"the path has more than {_MOST} commands")
        kind = command.upper()
        base = np.zeros(2) if command.isupper() else at
        to = at
        if kind in "CSQTA":
            _join(curves, corners)
            curved += 1
            if curved > _MOST_CURVES:
                raise ValueError(f"the path has more than {_MOST_CURVES} curves")
        if kind == "M":
            _keep(found, curves, corners, closed=False)
            curves = []
            start = at = base + values
            handle = None
        elif kind == "Z":
            if (at != start).any():
                corners += [start] if corners else [at, start]
            _keep(found, curves, corners, closed=True)
            curves, at, handle = [], start, None
        elif kind in "LHV":
            to = base + _full(kind, values, at - base)
            corners += [to] if corners else [at, to]
            handle = None
        elif kind in "CS":
            rest = base + np.reshape(values, (-1, 2))
            smooth = handle if before in "CS" and handle is not None else at
            first = rest[:1] if kind == "C" else 2 * at - smooth[None]
            control = np.vstack([at, first, rest[-2:]])
            handle, to = control[2], control[3]
            curves.append(bezier(control))
        elif kind in "QT":
            rest = base + np.reshape(values, (-1, 2))
            smooth = handle if before in "QT" and handle is not None else at
            handle = rest[0] if kind == "Q" else 2 * at - smooth
            to = rest[-1]
            curves.append(bezier(np.vstack([at, handle, to])))
        else:
            to = base + values[5:]
            curves += elliptical(at, to, abs(values[0]), abs(values[1]), values[2], *map(bool, values[3:5]))
            handle = None
        if kind not in "MZ":
            at = to
        before = kind
    _keep(found, curves, corners, closed=False)
    return found


def elliptical(
    start: Array, end: Array, rx: float, ry: float, degrees: float, large: bool, sweep: bool
) -> list[Curve]:
    """The arc from start to end of an ellipse turned by ``degrees`` (SVG 2, appendix B.2): one curve or none.

    In coordinates that turn the ellipse into the unit circle, its centre is on the chord's bisector.
    """
    if (start == end).all():
        return []
    if rx == 0 or ry == 0:
        return [line(start, end)]
    t = np.radians(degrees)
    axes = np.array([[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]]) * [rx, ry]
    half = np.linalg.solve(axes, (end - start) / 2)
    size = float(np.hypot(*half))
    if size > 1:  # too small to reach: as large as need be
        axes, half, size = axes * size, half / size, 1.0
    height = np.sqrt(max(0.0, (1 - size) * (1 + size))) / size
    side = 1.0 if large != sweep else -1.0
    middle = side * height * np.array([-half[1], half[0]])  # from the chord's middle to the centre
    first, last = -half - middle, half - middle
    begin = np.arctan2(first[1], first[0])
    turn = (np.arctan2(last[1], last[0]) - begin) % (2 * np.pi)
    if not sweep:
        turn -= 2 * np.pi
    centre = (start + end) / 2 + axes @ middle
    return [_between(arc(centre, axes[:, 0], axes[:, 1], begin, begin + turn), start, end)]


def _between(curve: Curve, start: Array, end: Array) -> Curve:
    """The curve with its ends where they were given, to the bit, so that pieces meet."""

    def at(t: Array) -> Array:
        points = curve.at(t)
        points[t == curve.start] = start
        points[t == curve.end] = end
        return points

    return Curve(at, curve.start, curve.end)


def _commands(data: str) -> Iterator[tuple[str, Array]]:
    place, command = 0, ""
    end = len(data.rstrip(" \t\r\n\f,"))
    while place < end:
        found = _COMMAND.match(data, place)
        if found:
            command, place = found[1], found.end()
        elif command in ("", "Z", "z"):
            raise ValueError(f"the path has {_near(data, place)} where a command is expected")
        elif command in "Mm":
            command = "L" if command == "M" else "l"  # further pairs are lines
        kind = command.upper()
        values = []
        for k in range(_COUNTS[kind]):
            number = (_FLAG if kind == "A" and k in _FLAGS else _NUMBER).match(data, place)
            if not number:
                raise ValueError(f"the path has {_near(data, place)} where a number of {command} is expected")
            values.append(number_of(number[1]))
            place = number.end()
        yield command, np.array(values)


def _near(data: str, place: int) -> str:
    return repr(data[place : place + 20].strip()) if data[place:].strip() else "its end"


def _full(kind: str, values: Array, at: Array) -> Array:
    if kind == "L":
        return values
    return np.array([values[0], at[1]] if kind == "H" else [at[0], values[0]])


def _join(curves: list[Curve], corners: list[Array]) -> None:
    """The straight pieces as one curve."""
    if corners:
        curves.append(polyline(np.array(corners)))
        corners.clear()


def _keep(found: list[Subpath], curves: list[Curve], corners: list[Array], closed: bool) -> None:
    _join(curves, corners)
    if curves:
        found.append(Subpath(curves, closed))
