"""A plan as a film: GIF, HTML page or MP4."""

from collections.abc import Sequence
from dataclasses import replace
from math import ceil, floor, log10
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.figure import Figure
from PIL import Image

from regrasp.disk.staging import whole_path
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import number
from regrasp.motions.value import Motions
from regrasp.outline.outline import Outline
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition
from regrasp.plots.look.solids import triangles_of
from regrasp.plots.look.space_axes import space_panel
from regrasp.plots.look.style import SMALL, TEXT, label_axis, new_figure, short, tidy
from regrasp.plots.look.units import SI, Units
from regrasp.plots.look.view import shared_view
from regrasp.plots.pages.timeline import LIFT, timeline
from regrasp.plots.regrasps.moments import Moment, Stage, as_regrasp, moment_of
from regrasp.plots.regrasps.space_moments import SpaceStage, measures
from regrasp.plots.regrasps.ways import motion_moments

_DPI = 100
_MOST = 10_000  # frames; more are a slip of the pen


def animate(
    plan: RegraspPlan | Transition | Motions,
    outline: Outline | Any = None,
    *,
    path: str | PathLike[str],
    frames_per_second: float = 20.0,
    move_time: float = 0.6,
    units: Units = SI,
) -> Path:
    """Write a film of a plan in the world frame, in which gravity keeps its direction and the object turns.

    Forces are those of the fingers on the object, with their tails at the contacts. A dashed ring is a finger
    in the air; its way between two contact points is only suggested and takes ``move_time`` [s], which no
    plan says. Time runs as in the plan. Of ``Motions`` the ways and the clock are theirs.

    Args:
        plan: a ``RegraspPlan``, a ``Transition``, or the ``Motions`` of one.
        outline: in space the solid, as for ``plot_regrasp``. Without it the hull of all contacts stands for
            the object.
        path: ``.gif``, ``.html`` (with buttons; one file) or ``.mp4``, which needs ffmpeg. Returns it.
        frames_per_second: at least 0.01 [1/s].
        move_time: how long a finger is in the air [s].
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For another ending, for MP4 without ffmpeg, for over 10,000 frames and a path that
            cannot be written.
    """
    if not isinstance(plan, (RegraspPlan, Transition, Motions)):
        raise InvalidInput(f"plan must be a RegraspPlan, a Transition or Motions, got {shown(plan)}")
    target = Path(path)
    ending = target.suffix.lower()
    if ending not in (".gif", ".html", ".mp4"):
        raise InvalidInput(f"path must end in .gif, .html or .mp4, got {shown(str(target))}")
    if ending == ".mp4" and not FFMpegWriter.isAvailable():
        raise InvalidInput("MP4 needs the program ffmpeg, which is not found; write a .gif or .html instead")
    rate = number(frames_per_second, "frames_per_second", least=0.01)
    whole = as_regrasp(plan.plan if isinstance(plan, Motions) else plan)
    scene = (_SpaceScene if whole.steps[0].grasp.dimension == 3 else _Scene)(whole, outline, units)
    pause = number(move_time, "move_time", least=0)
    seconds = plan.duration if isinstance(plan, Motions) else whole.duration + len(whole.moves) * pause
    if seconds * rate > _MOST:
        raise InvalidInput(
            f"{seconds:g} s at {rate:g} frames_per_second are {seconds * rate:.3g} frames, of which at most "
            f"{_MOST} are drawn"
        )
    if isinstance(plan, Motions):
        frames = _in_motion(plan, rate, units)
    else:
        frames = moments(whole, rate, pause, scene.stage.radius, units)
    with whole_path(target) as part:
        film = _film(scene, frames, rate)
        if ending == ".html":
            part.write_text(film.to_jshtml(embed_frames=True), encoding="utf-8")
        else:
            writer = _GIF(fps=rate) if ending == ".gif" else FFMpegWriter(fps=rate)  # type: ignore[arg-type]
            film.save(part, writer=writer, dpi=_DPI)
    return target


def moments(
    plan: RegraspPlan, rate: float, move_time: float, radius: float, units: Units = SI
) -> list[tuple[str, Moment]]:
    """What every frame shows: a title and a moment; see ``timeline``."""
    frames = []
    for instant in timeline(plan, rate, move_time, radius):
        words = "a finger moves" if instant.moving else plan.steps[instant.step].in_words
        title = f"{short(_rounded(instant.time, plan))} {units.time}: {words}"
        frames.append((title.replace("$", r"\$"), instant.moment))
    return frames


def _in_motion(motions: Motions, rate: float, units: Units) -> list[tuple[str, Moment]]:
    """What every frame shows of motions, on their clock."""
    t = np.linspace(0, motions.duration, max(2, ceil(motions.duration * rate) + 1))
    shown, k = motion_moments(motions, t), motions.step_times(t)[0]
    moving = (np.linalg.norm(motions.velocities(t), axis=2) > 0).any(axis=1)
    clock = np.diff(motions.plan_time(t), append=np.inf) > 0
    titles = [
        f"{time:.2f} {units.time}: " + (motions.steps[step].in_words if runs else "fingers move")
        for time, step, runs in zip(t.tolist(), k.tolist(), clock | ~moving, strict=True)
    ]
    return [(title.replace("$", r"\$"), moment) for title, moment in zip(titles, shown, strict=True)]


def _rounded(t: float, plan: RegraspPlan) -> float:
    """A time to show, to a thousandth of the plan's."""
    step = 10.0 ** floor(log10(plan.duration) - 2)
    return float(f"{round(t / step) * step:.6g}")


class _Scene:
    """A planar object in axes with numbers."""

    def __init__(self, plan: RegraspPlan, outline: Any, units: Units) -> None:
        if outline is not None and not isinstance(outline, Outline):
            raise InvalidInput(f"a plan in the plane is drawn on an Outline, got {type(outline).__name__}")
        self.stage, self.units = Stage(plan.steps, outline), units

    def axes(self, figure: Figure) -> Any:
        """New axes for all moments."""
        return tidy(figure.add_axes((0.16, 0.12, 0.8, 0.8)))

    def show(self, ax: Any, moment: Moment) -> None:
        """Draw a moment on axes that were cleared."""
        self.stage.draw(ax, moment)
        self.stage.scale_key(ax, self.units)
        ax.tick_params(labelsize=SMALL)
        label_axis(ax.xaxis, "$x$ in the world", self.units.length, self.stage.size)
        label_axis(ax.yaxis, "$y$", self.units.length, self.stage.size)


class _SpaceScene:
    """A solid object seen from one direction, with the world's axes and a bar of a round length."""

    def __init__(self, plan: RegraspPlan, mesh: Any, units: Units) -> None:
        self.stage, self.units = SpaceStage(plan.steps, triangles_of(mesh)), units
        shown = [
            moment_of(plan, k, t)
            for k, step in enumerate(plan.steps)
            for t in np.linspace(0, step.duration, 5).tolist()
        ]
        window = self.stage.window(shown, shared_view([moment.touching for moment in shown]))
        # room for fingers in the air
        self.window = replace(window, side=max(window.side, (1 + 2 * LIFT) * self.stage.radius))

    def axes(self, figure: Figure) -> Any:
        """New axes for all moments."""
        return space_panel(figure, (0.03, 0.0, 0.94, 0.94))

    def show(self, ax: Any, moment: Moment) -> None:
        """Draw a moment on axes that were cleared."""
        self.window.show(ax)
        self.stage.draw(ax, moment)
        measures(ax, self.stage, self.window, self.units)


class _Film(FuncAnimation):
    """An animation whose frames are drawn where they are written, not before, too."""

    def _post_draw(self, framedata: Any, blit: bool) -> None:
        """Nothing: no window waits for the frame."""


class _GIF(PillowWriter):
    """A writer that draws a frame once; ``savefig`` draws twice, for layouts that films do without."""

    _frames: list[Image.Image]

    def grab_frame(self, **_: Any) -> None:
        """Draw the figure as it is, and keep the picture."""
        canvas: Any = self.fig.canvas
        canvas.draw()
        self._frames.append(Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3]))


def _film(scene: _Scene | _SpaceScene, frames: Sequence[tuple[str, Moment]], rate: float) -> FuncAnimation:
    figure = new_figure(height=3.6)
    figure.set_dpi(_DPI)
    figure.set_layout_engine("none")
    ax = scene.axes(figure)

    def show(k: int) -> list[Any]:
        title, moment = frames[k]
        ax.clear()
        scene.show(ax, moment)
        ax.set_title(title, fontsize=TEXT, loc="left")
        return []

    return _Film(figure, show, frames=len(frames), interval=1000 / rate, cache_frame_data=False)
