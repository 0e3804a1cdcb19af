"""A figure as bytes."""

from io import BytesIO

from matplotlib.figure import Figure


def png(figure: Figure) -> bytes:
    """A figure as a PNG image.

    Args:
        figure: the figure.
    """
    buffer = BytesIO()
    figure.savefig(buffer, format="png")
    return buffer.getvalue()
