"""Drawings in SVG: what is seen of them, every transform applied, y turned up."""

import re
from dataclasses import dataclass, replace
from typing import Any
from warnings import warn
from xml.etree.ElementTree import Element

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.outline.drawing import UNITS, Budget, Drawing, Piece, check_known, counted
from regrasp.outline.opening import reason
from regrasp.outline.svg.clip import Clip, clip_of, cut, share_within
from regrasp.outline.svg.shapes import SHAPES, shape
from regrasp.outline.svg.style import Name, Styles, is_painted
from regrasp.outline.svg.transform import (
    NUMBER,
    length,
    numbers_of,
    origin_of,
    transform,
    turned_about,
    viewport,
)
from regrasp.outline.svg.xml import attribute, local, tree_of

_SILENT = {
    "defs", "symbol", "title", "desc", "metadata", "style", "script", "clipPath", "mask", "pattern", "marker",
    "linearGradient", "radialGradient", "filter", "view", "cursor", "font", "color-profile",
}  # fmt: skip
_DEEPEST = 200
_UNDER = np.diag([1.0, -1.0, 1.0])


@dataclass(frozen=True)
class _Place:
    """Where an element stands: its transform, ancestors, inherited style and viewport."""

    matrix: Array
    path: tuple[Name, ...]
    style: dict[str, str]
    view: tuple[float, float]
    chosen: bool  # in a layer asked for, or none was
    uses: tuple[int, ...] = ()
    clips: tuple[Clip | None, ...] = ()  # outside of which nothing is seen


def svg_drawing(data: bytes, layers: tuple[str, ...] | None = None) -> Drawing:
    """The pieces of every shape that is seen, in user units. Raises ``InvalidInput`` for what is not SVG.

    layers: read these groups only, by ``id`` or Inkscape's label, hidden or not.
    """
    root = tree_of(data)
    walk = _Walk(root, layers)
    try:
        walk.element(root, _Place(_UNDER, (), {}, (0.0, 0.0), layers is None))
    except (ValueError, OverflowError, np.linalg.LinAlgError) as error:
        if isinstance(error, InvalidInput):
            raise
        raise InvalidInput(f"the file cannot be read as SVG: {reason(error)}") from None
    return walk.drawing()


class _Walk:
    """Goes through the tree and collects pieces."""

    def __init__(self, root: Element, layers: tuple[str, ...] | None) -> None:
        self._root, self._layers = root, layers
        self._by_id = {element.attrib["id"]: element for element in root.iter() if "id" in element.attrib}
        self._styles = Styles([e.text or "" for e in root.iter() if local(e.tag) == "style"])
        self._budget = Budget()
        self._seen: list[Piece] = []
        self._unpainted: list[Piece] = []
        self._hidden: list[str] = []
        self._left: list[str] = []
        self._known: list[str] = []
        self._cut: list[str] = []
        self._uncut: list[str] = []
        self._clips: dict[tuple[Any, ...], Clip | None] = {}

    def drawing(self) -> Drawing:
        check_known(self._layers, self._known)
        words = f"cut by a clip-path, which is not followed: {counted(self._uncut)}"
        notes = [words] if self._uncut else []
        for note in notes:
            warn(f"the drawing is {note}: look at what was read", stacklevel=6)
        for words, found in (("cut off at a clip-path", self._cut),
                             ("hidden, left out", self._hidden), ("left out", self._left),
                             ("style rules not followed", self._styles.unread)):  # fmt: skip
            if found:
                notes.append(f"{words}: {counted(found)}")
        doubts = counted(["curve with neither fill nor stroke"] * len(self._unpainted))
        return Drawing(self._seen, self._unpainted, doubts, _unit(self._root), tuple(self._known), notes)

    def element(self, element: Element, place: _Place, used: bool = False) -> None:
        """One element and what is in it; a symbol only where it is used."""
        kind = local(element.tag)
        if not kind:
            return
        if len(place.path) > _DEEPEST:
            raise InvalidInput(f"the file has elements nested more than {_DEEPEST} deep, uses included")
        self._budget.spend(pieces=1)
        name = (kind, element.attrib.get("id", ""), frozenset(element.attrib.get("class", "").split()))
        path = (*place.path, name)
        style = self._styles.of(path, element.attrib, place.style)
        is_named = self._is_named(element)
        if style.get("display") == "none" and not (is_named and self._layers):
            if kind not in _SILENT:
                self._hidden.append(kind)
            return
        here = replace(
            place, matrix=place.matrix @ _own(style, place.view), path=path, style=style,
            chosen=place.chosen or is_named,
        )  # fmt: skip
        clip = style.get("clip-path", "none")
        if clip != "none":
            here = replace(here, clips=(*here.clips, self._clip(clip, here)))
        if style.get("mask", "none") != "none":
            self._left.append("mask")
        if kind in SHAPES:
            self._shape(kind, element, here)
        elif kind == "use":
            self._use(element, here)
        elif kind == "svg" or (kind == "symbol" and used):
            self._viewport(element, here, kind)
        elif kind in ("g", "a"):
            self._children(element, here)
        elif kind == "switch":
            for child in element:
                if local(child.tag) and not attribute(child, "requiredExtensions"):
                    self.element(child, here)
                    break
        elif kind not in _SILENT:
            self._left.append(kind)

    def _is_named(self, element: Element) -> bool:
        """Whether the element is a layer asked for; what could be one is remembered."""
        label = next((v for k, v in element.attrib.items() if k.endswith("}label")), None)
        names = [name for name in (label, element.attrib.get("id")) if name]
        if local(element.tag) == "g":
            self._known += [name for name in names[:1] if name not in self._known]
        asked = {layer.casefold() for layer in self._layers or ()}
        found = [name for name in names if name.casefold() in asked]
        self._known += [name for name in found if name not in self._known]
        return bool(found)

    def _children(self, element: Element, place: _Place) -> None:
        for child in element:
            self.element(child, place)

    def _shape(self, kind: str, element: Element, place: _Place) -> None:
        if not place.chosen:
            return
        if place.style.get("visibility") in ("hidden", "collapse"):
            self._hidden.append(kind)
            return
        inside, edge = is_painted(place.style)
        matrix, shift = place.matrix[:2, :2], place.matrix[:2, 2]
        for piece in shape(kind, element.attrib | place.style, place.view):
            self._budget.spend_on(piece)
            curves = tuple(curve.mapped(matrix, shift) for curve in piece.curves)
            drawn = Piece(curves, piece.closed, piece.filled and inside)
            if place.clips:
                self._budget.spend(pieces=20)
            seen = self._shown_of(kind, drawn, place.clips) if place.clips else [drawn]
            (self._seen if inside or edge else self._unpainted).extend(seen)

    def _clip(self, link: str, place: _Place) -> Clip | None:
        """What a clip-path shows, None where it is not known."""
        target = self._by_id.get(link.strip().removeprefix("url(").rstrip(")").strip("'\"# "))
        if target is None or local(target.tag) != "clipPath" or id(target) in place.uses:
            return None
        if target.attrib.get("clipPathUnits", "userSpaceOnUse") != "userSpaceOnUse":
            return None
        key = (id(target), place.matrix.tobytes())
        if key not in self._clips:
            inside = replace(
                place, style={"fill": "black"}, uses=(*place.uses, id(target)), clips=(), chosen=True
            )
            kept = self._seen, self._unpainted
            self._seen, self._unpainted = [], []
            for child in target:
                self.element(child, inside)
            self._clips[key] = clip_of(self._seen)
            self._seen, self._unpainted = kept
        return self._clips[key]

    def _shown_of(self, kind: str, piece: Piece, clips: tuple[Clip | None, ...]) -> list[Piece]:
        """What is seen of a piece in clips; remembers one that is cut, and one that should be."""
        seen = [None if clip is None else share_within(piece, clip) for clip in clips]
        if 0 in seen and not (piece.filled and self._left_of(piece, clips)):
            self._hidden.append(f"{kind} outside its clip-path")
            return []
        if all(share == 1 for share in seen):
            return [piece]
        left = self._left_of(piece, clips)
        (self._uncut if left is None else self._cut).append(kind)
        return [piece] if left is None else left

    def _left_of(self, piece: Piece, clips: tuple[Clip | None, ...]) -> list[Piece] | None:
        known = [clip for clip in clips if clip is not None]
        return cut(piece, known) if len(known) == len(clips) else None

    def _use(self, element: Element, place: _Place) -> None:
        link = (attribute(element, "href") or "").strip()
        target = self._by_id.get(link[1:]) if link.startswith("#") else None
        if target is None:
            self._left.append(f"use of {link[:40]!r}, which is not in the file")
            return
        if id(target) in place.uses:
            raise InvalidInput(f"{link[:40]!r} uses itself")
        given = element.attrib | place.style
        x, y = (length(given.get(name, "0"), whole) for name, whole in zip("xy", place.view, strict=True))
        shift = np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])
        inside = replace(place, matrix=place.matrix @ shift, uses=(*place.uses, id(target)))
        if local(target.tag) in ("svg", "symbol"):
            sizes = {k: given[k] for k in ("width", "height") if given.get(k, "auto") != "auto"}
            copy = Element(target.tag, {**target.attrib, **sizes})
            copy[:] = list(target)
            target = copy
        self.element(target, inside, used=True)

    def _viewport(self, element: Element, place: _Place, kind: str) -> None:
        """The outermost svg stays in its own units; one inside is fitted into its width and height."""
        given: dict[str, Any] = element.attrib | place.style
        box = _box(element)
        if element is self._root:
            w, h = box[2:] or [_shown(given.get(k, "100%")) for k in ("width", "height")]
            self._children(element, replace(place, view=(w, h)))
            return
        w, h = (
            place.view[k] if given.get(name, "auto") == "auto" else length(given[name], place.view[k])
            for k, name in enumerate(("width", "height"))
        )
        if not (w > 0 and h > 0):
            return
        x, y = (length(given.get(n, "0"), whole) if kind == "svg" else 0.0
                for n, whole in zip("xy", place.view, strict=True))  # fmt: skip
        matrix = place.matrix @ np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])
        if box:
            matrix = matrix @ viewport(box, w, h, element.attrib.get("preserveAspectRatio", ""))
            w, h = box[2:]
        self._children(element, replace(place, matrix=matrix, view=(w, h)))


def _own(style: dict[str, str], view: tuple[float, float]) -> Array:
    for name in ("translate", "rotate", "scale"):
        if style.get(name, "none") != "none":
            raise ValueError(f"the style property {name} is not followed: give it as transform")
    text = style.get("transform")
    if text is None or not text.strip():
        return np.eye(3)
    matrix = transform(text)
    if "transform-origin" not in style:
        return matrix
    if style.get("transform-box", "view-box") != "view-box":
        raise ValueError(f"transform-box {shown(style['transform-box'])} is not followed")
    return turned_about(origin_of(style["transform-origin"], *view), matrix)


def _box(element: Element) -> list[float]:
    """The four numbers of ``viewBox``, or none where it is not one."""
    try:
        box = numbers_of(element.attrib.get("viewBox", ""))
    except ValueError:
        return []
    return box if len(box) == 4 and box[2] > 0 and box[3] > 0 else []


def _shown(text: str) -> float:
    """A side of the outermost viewport; 100 for what is no length."""
    try:
        return length(text, 100.0)
    except ValueError:
        return 100.0


def _unit(root: Element) -> float | None:
    """What a user unit is [m], where the file gives its width or height in a unit that has a length."""
    box, found = _box(root), []
    for name, k in (("width", 2), ("height", 3)):
        text = root.attrib.get(name, "").strip()
        if re.fullmatch(rf"{NUMBER}\s*(in|cm|mm|q|pt|pc)", text, re.IGNORECASE):
            found.append(length(text) * UNITS["px"] / box[k] if box else UNITS["px"])
    return min(found) if found and min(found) > 0 else None
