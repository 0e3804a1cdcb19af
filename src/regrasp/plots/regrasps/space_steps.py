"""A whole regrasp in space, step by step."""

from dataclasses import replace
from math import ceil, degrees
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from regrasp.mechanics.checks import Array
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plots.grasps.space_body import dot, write
from regrasp.plots.look.arrows import arrow3d
from regrasp.plots.look.labels import Labels
from regrasp.plots.look.solids import Triangles
from regrasp.plots.look.space_axes import space_panel
from regrasp.plots.look.style import (
    GREY,
    INK,
    PALETTE,
    SMALL,
    TEXT,
    WIDTH,
    new_figure,
    quantity,
    short,
)
from regrasp.plots.look.units import Units
from regrasp.plots.look.view import shared_view
from regrasp.plots.regrasps.moments import Moment, joined, moment_of
from regrasp.plots.regrasps.space_moments import SpaceStage, Window, measures

_COLUMNS = 4
_PANEL = WIDTH / 1.7  # [in]
_TITLE, _FOOT = 0.22, 0.36  # [in]
_ROOM = 1.15  # for the words beside the fingers
_LIFT, _TURN = 0.04, 0.3  # of the object's size
_GAP = 3.0  # between a finger and its word [pt]


def draw_regrasp(plan: RegraspPlan, mesh: Triangles | None, units: Units) -> Figure:
    """``plot_regrasp`` in space."""
    stage, count = SpaceStage(plan.steps, mesh, heads=6), len(plan.steps) + 1
    rows = ceil(count / _COLUMNS)
    columns = ceil(count / rows)
    width, height = _PANEL * columns, (_PANEL + _TITLE) * rows + _FOOT
    figure = new_figure(width, height)
    figure.set_layout_engine("none")
    moments = [moment_of(plan, k, 0.0) for k in range(count - 1)]
    moments.append(moment_of(plan, count - 2, plan.steps[-1].duration))
    window = stage.window(moments, shared_view([moment.touching for moment in moments]))
    window = replace(window, side=_ROOM * window.side)
    for k, moment in enumerate(moments):
        row, column = divmod(k, columns)
        bottom = height - (row + 1) * (_PANEL + _TITLE)
        place = column * _PANEL / width, bottom / height, _PANEL / width, _PANEL / height
        ax = space_panel(figure, place)
        ax.set_gid(f"step {k + 1}")
        window.show(ax)
        stage.draw(ax, moment)
        title = "end" if k == count - 1 else f"{k + 1} {plan.steps[k].kind}"
        figure.text(place[0] + 0.02, (bottom + _PANEL + 0.04) / height, title, fontsize=TEXT)
        if k < count - 1:
            _step(ax, plan, k, stage, moment, window)
    measures(figure.axes[0], stage, window, units)
    _foot(figure, stage, len(plan.fingers[0]), units)
    return figure


def _step(ax: Any, plan: RegraspPlan, k: int, stage: SpaceStage, moment: Moment, window: Window) -> None:
    """What moves: the finger before the step, who leaves and arrives in it, and the turn of the object."""
    step, words = plan.steps[k], _Words(ax, window)
    for finger in moment.fingers:
        words.keep_off(np.linspace(stage.tip(finger), finger.at + stage.scale * finger.force, 6))
    _draw_moves(ax, plan, k, stage, moment.turn)
    for finger in moment.fingers:
        name = plan.fingers[k][finger.number]
        word = "leaves" if name in step.idle_at_end else "arrives" if name in step.idle_at_start else ""
        if word and finger.normal is not None:
            gid, colour = f"word {finger.number}", PALETTE[finger.number % len(PALETTE)]
            words.write(word, stage.tip(finger), -finger.normal, gid=gid, color=colour)
    if step.turn is not None and step.turn.axis is not None:
        arc = _draw_turn(ax, stage, moment.turn @ step.turn.axis, step.turn.angle)
        middle = arc[len(arc) // 2]
        text = f"{short(round(degrees(abs(step.turn.angle)), 1))}\N{DEGREE SIGN}"
        words.write(text, middle, middle, gid="turned", color=GREY)


class _Words:
    """Words of one panel, which keep clear of one another and of the fingers."""

    def __init__(self, ax: Any, window: Window) -> None:
        self.ax, self.window = ax, window
        self.labels = Labels(72 * _PANEL / (2 * window.side), gap=_GAP)
        for way in ((1, 0), (-1, 0), (0, 1), (0, -1)):  # the panels beside this one
            self.labels.occupy(11 * window.side * np.array(way), 10 * window.side)

    def keep_off(self, points: Array) -> None:
        """Keep words away from points (m, 3)."""
        for point in points:
            self.labels.occupy(self.window.flat(point), 2.0 / self.labels.scale)

    def write(self, text: str, at: Array, towards: Array, *, gid: str, color: str) -> None:
        """A word beside a point, if there is room in the direction that ``towards`` is seen in."""
        picture, flat = self.window.picture, self.window.flat(at)
        way = self.labels.direction(text, flat, picture @ towards, SMALL)
        write(self.ax, text, at, way @ picture, _GAP / self.labels.scale, gid=gid, color=color)


def _draw_moves(ax: Any, plan: RegraspPlan, k: int, stage: SpaceStage, turn: Array) -> None:
    """A dashed arrow from where a finger last touched to where it touches in the step, off the surface."""
    normals = joined([step.grasp for step in plan.steps])
    for move in (move for move in plan.moves if move.step == k):
        colour = PALETTE[move.finger % len(PALETTE)]
        ends = [(move.origin, normals[move.origin_name]), (move.target, normals[move.target_name])]
        origin, target = (turn @ (r - _LIFT * stage.size * n) for r, n in ends)
        dot(ax, origin, gid=f"origin {move.finger}", color="white", markeredgecolor=colour, markersize=4)
        look: dict[str, Any] = {"color": colour, "linewidth": 1.0, "linestyle": (0, (3, 2)), "zorder": 6}
        arrow3d(ax, origin, target, gid=f"move {move.finger}", mutation_scale=6, **look)


def _draw_turn(ax: Any, stage: SpaceStage, axis: Array, angle: float) -> Array:
    """The axis of a turn, and an arc around it as long as the turn, (m, 3), which is returned."""
    line = 0.55 * stage.size * np.array([-axis, axis])
    ax.plot(*line.T, color=GREY, linewidth=0.7, linestyle=(0, (6, 2, 1, 2)), zorder=3, gid="axis")
    across = np.cross(axis, np.eye(3)[np.argmin(abs(axis))])
    across /= np.linalg.norm(across)
    angles = np.linspace(0, angle, max(8, ceil(abs(angle) / 0.05)))[:, None]
    arc: Array = _TURN * stage.size * (np.cos(angles) * across + np.sin(angles) * np.cross(axis, across))
    ax.plot(*arc[:-2].T, color=GREY, linewidth=1.4, zorder=6)
    arrow3d(ax, arc[-3], arc[-1], gid="turn", color=GREY, zorder=6, mutation_scale=7)
    return arc


def _foot(figure: Figure, stage: SpaceStage, count: int, units: Units) -> None:
    """Which colour is which finger, and the scale of the forces."""
    colours = [PALETTE[i % len(PALETTE)] for i in range(count)]
    marks = [Line2D([], [], color=c, linewidth=4.0, label=f"F{i}") for i, c in enumerate(colours, 1)]
    marks.append(Line2D([], [], color=INK, linewidth=1.4, label="load"))
    figure.legend(
        handles=marks, loc="lower left", ncols=len(marks), fontsize=SMALL, frameon=False, handlelength=1.2,
        columnspacing=1.0,
    )  # fmt: skip
    text = f"longest arrow: {quantity(stage.longest, units.force)}"
    figure.text(0.99, 0.1 / figure.get_figheight(), text, fontsize=SMALL, ha="right", gid="scale")
