"""SVG as a tree of elements, read with bounds: an XML file can stand for more than memory holds."""

from typing import Any
from xml.etree.ElementTree import Element, ParseError, TreeBuilder, XMLParser

from regrasp.errors import InvalidInput
from regrasp.outline.opening import reason

_MOST_ELEMENTS, _DEEPEST, _MOST_EXPANDED = 200_000, 200, 50_000_000


class _Bounded(TreeBuilder):
    """Counts elements and their depth."""

    def __init__(self) -> None:
        super().__init__()
        self._elements = self._depth = 0

    def start(self, tag: Any, attrs: Any) -> Element:
        self._elements += 1
        self._depth += 1
        if self._elements > _MOST_ELEMENTS:
            raise InvalidInput(f"the file has more than {_MOST_ELEMENTS} elements")
        if self._depth > _DEEPEST:
            raise InvalidInput(f"the file has elements nested more than {_DEEPEST} deep")
        return super().start(tag, attrs)

    def end(self, tag: Any) -> Element:
        self._depth -= 1
        return super().end(tag)


def tree_of(data: bytes) -> Element:
    """The root element. Raises ``InvalidInput`` for what is not XML or too large."""
    _check_entities(data)
    parser = XMLParser(target=_Bounded())
    try:
        parser.feed(data)
        root = parser.close()
    except (ParseError, ValueError, LookupError) as error:
        if isinstance(error, InvalidInput):
            raise
        raise InvalidInput(f"the file cannot be read as SVG: {reason(error)}") from None
    if not isinstance(root, Element) or local(root.tag) != "svg":
        raise InvalidInput("the file cannot be read as SVG: its root element is not svg")
    return root


def local(tag: Any) -> str:
    """A tag without its namespace; empty for other namespaces than SVG's, comments and the like."""
    if not isinstance(tag, str):
        return ""
    space, brace, name = tag.rpartition("}")
    return name if not brace or space == "{http://www.w3.org/2000/svg" else ""


def attribute(element: Element, name: str) -> str | None:
    """An attribute in any namespace: ``href`` is ``xlink:href`` too."""
    if name in element.attrib:
        return element.attrib[name]
    return next((value for key, value in element.attrib.items() if key.endswith("}" + name)), None)


def _check_entities(data: bytes) -> None:
    """Entities stand for text: none may stand for more of them, nor all of them for too much."""
    if b"E\0N\0T\0I\0T\0Y" not in data and b"\0E\0N\0T\0I\0T\0Y" not in data and b"<!ENTITY" not in data:
        return
    from xml.parsers import expat

    longest = 0

    def declared(name: str, _parameter: bool, value: str | None, *_: Any) -> None:
        nonlocal longest
        longest = max(longest, len(value or ""))
        if "&" in (value or ""):
            raise InvalidInput(f"the entity {name[:40]!r} stands for other entities")

    def ended() -> None:
        if longest * data.count(b"&") > _MOST_EXPANDED:
            raise InvalidInput("the file's entities stand for too much text")

    parser = expat.ParserCreate()
    parser.EntityDeclHandler = declared
    parser.EndDoctypeDeclHandler = ended
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        if isinstance(error, InvalidInput):
            raise
