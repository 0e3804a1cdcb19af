"""A figure as bytes, or in a file."""

import zlib
from io import BytesIO
from os import PathLike
from pathlib import Path
from struct import pack
from typing import IO, cast

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

_LEVEL = 3


def png(figure: Figure) -> bytes:
    """A figure as a PNG image.

    Args:
        figure: the figure.
    """
    buffer = BytesIO()
    save_png(figure, buffer)
    return buffer.getvalue()


def save_png(figure: Figure, to: str | PathLike[str] | IO[bytes]) -> None:
    """A figure as a PNG file: what ``savefig`` shows, drawn once and laid out meanwhile, not drawn twice.

    Args:
        figure: the figure.
        to: a file name, or a file that is open.
    """
    if not isinstance(figure.canvas, FigureCanvasAgg):  # a window's
        figure.savefig(cast(str, to), format="png")
        return
    figure.canvas.draw()  # type: ignore[no-untyped-call]
    image = _written(np.asarray(figure.canvas.buffer_rgba()), figure.dpi)  # type: ignore[no-untyped-call]
    if isinstance(to, str | PathLike):
        Path(to).write_bytes(image)
    else:
        to.write(image)


def _written(pixels: np.ndarray, dpi: float) -> bytes:
    """Pixels (h, w, 4) as a PNG file (ISO/IEC 15948) without filters, which are for photographs.

    Flat areas and lines take half of the time so, and a fifth fewer bytes.
    """
    if (pixels[..., 3] == 255).all():
        pixels = pixels[..., :3]
    height, width, channels = pixels.shape
    rows = np.zeros((height, 1 + width * channels), dtype=np.uint8)
    rows[:, 1:] = pixels.reshape(height, -1)
    metre = round(dpi / 0.0254)
    header = pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    return b"".join(
        (
            b"\x89PNG\r\n\x1a\n",
            _chunk(b"IHDR", header),
            _chunk(b"pHYs", pack(">IIB", metre, metre, 1)),
            _chunk(b"IDAT", zlib.compress(rows.tobytes(), _LEVEL)),
            _chunk(b"IEND", b""),
        )
    )


def _chunk(kind: bytes, data: bytes) -> bytes:
    return pack(">I", len(data)) + kind + data + pack(">I", zlib.crc32(kind + data))
