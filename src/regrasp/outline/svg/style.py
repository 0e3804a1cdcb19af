"""The styles of SVG as far as an outline needs them: style sheets, style attributes, inheritance."""

import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from regrasp.errors import InvalidInput

_INHERITED = ("fill", "stroke", "visibility", "fill-opacity", "stroke-opacity", "stroke-width", "color")
_PROPERTIES = (*_INHERITED, "display", "opacity", "clip-path", "mask", "transform", "transform-origin",
               "transform-box", "translate", "rotate", "scale",
               "x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "d")  # fmt: skip
_COMPOUND = re.compile(r"([\w-]+|\*)?((?:[#.][\w-]+)*)\Z")
_MOST_TESTS = 3_000_000

Name = tuple[str, str, frozenset[str]]
"""Tag, id and classes of an element."""


@dataclass(frozen=True)
class _Rule:
    """compounds: the selector's parts, innermost last, each with whether it must be the parent's."""

    rank: tuple[int, int, int, int]
    compounds: tuple[tuple[Name, bool], ...]
    values: dict[str, tuple[str, bool]]


class Styles:
    """What the style sheets of a file say."""

    def __init__(self, sheets: Sequence[str]) -> None:
        self.unread: list[str] = []
        self._by_key: dict[str, list[_Rule]] = defaultdict(list)
        self._tests = 0
        order = 0
        for selectors, body in (rule for sheet in sheets for rule in _rules(sheet)):
            values = _declarations(body)
            if not values:
                continue
            for selector in selectors.split(","):
                order += 1
                compounds = _compounds(selector)
                if compounds is None:
                    self.unread.append(" ".join(selector.split())[:40])
                    continue
                names = [name for name, _ in compounds]
                rank = (sum(bool(name[1]) for name in names), sum(len(name[2]) for name in names),
                        sum(name[0] != "*" for name in names), order)  # fmt: skip
                tag, identity, classes = names[-1]
                key = f"#{identity}" if identity else f".{min(classes)}" if classes else tag
                self._by_key[key].append(_Rule(rank, tuple(compounds), values))

    def of(
        self, path: Sequence[Name], attributes: dict[str, str], inherited: dict[str, str]
    ) -> dict[str, str]:
        """The properties of the last element of ``path``, from the root, that has these attributes.

        An attribute gives way to the sheets, these to the style attribute, all to what is important.
        """
        result = {name: value for name, value in inherited.items() if name in _INHERITED}
        own = {name: attributes[name] for name in _PROPERTIES if name in attributes}
        strong: dict[str, str] = {}
        values = [rule.values for rule in sorted(self._matching(path), key=lambda rule: rule.rank)]
        for declared in [*values, _declarations(attributes.get("style", ""))]:
            for name, (value, important) in declared.items():
                (strong if important else own)[name] = value
        own |= strong
        for name, value in own.items():
            if value == "inherit" or (value in ("unset", "revert") and name in _INHERITED):
                if name in inherited:
                    result[name] = inherited[name]
            elif value not in ("initial", "unset", "revert"):
                result[name] = value
            else:
                result.pop(name, None)
        return result

    def _matching(self, path: Sequence[Name]) -> Iterator[_Rule]:
        tag, identity, classes = path[-1]
        for key in (tag, "*", f"#{identity}", *(f".{name}" for name in classes)):
            for rule in self._by_key.get(key, ()):
                self._tests += len(path)
                if self._tests > _MOST_TESTS:
                    raise InvalidInput("the file has too many style rules for too many elements")
                if _matches(rule.compounds, path):
                    yield rule


def is_painted(style: dict[str, str]) -> tuple[bool, bool]:
    """Whether an element's inside and its line are seen."""
    if _zero(style.get("opacity", "1")):
        return False, False
    clear = ("none", "transparent")
    inside = style.get("fill", "black") not in clear and not _zero(style.get("fill-opacity", "1"))
    widths = (style.get("stroke-opacity", "1"), style.get("stroke-width", "1"))
    edge = style.get("stroke", "none") not in clear and not any(map(_zero, widths))
    return inside, edge


def _zero(text: str) -> bool:
    found = re.match(r"\s*[-+]?0*\.?0*(?:[eE][-+]?\d+)?\s*(?:[a-zA-Z]+|%)?\s*\Z", text)
    return bool(found) and any(letter == "0" for letter in text)


def _declarations(text: str) -> dict[str, tuple[str, bool]]:
    result: dict[str, tuple[str, bool]] = {}
    for part in re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL).split(";"):
        name, colon, value = part.partition(":")
        name, value = name.strip().lower(), value.strip()
        important = bool(re.search(r"!\s*important\Z", value))
        if colon and name in _PROPERTIES:
            value = re.sub(r"!\s*important\Z", "", value).strip()
            if important or not result.get(name, ("", False))[1]:
                result[name] = (_path_of(value) if name == "d" else value, important)
    return result


def _path_of(value: str) -> str:
    found = re.match(r"path\(\s*[\"'](.*)[\"']\s*\)\Z", value, flags=re.DOTALL)
    return found[1] if found else value


def _rules(sheet: str) -> Iterator[tuple[str, str]]:
    """Selectors and bodies; what stands in @-rules is left out."""
    text = re.sub(r"/\*.*?\*/|<!--|-->", " ", sheet, flags=re.DOTALL)
    at = 0
    while True:
        opening = text.find("{", at)
        if opening < 0:
            return
        head = text[at:opening]
        if ";" in head:
            head = head[head.rindex(";") + 1 :]
        closing = text.find("}", opening)
        if head.strip().startswith("@"):
            depth, closing = 1, opening
            for found in re.finditer(r"[{}]", text[opening + 1 :]):
                depth += 1 if found[0] == "{" else -1
                closing = opening + 1 + found.start()
                if not depth:
                    break
        elif closing > 0:
            yield head, text[opening + 1 : closing]
        if closing < 0:
            return
        at = closing + 1


def _compounds(selector: str) -> list[tuple[Name, bool]] | None:
    words = selector.replace(">", " > ").split()
    result: list[tuple[Name, bool]] = []
    child = False
    for word in words:
        if word == ">":
            child = True
            continue
        found = _COMPOUND.match(word)
        if not found:
            return None
        marks = re.findall(r"[#.][\w-]+", found[2])
        identity = "".join(mark[1:] for mark in marks if mark[0] == "#")
        classes = frozenset(mark[1:] for mark in marks if mark[0] == ".")
        result.append(((found[1] or "*", identity, classes), child))
        child = False
    return result or None


def _matches(compounds: tuple[tuple[Name, bool], ...], path: Sequence[Name]) -> bool:
    """Whether the compounds name elements of ``path``, the last of them its last."""
    places, child = {len(path)}, True  # where what stands to the right of a compound may be
    for name, is_child in reversed(compounds):
        above = {k - 1 for k in places} if child else set(range(max(places)))
        places = {k for k in above if k >= 0 and _is(path[k], name)}
        if not places:
            return False
        child = is_child
    return True


def _is(own: Name, asked: Name) -> bool:
    tag, identity, classes = asked
    return tag in ("*", own[0]) and identity in ("", own[1]) and classes <= own[2]
