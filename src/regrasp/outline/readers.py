"""Outlines from files: what the formats share."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.outline.chains import chains, closed_ring
from regrasp.outline.coordinates import coordinate_rings
from regrasp.outline.drawing import UNITS, Budget, Drawing, Piece, counted
from regrasp.outline.flatten import check_finite, flattened
from regrasp.outline.nesting import check_nested, check_once
from regrasp.outline.opening import read_bytes
from regrasp.outline.region import checked_region, checked_ring, checked_size, signed_area

_TOLERANCE = 1e-4
_COORDINATES = (".csv", ".txt", ".dat")
_MOST = {".svg": 16_000_000, ".dxf": 12_000_000}  # bytes: what is read within seconds
_MOST_TEXT = 30_000_000
_MOST_RINGS = 10_000


@dataclass(frozen=True)
class Found:
    """The closed curves of a file as rings (k, 2), the outline first, and words on what was done."""

    rings: list[Array]
    notes: tuple[str, ...] = ()


@np.errstate(all="ignore")  # numbers too large for floats are found by their results
def read_rings(
    path: Path,
    tolerance: float | None = None,
    layers: tuple[str, ...] | None = None,
    unit: str | None = None,
) -> Found:
    """The outline of a file and its holes; see ``Outline.from_file``."""
    kind = path.suffix.lower()
    known = (".svg", ".dxf", *_COORDINATES)
    if kind not in known and path.is_file():
        raise InvalidInput(f"the kind of file must be one of {', '.join(known)}; got {shown(kind or 'none')}")
    data = read_bytes(path, "an outline", _MOST.get(kind, _MOST_TEXT))
    if kind in _COORDINATES:
        if layers is not None:
            raise InvalidInput("a file of coordinates has no layers: leave out layers")
        if unit is not None:
            raise InvalidInput("a file of coordinates does not say its unit: give scale in place of unit")
        return Found(nested(coordinate_rings(data)))
    if kind == ".svg":
        from regrasp.outline.svg.reader import svg_drawing

        drawing = svg_drawing(data, layers)
    else:
        from regrasp.outline.dxf.reader import dxf_drawing

        drawing = dxf_drawing(path, len(data), layers)
    rings, notes = _outline(drawing, tolerance)
    factor, words = _converted(drawing.unit, unit)
    return Found([factor * ring for ring in rings], (*drawing.notes, *notes, *words))


def _outline(drawing: Drawing, tolerance: float | None) -> tuple[list[Array], list[str]]:
    """The outline without what is doubtful, if there is one, else with it."""
    sure, all_of_it, doubts = drawing.pieces, drawing.pieces + drawing.doubtful, drawing.doubts
    if not all_of_it:
        aside = "".join(f"; {note}" for note in drawing.notes if note.startswith("hidden"))
        raise InvalidInput(f"the drawing is empty: it has no lines or curves that could be an outline{aside}")
    try:
        rings, notes = _rings(sure or all_of_it, tolerance)
        words = "left out" if sure else "nothing else is drawn, so read"
    except InvalidInput as error:
        try:
            if not (sure and doubts):
                raise error
            rings, notes = _rings(all_of_it, tolerance)
            words = "read, since the rest is no outline"
        except InvalidInput:
            raise InvalidInput(f"{error}{_advice(drawing)}") from None
    return rings, [*notes, *([f"{words}: {doubts}"] if doubts else [])]


def _advice(drawing: Drawing) -> str:
    words = f"; left out: {drawing.doubts}" if drawing.doubts else ""
    if len(drawing.layers) > 1:
        names = ", ".join(repr(name) for name in drawing.layers[:10])
        words += f"; choose from its layers {names} with layers="
    return words


def _rings(pieces: list[Piece], tolerance: float | None) -> tuple[list[Array], list[str]]:
    """The outline that pieces make, first, and its holes; and words on what was closed or left out."""
    size = _size(pieces)
    within = _TOLERANCE * size if tolerance is None else tolerance
    budget = Budget()
    drawn = []
    for piece in pieces:
        parts = [flattened(curve, within) for curve in piece.curves]
        points = np.concatenate([*(part[:-1] for part in parts), parts[-1][-1:]])
        budget.spend(points=len(points))
        if np.ptp(points, axis=0).any():  # not a dot
            drawn.append((piece, points))
    rings = [points[:-1] if _meets(points, size) else points for piece, points in drawn if piece.closed]
    opened = [(piece, points) for piece, points in drawn if not piece.closed]
    try:
        more, notes = _closed(opened, within, size)
        return nested(rings + more), notes
    except InvalidInput:
        check_once([points for _, points in opened], size)
        raise


def _size(pieces: list[Piece]) -> float:
    """The larger side of what is drawn, about."""
    rough = np.concatenate([curve.rough() for piece in pieces for curve in piece.curves])
    check_finite(rough)
    return checked_size(rough, "the drawing")


def _meets(points: Array, size: float) -> bool:
    return float(np.hypot(*(points[0] - points[-1]))) <= 1e-12 * size


def _closed(opened: list[tuple[Piece, Array]], within: float, size: float) -> tuple[list[Array], list[str]]:
    """The rings of pieces with two ends: joined, or closed where the drawing paints their inside."""
    rings, closed, flat = [], 0, 0
    for chain in chains([points for _, points in opened], within):
        if chain.closed or not all(opened[member][0].filled for member in chain.members):
            rings.append(closed_ring(chain, within))
            continue
        for member in chain.members:
            points = opened[member][1]
            if abs(signed_area(points)) > 1e-9 * size**2:
                rings.append(points)
                closed += 1
            else:
                flat += 1
    notes = []
    if closed:
        notes.append(f"closed by a straight line, as fill does: {counted(['open path'] * closed)}")
    if flat:
        notes.append(f"left out: {counted(['open path without area'] * flat)}")
    return rings, notes


def nested(rings: list[Array]) -> list[Array]:
    """Checked rings, the outline first, then what is inside it; ``InvalidInput`` where that is no object."""
    if not rings:
        raise InvalidInput("the drawing is empty: nothing in it encloses an area")
    if len(rings) > _MOST_RINGS:
        raise InvalidInput(f"there are {len(rings)} closed curves, more than {_MOST_RINGS}")
    checked = sorted((checked_ring(ring, "outline") for ring in rings), key=signed_area, reverse=True)
    check_nested(checked, [checked_region(ring, "outline") for ring in checked])
    return checked


def _converted(unit: float | None, wanted: str | None) -> tuple[float, list[str]]:
    """The factor from the file's unit to the one wanted, and a word on the file's."""
    if unit is None:
        if wanted is not None:
            raise InvalidInput("the file does not say its unit: give scale in place of unit")
        return 1.0, []
    name = next((f"{n}" for n, metres in UNITS.items() if abs(metres - unit) <= 1e-9 * unit), f"{unit:.6g} m")
    words = [f"the file's unit is {name}" + ("" if wanted is None else f", converted to {wanted}")]
    return (1.0 if wanted is None else unit / UNITS[wanted]), words
