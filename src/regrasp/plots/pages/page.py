"""A grasp in space as one HTML page to turn and to play, which needs no network. The only user of plotly."""

from html import escape
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, overload

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.state import GraspState
from regrasp.plans.transition import Transition
from regrasp.plots.grasps.body import extent
from regrasp.plots.grasps.space_state import CONE
from regrasp.plots.grasps.state import force_scale_of, surface_of
from regrasp.plots.look.style import INK, contact_colours, short
from regrasp.plots.look.units import SI, Units
from regrasp.plots.look.view import facing_view, sight
from regrasp.plots.pages.page_scene import Trace, arrow_traces, body_traces, history_traces, marker_traces

_FRAMES = 40
_HEAD = "<head><title>regrasp</title><style>body { margin: 0; overflow: hidden }</style>"
_DRAWN = "document.documentElement.setAttribute('data-regrasp', 'drawn');"
"""Marks the page once plotly has drawn it."""


@overload
def html(
    value: GraspState | Transition, path: None = None, *, mesh: Any = None, units: Units = SI
) -> str: ...


@overload
def html(
    value: GraspState | Transition, path: str | PathLike[str], *, mesh: Any = None, units: Units = SI
) -> Path: ...


def html(
    value: GraspState | Transition,
    path: str | PathLike[str] | None = None,
    *,
    mesh: Any = None,
    units: Units = SI,
) -> str | Path:
    """A page that shows a state in space; of a transition, with forces that move and margins over time.

    The page holds all it needs (about 5 MB) and opens without a network; drag to turn, scroll to come nearer.
    Of the load its force is drawn, not its torque.

    Args:
        value: a state or a transition in space.
        path: where to write it, whole or not at all; returned. Without a path the text is returned.
        mesh: the object, anything with ``surface()``, or (vertices (v, 3), faces (f, 3)), as for
            ``plot_state``.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For a planar grasp and a path that cannot be written.
        ImportError: Without plotly, the extra ``regrasp[html]``.
    """
    if not isinstance(value, (GraspState, Transition)):
        raise InvalidInput(
            f"a page shows a GraspState or a Transition, such as a step of a regrasp; "
            f"got {type(value).__name__}"
        )
    if value.grasp.dimension != 3:
        raise InvalidInput("a page shows a grasp in space; of a planar plan, animate writes one")
    text = _page(value, mesh, units)
    if path is None:
        return text
    target = Path(path)
    try:
        with TemporaryDirectory(prefix=".regrasp-", dir=target.parent) as temporary:
            part = Path(temporary, "page")
            part.write_text(text, encoding="utf-8")
            part.replace(target)
    except OSError as error:
        raise InvalidInput(f"{target}: cannot be written: {error.strerror}") from None
    return target


def _page(value: GraspState | Transition, mesh: Any, units: Units) -> str:
    try:
        from plotly.graph_objects import Figure
    except ImportError:
        raise ImportError("pages need plotly: pip install 'regrasp[html]'") from None
    figure = Figure(_figure(value, mesh, units))
    page: str = figure.to_html(
        include_plotlyjs=True,
        full_html=True,
        auto_play=False,
        post_script=_DRAWN,
        default_height="100vh",
        config={"displaylogo": False, "responsive": True, "showSendToCloud": False, "plotlyServerURL": ""},
    )
    return page.replace("<head>", _HEAD, 1)


def _figure(value: GraspState | Transition, mesh: Any, units: Units) -> Trace:
    """The page's figure: what stays, then what moves, then the frames that move it."""
    grasp, triangles = value.grasp, surface_of(mesh, value.grasp)
    colours = contact_colours(grasp)
    size = extent(grasp, None if triangles is None else triangles[0])
    ends = (value,) if isinstance(value, GraspState) else (value.start, value.end)
    scale = force_scale_of(*ends, mesh=triangles)

    def forces(per_finger: Any, load: Any) -> list[Trace]:
        moving: list[Trace] = []
        for name, r, f in zip(grasp.names, grasp.positions, per_finger, strict=True):
            moving += arrow_traces(name, r, f, scale, size, colours[name], units)
        return moving + arrow_traces("load", np.zeros(3), load[:3], scale, size, INK, units)

    stays = body_traces(grasp, colours, triangles, CONE * size)
    layout = _layout(units, facing_view(grasp.positions, grasp.normals))
    if isinstance(value, GraspState):
        return {"data": stays + forces(value.wrenches[:, :3], value.load.vector), "layout": layout}
    stays += history_traces(value, colours, units)
    times = np.linspace(0, value.duration, _FRAMES + 1).tolist()
    moves = [forces(value.wrenches(t)[..., :3], value.load(t)) + marker_traces(t, value) for t in times]
    places = list(range(len(stays), len(stays) + len(moves[0])))
    frames = [{"name": str(k), "data": data, "traces": places} for k, data in enumerate(moves)]
    return {
        "data": stays + moves[0],
        "frames": frames,
        "layout": layout | _playing(value, times, layout["scene"], units),
    }


def _layout(units: Units, view: tuple[float, float]) -> Trace:
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


def _playing(transition: Transition, times: list[float], scene: Trace, units: Units) -> Trace:
    """Curves at the right of the scene, and under everything a slider of time with its buttons."""
    step = 1000 * transition.duration / _FRAMES if units.time == "s" else 50.0
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
    time = {"domain": [0.66, 1.0], "range": [0, transition.duration]}
    return {
        "scene": scene | {"domain": {"x": [0.0, 0.58], "y": [0.1, 1.0]}},
        "xaxis": {**time, "anchor": "y"},
        "yaxis": {"title": {"text": "angle margin [deg]"}, "domain": [0.62, 0.98], "anchor": "x"},
        "xaxis2": {**time, "anchor": "y2", "title": {"text": f"t [{unit}]"}},
        "yaxis2": {"title": {"text": f"force [{escape(units.force)}]"}, "domain": [0.14, 0.5], "anchor": "x2"}
        | {"rangemode": "tozero"},
        "sliders": [
            {"steps": steps, "x": 0.16, "len": 0.84, "y": 0.02, "pad": {"t": 30}}
            | {"currentvalue": {"prefix": "t = ", "suffix": f" {unit}"}}
        ],
        "updatemenus": [
            {"type": "buttons", "direction": "left", "buttons": buttons, "x": 0.0, "y": 0.0}
            | {"xanchor": "left", "yanchor": "top", "pad": {"t": 40}, "showactive": False}
        ],
    }
