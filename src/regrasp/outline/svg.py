"""Curves from SVG, by svgpathtools."""

import warnings
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import ParseError

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.outline.flatten import Curve, line


def svg_curves(path: Path) -> list[Curve]:
    """The pieces of every path and shape, transforms applied, in user units, y turned up.

    Seen are path, polygon, polyline, line, rect, circle and ellipse in any group; text, use and definitions
    are not. Raises ``ImportError`` without svgpathtools, ``InvalidInput`` for a file that is not SVG.
    """
    try:
        from svgpathtools import Document, Line
    except ImportError:
        raise ImportError("reading SVG needs svgpathtools: pip install 'regrasp[outlines]'") from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)  # what it would leave out is an error here
            drawn = Document(str(path)).paths()
    except (
        ParseError,
        ValueError,
        TypeError,
        IndexError,
        AttributeError,
        ZeroDivisionError,
        Warning,
    ) as error:
        raise InvalidInput(f"the file cannot be read as SVG: {error}") from None
    return [
        line(*_points(piece, np.array([0.0, 1.0]))) if isinstance(piece, Line) else _curve(piece)
        for shape in drawn
        for piece in shape
        if piece.start != piece.end
    ]


def _curve(piece: Any) -> Curve:
    return Curve(lambda t: _points(piece, t))


def _points(piece: Any, t: Array) -> Array:
    z = np.array([piece.point(value) for value in t])
    return np.column_stack([z.real, -z.imag])
