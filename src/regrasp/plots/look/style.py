"""Colours, sizes and axes shared by the figures: legible at a column's width, safe for colour-blind readers.

Figures are made without pyplot, so none is kept alive and no window system is touched.
"""

from collections.abc import Mapping
from itertools import cycle
from math import floor, isfinite, log10
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import ArrayLike, instance
from regrasp.mechanics.grasp import Grasp
from regrasp.plots.look.layout import OnePass

# Okabe and Ito, "Color Universal Design", 2008; yellow, too pale for a line, is left out.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
NO_HOLD = "#dddddd"
"""Of maps, where nothing holds."""
NOT_ALLOWED = "#a3a3a3"
"""Of maps, where constraints let no fingers be."""
INK, GREY, PALE = "#222222", "#767676", "#ececec"

WIDTH = 3.4
"""Width of one panel [in]: a column of a two-column page."""
TEXT, SMALL = 8.0, 7.0
"""Font sizes [pt]."""
DPI = 150

_BESIDE_TICKS = 0.78
"""Of a figure's width, what is left beside the ticks and the name of the vertical axis."""

Colours = Mapping[str, str]
"""The colour of each contact, by name."""


def contact_colours(grasp: Grasp) -> dict[str, str]:
    """A colour for each contact, by its place in the grasp; a seventh contact begins the palette again.

    Args:
        grasp: whose contacts are to be told apart.
    """
    instance(grasp, "grasp", Grasp)
    return dict(zip(grasp.names, cycle(PALETTE), strict=False))


_MARKS = ("o", "s", "^", "D", "v", "P")


def marks(number: int, count: int) -> dict[str, Any]:
    """A few marks by which a line over ``count`` points is told from others in a grey print.

    Each line has them elsewhere, so that lines that lie on each other show both.
    """
    step = max(1, count // 4)
    first = int(step * (0.15 + 0.28 * (number % 3) + 0.14 * (number // 3 % 2)))
    return {
        "marker": _MARKS[number % len(_MARKS)],
        "markersize": 3.4,
        "markevery": (min(first, count - 1), step),
    }


def refuse_space(dimension: int) -> None:
    """Raise ``InvalidInput`` for anything that is not planar."""
    if dimension != 2:
        raise InvalidInput(
            f"this picture is of the plane, got dimension {dimension}; in space there are plot_state, "
            f"plot_transition, plot_escape and html"
        )


def new_figure(width: float = WIDTH, height: float = 2.4, *, bar: bool = False) -> Figure:
    """An empty figure of a size [in], drawn by Agg; with room for a colour bar, if it gets one."""
    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained" if bar else OnePass())
    FigureCanvasAgg(figure)
    return figure


def axes_or_new(ax: Axes | None, height: float = 2.4, *, bar: bool = False) -> Axes:
    """The axes given, or new ones in a figure of their own, with room for a colour bar if it gets one."""
    return tidy(new_figure(height=height, bar=bar).add_subplot()) if ax is None else ax


def tidy(ax: Axes) -> Axes:
    """Axes with our font sizes and without the frame's upper and right sides."""
    ax.tick_params(labelsize=SMALL, length=2.5, width=0.6)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    for side in ("bottom", "left"):
        ax.spines[side].set_linewidth(0.6)
    return ax


def label_axis(axis: Any, name: str, unit: str, largest: float) -> None:
    """Label an axis ``name [unit]``, with a power of ten where ``largest``, its largest number, asks for one.

    The power stands in the label because matplotlib's own place for it collides with titles and legends.
    """
    power = 0
    if isfinite(largest) and largest > 0 and not 0.05 <= largest < 5000:
        power = 3 * floor(log10(largest) / 3)
    prefix = rf"$10^{{{power}}}$ " if power else ""
    axis.set_label_text(f"{name} [{prefix}{unit}]", fontsize=TEXT)
    axis.set_major_formatter(FuncFormatter(lambda value, _: short(value / 10.0**power)))


def steady(ax: Axes, *lines: ArrayLike) -> None:
    """Let an axis of values that hardly change show that: its range is a good part of the values."""
    values = np.concatenate([np.ravel(np.asarray(line, dtype=float)) for line in lines])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    largest = max(abs(low), abs(high))
    if high - low < 0.02 * largest or largest == 0:
        room = 0.3 * largest or 1.0
        ax.set_ylim(low - room, high + room)


def short(value: float) -> str:
    """A number in a few characters, with a true minus sign."""
    return f"{value + 0.0:.4g}".replace("-", "\N{MINUS SIGN}")


def quantity(value: float, unit: str, digits: int = 4) -> str:
    """A number and its unit, a tiny or huge number with a power of ten."""
    mantissa, _, power = f"{value:.{digits}g}".partition("e")
    factor = rf"$\cdot 10^{{{int(power)}}}$" if power else ""
    return f"{short(float(mantissa))}{factor} {unit}"


def literal(name: str) -> str:
    """A name to be shown letter by letter: no ``$`` opens mathematics, no ``_`` hides it from a legend."""
    shown = name.replace("$", r"\$")
    return f" {shown}" if shown.startswith("_") else shown


def note(ax: Axes, text: str, at: ArrayLike, towards: ArrayLike, *, gap: float = 4.0, **look: Any) -> None:
    """A short text beside a point, ``gap`` points away from it in a direction, with a white rim."""
    x, y = np.asarray(towards, dtype=float) / (np.hypot(*np.asarray(towards)) or 1.0)
    side = "left" if x > 0.4 else "right" if x < -0.4 else "center"
    own: dict[str, Any] = {"fontsize": SMALL, "zorder": 6, "ha": side}
    ax.annotate(
        text,
        tuple(np.asarray(at, dtype=float)),
        (gap * x, gap * y),
        textcoords="offset points",
        va="bottom" if y > 0.4 else "top" if y < -0.4 else "center",
        path_effects=[withStroke(linewidth=1.5, foreground="white")],
        **(own | look),
    )


def round_below(value: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that is not above a positive ``value``."""
    power = 10.0 ** floor(log10(value))
    return next(step * power for step in (5, 2, 1) if step * power <= value * (1 + 1e-9))


def legend(ax: Axes, handles: list[Line2D] | None = None, **where: Any) -> None:
    """A legend of the labelled lines, or of ``handles``, above the axes unless placed elsewhere."""
    place = {"loc": "lower left", "bbox_to_anchor": (0, 1), "borderaxespad": 0.2} | where
    columns = len(handles) if handles is not None else len(ax.get_legend_handles_labels()[1])
    options: dict[str, Any] = {"ncols": columns, "columnspacing": 1.0, "handlelength": 1.4} | place
    if handles is not None:
        options["handles"] = handles
    ax.legend(fontsize=SMALL, frameon=False, handletextpad=0.4, **options)


def legend_in_columns(ax: Axes, handles: list[Line2D]) -> None:
    """A legend in two columns above the axes, or in one where two would end beyond the figure."""
    legend(ax, handles, ncols=2)
    figure, made, place = ax.get_figure(root=True), ax.get_legend(), ax.get_subplotspec()
    if figure is None or made is None:
        return
    beside = place.get_gridspec().ncols if place is not None else 1
    if made.get_window_extent().width > _BESIDE_TICKS * figure.bbox.width / beside:
        legend(ax, handles, ncols=1)
