"""Directives of the reference, which is written from the code: `public-names` and `all-names`.

`public-names` documents every name of `regrasp.__all__` whose code lies in the rooms listed, one a line (of
all pages the closest room has it), or with `module regrasp.plots` all that this module exports. `all-names`
is a table of them with their first lines.
"""

import importlib
import inspect
import re
from functools import cache
from pathlib import Path

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

import regrasp

STOP_AT = "object, BaseException, BaseModel, dict, tuple"  # not what these bring along
PAGES = Path(__file__).parents[1] / "reference"
BLOCK = re.compile(r"^```\{public-names\}\n(.*?)^```", re.MULTILINE | re.DOTALL)


@cache
def listed() -> list[str]:
    """What the pages of the reference list: rooms, and modules."""
    found = [BLOCK.findall(page.read_text(encoding="utf-8")) for page in sorted(PAGES.glob("*.md"))]
    return [line for blocks in found for block in blocks for line in block.splitlines()]


def room_of(name: str) -> str:
    """The closest of the rooms listed around what defines a public name; `regrasp` is around all."""
    module = getattr(regrasp, name).__module__
    rooms = [line for line in listed() if not line.startswith("module ")]
    around = [room for room in rooms if f"{module}.".startswith(f"{_path(room)}.")]
    return max(around, key=lambda room: len(_path(room)))


def names_in(line: str) -> list[str]:
    """Public names that a line stands for, with their modules; functions first."""
    if line.startswith("module "):
        module = line.removeprefix("module ")
        return [f"{module}.{name}" for name in importlib.import_module(module).__all__]
    inside = [name for name in regrasp.__all__ if room_of(name) == line]
    inside.sort(key=lambda name: (inspect.isclass(getattr(regrasp, name)), name.lower()))
    return [f"regrasp.{name}" for name in inside]


def _path(room: str) -> str:
    return room if room == "regrasp" else f"regrasp.{room}"


class PublicNames(SphinxDirective):
    """One entry for each name, as autodoc writes them."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """The entries, in the order of the lines."""
        return _parsed(self, "\n".join(_entry(path) for line in self.content for path in names_in(line)))


class AllNames(SphinxDirective):
    """A table of every public name with the first line of its docstring."""

    def run(self) -> list[nodes.Node]:
        """The table; names lead to their entries."""
        paths = sorted((path for line in listed() for path in names_in(line)), key=str.lower)
        paths.sort(key=lambda path: path.count("."))
        lines = [".. list-table::", "   :widths: 35 65", ""]
        for path in paths:
            meaning = (inspect.getdoc(_value(path)) or "").partition("\n")[0]
            lines.append(f"   * - :py:obj:`{path.removeprefix('regrasp.')} <{path}>`")
            lines.append(f"     - {_escaped(meaning)}")
        return _parsed(self, "\n".join(lines))


def _parsed(directive: SphinxDirective, text: str) -> list[nodes.Node]:
    return directive.parse_text_to_nodes(f"````{{eval-rst}}\n{text}\n````\n")  # pages are Markdown


def _value(path: str) -> object:
    module, _, name = path.rpartition(".")
    return getattr(importlib.import_module(module), name)


def _entry(path: str) -> str:
    value = _value(path)
    if inspect.isclass(value):
        return f".. autoclass:: {path}\n   :members:\n   :inherited-members: {STOP_AT}\n"
    return f".. {'autofunction' if callable(value) else 'autodata'}:: {path}\n"


def plain_bars(app, what, name, value, options, lines) -> None:
    """Bars in docstrings are absolute values, never substitutions of reStructuredText."""
    lines[:] = [_escaped(line) for line in lines]


def _escaped(line: str) -> str:
    parts = line.split("``")
    return "``".join(part if i % 2 else part.replace("|", r"\|") for i, part in enumerate(parts))


def setup(app):
    """Register the directives."""
    app.add_directive("public-names", PublicNames)
    app.add_directive("all-names", AllNames)
    app.connect("autodoc-process-docstring", plain_bars)
    return {"parallel_read_safe": True}
