"""A plan as a film: GIF, HTML page or MP4."""

from collections.abc import Sequence
from math import ceil, floor, log10, pi
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, number
from regrasp.outline.outline import Outline
from regrasp.planning.regrasp_plan import FingerMove, RegraspPlan
from regrasp.planning.transition import Transition
from regrasp.plots.style import SMALL, TEXT, label_axis, new_figure, refuse_space, short, tidy
from regrasp.plots.units import SI, Units
from regrasp.plots.world import Moment, Stage, as_regrasp, joined, moment_of

# A finger in the air keeps this far from where it touched, as a fraction of the object's size.
_LIFT = 0.08
_DPI = 100


def animate(
    plan: RegraspPlan | Transition,
    outline: Outline | None = None,
    *,
    path: str | PathLike[str],
    frames_per_second: float = 20.0,
    move_time: float = 0.6,
    units: Units = SI,
) -> Path:
    """Write a film of a plan in the world frame, in which gravity keeps its direction and the object turns.

    Forces are those of the fingers on the object, with their tails at the contacts. A dashed ring is a finger
    in the air; its way between two contact points is only suggested and takes ``move_time`` [s], which no
    plan says. Without an outline the hull of all contacts stands for the object. Time runs as in the plan.
    path: ``.gif``, ``.html`` (with buttons; one file) or ``.mp4``, which needs ffmpeg. Returns it.
    Raises ``InvalidInput`` for another ending, for MP4 without ffmpeg and for a grasp in space.
    """
    target = Path(path)
    ending = target.suffix.lower()
    if ending not in (".gif", ".html", ".mp4"):
        raise InvalidInput(f"path must end in .gif, .html or .mp4, got {str(target)!r}")
    if ending == ".mp4" and not FFMpegWriter.isAvailable():
        raise InvalidInput("MP4 needs the program ffmpeg, which is not found; write a .gif or .html instead")
    rate = number(frames_per_second, "frames_per_second", above=0)
    whole = as_regrasp(plan)
    refuse_space(whole.steps[0].grasp.dimension)
    stage = Stage(whole.steps, outline)
    frames = moments(whole, rate, number(move_time, "move_time", least=0), stage.radius, units)
    film = _film(stage, frames, rate, units)
    if ending == ".html":
        target.write_text(film.to_jshtml(embed_frames=True), encoding="utf-8")
    else:
        writer = PillowWriter(fps=rate) if ending == ".gif" else FFMpegWriter(fps=rate)  # type: ignore[arg-type]
        film.save(target, writer=writer, dpi=_DPI)
    return target


def moments(
    plan: RegraspPlan, rate: float, move_time: float, radius: float, units: Units = SI
) -> list[tuple[str, Moment]]:
    """What every frame shows: a title and a moment; fingers move before the step they are needed in.

    radius: of the object [m], around which they move.
    """
    normals = joined([step.grasp for step in plan.steps])
    lift, far = 2 * _LIFT * radius, (1 + 2 * _LIFT) * radius
    idle: dict[int, Array] = {}
    frames: list[tuple[str, Moment]] = []
    elapsed = 0.0
    for k, step in enumerate(plan.steps):
        for move in (m for m in plan.moves if m.step == k):
            ends = [
                move.origin - lift * normals[move.origin_name],
                move.target - lift * normals[move.target_name],
            ]
            count = max(2, ceil(move_time * rate)) if move_time else 0
            title = f"{short(_rounded(elapsed, plan))} {units.time}: a finger moves"
            frames += [
                (title, _moving(plan, k, idle, move, _way(ends[0], ends[1], far, u)))
                for u in np.linspace(0, 1, count).tolist()
            ]
            idle.pop(move.finger, None)
        what = step.kind if step.contact is None else f"{step.kind} of {step.contact}"
        what += f" for {step.arrival}" if step.arrival else ""
        for t in np.linspace(0, step.duration, max(2, ceil(step.duration * rate) + 1)).tolist():
            title = f"{short(_rounded(elapsed + t, plan))} {units.time}: {what}".replace("$", r"\$")
            frames.append((title, moment_of(plan, k, t, idle)))
        elapsed += step.duration
        for number_, name in enumerate(plan.fingers[k]):
            if name is not None and name in step.idle_at_end:
                idle[number_] = step.grasp[name].position - lift * normals[name]
    return frames


def _rounded(t: float, plan: RegraspPlan) -> float:
    """A time to show, to a thousandth of the plan's."""
    step = 10.0 ** floor(log10(plan.duration) - 2)
    return float(f"{round(t / step) * step:.6g}")


def _moving(plan: RegraspPlan, k: int, idle: dict[int, Array], move: FingerMove, at: Array) -> Moment:
    """The start of a step, with the arriving finger still in the air."""
    moment = moment_of(plan, k, 0.0, {n: r for n, r in idle.items() if n != move.finger})
    others = tuple(f for f in moment.fingers if f.number != move.finger)
    here = next(f for f in moment.fingers if f.number == move.finger)
    c, s = np.cos(moment.angle), np.sin(moment.angle)
    flying = type(here)(here.number, here.name, np.array([[c, -s], [s, c]]) @ at, None, 0.0, np.zeros(2))
    return Moment(moment.angle, moment.load, (*others, flying))


def _way(origin: Array, target: Array, far: float, u: float) -> Array:
    """Away from the centre of mass to a distance ``far`` [m], around it the shorter way, and back."""
    a, b = np.arctan2(origin[1], origin[0]), np.arctan2(target[1], target[0])
    turn = (b - a + pi) % (2 * pi) - pi
    rise, around, fall = (float(np.clip((u - start) / (1 / 3), 0, 1)) for start in (0, 1 / 3, 2 / 3))
    radii = float(np.hypot(*origin)), float(np.hypot(*target))
    start_or_end, share = (radii[1], 1 - fall) if fall else (radii[0], rise)
    radius = start_or_end + share * max(0.0, far - start_or_end)
    angle = a + around * turn
    return np.asarray(radius * np.array([np.cos(angle), np.sin(angle)]))


def _film(
    stage: Stage,
    frames: Sequence[tuple[str, Moment]],
    rate: float,
    units: Units,
) -> FuncAnimation:
    figure = new_figure(height=3.6)
    figure.set_layout_engine("none")
    ax = tidy(figure.add_axes((0.16, 0.12, 0.8, 0.8)))

    def show(k: int) -> list[Any]:
        title, moment = frames[k]
        ax.clear()
        stage.draw(ax, moment)
        ax.set_title(title, fontsize=TEXT, loc="left")
        ax.tick_params(labelsize=SMALL)
        label_axis(ax.xaxis, "$x$ in the world", units.length, stage.size)
        label_axis(ax.yaxis, "$y$", units.length, stage.size)
        return []

    return FuncAnimation(figure, show, frames=len(frames), interval=1000 / rate, cache_frame_data=False)
