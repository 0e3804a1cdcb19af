"""A whole regrasp in space, in the object's frame: what stays, what moves, and the frames that move it."""

from html import escape
from itertools import cycle

import numpy as np

from regrasp.mechanics.grasp import Grasp
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plots.grasps.body import breadth, extent
from regrasp.plots.grasps.space_state import CONE
from regrasp.plots.grasps.state import surface_of
from regrasp.plots.look.style import INK, PALETTE
from regrasp.plots.look.units import Units
from regrasp.plots.look.view import facing_view
from regrasp.plots.pages.histories import histories
from regrasp.plots.pages.page_look import layout_of, playing
from regrasp.plots.pages.page_scene import Trace, arrow_traces, body_traces, curve_traces, now_traces

_FRAMES = 160  # of the whole plan, in all
_LONGEST = 0.45  # of the extent: the largest force


def regrasp_figure(plan: RegraspPlan, mesh: object, units: Units) -> Trace:
    """The page's figure. A finger keeps its colour; where it is in the air it has no arrow."""
    found = {contact.name: contact for step in plan.steps for contact in step.grasp}
    every = Grasp(found.values())
    fingers = [
        next(iter(filter(None, names)), f"{i + 1}") for i, names in enumerate(zip(*plan.fingers, strict=True))
    ]
    shade = [colour for _, colour in zip(fingers, cycle(PALETTE), strict=False)]
    colours = {
        name: shade[i] for names in reversed(plan.fingers) for i, name in enumerate(names) if name is not None
    }
    triangles = surface_of(mesh, every)
    vertices = None if triangles is None else triangles[0]
    size, reach = extent(every, vertices), breadth(every, vertices)
    scale = min(_LONGEST * size, reach) / (max(step.peak for step in plan.steps) or 1.0)

    def moving(step: int, t: float) -> list[Trace]:
        now, traces = plan.steps[step], []
        forces = now.forces(t)[:, :3]
        for i, name in enumerate(plan.fingers[step]):
            j = None if name is None else now.grasp.index(name)
            at, force = (np.zeros(3), np.zeros(3)) if j is None else (now.grasp.positions[j], forces[j])
            traces += arrow_traces(f"finger {i + 1}", at, force, scale, size, shade[i], units)
        return traces + arrow_traces("load", np.zeros(3), now.load(t)[:3], scale, size, INK, units)

    history = histories(plan)
    stays = [*body_traces(every, colours, triangles, min(CONE * size, 0.8 * reach))]
    stays += curve_traces(history, shade, units)
    per_step = max(4, _FRAMES // len(plan.steps))
    starts = np.cumsum([0.0, *(step.duration for step in plan.steps)]).tolist()
    instants = [
        (k, t)
        for k, step in enumerate(plan.steps)
        for t in np.linspace(0, step.duration, per_step + 1).tolist()[1 if k else 0 :]
    ]
    times = [starts[k] + t for k, t in instants]
    moves = [
        moving(k, t) + now_traces(history, now, units) for (k, t), now in zip(instants, times, strict=True)
    ]
    places = list(range(len(stays), len(stays) + len(moves[0])))
    frames = [
        {"name": str(n), "data": data, "traces": places, "layout": _words(plan, k)}
        for n, (data, (k, _)) in enumerate(zip(moves, instants, strict=True))
    ]
    layout = layout_of(units, facing_view(every.positions, every.normals))
    return {
        "data": stays + moves[0],
        "frames": frames,
        "layout": layout
        | playing(plan.duration, times, layout["scene"], units, history.has_rates)
        | _words(plan, 0),
    }


def _words(plan: RegraspPlan, step: int) -> Trace:
    """What happens, above the curves."""
    text = f"step {step + 1} of {len(plan.steps)}: {escape(plan.steps[step].in_words)}"
    place = {"xref": "paper", "yref": "paper", "x": 1.0, "y": 1.0, "xanchor": "right", "yanchor": "bottom"}
    return {"annotations": [{"text": text, "showarrow": False, **place}]}
