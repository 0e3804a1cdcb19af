"""Pictures of how solvers compare: performance profiles, growth with size, distance from known answers."""

from collections.abc import Iterable, Mapping, Sequence
from io import StringIO
from typing import Any, cast

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, PercentFormatter
from numpy.typing import NDArray

from regrasp.plots.look.style import PALE, PALETTE, SMALL, TEXT, literal, new_figure, tidy

Array = NDArray[np.float64]
Looks = Mapping[str, Mapping[str, Any]]
_STROKES = ("-", (0, (4, 1.5)), (0, (5, 1, 1, 1)), (0, (1, 1.2)))
_MARKS = ("o", "s", "^", "D")
_WIDTH, _HEIGHT = 6.6, 3.2


def solver_looks(names: Iterable[str]) -> dict[str, dict[str, Any]]:
    """A colour, stroke and mark for each solver, so that all pictures of a report agree.

    A solver called through another package has the colour it has by itself, dotted.
    """
    names = sorted(names)
    own = {name.rpartition(":")[2].lower() for name in names}
    looks = {}
    for place, name in enumerate(sorted(own)):
        turn = place // len(PALETTE) % len(_STROKES[:-1])
        colour = PALETTE[place % len(PALETTE)]
        looks[name] = {"color": colour, "linestyle": _STROKES[turn], "marker": _MARKS[turn]}
    through = {"linestyle": _STROKES[-1], "marker": _MARKS[-1]}
    return {name: looks[name.rpartition(":")[2].lower()] | (through if ":" in name else {}) for name in names}


def plot_profiles(ratios: Mapping[str, Array], looks: Looks, ax: Axes | None = None) -> Axes:
    """Performance profiles: per solver the share of problems solved rightly within a factor of the best time.

    ratios: of each solver its times over the best of all, rising, infinite where not right.
    """
    ax = _axes(ax)
    largest = max([float(r[np.isfinite(r)].max(initial=1.0)) for r in ratios.values()], default=1.0) * 2
    for name, rising in ratios.items():
        _steps(ax, rising, 1.0, largest, name, looks)
    ax.set_xscale("log")
    ax.set_xlim(1, largest)
    return _shares(ax, "time over the best solver's, \N{GREEK SMALL LETTER TAU}", "right within that factor")


def plot_distances(distances: Mapping[str, Sequence[float]], looks: Looks, ax: Axes | None = None) -> Axes:
    """Per solver the share of problems whose objective lies within a relative distance of the known optimum.

    distances: rising, infinite where no answer came.
    """
    ax = _axes(ax)
    least, largest = 1e-17, 1.0
    for name, there in distances.items():
        _steps(ax, np.maximum(np.array(there, dtype=float), least), least, largest, name, looks)
    ax.set_xscale("log")
    ax.set_xlim(least, largest)
    return _shares(ax, "distance of the objective from the known optimum, relative", "problems within it")


def plot_growth(
    times: Mapping[str, tuple[Sequence[float], Sequence[float]]], looks: Looks, ax: Axes | None = None
) -> Axes:
    """Per solver its times [s] over the sizes of problems [entries of A], with lines of linear growth.

    Sizes of one octave are drawn as one, at their geometric means: problems of other kinds lie between.
    """
    ax = _axes(ax)
    merged = {name: _octaves(*found) for name, found in times.items()}
    for name, (sizes, seconds) in merged.items():
        ax.plot(sizes, seconds, label=literal(name), linewidth=1.2, markersize=2.5, **looks[name])
    ax.set_xscale("log")
    ax.set_yscale("log")
    everything = [seconds.tolist() for _, seconds in merged.values()]
    low, high = min(map(min, everything)), max(map(max, everything))
    ax.set_ylim(low / 2, high * 2)
    ends = np.array(ax.get_xlim())
    for power in range(-12, 6):  # t = 10^power times the entries
        ax.plot(ends, 10.0**power * ends, color=PALE, linewidth=0.8, zorder=0)
    ax.set_xlim(*ends)
    ax.xaxis.set_minor_formatter(NullFormatter())
    if ends[1] < 100 * ends[0]:  # else decades are enough
        ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        ax.xaxis.set_major_formatter(FuncFormatter(lambda size, _: f"{size:.0f}"))
    ax.set_xlabel("non-zero entries of A", fontsize=TEXT)
    ax.set_ylabel("time [s]", fontsize=TEXT)
    return _keyed(ax)


def svg(ax: Axes) -> str:
    """The figure of the axes as SVG, the same at every call."""
    text = StringIO()
    with rc_context({"svg.hashsalt": "regrasp", "svg.fonttype": "path"}):
        cast(Figure, ax.figure).savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def _octaves(sizes: Sequence[float], seconds: Sequence[float]) -> tuple[Array, Array]:
    """Geometric means of the sizes and times between one power of two and the next."""
    logs = np.log2(np.array([sizes, seconds], dtype=float))
    octaves = np.floor(logs[0])
    means = np.array([logs[:, octaves == octave].mean(axis=1) for octave in np.unique(octaves)])
    return np.exp2(means[:, 0]), np.exp2(means[:, 1])


def _axes(ax: Axes | None) -> Axes:
    return tidy(new_figure(_WIDTH, _HEIGHT).add_subplot()) if ax is None else ax


def _steps(ax: Axes, rising: Array, start: float, end: float, name: str, looks: Looks) -> None:
    """The share of values up to x, as a line that rises at each of them."""
    came = rising[np.isfinite(rising)]
    heights = np.arange(came.size + 1) / rising.size
    look = {key: value for key, value in looks[name].items() if key != "marker"}
    ax.step(
        [start, *came, end], [*heights, heights[-1]], where="post", label=literal(name), linewidth=1.2, **look
    )


def _shares(ax: Axes, below: str, beside: str) -> Axes:
    ax.set_ylim(0, 1.02)
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    ax.set_xlabel(below, fontsize=TEXT)
    ax.set_ylabel(beside, fontsize=TEXT)
    ax.grid(visible=True, axis="y", color=PALE, linewidth=0.6)
    return _keyed(ax)


def _keyed(ax: Axes) -> Axes:
    """With the key beside the axes, where it covers nothing."""
    ax.set_axisbelow(True)
    ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=SMALL, frameon=False, handlelength=2.6)
    return ax
