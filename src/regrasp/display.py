"""Pictures in notebooks for values that must not import the floor that draws them."""

from collections.abc import Iterable, Sequence
from importlib import import_module
from math import isnan
from typing import ClassVar

from regrasp.errors import InvalidInput


class Pictured:
    """A value that a notebook shows as a picture.

    ``_drawn_by`` names the drawing function, ``"module:function"``, which returns PNG bytes. It is
    looked up when the picture is shown, so that a plan never imports matplotlib. A value that has no
    picture yet shows its text.
    """

    __slots__ = ()
    _drawn_by: ClassVar[str]

    def _repr_png_(self) -> bytes | None:
        module, function = self._drawn_by.split(":")
        try:
            png: bytes = getattr(import_module(module), function)(self)
        except InvalidInput:
            return None
        return png


def table(head: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "") -> str:
    """A table in HTML: numbers in five digits, a dash for NaN, everything else as text.

    Args:
        head: of the columns, with units.
        rows: cells, as many as the head has.
        caption: a line below.
    """
    from html import escape  # one table of all characters: notebooks alone need it

    titles = "".join(f"<th>{escape(title)}</th>" for title in head)
    body = "".join("<tr>" + "".join(f"<td>{_cell(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    below = f'<caption style="caption-side: bottom">{escape(caption)}</caption>' if caption else ""
    return f"<table>{below}<thead><tr>{titles}</tr></thead><tbody>{body}</tbody></table>"


def _cell(cell: object) -> str:
    if not isinstance(cell, float):
        from html import escape

        return escape(str(cell))
    return "\N{EN DASH}" if isnan(cell) else f"{cell + 0.0:.5g}".replace("-", "\N{MINUS SIGN}")
