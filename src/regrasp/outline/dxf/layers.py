"""Which entities of a DXF are seen, and which by their names are no outline."""

import re
from typing import Any

# Lines of dashes and dots stand for axes and for what is not there; acad_iso names them by numbers.
_LINETYPES = re.compile(
    r"(CENT(ER|RE)|DASH ?DOT|DOT ?DASH|PHANTOM|DIVIDE|BORDER|CHAIN|MITTELLINIE|STRICHPUNKT"
    r"|ACAD_ISO(0[45689]|1[0-5])W)",
    re.IGNORECASE,
)
_LAYERS = re.compile(
    r"(defpoints|(cent(er|re)|axis|construction|dimension|hatch|text|title|border)[ _-]*(lines?|layer|block)"
    r"|dims?|dimensions?|bemassung(en)?|mittellinien?|annotations?|notes?|hatch(es|ing)?|texts?)",
    re.IGNORECASE,
)


class Layers:
    """The layers of a document: on or off, and their line types."""

    def __init__(self, document: Any) -> None:
        self._by_name = {layer.dxf.name.casefold(): layer for layer in document.layers}

    @property
    def names(self) -> tuple[str, ...]:
        """As the table of layers has them."""
        return tuple(layer.dxf.name for layer in self._by_name.values())

    def is_frozen(self, name: str) -> bool:
        """A frozen layer hides what is inserted on it, too."""
        layer = self._by_name.get(name.casefold())
        return bool(layer is not None and layer.is_frozen())

    def is_hidden(self, name: str) -> bool:
        """Off or frozen."""
        layer = self._by_name.get(name.casefold())
        return bool(layer is not None and (layer.is_off() or layer.is_frozen()))

    def linetype(self, entity: Any, layer: str, block: str) -> str:
        """The name of an entity's line type; ``block``: that of the insert it is part of."""
        name = str(entity.dxf.get("linetype", "BYLAYER"))
        if name.upper() == "BYBLOCK":
            return block
        if name.upper() == "BYLAYER":
            found = self._by_name.get(layer.casefold())
            return "" if found is None else str(found.dxf.get("linetype", ""))
        return name

    @staticmethod
    def doubt(layer: str, linetype: str) -> str | None:
        """Why a curve is no outline by its names, or None."""
        if _LINETYPES.match(linetype):
            return f"line type {linetype}"
        return f"layer {layer!r}" if _LAYERS.fullmatch(layer.strip()) else None
