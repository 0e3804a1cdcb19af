"""The basic shapes of SVG as curves, in their own coordinates (SVG 2, chapter 10)."""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.outline.drawing import Piece
from regrasp.outline.flatten import Curve, arc, line, polyline
from regrasp.outline.svg.path import subpaths
from regrasp.outline.svg.transform import length, numbers_of

SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")


def shape(kind: str, given: dict[str, str], view: tuple[float, float]) -> list[Piece]:
    """The pieces of a shape with these properties in a viewport of this size. Raises ``ValueError``."""
    diagonal = float(np.hypot(*view) / np.sqrt(2))

    def size(name: str, whole: float, default: float = 0.0) -> float:
        text = given.get(name, "auto")
        return default if text == "auto" else length(text, whole)

    if kind == "path":
        text = given.get("d", "none")
        parts = [] if text == "none" else subpaths(text)
        return [Piece(tuple(part.curves), part.closed, filled=True) for part in parts]
    if kind in ("polyline", "polygon"):
        points = numbers_of(given.get("points", ""))
        pairs = np.array(points[: len(points) // 2 * 2]).reshape(-1, 2)
        if kind == "polygon" and len(pairs):
            pairs = np.vstack([pairs, pairs[:1]])
        return [Piece((polyline(pairs),), kind == "polygon", filled=True)] if len(pairs) > 1 else []
    if kind == "line":
        a = np.array([size("x1", view[0]), size("y1", view[1])])
        b = np.array([size("x2", view[0]), size("y2", view[1])])
        return [Piece((line(a, b),))]
    if kind == "rect":
        return _rectangle(given, view, size("x", view[0]), size("y", view[1]),
                          size("width", view[0]), size("height", view[1]))  # fmt: skip
    centre = np.array([size("cx", view[0]), size("cy", view[1])])
    if kind == "circle":
        rx = ry = size("r", diagonal)
    else:
        rx, ry = size("rx", view[0], np.nan), size("ry", view[1], np.nan)
        rx, ry = (ry if np.isnan(rx) else rx), (rx if np.isnan(ry) else ry)
    if rx < 0 or ry < 0:
        raise ValueError(f"the radius of {kind} is negative")
    if not (rx > 0 and ry > 0):
        return []
    around = arc(centre, np.array([rx, 0.0]), np.array([0.0, ry]), np.pi, 3 * np.pi)
    return [Piece((around,), closed=True, filled=True)]


def _rectangle(
    given: dict[str, str], view: tuple[float, float], x: float, y: float, w: float, h: float
) -> list[Piece]:
    """With round corners: a radius that is not given is the other, none is more than half a side."""
    if w < 0 or h < 0:
        raise ValueError("the width or height of rect is negative")
    if not (w > 0 and h > 0):
        return []
    words = [None if given.get(name, "auto") == "auto" else given[name] for name in ("rx", "ry")]
    across = None if words[0] is None else length(words[0], view[0])
    along = None if words[1] is None else length(words[1], view[1])
    rx = min(max(along or 0.0 if across is None else across, 0.0), w / 2)
    ry = min(max(across or 0.0 if along is None else along, 0.0), h / 2)
    if not (rx > 0 and ry > 0):
        corners = np.array([(x, y), (x + w, y), (x + w, y + h), (x, y + h), (x, y)])
        return [Piece((polyline(corners),), True, True)]
    u, v = np.array([rx, 0.0]), np.array([0.0, ry])
    curves: list[Curve] = []
    middles = [(x + w - rx, y + ry), (x + w - rx, y + h - ry), (x + rx, y + h - ry), (x + rx, y + ry)]
    for k, middle in enumerate(middles):
        centre, begin = np.array(middle), (k - 1) * np.pi / 2
        curves.append(arc(centre, u, v, begin, begin + np.pi / 2))
        after = np.array(middles[(k + 1) % 4])
        away = _quarter(k) * (rx, ry)
        if (after != centre).any():
            curves.append(line(centre + away, after + away))
    return [Piece(tuple(curves), True, True)]


def _quarter(k: int) -> Array:
    """(2,) the direction in which corner arc k ends."""
    return np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][k])
