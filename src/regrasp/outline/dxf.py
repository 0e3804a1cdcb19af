"""Curves from DXF, by ezdxf."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.outline.flatten import Curve, line


def dxf_curves(path: Path) -> list[Curve]:
    """The pieces of the model space, blocks included, seen along z, in the drawing's units.

    Seen are LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE and POLYLINE; texts, dimensions, points and
    hatches are not. Raises ``ImportError`` without ezdxf, ``InvalidInput`` for a file that is not DXF.
    """
    try:
        from ezdxf.filemanagement import readfile
        from ezdxf.lldxf.const import DXFError
    except ImportError:
        raise ImportError("reading DXF needs ezdxf: pip install 'regrasp[outlines]'") from None
    try:
        return [curve for entity in readfile(path).modelspace() for curve in _curves(entity)]
    except (OSError, UnicodeDecodeError, ValueError, DXFError) as error:
        raise InvalidInput(f"the file cannot be read as DXF: {error}") from None


def _curves(entity: Any) -> Iterator[Curve]:
    kind = entity.dxftype()
    if kind in ("INSERT", "LWPOLYLINE", "POLYLINE"):
        for part in entity.virtual_entities():
            yield from _curves(part)
    elif kind == "LINE":
        yield line(*_plane([entity.dxf.start, entity.dxf.end]))
    elif kind == "CIRCLE":
        yield Curve(lambda t: _plane(entity.vertices(t)), 0.0, 360.0)
    elif kind == "ARC":
        start = entity.dxf.start_angle
        turn = (entity.dxf.end_angle - start) % 360 or 360.0
        yield Curve(lambda t: _plane(entity.vertices(t)), start, start + turn)
    elif kind == "ELLIPSE":
        start = entity.dxf.start_param
        turn = (entity.dxf.end_param - start) % (2 * np.pi) or 2 * np.pi
        yield Curve(lambda t: _plane(entity.vertices(t)), start, start + turn)
    elif kind == "SPLINE":
        spline = entity.construction_tool()
        knots = spline.knots()
        yield Curve(lambda t: _plane(spline.points(t)), knots[spline.order - 1], knots[-spline.order])


def _plane(points: Iterable[Any]) -> Array:
    return np.array([(point.x, point.y) for point in points])
