"""Lengths and transforms of SVG: 3 x 3 matrices of homogeneous coordinates, x' = M x."""

import re
from collections.abc import Callable
from math import isfinite

import numpy as np

from regrasp.errors import shown
from regrasp.mechanics.checks import Array

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_LENGTH = re.compile(rf"\s*({NUMBER})\s*([a-zA-Z]+|%)?\s*\Z")
_VALUE = re.compile(rf"\s*({NUMBER})\s*([a-zA-Z]+|%)?\s*,?")
_FUNCTION = re.compile(r"\s*,?\s*([a-zA-Z0-9]+)\s*\(([^()]*)\)")
# In px, of which an inch has 96; em and ex of a letter of 16.
PX = {"": 1, "px": 1, "in": 96, "cm": 96 / 2.54, "mm": 96 / 25.4, "q": 24 / 25.4, "pt": 96 / 72, "pc": 16,
      "em": 16, "rem": 16, "ex": 8}  # fmt: skip
_DEGREES = {"": 1.0, "deg": 1.0, "grad": 0.9, "turn": 360.0, "rad": 180 / np.pi}
_ALONG = {"none": 0.0, "Min": 0.0, "Mid": 0.5, "Max": 1.0}
_WORDS = {"left": "0%", "top": "0%", "center": "50%", "right": "100%", "bottom": "100%"}


def length(text: str, whole: float = 0.0) -> float:
    """A length in user units; ``whole`` is what per cent are of. Raises ``ValueError``."""
    found = _LENGTH.match(text)
    if not found:
        raise ValueError(f"could not convert string to float: {text[:40]!r}")
    value, unit = number_of(found[1]), (found[2] or "").lower()
    if unit == "%":
        return value * whole / 100
    if unit not in PX:
        raise ValueError(f"the unit of {shown(text)} is not known")
    return value * PX[unit]


def numbers_of(text: str) -> list[float]:
    """Numbers apart by commas, spaces or signs, without anything else. Raises ``ValueError``."""
    rest = re.sub(NUMBER, "", text).strip(" \t\r\n\f,")
    if rest:
        raise ValueError(f"numbers are expected in the place of {rest[:40]!r}")
    return [number_of(word) for word in re.findall(NUMBER, text)]


def number_of(word: str) -> float:
    """A finite number. Raises ``ValueError`` for one beyond what a float holds."""
    value = float(word)
    if not isfinite(value):
        raise ValueError(f"the number {word[:40]} is too large")
    return value


def transform(text: str) -> Array:
    """The product of the functions in ``transform="..."`` or its CSS form. Raises ``ValueError``."""
    result, at = np.eye(3), 0
    text = text.strip()
    if text == "none":
        return result
    while at < len(text):
        found = _FUNCTION.match(text, at)
        if not found or found[1] not in _FUNCTIONS:
            raise ValueError(f"the transform {text[at : at + 40]!r} is none of {', '.join(_FUNCTIONS)}")
        at = found.end()
        read, least, most = _FUNCTIONS[found[1]]
        values = _values(found[2])
        if not least <= len(values) <= most:
            raise ValueError(f"the transform {shown(found[0].strip())} has {len(values)} values")
        result = result @ read(*values)
    return result


def turned_about(origin: tuple[float, float], matrix: Array) -> Array:
    """The same transform about another point than (0, 0)."""
    return _shifted(*origin) @ matrix @ _shifted(-origin[0], -origin[1])


def origin_of(text: str, width: float, height: float) -> tuple[float, float]:
    """``transform-origin``: of a viewport. Raises ``ValueError``."""
    words = text.split()[:2]
    if words and words[0] in ("top", "bottom"):
        words.reverse()
    words = [_WORDS.get(word, word) for word in words]
    return length(words[0] if words else "0", width), length(words[1] if len(words) > 1 else "50%", height)


def viewport(box: list[float], width: float, height: float, align: str) -> Array:
    """What takes ``viewBox`` = x, y, w, h to a viewport at the origin; align: ``preserveAspectRatio``."""
    x, y, w, h = box
    sx, sy = width / w, height / h
    word, *rest = align.split() or ["xMidYMid"]
    if word == "none":
        return _scaled(sx, sy) @ _shifted(-x, -y)
    scale = max(sx, sy) if "slice" in rest else min(sx, sy)
    across, along = _ALONG.get(word[1:4], 0.5), _ALONG.get(word[5:8], 0.5)
    place = _shifted(across * (width - scale * w), along * (height - scale * h))
    return place @ _scaled(scale, scale) @ _shifted(-x, -y)


def _values(text: str) -> list[tuple[float, str]]:
    values, at = [], 0
    text = text.strip()
    while at < len(text):
        found = _VALUE.match(text, at)
        if not found:
            raise ValueError(f"the transform has {shown(text)} where numbers are expected")
        values.append((number_of(found[1]), (found[2] or "").lower()))
        at = found.end()
    return values


Value = tuple[float, str]


def _px(value: Value) -> float:
    number, unit = value
    if unit not in PX:
        raise ValueError(f"a transform by {number:g}{unit} is not followed: give it in px")
    return number * PX[unit]


def _radians(value: Value) -> float:
    number, unit = value
    if unit not in _DEGREES:
        raise ValueError(f"an angle of {number:g}{unit} is not known")
    return float(np.radians(number * _DEGREES[unit]))


def _plain(value: Value) -> float:
    number, unit = value
    if unit == "%":
        return number / 100
    if unit:
        raise ValueError(f"a factor of {number:g}{unit} is not known")
    return number


def _shifted(x: float, y: float) -> Array:
    return np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])


def _scaled(x: float, y: float) -> Array:
    return np.diag([x, y, 1.0])


def _skewed(x: float, y: float) -> Array:
    return np.array([[1.0, np.tan(x), 0.0], [np.tan(y), 1.0, 0.0], [0.0, 0.0, 1.0]])


def _matrix(*values: Value) -> Array:
    a, b, c, d = (_plain(value) for value in values[:4])
    return np.array([[a, c, _px(values[4])], [b, d, _px(values[5])], [0.0, 0.0, 1.0]])


def _rotate(angle: Value, *centre: Value) -> Array:
    if len(centre) == 1:
        raise ValueError("rotate has 1 or 3 values, got 2")
    t = _radians(angle)
    turn = np.array([[np.cos(t), -np.sin(t), 0.0], [np.sin(t), np.cos(t), 0.0], [0.0, 0.0, 1.0]])
    return turned_about((_px(centre[0]), _px(centre[1])), turn) if centre else turn


_FUNCTIONS: dict[str, tuple[Callable[..., Array], int, int]] = {
    "matrix": (_matrix, 6, 6),
    "translate": (lambda x, y=(0.0, ""): _shifted(_px(x), _px(y)), 1, 2),
    "translateX": (lambda x: _shifted(_px(x), 0.0), 1, 1),
    "translateY": (lambda y: _shifted(0.0, _px(y)), 1, 1),
    "scale": (lambda x, y=None: _scaled(_plain(x), _plain(x if y is None else y)), 1, 2),
    "scaleX": (lambda x: _scaled(_plain(x), 1.0), 1, 1),
    "scaleY": (lambda y: _scaled(1.0, _plain(y)), 1, 1),
    "rotate": (_rotate, 1, 3),
    "skewX": (lambda x: _skewed(_radians(x), 0.0), 1, 1),
    "skewY": (lambda y: _skewed(0.0, _radians(y)), 1, 1),
    "skew": (lambda x, y=(0.0, ""): _skewed(_radians(x), _radians(y)), 1, 2),
}
