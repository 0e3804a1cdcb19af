"""The surface of a solid object in space: where fingers can touch it, and where its weight acts."""

from regrasp.mesh.mesh import Mesh

__all__ = ["Mesh"]
