"""Arrows whose heads keep their shape, in the plane and in wrench space."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch
from mpl_toolkits.mplot3d.proj3d import proj_transform  # type: ignore[import-untyped]

from regrasp.mechanics.checks import ArrayLike

_LOOK: dict[str, Any] = {
    "arrowstyle": "-|>,head_length=0.5,head_width=0.2",
    "mutation_scale": 9,
    "shrinkA": 0,
    "shrinkB": 0,
    "joinstyle": "miter",
    "linewidth": 1.4,
}


def arrow(ax: Axes, tail: ArrayLike, head: ArrayLike, *, gid: str, **look: Any) -> FancyArrowPatch:
    """An arrow in the plane; ``gid`` says what it stands for and becomes the element's id in an SVG."""
    ends = np.array([tail, head], dtype=float)
    patch = FancyArrowPatch(tuple(ends[0]), tuple(ends[1]), gid=gid, **(_LOOK | look))
    ax.add_artist(patch)  # not as a patch: limits would then count the head, whose size is not in data units
    ax.update_datalim(ends)
    return patch


def arrow3d(ax: Any, tail: ArrayLike, head: ArrayLike, *, gid: str, **look: Any) -> "Arrow3D":
    """An arrow in wrench space."""
    patch = Arrow3D(np.array([tail, head], dtype=float), gid=gid, **(_LOOK | look))
    had_data = ax.has_data()
    ax.add_artist(patch)
    ax.auto_scale_xyz(*patch.ends.T, had_data)
    return patch


class Arrow3D(FancyArrowPatch):
    """An arrow whose ends are projected, and whose head is drawn in the picture."""

    def __init__(self, ends: np.ndarray[Any, Any], **look: Any) -> None:
        super().__init__((0, 0), (0, 0), **look)
        self.ends = ends
        self.set_in_layout(False)  # its place is not known before it is drawn

    def do_3d_projection(self) -> float:
        """Place the arrow in the picture; returns the depth by which matplotlib sorts artists."""
        x, y, z = proj_transform(*self.ends.T, self.axes.M)  # type: ignore[union-attr]
        self.set_positions((x[0], y[0]), (x[1], y[1]))
        return float(z.min())
