"""What the best margin or the least effort is most sensitive to."""

from typing import Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from regrasp.mechanics.checks import Array, instance
from regrasp.planning.surveys.sensitivity import Sensitivity
from regrasp.plots.look.png import png
from regrasp.plots.look.style import (
    GREY,
    INK,
    SMALL,
    TEXT,
    axes_or_new,
    contact_colours,
    label_axis,
    legend,
    literal,
    quantity,
)
from regrasp.plots.look.units import SI, Units

_BAR, _GAP = 1.0, 0.8
_LINE = 36  # letters that fit above the axes
_HATCHES = ("", "//////", "......", "\\\\\\\\\\\\", "xxxxxx", "||||||")  # fingers in grey
_SEEN: dict[str, Any] = {"edgecolor": "white", "linewidth": 0.0}


def plot_sensitivity(sensitivity: Sensitivity, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """The change of the best value, to first order, by a hundredth of everything (``Sensitivity.effects``).

    A bar per contact for its friction, its place along the boundary's tangent (in space along both), its
    normal and its force limit, where one is given; below them the load's force and torque. Angles are in
    degrees.

    Args:
        sensitivity: what ``regrasp.sensitivity`` found.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(sensitivity, "sensitivity", Sensitivity)
    steps, effects = sensitivity.steps(), sensitivity.effects()
    degrees = sensitivity.unit == "rad"
    factor, unit = (np.degrees(1.0), "deg") if degrees else (1.0, units.of(sensitivity.unit))
    rows = _rows(sensitivity, steps, effects, units)
    height = sum(len(values) * _BAR + _GAP for _, values, _ in rows)
    names = contact_colours(sensitivity.grasp)
    columns = max(1, _LINE // (max(map(len, names)) + 4))  # of the legend
    ax = axes_or_new(ax, height=0.65 + 0.105 * height + 0.14 * -(-len(names) // columns))
    top, ticks = 0.0, []
    for label, values, colours in rows:
        places = top + _BAR * (np.arange(len(values)) + 0.5)
        for place, value, colour, hatch in zip(places, values, colours, _hatches(len(values)), strict=True):
            ax.barh(place, factor * value, 0.8 * _BAR, color=colour, gid=label, hatch=hatch, **_SEEN)
        ticks.append((float(places.mean()), label))
        top += len(values) * _BAR + _GAP
    ax.axvline(0, color=INK, linewidth=0.8)
    ax.set_yticks([y for y, _ in ticks], [label for _, label in ticks], fontsize=SMALL)
    ax.tick_params(axis="y", length=0)
    ax.set_ylim(top, -_GAP)
    ax.spines["left"].set_visible(False)
    largest = factor * max(float(np.nanmax(abs(values), initial=0.0)) for _, values, _ in rows)
    ax.set_xlim(-1.1 * (largest or 1.0), 1.1 * (largest or 1.0))
    arrow = "better \N{RIGHTWARDS ARROW}" if sensitivity.larger_is_better else "\N{LEFTWARDS ARROW} better"
    label_axis(ax.xaxis, f"change ({arrow})", unit, largest)
    value = quantity(factor * sensitivity.value, "" if unit == "-" else unit).strip()
    handles = [
        Patch(facecolor=colour, hatch=hatch, label=literal(name), **_SEEN)
        for (name, colour), hatch in zip(names.items(), _hatches(len(names)), strict=True)
    ]
    title = f"{sensitivity.objective.words} {value}"
    legend(ax, handles, ncols=columns, title=title, title_fontsize=TEXT, alignment="left")  # type: ignore[arg-type]
    return ax


def sensitivity_png(sensitivity: Sensitivity) -> bytes:
    """``plot_sensitivity`` as a PNG image, for display in notebooks."""
    return png(cast(Figure, plot_sensitivity(sensitivity).figure))


def _hatches(count: int) -> list[str]:
    """For each finger, so that bars are told apart without colour."""
    return [_HATCHES[i % len(_HATCHES)] for i in range(count)]


def _rows(
    sensitivity: Sensitivity, steps: dict[str, Array], effects: dict[str, Array], units: Units
) -> list[tuple[str, Array, list[str]]]:
    """Label, bars and colours of each group, from top to bottom."""
    colours = list(contact_colours(sensitivity.grasp).values())
    along = quantity(float(steps["position"].flat[0]), units.length, 2)
    turn = quantity(float(np.degrees(steps["normal"].flat[0])), "deg", 2)
    labels = {
        "friction": "friction\n+1%",
        "position": f"position\n+{along}",
        "normal": f"normal\n+{turn}",
        "limit": "force limit\n+1%",
        "torsion": "torsion\n+1%",
    }
    rows = []
    for name, label in labels.items():
        parts = np.atleast_2d(effects[name].T)  # in space one for each tangent
        for k, part in enumerate(parts, 1):
            words = label if len(parts) == 1 else label.replace("\n", f" $t_{k}$\n")
            if np.isfinite(part).any():
                rows.append((words, np.nan_to_num(part), colours))
    d = sensitivity.grasp.dimension
    axes = "xyz"[:d]
    names = [f"load $f_{axis}$" for axis in axes]
    names += [r"load $\tau$"] if d == 2 else [rf"load $\tau_{axis}$" for axis in axes]
    of_units = [units.force] * d + [units.torque] * (len(names) - d)
    for name, step, effect, of in zip(names, steps["load"], effects["load"], of_units, strict=True):
        rows.append((f"{name} +{quantity(float(step), of, 2)}", np.array([effect]), [GREY]))
    return rows
