"""How far things may be off, withstood beside answered."""

from math import degrees, inf, isfinite, pi

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from regrasp.mechanics.checks import instance
from regrasp.planning.robustness.tolerances import Tolerances
from regrasp.plots.look.style import GREY, INK, PALE, PALETTE, SMALL, axes_or_new, legend, literal
from regrasp.plots.look.units import SI, Units


def plot_tolerances(tolerances: Tolerances, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """What is withstood as a share of what some forces could answer, a row for each quantity.

    The room from where things are: friction from 1 down, the load's factor from 1 up, angles and lengths from
    0. On the right both numbers; an empty bar where what can be answered has no end.

    Args:
        tolerances: what ``regrasp.tolerances`` found.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length is called; nothing is converted.
    """
    instance(tolerances, "tolerances", Tolerances)
    rows = _rows(tolerances, units)
    ax = axes_or_new(ax, height=0.9 + 0.21 * len(rows))
    for k, (label, mine, other, words) in enumerate(rows):
        ax.barh(k, 1.0, 0.62, color=PALE if isfinite(other) else "none", edgecolor=GREY, linewidth=0.5)
        share = 0.0 if not isfinite(other) or other <= 0 else min(mine / other, 1.0)
        ax.barh(k, share, 0.62, color=PALETTE[0], gid=label)
        ax.annotate(words, (1.03, k), fontsize=SMALL, color=INK, va="center", annotation_clip=False)
    ax.set_yticks(range(len(rows)), [literal(label) for label, *_ in rows], fontsize=SMALL)
    ax.set_xticks([0, 0.5, 1.0], ["0", "50 %", "100 %"], fontsize=SMALL)
    ax.set_xlim(0, 1.75)
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    ax.spines["bottom"].set_bounds(0, 1)
    ax.set_xlabel("of what can be answered", fontsize=SMALL, loc="left")
    handles = [
        Line2D([], [], color=colour, linewidth=5, solid_capstyle="butt", label=name)
        for colour, name in ((PALETTE[0], "withstood"), ("#cfcfcf", "answered"))
    ]
    legend(ax, handles, ncols=2, alignment="left")
    return ax


def _rows(tolerances: Tolerances, units: Units) -> list[tuple[str, float, float, str]]:
    """Label, withstood and answered room, and both numbers in words."""
    mine, other = tolerances.withstood, tolerances.answered
    rows = [
        ("friction", 1 - mine.friction, 1 - other.friction, _both(mine.friction, other.friction, "x")),
        ("load", mine.load - 1, other.load - 1, _both(mine.load, other.load, "x")),
        ("tilt", mine.tilt, other.tilt, _both(_angle(mine.tilt), _angle(other.tilt), "deg")),
        ("centre", mine.centre, other.centre, _both(mine.centre, other.centre, units.length)),
    ]
    for name, a, b in zip(tolerances.names, mine.position.tolist(), other.position.tolist(), strict=True):
        rows.append((f"position {name}", a, b, _both(a, b, units.length)))
    return rows


def _angle(value: float) -> float:
    return inf if value == pi else degrees(value)


def _both(mine: float, other: float, unit: str) -> str:
    first, second = (
        "any"
        if value == inf
        else f"\N{MULTIPLICATION SIGN}{value:.3g}"
        if unit == "x"
        else f"{value:.3g} {unit}"
        for value in (mine, other)
    )
    return f"{first}  |  {second}"
