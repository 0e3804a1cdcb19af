"""A plan as one HTML page that plays and needs no network; in space to turn, too. The only user of plotly."""

from html import escape
from os import PathLike
from pathlib import Path
from typing import Any, overload

import numpy as np

from regrasp.disk.staging import whole_path
from regrasp.errors import InvalidInput
from regrasp.mechanics.state import GraspState
from regrasp.motions import Motions
from regrasp.outline.outline import Outline
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition
from regrasp.plots.grasps.body import breadth, extent
from regrasp.plots.grasps.space_state import CONE
from regrasp.plots.grasps.state import force_scale_of, surface_of
from regrasp.plots.look.style import INK, contact_colours
from regrasp.plots.look.units import SI, Units
from regrasp.plots.look.view import facing_view
from regrasp.plots.pages.histories import histories
from regrasp.plots.pages.page_look import layout_of, playing
from regrasp.plots.pages.page_regrasp import regrasp_figure
from regrasp.plots.pages.page_scene import Trace, arrow_traces, body_traces, curve_traces, now_traces
from regrasp.plots.regrasps.moments import as_regrasp

_FRAMES = 40
_HEAD = "<head><title>regrasp</title><style>body { margin: 0; overflow: hidden }</style>"
_DRAWN = "document.documentElement.setAttribute('data-regrasp', 'drawn');"
"""Marks the page once plotly has drawn it."""


Shown = GraspState | Transition | RegraspPlan | Motions


@overload
def html(
    value: Shown,
    path: None = None,
    *,
    mesh: Any = None,
    outline: Outline | None = None,
    title: str | None = None,
    caption: str | None = None,
    units: Units = SI,
) -> str: ...


@overload
def html(
    value: Shown,
    path: str | PathLike[str],
    *,
    mesh: Any = None,
    outline: Outline | None = None,
    title: str | None = None,
    caption: str | None = None,
    units: Units = SI,
) -> Path: ...


def html(
    value: Shown,
    path: str | PathLike[str] | None = None,
    *,
    mesh: Any = None,
    outline: Outline | None = None,
    title: str | None = None,
    caption: str | None = None,
    units: Units = SI,
) -> str | Path:
    """A page that shows a state; of a plan, playing, with forces that move and margins over time.

    In the plane it is drawn in the world frame by our own module, under 1 MB, fingers' motions as they are
    planned. In space it is drawn in the object's frame by plotly (about 5 MB): drag to turn, scroll to come
    nearer; of the load its force is drawn, not its torque. The page holds all it needs and opens without a
    network.

    Args:
        value: a state, a transition, a whole regrasp, or the ``Motions`` of a plan.
        path: where to write it, whole or not at all; returned. Without a path the text is returned.
        mesh: the object in space, anything with ``surface()``, or (vertices (v, 3), faces (f, 3)), as for
            ``plot_state``.
        outline: the object in the plane. Without it the hull of all contacts stands for it.
        title: shown above; what happens, if not given.
        caption: a line below the title, in the plane; the first of the value's own words, if not given.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For anything else and a path that cannot be written.
        ImportError: In space without plotly, the extra ``regrasp[html]``.
    """
    if not isinstance(value, Shown):
        raise InvalidInput(
            f"a page shows a GraspState, a Transition, a RegraspPlan or Motions; got {type(value).__name__}"
        )
    for name, given, d in (("mesh", mesh, 3), ("outline", outline, 2)):
        if given is not None and _dimension(value) != d:
            other = "outline" if d == 3 else "mesh"
            raise InvalidInput(
                f"{name} is of an object {'in space' if d == 3 else 'in the plane'}, which this is not; give "
                f"{other}, got {name} a {type(given).__name__}"
            )
    if _dimension(value) == 2:
        from regrasp.plots.pages.planar_page import planar_page

        text = planar_page(value, outline, title, caption, units)
    else:
        text = _page(value.plan if isinstance(value, Motions) else value, mesh, title, units)
    if path is None:
        return text
    target = Path(path)
    with whole_path(target) as part:
        part.write_text(text, encoding="utf-8")
    return target


def _dimension(value: Shown) -> int:
    if isinstance(value, (GraspState, Transition)):
        return value.grasp.dimension
    return value.steps[0].grasp.dimension


def _page(value: GraspState | Transition | RegraspPlan, mesh: Any, title: str | None, units: Units) -> str:
    try:
        from plotly.graph_objects import Figure
    except ImportError:
        raise ImportError("pages need plotly: pip install 'regrasp[html]'") from None
    if isinstance(value, RegraspPlan):
        shown = regrasp_figure(value, mesh, units)
    else:
        shown = _figure(value, mesh, units)
    if title is not None:
        shown["layout"]["title"] = {"text": escape(title), "x": 0.01, "font": {"size": 15}}
        shown["layout"]["margin"]["t"] = 84
    figure = Figure(shown)
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
    vertices = None if triangles is None else triangles[0]
    scale = force_scale_of(*ends, vertices=vertices)

    def forces(per_finger: Any, load: Any) -> list[Trace]:
        moving: list[Trace] = []
        for name, r, f in zip(grasp.names, grasp.positions, per_finger, strict=True):
            moving += arrow_traces(name, r, f, scale, size, colours[name], units)
        return moving + arrow_traces("load", np.zeros(3), load[:3], scale, size, INK, units)

    stays = body_traces(grasp, colours, triangles, min(CONE * size, 0.8 * breadth(grasp, vertices)))
    layout = layout_of(units, facing_view(grasp.positions, grasp.normals))
    if isinstance(value, GraspState):
        return {"data": stays + forces(value.wrenches[:, :3], value.load.vector), "layout": layout}
    history = histories(as_regrasp(value))
    stays += curve_traces(history, list(colours.values()), units)
    times = np.linspace(0, value.duration, _FRAMES + 1).tolist()
    moves = [forces(value.wrenches(t)[..., :3], value.load(t)) + now_traces(history, t, units) for t in times]
    places = list(range(len(stays), len(stays) + len(moves[0])))
    frames = [{"name": str(k), "data": data, "traces": places} for k, data in enumerate(moves)]
    return {
        "data": stays + moves[0],
        "frames": frames,
        "layout": layout | playing(value.duration, times, layout["scene"], units, history.has_rates),
    }
