"""A plan in the plane as one HTML page that plays, drawn by our own module of SVG; it needs no network."""

import json
from html import escape
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.state import GraspState
from regrasp.motions import Motions
from regrasp.outline.outline import Outline
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition
from regrasp.plots.look.units import Units
from regrasp.plots.pages.histories import finger_names, histories, rounded
from regrasp.plots.pages.timeline import Instant, timeline
from regrasp.plots.regrasps.moments import Moment, Stage, as_regrasp, moment_of
from regrasp.plots.regrasps.ways import motion_moments
from regrasp.web.modules import module, style

_FRAMES, _MOST = 40, 1200  # of a step, and of a page
_MOVE = 0.5  # of the mean step's time: how long a finger is in the air where no motion says
_KEY = (
    "Arrows are forces of the fingers on the object and, in black, the load; the world stands still and the "
    "object turns. A filled finger pushes, an open one touches, a dashed one is in the air. Sectors are "
    "friction cones; the circled cross is the centre of mass. Lines stop where a finger has no force."
)
_SUGGESTED = " Grey is the hull of all contacts: the outline is not known."
_WAYS = " The ways of fingers in the air are only suggested."
_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy"
  content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:">
<title>{title}</title>
<style>{style}</style>
</head>
<body>
<main id="plan"></main>
<script type="application/json" id="shown">{shown}</script>
<script type="module">
{module}
open_player(document.getElementById("plan"), JSON.parse(document.getElementById("shown").textContent));
</script>
</body>
</html>
"""


def planar_page(
    value: GraspState | Transition | RegraspPlan | Motions,
    outline: Outline | None,
    title: str | None,
    caption: str | None,
    units: Units,
) -> str:
    """The text of the page; see ``html``."""
    if outline is not None and not isinstance(outline, Outline):
        raise InvalidInput(f"a plan in the plane is drawn on an Outline, got {type(outline).__name__}")
    plan = _as_plan(value)
    whole = as_regrasp(plan)
    stage = Stage(whole.steps, outline)
    frames = _frames(value, whole, stage.radius)
    rings = stage.rings or [stage.hull]
    guessed = not isinstance(value, Motions) and any(f.moving for f in frames)
    still, history = isinstance(value, GraspState), histories(whole)
    shown = {
        "title": title or _title(value),
        "caption": caption or str(value).partition("\n")[0],
        "key": _KEY + ("" if stage.rings else _SUGGESTED) + (_WAYS if guessed else ""),
        "units": {"length": units.length, "force": units.force, "time": units.time},
        "rings": [_plain(ring) for ring in rings],
        "known": bool(stage.rings),
        "radius": stage.radius,
        "reach": stage.reach,
        "perNewton": stage.scale,
        "frames": [_frame(instant, whole) for instant in frames],
        "steps": [] if still else [{"words": step.in_words} for step in whole.steps],
        "fingers": finger_names(whole),
        "times": [0.0] if still else history.times,
        "lines": [] if still else history.lines,
    }
    text = json.dumps(shown, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    return _PAGE.format(
        title=escape(str(shown["title"])),
        style=style(),
        shown=text,
        module=module("scene", "charts", "player"),
    )


def _as_plan(value: GraspState | Transition | RegraspPlan | Motions) -> Transition | RegraspPlan:
    if isinstance(value, Motions):
        return value.plan
    return _still(value) if isinstance(value, GraspState) else value


def _still(state: GraspState) -> Transition:
    """A state as a plan in which nothing changes."""
    from regrasp.plans.record import Record
    from regrasp.plans.timing import TimeScaling

    return Transition(state, state, TimeScaling.linear(1.0), Record(0.0))


def _title(value: Any) -> str:
    if isinstance(value, GraspState):
        return f"A grasp of {len(value.grasp)} fingers"
    if isinstance(value, Transition):
        words = value.in_words
        return words[:1].upper() + words[1:]
    return "A regrasp"


def _frames(value: Any, whole: RegraspPlan, radius: float) -> list[Instant]:
    """The moments that the page shows, not more than it can hold."""
    if isinstance(value, GraspState):
        return [Instant(0.0, 0, False, moment_of(whole, 0, 0.0))]
    count = min(_FRAMES, max(2, _MOST // len(whole.steps)))
    rate = count * len(whole.steps) / whole.duration
    if not isinstance(value, Motions):
        return timeline(whole, rate, _MOVE * whole.duration / len(whole.steps), radius)
    t = np.linspace(0, value.duration, min(_MOST, 2 + int(rate * value.duration)))
    times, (steps, local) = value.plan_time(t), value.step_times(t)
    still = [local[i] in (0.0, whole.steps[s].duration) for i, s in enumerate(steps)]
    return [
        Instant(float(times[i]), int(steps[i]), still[i], moment)
        for i, moment in enumerate(motion_moments(value, t))
    ]


def _frame(instant: Instant, whole: RegraspPlan) -> list[Any]:
    """Time, step, whether a finger moves, the object's angle, the load, and the fingers."""
    moment: Moment = instant.moment
    grasp = whole.steps[instant.step].grasp
    names = whole.fingers[instant.step]
    fingers = []
    for f in moment.fingers:
        name = names[f.number] if f.number < len(names) else None
        one: dict[str, Any] = {"number": f.number, "at": _plain(f.at), "force": _plain(f.force)}
        one["normal"] = None if f.normal is None else _plain(f.normal)
        if f.normal is not None and name is not None:
            one |= {"name": name, "friction": grasp[name].friction}
        fingers.append(one)
    now = [rounded(instant.time), instant.step, instant.moving, rounded(moment.angle)]
    return [*now, _plain(moment.load), fingers]


def _plain(values: Any) -> Any:
    """Nested lists of six digits."""
    return np.vectorize(rounded, otypes=[float])(values).tolist()
