"""A figure as bytes, or in a file."""

from io import BytesIO
from os import PathLike
from typing import IO, cast

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

_LEVEL = 3  # half the time of the default, a tenth more bytes


def png(figure: Figure) -> bytes:
    """A figure as a PNG image.

    Args:
        figure: the figure.
    """
    buffer = BytesIO()
    save_png(figure, buffer)
    return buffer.getvalue()


def save_png(figure: Figure, to: str | PathLike[str] | IO[bytes]) -> None:
    """A figure as a PNG file: what ``savefig`` writes, drawn once and laid out meanwhile, not drawn twice.

    Args:
        figure: the figure.
        to: a file name, or a file that is open.
    """
    if isinstance(figure.canvas, FigureCanvasAgg):
        figure.canvas.print_png(to, pil_kwargs={"compress_level": _LEVEL})  # type: ignore[no-untyped-call]
    else:  # a window's
        figure.savefig(cast(str, to), format="png")
