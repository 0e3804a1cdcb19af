"""What a page in space shows, as plain traces: mesh, cones, contacts, forces, and margins over time.

A trace is a dictionary in plotly's terms; nothing here needs plotly.
"""

from html import escape
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.plots.grasps.space_body import cone_surface
from regrasp.plots.look.solids import Triangles, cone, creases
from regrasp.plots.look.style import GREY, INK, Colours, short
from regrasp.plots.look.units import Units
from regrasp.plots.pages.histories import Histories
from regrasp.plots.pages.page_curves import axis_of, curves

Trace = dict[str, Any]

_HEAD = 0.045  # length of an arrow's head, by the extent
_SHOWN = 2.5  # limits up to this many times the largest value are drawn


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


def curve_traces(history: Histories, colours: list[str], units: Units) -> list[Trace]:
    """Margins, forces and rates of every finger over time, on axes below one another; limits are dashed."""
    traces: list[Trace] = []
    for place, (key, limit, unit) in enumerate(_curves(history, units)):
        for line, colour in zip(history.lines, colours, strict=True):
            traces.append(_curve(history.times, line[key], line["name"], colour, place, unit))
        traces += _limit_lines(history, (key, limit), colours, place, unit)
    return traces


def now_traces(history: Histories, t: float, units: Units) -> list[Trace]:
    """Where the time is: a dot on every line of ``curve_traces``."""
    k = int(np.searchsorted(history.times, t - 1e-5 * history.times[-1]).clip(max=len(history.times) - 1))
    look = {"type": "scatter", "mode": "markers", "marker": {"color": INK, "size": 7}}
    rest = {"showlegend": False, "hoverinfo": "skip", "name": "now"}
    dots = []
    for place, (key, _, _) in enumerate(_curves(history, units)):
        values, a = [line[key][k] for line in history.lines], axis_of(place)
        dots.append({**look, **rest, "x": [t] * len(values), "y": values, "xaxis": f"x{a}", "yaxis": f"y{a}"})
    return dots


def _limit_lines(
    history: Histories, keys: tuple[str, str], colours: list[str], place: int, unit: str
) -> list[Trace]:
    """Limits that are near what is drawn; one that all fingers share is grey."""
    largest = max((v for line in history.lines for v in line[keys[0]] if v is not None), default=0.0)
    most = [line.get(keys[1]) for line in history.lines]
    shared, ends = len(set(most)) == 1, [history.times[0], history.times[-1]]
    names = ["all" if shared else line["name"] for line in history.lines]
    return [
        _curve(ends, [limit] * 2, f"limit of {name}", colour, place, unit)
        | {"line": {"color": GREY if shared else colour, "width": 1, "dash": "dash"}}
        for limit, name, colour in list(zip(most, names, colours, strict=True))[: 1 if shared else None]
        if limit is not None and limit <= _SHOWN * largest
    ]


def _curves(history: Histories, units: Units) -> list[tuple[str, str, str]]:
    """Of every curve what is drawn, its limit's key and its unit."""
    shown = curves(units, history.has_rates)
    keys = (("margins", ""), ("forces", "limit"), ("rates", "rate_limit"))
    return [(*key, escape(unit)) for key, (_, unit) in zip(keys, shown, strict=False)]


def _curve(times: list[float], values: list[Any], name: str, colour: str, place: int, unit: str) -> Trace:
    a, what = axis_of(place), escape(name)
    return {"type": "scatter", "mode": "lines", "x": times, "y": values} | {
        "line": {"color": colour, "width": 2},
        "xaxis": f"x{a}",
        "yaxis": f"y{a}",
        "showlegend": False,
        "name": what,
        "hovertemplate": f"{what}: %{{y:.4g}} {unit}<extra></extra>",
    }


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
