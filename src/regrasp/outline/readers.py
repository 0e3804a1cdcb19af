"""Outlines from files: what the formats share."""

from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.outline.chains import joined
from regrasp.outline.coordinates import coordinate_rings
from regrasp.outline.flatten import flattened
from regrasp.outline.region import checked_region, checked_ring, signed_area

_TOLERANCE = 1e-4
_COORDINATES = (".csv", ".txt", ".dat")


def read_rings(path: Path, tolerance: float | None = None) -> list[Array]:
    """The closed curves of a file as rings (k, 2): the outline, then its holes; see ``Outline.from_file``."""
    rings = [checked_ring(ring, "outline") for ring in _closed(path, tolerance)]
    rings.sort(key=signed_area, reverse=True)
    outer, *inner = [checked_region(ring, "outline") for ring in rings]
    for i, region in enumerate(inner, start=1):
        if not outer.intersects(region):
            x, y = rings[i][0]
            raise InvalidInput(
                f"there are several outlines: one at ({x:.6g}, {y:.6g}) is outside the largest; "
                "keep one object in a file"
            )
    return rings


@contextmanager
def naming(file: str | PathLike[str]) -> Iterator[None]:
    """Put the file's name before the message of every ``InvalidInput`` raised inside."""
    try:
        yield
    except InvalidInput as error:
        raise InvalidInput(f"{file}: {error}") from None


def _closed(path: Path, tolerance: float | None) -> list[Array]:
    kind = path.suffix.lower()
    if not path.is_file():
        raise InvalidInput("expected a file with an outline, found none")
    if kind in _COORDINATES:
        return coordinate_rings(path)
    if kind == ".svg":
        from regrasp.outline.svg import svg_curves

        curves = svg_curves(path)
    elif kind == ".dxf":
        from regrasp.outline.dxf import dxf_curves

        curves = dxf_curves(path)
    else:
        known = ", ".join((".svg", ".dxf", *_COORDINATES))
        raise InvalidInput(f"the kind of file must be one of {known}; got {kind or 'none'!r}")
    if not curves:
        raise InvalidInput("the drawing is empty: it has no lines or curves that could be an outline")
    if tolerance is None:
        rough = np.concatenate([curve.at(np.linspace(curve.start, curve.end, 9)) for curve in curves])
        tolerance = _TOLERANCE * float(np.ptp(rough, axis=0).max())
    return joined([flattened(curve, tolerance) for curve in curves], tolerance)
