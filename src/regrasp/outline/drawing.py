"""What a drawing consists of, whatever its format."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import items
from regrasp.outline.flatten import Curve

MOST_PIECES, _MOST_POINTS = 40_000, 1_000_000
UNITS = {
    "um": 1e-6,
    "mm": 1e-3,
    "cm": 1e-2,
    "dm": 1e-1,
    "m": 1.0,
    "km": 1e3,
    "in": 0.0254,
    "ft": 0.3048,
    "yd": 0.9144,
    "mil": 0.0254e-3,
    "px": 0.0254 / 96,
}
"""Units of drawings [m]; a px is CSS's."""


@dataclass(frozen=True)
class Piece:
    """Curves drawn end to end.

    closed: whether the last one ends where the first begins. filled: whether the drawing paints the inside,
    which closes the piece by a straight line.
    """

    curves: tuple[Curve, ...]
    closed: bool = False
    filled: bool = False


@dataclass
class Drawing:
    """What a file draws.

    pieces: what is seen. doubtful: what by its name or paint is no outline, and ``doubts``, words on it; it
    counts only where there is no outline without it. unit: [m], where the file says it. layers: those in use.
    notes: words on what was done.
    """

    pieces: list[Piece] = field(default_factory=list)
    doubtful: list[Piece] = field(default_factory=list)
    doubts: str = ""
    unit: float | None = None
    layers: tuple[str, ...] = ()
    notes: list[str] = field(default_factory=list)


class Budget:
    """How much of a file may be looked at: a small file can stand for a drawing without end."""

    def __init__(self) -> None:
        self._pieces, self._points = MOST_PIECES, _MOST_POINTS

    def spend(self, pieces: int = 0, points: int = 0) -> None:
        """Raise ``InvalidInput`` when all is spent."""
        self._pieces -= pieces
        self._points -= points
        if self._pieces < 0:
            raise InvalidInput(
                f"there are more than {MOST_PIECES} pieces, uses and inserts counted each time"
            )
        if self._points < 0:
            raise InvalidInput(f"there are more than {_MOST_POINTS} points")

    def spend_on(self, piece: Piece) -> None:
        """What a piece costs: a curve is flattened, straight lines have points."""
        curves = sum(not curve.straight for curve in piece.curves)
        self.spend(1 + 2 * curves, sum(len(curve.inner) + 2 for curve in piece.curves if curve.straight))


def counted(names: Iterable[str]) -> str:
    """What was met how often, as words: 2 of TEXT, 1 of HATCH."""
    return ", ".join(f"{count} {name}" for name, count in Counter(names).most_common())


def checked_layers(layers: object) -> tuple[str, ...] | None:
    """Names of layers as a tuple; one name alone will do."""
    if layers is None:
        return None
    names = (layers,) if isinstance(layers, str) else layers
    result = () if isinstance(names, dict) else items(names, "layers")
    if not result or not all(isinstance(name, str) for name in result):
        raise InvalidInput(f"layers must be a name or names of layers, got {shown(layers)}")
    return result


def check_known(layers: tuple[str, ...] | None, known: Iterable[str]) -> None:
    """Raise ``InvalidInput`` for a layer asked for that the drawing does not have."""
    names = tuple(known)
    for name in layers or ():
        if name.casefold() not in {other.casefold() for other in names}:
            has = ", ".join(repr(other) for other in names[:20]) or "none"
            raise InvalidInput(f"there is no layer {shown(name)}; the drawing has {has}")
