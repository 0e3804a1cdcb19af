"""A whole regrasp, step by step."""

from math import ceil, degrees
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.outline.outline import Outline
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plots.look.arrows import arrow
from regrasp.plots.look.labels import Labels
from regrasp.plots.look.png import png
from regrasp.plots.look.solids import triangles_of
from regrasp.plots.look.style import (
    GREY,
    PALETTE,
    SMALL,
    TEXT,
    WIDTH,
    label_axis,
    new_figure,
    note,
    short,
    tidy,
)
from regrasp.plots.look.units import SI, Units
from regrasp.plots.regrasps.moments import Finger, Stage, moment_of
from regrasp.plots.regrasps.space_steps import draw_regrasp

_COLUMNS = 4
_PANEL = WIDTH / 2  # [in]
_ROOM = 1.15  # for the words beside the fingers
_INSIDE = 0.8  # of a panel: its axes
_WORD = 6.5  # [pt]


def plot_regrasp(plan: RegraspPlan, outline: Outline | Any = None, *, units: Units = SI) -> Figure:
    """Every step of a regrasp side by side in the world frame, each as it begins, and the end.

    Beside the fingers stands who leaves and who arrives in the step; a grey arc is the turn of the object
    during it. A filled finger pushes: arrows are its force on the object, all at one scale; black is the
    load. In space a dashed arrow is the move of a finger before the step, and a thin line the axis of a turn.

    Args:
        plan: the regrasp to draw.
        outline: in space the solid, anything with ``surface()`` or (vertices (v, 3), faces (f, 3)). Without
            it the hull of all contacts stands for the object.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For anything else.
    """
    if not isinstance(plan, RegraspPlan):
        raise InvalidInput(f"plan must be a RegraspPlan, got {type(plan).__name__}; see plot_transition")
    if plan.rotations is not None:
        return draw_regrasp(plan, triangles_of(outline), units)
    if outline is not None and not isinstance(outline, Outline):
        raise InvalidInput(f"a regrasp in the plane is drawn on an Outline, got {type(outline).__name__}")
    stage, count = Stage(plan.steps, outline, heads=6), len(plan.steps) + 1
    rows = ceil(count / _COLUMNS)
    columns = ceil(count / rows)
    side = _ROOM * stage.reach
    figure = new_figure(_PANEL * columns, (_PANEL + 0.25) * rows)
    for k in range(count):
        ax = tidy(figure.add_subplot(rows, columns, k + 1))
        ax.set_gid(f"step {k + 1}")
        if k < len(plan.steps):
            _step(ax, plan, k, stage)
        else:
            stage.draw(ax, moment_of(plan, k - 1, plan.steps[-1].duration))
            ax.set_title("end" + _at(plan.orientations[-1]), fontsize=TEXT, loc="left")
        first, last = k % columns == 0, k >= count - columns
        ax.tick_params(labelsize=SMALL - 1, labelleft=first, labelbottom=last)
        if first:
            label_axis(ax.yaxis, "$y$", units.length, stage.size)
        if last:
            label_axis(ax.xaxis, "$x$", units.length, stage.size)
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
        ax.set(xlim=(-side, side), ylim=(-side, side))
        if k == 0:
            stage.scale_key(ax, units)
    return figure


def regrasp_png(plan: RegraspPlan) -> bytes:
    """``plot_regrasp`` as a PNG image, for display in notebooks."""
    return png(plot_regrasp(plan))


def _step(ax: Axes, plan: RegraspPlan, k: int, stage: Stage) -> None:
    step = plan.steps[k]
    moment = moment_of(plan, k, 0.0)
    stage.draw(ax, moment)
    labels = Labels(72 * _INSIDE * _PANEL / (2 * _ROOM * stage.reach), gap=1.0)
    for finger in moment.fingers:
        labels.occupy(stage.tip(finger), stage.finger)
    for finger, name in _named(moment.fingers, plan.fingers[k]):
        word = "leaves" if name in step.idle_at_end else "arrives" if name in step.idle_at_start else ""
        if word:
            _label(ax, stage, labels, finger, word)
    turn = plan.orientations[k + 1] - plan.orientations[k]
    if turn:
        _draw_turn(ax, labels, moment.angle, turn, 0.3 * stage.size)
    title = f"{k + 1} {step.kind}" + _at(plan.orientations[k])
    ax.set_title(title, fontsize=TEXT, loc="left")


def _label(ax: Axes, stage: Stage, labels: Labels, finger: Finger, word: str) -> None:
    """A word beside a finger, outside if there is room."""
    outwards = stage.tip(finger) - finger.at
    way = labels.direction(word, stage.tip(finger) + outwards, outwards, _WORD)
    at = stage.tip(finger) + 1.2 * stage.finger * way
    colour = PALETTE[finger.number % len(PALETTE)]
    note(ax, word, at, way, gap=1.0, color=colour, fontsize=_WORD, zorder=8)


def _named(fingers: tuple[Finger, ...], names: tuple[str | None, ...]) -> list[tuple[Finger, str]]:
    return [(finger, str(names[finger.number])) for finger in fingers]


def _at(angle: float) -> str:
    return f", {short(round(degrees(angle), 1))}\N{DEGREE SIGN}" if angle else ""


def _draw_turn(ax: Axes, labels: Labels, start: float, turn: float, radius: float) -> None:
    """An arc from the object's x axis to where it will be."""
    angles = start + np.linspace(0, turn, max(8, ceil(abs(turn) / 0.05)))
    arc: Array = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    ax.plot(*arc[:-2].T, color=GREY, linewidth=1.4, zorder=3)
    arrow(ax, arc[-3], arc[-1], gid="turn", color=GREY, zorder=3, mutation_scale=7)
    middle = arc[len(arc) // 2]
    text = f"{'+' if turn > 0 else ''}{short(round(degrees(turn), 1))}\N{DEGREE SIGN}"
    note(ax, text, middle, labels.direction(text, middle, middle, SMALL), gap=3, color=GREY)
