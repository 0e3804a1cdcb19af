"""Real parts from a few dimensions in metres, to try things on. ``PARTS`` has them by name."""

from collections.abc import Callable, Sequence

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mesh.arrays import Indices
from regrasp.mesh.build import polygon_triangles, strips
from regrasp.mesh.mesh import Mesh
from regrasp.outline import Outline
from regrasp.outline import parts as outlines

_ARC = 9  # points in a quarter of a circle
_BORE = 32  # points around a hole of the bracket


def bracket(
    width: float = 0.04, leg: float = 0.06, height: float = 0.05, web: float = 0.006, hole: float = 0.012
) -> Mesh:
    """An angle bracket, a hole through each leg [m]: one leg lies on z = 0, the other stands on x = 0."""
    profile = np.array([(0, 0), (leg, 0), (leg, web), (web, web), (web, height), (0, height)])
    lying = _circle((web + (leg - web) / 2, width / 2), hole / 2)
    standing = _circle((width / 2, web + (height - web) / 2), hole / 2)
    pieces = [
        *(_flat([profile], "xz", y) for y in (0.0, width)),
        _flat([_rectangle(0, 0, leg, width), lying], "xy", 0.0),
        _flat([_rectangle(web, 0, leg, width), lying], "xy", web),
        _flat([_rectangle(0, 0, width, height), standing], "yz", 0.0),
        _flat([_rectangle(0, web, width, height), standing], "yz", web),
        _flat([_rectangle(0, 0, width, web)], "yz", leg),
        _flat([_rectangle(0, 0, web, width)], "xy", height),
        _wall(lying, "xy", web),
        _wall(standing, "yz", web),
    ]
    before = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    faces = [piece + count for (_, piece), count in zip(pieces, before[:-1], strict=True)]
    return Mesh(np.concatenate([vertices for vertices, _ in pieces]), np.concatenate(faces))


def wrench(length: float = 0.16, jaw: float = 0.017, ring: float = 0.017, thickness: float = 0.006) -> Mesh:
    """The spanner of ``regrasp.outline.parts`` as a plate [m]."""
    return Mesh.extruded(outlines.wrench(length, jaw, ring), thickness)


def cam(base: float = 0.016, lift: float = 0.012, bore: float = 0.012, width: float = 0.012) -> Mesh:
    """The disc cam of ``regrasp.outline.parts`` [m], smooth."""
    return Mesh.extruded(outlines.cam(base, lift, bore), width)


def nut(width: float = 0.016, height: float = 0.008, bore: float = 0.0085) -> Mesh:
    """A hexagonal nut of a width across flats [m], without thread or chamfer; M10 by default."""
    turn = np.arange(6) * np.pi / 3
    hexagon = width / np.sqrt(3) * np.column_stack([np.cos(turn), np.sin(turn)])
    return Mesh.extruded(Outline(hexagon, [Outline.ellipse(bore / 2, bore / 2)]), height)


def bottle(height: float = 0.22, diameter: float = 0.07, neck: float = 0.028, *, segments: int = 48) -> Mesh:
    """A full bottle on its base [m], smooth: a rounded foot, a shoulder, a neck and a cap wider than it."""
    r, s, foot, cap = diameter / 2, neck / 2, 0.1 * diameter, 1.16 * neck / 2
    quarter = np.linspace(0, np.pi / 2, _ARC)
    up = np.linspace(0, 1, 2 * _ARC)
    profile = [
        np.array([[0, 0]]),
        np.column_stack([r - foot + foot * np.sin(quarter), foot - foot * np.cos(quarter)]),
        np.column_stack([s + (r - s) * (1 + np.cos(np.pi * up)) / 2, (0.55 + 0.27 * up) * height]),
        np.array([[s, 0.89 * height], [cap, 0.89 * height], [cap, height], [0, height]]),
    ]
    return Mesh.revolved(np.concatenate(profile), segments=segments)


PARTS: dict[str, Callable[..., Mesh]] = {part.__name__: part for part in (bracket, wrench, cam, nut, bottle)}
"""The parts by name."""


# -- flat faces in space: Mesh merges their corners and turns them the right way ---------------------------


def _rectangle(left: float, low: float, right: float, high: float) -> Array:
    return np.array([(left, low), (right, low), (right, high), (left, high)], dtype=float)


def _circle(centre: tuple[float, float], radius: float) -> Array:
    turn = np.arange(_BORE) * 2 * np.pi / _BORE
    return np.array(centre) + radius * np.column_stack([np.cos(turn), np.sin(turn)])


def _flat(rings: Sequence[Array], plane: str, at: float) -> tuple[Array, Indices]:
    """A polygon with holes in the ``plane`` of two axes, at a place along the third."""
    return _raised(np.concatenate(rings), plane, at), polygon_triangles(rings)


def _wall(ring: Array, plane: str, thickness: float) -> tuple[Array, Indices]:
    """Of a hole through a plate from 0 to ``thickness``."""
    ends = [_raised(ring, plane, z) for z in (0.0, thickness)]
    return np.concatenate(ends), strips([ring])[0]


def _raised(points: Array, plane: str, at: float) -> Array:
    axes = ["xyz".index(axis) for axis in plane]
    result = np.full((len(points), 3), at)
    result[:, axes] = points
    return result
