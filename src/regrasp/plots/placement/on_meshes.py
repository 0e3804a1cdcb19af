"""A chosen grasp on its mesh."""

from typing import Any

import numpy as np

from regrasp.mechanics.grasp import Grasp
from regrasp.mesh.mesh import Mesh
from regrasp.planning.placement.chosen import ChosenGrasp
from regrasp.plots.grasps.body import extent
from regrasp.plots.grasps.space_body import dot, draw_body_in_space
from regrasp.plots.look.solids import Triangles
from regrasp.plots.look.space_axes import space_axes
from regrasp.plots.look.style import GREY, contact_colours
from regrasp.plots.look.view import facing_view

_CONE = 0.18  # sides of cones, as a fraction of the object's extent


def draw_fingers(ax: Any, mesh: Mesh, grasp: Grasp, cone: float = _CONE) -> tuple[Any, Triangles]:
    """Mesh, fingers with cones and centre of mass; new axes look from where the fingers are best seen."""
    new, ax = ax is None, space_axes(ax, height=3.8)
    if new:
        ax.set_position((0.07, 0.03, 0.88, 0.82))
        ax.view_init(*facing_view(grasp.positions, grasp.normals))
    triangles = mesh.surface()
    size = extent(grasp, triangles[0])
    draw_body_in_space(ax, grasp, contact_colours(grasp), cone * size, size, mesh=triangles)
    return ax, triangles


def draw_chosen(ax: Any, chosen: ChosenGrasp, mesh: Mesh) -> Any:
    """Fingers on the mesh, and those of grasps that were passed over as open circles."""
    ax, _ = draw_fingers(ax, mesh, chosen.grasp)
    for at in np.concatenate([other.grasp.positions for other in chosen.others] or [np.zeros((0, 3))]):
        dot(ax, at, gid="other", color="white", markeredgecolor=GREY, markersize=3.5, zorder=3)
    return ax
