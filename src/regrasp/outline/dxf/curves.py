"""The entities of DXF that draw curves, as curves in space."""

from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.outline.drawing import Piece
from regrasp.outline.flatten import Curve, arc, line, polyline

CURVES = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE")

# An arc that ends this near to a full turn [rad] is one: angles are written with few digits.
_FULL, _NO_TURN = 1e-5, 1e-9
_FRAME = 16  # a vertex of the control frame of a polyline that is fitted by splines


def piece(entity: Any) -> Piece | None:
    """The curves (m, 3) of an entity, or nothing where it has no length."""
    kind = entity.dxftype()
    if kind == "LINE":
        return Piece((line(vector(entity.dxf.start), vector(entity.dxf.end)),))
    if kind in ("CIRCLE", "ARC"):
        return _circular(entity, kind)
    if kind == "ELLIPSE":
        return _ellipse(entity)
    if kind == "SPLINE":
        return _spline(entity)
    if kind == "LWPOLYLINE":
        height = float(entity.dxf.elevation)
        points = np.array([(x, y, height, bulge) for x, y, bulge in entity.get_points("xyb")], dtype=float)
        return _bulged(points.reshape(-1, 4), bool(entity.closed), frame(entity))
    return _polyline(entity)


def _circular(entity: Any, kind: str) -> Piece | None:
    axes, radius = frame(entity), abs(float(entity.dxf.radius))
    centre = axes @ vector(entity.dxf.center)
    if radius == 0:
        return None
    start, end = (0.0, 360.0) if kind == "CIRCLE" else (entity.dxf.start_angle, entity.dxf.end_angle)
    begin, turn = turned(np.radians(start), np.radians(end))
    u, v = radius * axes[:, 0], radius * axes[:, 1]
    return Piece((arc(centre, u, v, begin, begin + turn),), closed=turn == 2 * np.pi)


def _ellipse(entity: Any) -> Piece | None:
    normal, u = vector(entity.dxf.extrusion), vector(entity.dxf.major_axis)
    size = float(np.linalg.norm(normal))
    if not (size > 0 and np.linalg.norm(u) > 0):
        return None
    v = np.cross(normal / size, u) * float(entity.dxf.ratio)
    begin, turn = turned(float(entity.dxf.start_param), float(entity.dxf.end_param))
    return Piece((arc(vector(entity.dxf.center), u, v, begin, begin + turn),), closed=turn == 2 * np.pi)


def turned(start: float, end: float) -> tuple[float, float]:
    """Where an arc begins and how far it turns [rad]: a full turn where no more than rounding is missing."""
    whole = 2 * np.pi
    if not np.isfinite([start, end]).all():
        return np.nan, np.nan
    turn = (end - start) % whole
    beyond = abs(end - start) > np.pi  # not a tiny arc, but a turn and a little
    if turn > whole - _FULL or turn < (_FULL if beyond else _NO_TURN):
        turn = whole
    return start, turn


def _spline(entity: Any) -> Piece | None:
    from scipy.interpolate import BSpline

    if not len(entity.control_points) and len(entity.fit_points) < 2:
        return None
    tool = entity.construction_tool()
    degree, knots = tool.degree, np.array(tool.knots(), dtype=float)
    control = np.array([vector(point) for point in tool.control_points])
    weights = np.array(tool.weights() or np.ones(len(control)), dtype=float)
    if not (np.isfinite(knots).all() and np.isfinite(control).all() and np.isfinite(weights).all()):
        raise ValueError("a SPLINE has numbers that are not finite")
    if (np.diff(knots) < 0).any() or len(knots) != len(control) + degree + 1 or not (weights > 0).all():
        raise ValueError("a SPLINE has knots or weights that make no curve")
    spline = BSpline(knots, np.column_stack([control * weights[:, None], weights]), degree)
    start, end = knots[degree], knots[-degree - 1]
    if not end > start:
        return None
    inner = np.unique(knots[(knots > start) & (knots < end)])

    def at(t: Array) -> Array:
        points = spline(t)
        result: Array = points[:, :3] / points[:, 3:]
        return result

    return Piece((Curve(at, float(start), float(end), inner=tuple(inner)),))


def _polyline(entity: Any) -> Piece | None:
    if not (entity.is_2d_polyline or entity.is_3d_polyline):
        return None
    vertices = [v for v in entity.vertices if not v.dxf.flags & _FRAME]
    points = np.array([(*vector(v.dxf.location), float(v.dxf.get("bulge", 0.0))) for v in vertices])
    if entity.is_2d_polyline and len(points):
        points[:, 2] = vector(entity.dxf.elevation)[2] if entity.dxf.hasattr("elevation") else points[:, 2]
    elif len(points):
        points[:, 3] = 0.0
    axes = frame(entity) if entity.is_2d_polyline else np.eye(3)
    return _bulged(points.reshape(-1, 4), bool(entity.is_closed), axes)


def _bulged(points: Array, closed: bool, axes: Array) -> Piece | None:
    """Vertices (k, 4) of x, y, z and bulge: tan of a quarter of the turn of the arc to the next vertex."""
    if closed and len(points) > 1 and (points[0, :3] != points[-1, :3]).any():
        points = np.vstack([points, points[:1]])
    if len(points) < 2:
        return None
    corners, bulges = points[:, :3], points[:-1, 3]
    if not bulges.any():
        return Piece((polyline(corners @ axes.T),), closed)
    curves = []
    for a, b, bulge in zip(corners[:-1], corners[1:], bulges, strict=True):
        if not np.isfinite(bulge):
            raise ValueError("a polyline has a bulge that is not finite")
        if bulge == 0 or (a == b).all():
            curves.append(line(a, b).mapped(axes, np.zeros(3)))
            continue
        half, turn = (b - a) / 2, 4 * float(np.arctan(bulge))
        side = np.array([-half[1], half[0], 0.0])
        centre = (a + b) / 2 + side * (1 - bulge**2) / (2 * bulge)
        u = a - centre  # the radius to the start, and a quarter of a turn on
        v = np.array([-u[1], u[0], 0.0])
        curves.append(arc(centre, u, v, 0.0, turn).mapped(axes, np.zeros(3)))
    return Piece(tuple(curves), closed)


def frame(entity: Any) -> Array:
    """(3, 3) whose columns are the axes of an entity's own coordinates (the arbitrary axis algorithm)."""
    z = vector(entity.dxf.extrusion) if entity.dxf.hasattr("extrusion") else np.array([0.0, 0.0, 1.0])
    size = float(np.linalg.norm(z))
    if not size > 0 or ((z[:2] == 0).all() and z[2] > 0):
        return np.eye(3)
    z = z / size
    away = np.array([0.0, 1.0, 0.0] if max(abs(z[:2])) < 1 / 64 else [0.0, 0.0, 1.0])
    x = np.cross(away, z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def vector(point: Any) -> Array:
    """(3,) of a point of two or three coordinates."""
    x, y, *z = point
    return np.array([x, y, z[0] if z else 0.0], dtype=float)


def mapped(found: Piece, matrix: Array, shift: Array) -> Piece:
    """A piece in space after an affine map, seen along z."""
    curves = tuple(curve.mapped(matrix[:2], shift[:2]) for curve in found.curves)
    return Piece(curves, found.closed)
