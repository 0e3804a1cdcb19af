"""What a page in space shows, as plain traces: mesh, cones, contacts, forces, and margins over time.

A trace is a dictionary in plotly's terms; nothing here needs plotly.
"""

from html import escape
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.plans.transition import Transition
from regrasp.plots.grasps.space_body import cone_surface
from regrasp.plots.look.solids import Triangles, cone, creases
from regrasp.plots.look.style import GREY, INK, Colours, short
from regrasp.plots.look.units import Units

Trace = dict[str, Any]

_HEAD = 0.045  # length of an arrow's head, by the extent
_SAMPLES = 201


def body_traces(grasp: Grasp, colours: Colours, mesh: Triangles | None, cone_length: float) -> list[Trace]:
    """The mesh with its sharp edges, the friction cones, the contacts with names, and the centre of mass."""
    traces: list[Trace] = []
    if mesh is not None:
        flat = {"ambient": 0.7, "diffuse": 0.4, "specular": 0.05}
        traces.append(
            _solid(mesh, "#c9ced3", 0.3, "object", showlegend=True, flatshading=True, lighting=flat)
        )
        traces.append(_line(_broken(creases(mesh)), GREY, 1.5, "edges"))
    for contact in grasp:
        if contact.friction:
            side = cone_surface(contact, cone_length)
            traces.append(_solid(side, colours[str(contact.name)], 0.2, f"cone {contact.name}"))
    names = [escape(name) for name in grasp.names]
    shade = [colours[name] for name in grasp.names]
    r = grasp.positions
    traces.append(
        {
            **_at(r),
            "type": "scatter3d",
            "mode": "markers+text",
            "text": names,
            "textposition": "top center",
            "textfont": {"color": shade, "size": 13},
            "marker": {"color": shade, "size": 5},
            "name": "contacts",
            "hovertemplate": "%{text}<extra></extra>",
            "showlegend": False,
        }
    )
    centre = {"color": "white", "size": 6, "line": {"color": INK, "width": 2}}
    traces.append(
        {
            **_at(np.zeros((1, 3))),
            "type": "scatter3d",
            "mode": "markers",
            "marker": centre,
            "hoverinfo": "name",
        }
        | {"name": "centre of mass", "showlegend": False}
    )
    return traces


def arrow_traces(
    name: str, tail: Array, vector: Array, scale: float, size: float, colour: str, units: Units
) -> list[Trace]:
    """A shaft and a head for a force [N] at ``scale`` [m/N]; both empty for no force."""
    force = float(np.linalg.norm(vector))
    length, head = scale * force, _HEAD * size
    shown = f"{escape(name)}: {short(float(f'{force:.4g}'))} {escape(units.force)}"
    if length <= 1e-6 * size:
        shaft, tip = np.full((2, 3), np.nan), (np.full((3, 3), np.nan), np.array([[0, 1, 2]]))
    else:
        along = vector / force
        end = tail + scale * vector
        head = min(head, 0.6 * length)
        shaft = np.array([tail, end - head * along])
        tip = cone(end, -along, head, 0.38 * head, 16)
    about = {"hovertemplate": f"{shown}<extra></extra>", "legendgroup": name}
    return [
        _line(shaft, colour, 7, escape(name)) | about | {"showlegend": True, "hoverinfo": None},
        _solid(tip, colour, 1.0, escape(name)) | about | {"hoverinfo": None},
    ]


def history_traces(transition: Transition, colours: Colours, units: Units) -> list[Trace]:
    """Angle margins and magnitudes over time, a line for each finger, on the axes x, y and x2, y2."""
    t = np.linspace(0, transition.duration, _SAMPLES)
    margins = np.degrees(transition.margins(t).angle)
    magnitudes = np.linalg.norm(transition.wrenches(t)[..., :3], axis=-1)
    traces: list[Trace] = []
    for values, axis, unit in ((margins, "", "deg"), (magnitudes, "2", escape(units.force))):
        for i, name in enumerate(transition.grasp.names):
            line = {"color": colours[name], "width": 2}
            what = f"{escape(name)}: %{{y:.4g}} {unit}<extra></extra>"
            traces.append(
                {
                    "type": "scatter",
                    "mode": "lines",
                    "x": t.tolist(),
                    "y": _numbers(values[:, i]),
                    "line": line,
                }
                | {"xaxis": f"x{axis}", "yaxis": f"y{axis}", "hovertemplate": what}
                | {"showlegend": False, "name": escape(name)}
            )
    return traces


def marker_traces(t: float, transition: Transition) -> list[Trace]:
    """Where the time is, a dot on every line of ``history_traces``."""
    margins = np.degrees(transition.margins(t).angle)
    magnitudes = np.linalg.norm(transition.wrenches(t)[..., :3], axis=-1)
    look = {"type": "scatter", "mode": "markers", "marker": {"color": INK, "size": 7}}
    rest = {"showlegend": False, "hoverinfo": "skip", "name": "now"}
    return [
        {**look, **rest, "x": [t] * len(values), "y": _numbers(values), "xaxis": f"x{a}", "yaxis": f"y{a}"}
        for values, a in ((margins, ""), (magnitudes, "2"))
    ]


def line_traces(
    times: list[float], lines: list[list[float | None]], colours: list[str], axis: str, unit: str
) -> list[Trace]:
    """A line over time for each finger, on the axes named."""
    return [
        {"type": "scatter", "mode": "lines", "x": times, "y": values, "line": {"color": colour, "width": 2}}
        | {"xaxis": f"x{axis}", "yaxis": f"y{axis}", "showlegend": False, "name": f"finger {i}"}
        | {"hovertemplate": f"finger {i}: %{{y:.4g}} {escape(unit)}<extra></extra>"}
        for i, (values, colour) in enumerate(zip(lines, colours, strict=True), 1)
    ]


def point_traces(t: float, values: list[list[float | None]]) -> list[Trace]:
    """Where the time is, dots on the lines of the first axes and of the second."""
    look = {"type": "scatter", "mode": "markers", "marker": {"color": INK, "size": 7}}
    rest = {"showlegend": False, "hoverinfo": "skip", "name": "now"}
    return [
        {**look, **rest, "x": [t] * len(now), "y": now, "xaxis": f"x{a}", "yaxis": f"y{a}"}
        for now, a in zip(values, ("", "2"), strict=True)
    ]


def _at(points: Array) -> Trace:
    return {axis: _numbers(column) for axis, column in zip("xyz", points.T, strict=True)}


def _numbers(values: Array) -> list[float | None]:
    """Plain numbers; None, a gap, for NaN."""
    return [None if np.isnan(value) else value for value in values.tolist()]


def _line(points: Array, colour: str, width: float, name: str) -> Trace:
    line = {"color": colour, "width": width}
    return {**_at(points), "type": "scatter3d", "mode": "lines", "line": line, "name": name} | {
        "showlegend": False,
        "hoverinfo": "skip",
    }


def _solid(triangles: Triangles, colour: str, opacity: float, name: str, **look: Any) -> Trace:
    vertices, faces = triangles
    corners = {axis: column.tolist() for axis, column in zip("ijk", faces.T, strict=True)}
    base = {"color": colour, "opacity": opacity, "name": name, "hoverinfo": "skip", "showlegend": False}
    return {"type": "mesh3d", **_at(vertices), **corners, **base} | look


def _broken(segments: Array) -> Array:
    """(3 k, 3) the ends of segments (k, 2, 3) with a gap after each."""
    gaps = np.full((len(segments), 1, 3), np.nan)
    result: Array = np.concatenate([segments, gaps], axis=1).reshape(-1, 3)
    return result
