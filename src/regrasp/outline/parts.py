"""Outlines of real parts, drawn from a few dimensions in metres, to try things on.

Fillets and bores are chords that turn by less than 2 degrees; the cam is smooth. ``PARTS`` has them by name.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from regrasp.mechanics.checks import ArrayLike
from regrasp.outline.outline import Outline

_ARCS = 64  # chords in a quarter of a circle


def wrench(length: float = 0.16, jaw: float = 0.017, ring: float = 0.017) -> Outline:
    """An open-ended spanner with a ring at its far end [m]: ``jaw`` and ``ring`` fit nuts of that width.

    The jaws point 15 degrees off the handle.
    """
    head = _disc((0, 0), 1.25 * jaw)
    eye = _disc((length, 0), 0.95 * ring)
    handle = _box((0, -0.4 * jaw), (length, 0.4 * jaw))
    nut = _box((-2 * jaw, -jaw / 2), (0.35 * jaw, jaw / 2))
    body = _rounded(head | eye | handle, outer=0.0, inner=0.6 * jaw)
    open_jaw = _rounded(body - _turned(_rounded(nut, outer=0.15 * jaw), 15), outer=0.08 * jaw)
    return _outline(open_jaw - _hexagon((length, 0), ring))


def cam(base: float = 0.016, lift: float = 0.012, bore: float = 0.012, action: float = 140.0) -> Outline:
    """A disc cam on a shaft [m], whose radius rises from ``base`` by ``lift`` within ``action`` degrees.

    The rise is a squared raised cosine, which leaves the base circle with its curvature.
    """
    degrees = np.arange(-180, 180, 5)
    phase = np.clip(2 * np.pi * degrees / action, -np.pi, np.pi)
    radius = base + lift * ((1 + np.cos(phase)) / 2) ** 2
    profile = [_polar(r, angle) for r, angle in zip(radius, np.radians(degrees + 90), strict=True)]
    return Outline.smooth(profile, holes=[Outline.ellipse(bore / 2, bore / 2)])


def gear(teeth: int = 16, module: float = 0.003, bore: float = 0.012, keyway: float = 0.004) -> Outline:
    """A spur gear of straight-flanked teeth with a keyed bore; its pitch diameter is teeth x module [m]."""
    pitch, turn = teeth * module / 2, 2 * np.pi / teeth
    root, tip = pitch - 1.25 * module, pitch + module
    wheel = _disc((0, 0), root)
    for i in range(teeth):
        flanks = [(0.98 * root, -0.38), (tip, -0.14), (tip, 0.14), (0.98 * root, 0.38)]
        wheel |= _polygon([_polar(radius, (i + part) * turn) for radius, part in flanks])
    shaft = _disc((0, 0), bore / 2) | _box((0, -keyway / 2), (bore / 2 + keyway / 2, keyway / 2))
    return _outline(_rounded(wheel, outer=0.1 * module, inner=0.2 * module) - shaft)


def bracket(width: float = 0.06, height: float = 0.08, web: float = 0.014, hole: float = 0.006) -> Outline:
    """An angle bracket with two holes in each leg [m]."""
    angle = _box((0, 0), (width, web)) | _box((0, 0), (web, height))
    angle |= _polygon([(web, web), (web + 0.8 * web, web), (web, web + 0.8 * web)])
    plate = _rounded(angle, outer=0.3 * web, inner=0.3 * web)
    across = [(x * width, web / 2) for x in (0.55, 0.85)]
    up = [(web / 2, y * height) for y in (0.55, 0.88)]
    for centre in across + up:
        plate -= _disc(centre, hole / 2)
    return _outline(plate)


def bottle(height: float = 0.22, diameter: float = 0.07, neck: float = 0.028) -> Outline:
    """The silhouette of a bottle that stands on its base, the cap on its neck [m]."""
    body = _box((-diameter / 2, 0), (diameter / 2, 0.62 * height))
    shoulder = _polygon(
        [
            (-diameter / 2, 0.6 * height),
            (diameter / 2, 0.6 * height),
            (neck / 2, 0.82 * height),
            (-neck / 2, 0.82 * height),
        ]
    )
    throat = _box((-neck / 2, 0.8 * height), (neck / 2, 0.9 * height))
    cap = _box((-0.58 * neck, 0.89 * height), (0.58 * neck, height))
    glass = _rounded(body | shoulder | throat, outer=0.12 * diameter, inner=0.5 * diameter)
    return _outline(_rounded(glass | throat | cap, outer=0.08 * neck))


def puzzle_piece(side: float = 0.02, knob: float = 0.0031) -> Outline:
    """A piece of a jigsaw, knobs on the right and on top, sockets on the left and below [m]."""
    half, reach = side / 2, 0.8 * knob
    knobs = [_disc((half + reach, 0), knob), _disc((0, half + reach), knob)]
    sockets = [_disc((-half + reach, 0), knob), _disc((0, -half + reach), knob)]
    piece = _box((-half, -half), (half, half))
    for disc in knobs:
        piece |= disc
    for disc in sockets:
        piece -= disc
    return _outline(_rounded(piece, outer=0.15 * knob, inner=0.15 * knob))


PARTS: dict[str, Callable[..., Outline]] = {
    part.__name__: part for part in (wrench, cam, gear, bracket, bottle, puzzle_piece)
}
"""The parts by name."""


# -- shapes, by shapely -----------------------------------------------------------------------------------


def _polygon(points: Iterable[ArrayLike]) -> Any:
    import shapely

    return shapely.Polygon(list(points))


def _box(low: tuple[float, float], high: tuple[float, float]) -> Any:
    return _polygon([low, (high[0], low[1]), high, (low[0], high[1])])


def _disc(centre: tuple[float, float], radius: float) -> Any:
    import shapely

    return shapely.Point(centre).buffer(radius, quad_segs=_ARCS)


def _hexagon(centre: tuple[float, float], width: float) -> Any:
    """Of a width across flats."""
    corners = [_polar(width / np.sqrt(3), angle) for angle in np.arange(6) * np.pi / 3]
    return _polygon(np.array(corners) + centre)


def _polar(radius: float, angle: float) -> tuple[float, float]:
    return float(radius * np.cos(angle)), float(radius * np.sin(angle))


def _turned(shape: Any, degrees: float) -> Any:
    from shapely.affinity import rotate

    return rotate(shape, degrees, origin=(0, 0))


def _rounded(shape: Any, outer: float = 0.0, inner: float = 0.0) -> Any:
    """With fillets of a radius at convex (``outer``) and concave (``inner``) corners."""
    shape = shape.buffer(-outer, join_style="mitre").buffer(outer, quad_segs=_ARCS)
    return shape.buffer(inner, join_style="mitre").buffer(-inner, quad_segs=_ARCS)


def _outline(shape: Any) -> Outline:
    return Outline(np.array(shape.exterior.coords), [np.array(hole.coords) for hole in shape.interiors])
