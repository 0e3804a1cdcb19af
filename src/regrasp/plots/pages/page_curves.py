"""Which curves over time a page in space shows beside its scene, and their axes."""

from html import escape
from typing import Any

from regrasp.plots.look.units import Units


def curves(units: Units, rates: bool) -> list[tuple[str, str]]:
    """What is drawn over time, from the top, and its unit; ``rates`` of forces where asked for."""
    shown = [("angle margin", "deg"), ("force", units.force)]
    return [*shown, ("rate", f"{units.force}/{units.time}")] if rates else shown


def axis_of(place: int) -> str:
    """The name of the axes of curve ``place``: plotly counts from 1 and leaves 1 out."""
    return str(place + 1) if place else ""


def axes_over_time(duration: float, units: Units, rates: bool) -> dict[str, Any]:
    """Axes of every curve, below one another; the lowest names the time."""
    shown = curves(units, rates)
    room, gap = 0.84 / len(shown), 0.12 if len(shown) == 2 else 0.07
    axes: dict[str, Any] = {}
    for k, (what, unit) in enumerate(shown):
        a, low = axis_of(k), 0.14 + room * (len(shown) - 1 - k)
        axes[f"xaxis{a}"] = {"domain": [0.66, 1.0], "range": [0, duration], "anchor": f"y{a}"}
        axes[f"yaxis{a}"] = {
            "title": {"text": f"{what} [{escape(unit)}]"},
            "domain": [low, low + room - (gap if k else 0.0)],
            "anchor": f"x{a}",
            "rangemode": "tozero" if k else "normal",
        }
    axes[f"xaxis{axis_of(len(shown) - 1)}"]["title"] = {"text": f"t [{escape(units.time)}]"}
    return axes
