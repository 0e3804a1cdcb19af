"""What a margin costs."""

from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from regrasp.mechanics.checks import instance, number
from regrasp.planning.robustness.margin_curve import MarginCurve
from regrasp.plots.look.png import png
from regrasp.plots.look.style import GREY, INK, PALETTE, SMALL, axes_or_new, label_axis, quantity
from regrasp.plots.look.units import SI, Units


def plot_margin_curve(
    curve: MarginCurve, ax: Axes | None = None, *, at_value: float | None = None, units: Units = SI
) -> Axes:
    """The best value of an objective over a force limit, friction or the place of a contact.

    Angles are in degrees. A grey band is where the load is not held.

    Args:
        curve: what ``regrasp.margin_curve`` found.
        ax: the axes to draw on; new ones if not given.
        at_value: a value of the objective, in its unit, at which the least x is shown.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(curve, "curve", MarginCurve)
    ax = axes_or_new(ax)
    degrees = curve.objective.unit == "rad"
    factor, unit = (float(np.degrees(1.0)), "deg") if degrees else (1.0, units.of(curve.objective.unit))
    of_x = {"max_force": units.force, "friction": "-", "position": units.length}[curve.x]
    names = {
        "max_force": "force limit",
        "friction": "factor on friction",
        "position": f"{curve.contact} off along its tangent",
    }
    held = ~np.isnan(curve.values)
    ax.plot(
        curve.at[held], factor * curve.values[held], color=PALETTE[0], linewidth=1.4, marker=".", markersize=3
    )
    ax.set_xlim(float(curve.at[0]), float(curve.at[-1]))
    if not held.all():
        ax.fill_between(
            curve.at,
            0,
            1,
            where=~held,
            step="mid",
            transform=ax.get_xaxis_transform(),
            color="#e4e4e4",
            linewidth=0,
        )
    label_axis(ax.xaxis, names[curve.x], of_x, float(np.abs(curve.at).max()))
    largest = float(np.nanmax(np.abs(factor * curve.values), initial=0.0))
    label_axis(ax.yaxis, f"best {curve.objective.quantity}", unit, largest)
    if at_value is not None:
        place = curve.least(number(at_value, "at_value"))
        if np.isfinite(place):
            y = factor * at_value
            ax.plot(
                [curve.at[0], place, place],
                [y, y, ax.get_ylim()[0]],
                color=GREY,
                linewidth=0.8,
                linestyle="--",
            )
            words = quantity(place, "" if of_x == "-" else of_x, 3).strip()
            ax.annotate(words, (place, y), (4, -9), textcoords="offset points", fontsize=SMALL, color=INK)
    return ax


def margin_curve_png(curve: MarginCurve) -> bytes:
    """``plot_margin_curve`` as a PNG image, for display in notebooks."""
    return png(cast(Figure, plot_margin_curve(curve).figure))
