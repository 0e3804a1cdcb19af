"""A run in physics as a film."""

from itertools import cycle
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter

from regrasp.disk.staging import whole_path
from regrasp.errors import InvalidInput, shown
from regrasp.execution.measured import Execution
from regrasp.mechanics.checks import Array, instance, number
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline
from regrasp.plots.look.solids import creases
from regrasp.plots.look.style import GREY, PALETTE, SMALL, WIDTH, label_axis, new_figure, tidy
from regrasp.plots.look.units import SI, Units

_DPI = 100
_MOST = 10_000  # frames; more are a slip of the pen


def animate_execution(
    execution: Execution, *, path: str | PathLike[str], frames_per_second: float = 20.0, units: Units = SI
) -> Path:
    """Write a film of a run in the world frame: the object as it moved, fingertips, measured forces.

    The shape is the setup's, or the hull of the contacts. In space the view is along z.

    Args:
        execution: the run to draw.
        path: ``.gif``, or ``.mp4``, which needs ffmpeg. It is returned.
        frames_per_second: of the run's own time, at least 0.01 [1/s].
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For another ending, for MP4 without ffmpeg, for over 10,000 frames and a path that
            cannot be written.
    """
    instance(execution, "execution", Execution)
    target = Path(path)
    if target.suffix.lower() not in (".gif", ".mp4"):
        raise InvalidInput(f"path must end in .gif or .mp4, got {shown(str(target))}")
    if target.suffix.lower() == ".mp4" and not FFMpegWriter.isAvailable():
        raise InvalidInput("MP4 needs the program ffmpeg, which is not found; write a .gif instead")
    rate = number(frames_per_second, "frames_per_second", least=0.01)
    if execution.times[-1] * rate > _MOST:
        raise InvalidInput(f"{rate:g} frames_per_second are more than the {_MOST} frames that are drawn")
    times = np.arange(0, execution.times[-1], 1 / rate)
    rows = np.unique(np.searchsorted(execution.times, times).clip(0, execution.times.size - 1))
    lines = [np.asarray(line) for line in _lines(execution)]
    size = max(float(np.linalg.norm(c.position)) for c in execution.contacts)
    longest = float(np.linalg.norm(execution.planned, axis=2).max())
    figure = new_figure(1.2 * WIDTH, 1.2 * WIDTH)
    ax = tidy(figure.add_subplot())
    ax.set(xlim=(-1.6 * size, 1.6 * size), ylim=(-1.6 * size, 1.6 * size), aspect="equal")
    label_axis(ax.xaxis, "$x$", units.length, 1.6 * size)
    label_axis(ax.yaxis, "$y$", units.length, 1.6 * size)
    title = ax.set_title(f"t = 0.00 {units.time}", fontsize=SMALL, loc="left")
    edges = [ax.plot([], [], color=GREY, linewidth=0.8)[0] for _ in lines]
    (tips,) = ax.plot([], [], "o", color=GREY, markersize=5, markerfacecolor="white")
    where, n = np.array([c.position for c in execution.contacts]), len(execution.contacts)
    colours = [colour for colour, _ in zip(cycle(PALETTE), range(n), strict=False)]
    look: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1, "width": 0.008, "zorder": 5}
    arrows = ax.quiver(*np.zeros((4, n)), color=colours, **look)
    figure.canvas.draw()
    figure.set_layout_engine("none")  # laid out once, not for every frame

    def draw(row: int) -> list[Any]:
        R, at = execution.rotations[row], execution.positions[row]
        for edge, line in zip(edges, lines, strict=True):
            edge.set_data(*(line @ R.T + at).T[:2])
        tips.set_data(*execution.tips[row].T[:2])
        arrows.set_offsets((where @ R.T + at)[:, :2])
        arrows.set_UVC(*(execution.forces[row] @ R.T * (0.6 * size / longest)).T[:2])
        title.set_text(f"t = {execution.times[row]:.2f} {units.time}")
        return []

    writer = (PillowWriter if target.suffix.lower() == ".gif" else FFMpegWriter)(fps=rate)  # type: ignore[arg-type]
    with whole_path(target) as part:
        film = FuncAnimation(figure, draw, frames=rows.tolist(), init_func=list, blit=False)
        film.save(part, writer=writer, dpi=_DPI)
    return target


def _lines(execution: Execution) -> list[Array]:
    """What is drawn of the object, in its own frame: closed rings in the plane, edges in space."""
    shape = execution.setup.shape
    if isinstance(shape, Outline):
        return [np.vstack([ring, ring[:1]]) for ring in (shape.polygon(), *shape.hole_polygons())]
    if isinstance(shape, Mesh):
        return list(creases(shape.surface()))
    points = np.array([c.position for c in execution.contacts])
    if points.shape[1] == 3:
        return [np.array([p, q]) for i, p in enumerate(points) for q in points[:i]]
    ring = points[np.argsort(np.arctan2(points[:, 1], points[:, 0]))]
    return [np.vstack([ring, ring[:1]])]
