"""Drawings in DXF, by ezdxf: what is seen of the model space along z, blocks at their places."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from warnings import warn

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.outline.drawing import MOST_PIECES, UNITS, Budget, Drawing, Piece, check_known, counted
from regrasp.outline.dxf.curves import CURVES, frame, mapped, piece, vector
from regrasp.outline.dxf.layers import Layers
from regrasp.outline.opening import quiet, reason

_DEEPEST, _LONGEST_RECOVERED = 50, 5_000_000
_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 9: "mil", 10: "yd", 13: "um", 14: "dm"}
_NO_MARK = ("POINT", "VIEWPORT", "ATTDEF", "ATTRIB", "SEQEND", "VERTEX")


@dataclass(frozen=True)
class _Place:
    """Where a block's entities stand: x' = matrix x + shift; layer and line type of the insert."""

    matrix: Array
    shift: Array
    layer: str = "0"
    linetype: str = ""
    blocks: tuple[str, ...] = ()
    chosen: bool = False


def dxf_drawing(path: Path, size: int, layers: tuple[str, ...] | None = None) -> Drawing:
    """The pieces of LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE and POLYLINE, in the drawing's units.

    What is hidden is left out; what is a centre line or a dimension by its line type or layer is doubtful.
    layers: read these only, hidden or not. size: of the file [bytes]. Raises ``ImportError`` without ezdxf,
    ``InvalidInput`` for a file that is not DXF.
    """
    with quiet("ezdxf"):
        document, notes = _document(path, size)
    from ezdxf.lldxf.const import DXFError

    for note in notes:
        warn(f"{path}: {note}: look at what was read", stacklevel=5)
    try:
        walk = _Walk(document, layers)
        walk.entities(document.modelspace(), _Place(np.eye(3), np.zeros(3)))
    except (
        ValueError,
        TypeError,
        AttributeError,
        ArithmeticError,
        LookupError,
        RuntimeError,
        DXFError,
    ) as error:
        if isinstance(error, InvalidInput):
            raise
        raise InvalidInput(f"the file cannot be read as DXF: {reason(error)}") from None
    drawing = walk.drawing()
    drawing.notes[:0] = notes
    name = _UNITS.get(document.header.get("$INSUNITS", 0))
    drawing.unit = UNITS[name] if name else None
    return drawing


def _document(path: Path, size: int) -> tuple[Any, list[str]]:
    """The document and, where the file is damaged, a word on its recovery."""
    try:
        from ezdxf import recover
        from ezdxf.filemanagement import readfile
        from ezdxf.lldxf.const import DXFError
    except ImportError:
        raise ImportError("reading DXF needs ezdxf: pip install 'regrasp[outlines]'") from None
    wrong = (
        OSError, ValueError, TypeError, AttributeError, LookupError, ArithmeticError, DXFError,
        StopIteration, EOFError, RuntimeError, AssertionError,
    )  # fmt: skip
    try:
        return readfile(path), []
    except wrong as error:
        first = reason(error)
    try:
        if size > _LONGEST_RECOVERED:
            raise ValueError(first)
        document, audit = recover.readfile(path)
        if not len(document.modelspace()):
            raise ValueError(first)
    except wrong:
        raise InvalidInput(f"the file cannot be read as DXF: {first}") from None
    words = (
        f"the file is damaged ({first}); {len(audit.fixes) + len(audit.errors)} faults were mended or passed"
    )
    return document, [words]


class _Walk:
    """Goes through the model space and its blocks and collects pieces."""

    def __init__(self, document: Any, layers: tuple[str, ...] | None) -> None:
        self._blocks, self._layers = document.blocks, Layers(document)
        self._asked = None if layers is None else {layer.casefold() for layer in layers}
        drawn = (str(entity.dxf.get("layer", "0")) for entity in document.modelspace())
        check_known(layers, dict.fromkeys([*self._layers.names, *drawn]))
        self._budget = Budget()
        self._cache: dict[int, Piece | None] = {}
        self._drawing = Drawing()
        self._used: dict[str, None] = {}
        self._left: list[str] = []
        self._hidden: list[str] = []
        self._doubts: list[str] = []

    def drawing(self) -> Drawing:
        drawing = self._drawing
        drawing.layers = tuple(self._used)
        for words, found in (("hidden, left out", self._hidden), ("left out", self._left)):
            if found:
                drawing.notes.append(f"{words}: {counted(found)}")
        drawing.doubts = counted(self._doubts)
        return drawing

    def entities(self, entities: Iterable[Any], place: _Place) -> None:
        for entity in entities:
            kind = entity.dxftype()
            if kind in _NO_MARK:
                continue
            own = str(entity.dxf.get("layer", "0"))
            layer = place.layer if own == "0" and place.blocks else own
            chosen = place.chosen or (self._asked is not None and layer.casefold() in self._asked)
            if not chosen and self._is_hidden(entity, kind, layer):
                self._hidden.append(f"{kind} on layer {layer!r}")
            elif kind == "INSERT":
                self._insert(entity, layer, chosen, place)
            elif chosen or self._asked is None:
                self._curve(entity, kind, layer, chosen, place)

    def _is_hidden(self, entity: Any, kind: str, layer: str) -> bool:
        hides = self._layers.is_frozen if kind == "INSERT" else self._layers.is_hidden
        return bool(entity.dxf.get("invisible", 0)) or hides(layer)

    def _curve(self, entity: Any, kind: str, layer: str, chosen: bool, place: _Place) -> None:
        if kind not in CURVES:
            self._left.append(kind)
            return
        if id(entity) not in self._cache:
            self._cache[id(entity)] = piece(entity)
        found = self._cache[id(entity)]
        if found is None:
            self._left.append(kind)
            return
        self._budget.spend_on(found)
        self._used[layer] = None
        drawn = mapped(found, place.matrix, place.shift)
        doubt = self._layers.doubt(layer, self._layers.linetype(entity, layer, place.linetype))
        if doubt and not chosen:
            self._doubts.append(f"{kind} of {doubt}")
            self._drawing.doubtful.append(drawn)
        else:
            self._drawing.pieces.append(drawn)

    def _insert(self, entity: Any, layer: str, chosen: bool, place: _Place) -> None:
        name = str(entity.dxf.get("name", ""))
        block = self._blocks.get(name)
        if block is None:
            self._left.append(f"INSERT of {name!r}, which is not in the file")
            return
        if name.casefold() in place.blocks:
            raise InvalidInput(f"the block {shown(name)} inserts itself")
        if len(place.blocks) >= _DEEPEST:
            raise InvalidInput(f"blocks are inserted more than {_DEEPEST} deep")
        linetype = self._layers.linetype(entity, layer, place.linetype)
        base = vector(block.block.dxf.get("base_point", (0, 0, 0)))
        for matrix, shift in self._copies(entity, base):
            inside = _Place(place.matrix @ matrix, place.matrix @ shift + place.shift, layer, linetype,
                            (*place.blocks, name.casefold()), chosen)  # fmt: skip
            self.entities(block, inside)

    def _copies(self, entity: Any, base: Array) -> Iterator[tuple[Array, Array]]:
        """Where the copies of a block stand: rows and columns, turned with the insert and not scaled."""
        dxf, axes = entity.dxf, frame(entity)
        t = np.radians(float(dxf.get("rotation", 0.0)))
        turn = np.array([[np.cos(t), -np.sin(t), 0.0], [np.sin(t), np.cos(t), 0.0], [0.0, 0.0, 1.0]])
        matrix = axes @ turn * [float(dxf.get(name, 1.0)) for name in ("xscale", "yscale", "zscale")]
        at = vector(dxf.get("insert", (0, 0, 0)))
        columns, rows = (
            np.arange(max(1, int(count))) * float(space) if space else np.zeros(1)
            for count, space in self._grid(dxf)
        )
        for y in rows:
            for x in columns:
                self._budget.spend(pieces=1)
                yield matrix, axes @ (at + turn @ np.array([x, y, 0.0])) - matrix @ base

    def _grid(self, dxf: Any) -> list[tuple[int, float]]:
        found = [(dxf.get(f"{name}_count", 1), dxf.get(f"{name}_spacing", 0.0)) for name in ("column", "row")]
        for count, space in found:
            if space and count > MOST_PIECES:
                raise InvalidInput(f"a block is inserted {count} times in a row, more than {MOST_PIECES}")
        return found
