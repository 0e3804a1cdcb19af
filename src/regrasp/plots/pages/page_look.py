"""How a page in space is laid out: the scene with its axes, curves beside it, a slider and buttons."""

from html import escape
from typing import Any

from regrasp.plots.look.style import INK, short
from regrasp.plots.look.units import Units
from regrasp.plots.look.view import sight
from regrasp.plots.pages.page_curves import axes_over_time

Trace = dict[str, Any]


def layout_of(units: Units, view: tuple[float, float]) -> Trace:
    """One scale on all axes, which name their units, seen from ``view``, elevation and azimuth [deg]."""
    axes = {
        f"{axis}axis": {"title": {"text": f"{axis} [{escape(units.length)}]"}, "backgroundcolor": "white"}
        | {"gridcolor": "#e0e0e0", "zerolinecolor": "#cccccc"}
        for axis in "xyz"
    }
    eye = dict(zip("xyz", (1.8 * sight(*view)).tolist(), strict=True))
    camera = {"projection": {"type": "orthographic"}, "eye": eye}
    return {
        "scene": {"aspectmode": "data", "camera": camera, **axes},
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0.0},
        "margin": {"l": 60, "r": 20, "t": 40, "b": 40},
        "template": "none",
        "font": {"family": "sans-serif", "size": 13, "color": INK},
    }


def playing(duration: float, times: list[float], scene: Trace, units: Units, rates: bool = False) -> Trace:
    """Curves at the right of the scene, and under everything a slider of time with its buttons."""
    step = 1000 * duration / (len(times) - 1) if units.time == "s" else 50.0
    now = {"mode": "immediate", "frame": {"duration": 0, "redraw": True}, "transition": {"duration": 0}}
    play = now | {"frame": {"duration": step, "redraw": True}, "fromcurrent": True}
    unit = escape(units.time)
    steps = [
        {"method": "animate", "args": [[str(k)], now], "label": short(float(f"{t:.3g}"))}
        for k, t in enumerate(times)
    ]
    buttons = [
        {"method": "animate", "args": [None, play], "label": "play"},
        {"method": "animate", "args": [[None], now], "label": "pause"},
    ]
    return {
        "scene": scene | {"domain": {"x": [0.0, 0.58], "y": [0.1, 1.0]}},
        **axes_over_time(duration, units, rates),
        "sliders": [
            {"steps": steps, "x": 0.16, "len": 0.84, "y": 0.02, "pad": {"t": 30}}
            | {"currentvalue": {"prefix": "t = ", "suffix": f" {unit}"}}
        ],
        "updatemenus": [
            {"type": "buttons", "direction": "left", "buttons": buttons, "x": 0.0, "y": 0.0}
            | {"xanchor": "left", "yanchor": "top", "pad": {"t": 40}, "showactive": False}
        ],
    }
