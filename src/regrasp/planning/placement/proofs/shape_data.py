"""Outlines and meshes to and from plain data."""

from collections.abc import Mapping
from typing import Any

from regrasp.mechanics.plain import entries
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline


def shape_data(shape: Outline | Mesh) -> dict[str, Any]:
    """As JSON can hold it."""
    if isinstance(shape, Outline):
        return shape.to_dict()
    return {"vertices": shape.vertices.tolist(), "faces": shape.faces.tolist()}


def shape_of(data: Any) -> Outline | Mesh:
    """The equal shape. Raises ``InvalidInput`` for what is none."""
    if not isinstance(data, Mapping) or "faces" not in data:
        return Outline.from_dict(data)
    given = entries(data, "a mesh", ("vertices", "faces"))
    return Mesh(given["vertices"], given["faces"])
