"""A chosen grasp on its mesh, and regions on its faces."""

from typing import Any

import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from regrasp.mechanics.grasp import Grasp
from regrasp.mesh.mesh import Mesh
from regrasp.planning.placement.chosen import ChosenGrasp
from regrasp.planning.placement.regions.face_patches import FaceRegions
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


def draw_regions(ax: Any, regions: FaceRegions) -> Any:
    """The polygon of each finger on its face."""
    ax, _ = draw_fingers(ax, regions.shape, regions.grasp, 0.6 * _CONE)
    colours = contact_colours(regions.grasp)
    for contact, patch in zip(regions.grasp, regions.patches, strict=True):
        colour = colours[contact.name or ""]
        face = Poly3DCollection([patch], facecolor=colour, edgecolor=colour, alpha=0.45, zorder=3)
        face.set_gid(f"region {contact.name}")
        ax.add_collection3d(face)
    return ax
