"""Pictures in notebooks for values that must not import the floor that draws them."""

from importlib import import_module
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
