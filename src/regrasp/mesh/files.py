"""Meshes from files, by trimesh, and as STL without it."""

from pathlib import Path
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mesh.arrays import Indices, checked_vertices, merged
from regrasp.mesh.shading import face_normals

_KINDS = (".stl", ".obj", ".ply")
# Vertices nearer than this, as a fraction of the largest side, are one: single precision keeps 6e-8.
_SAME = 1e-6


def read(path: Path) -> tuple[Array, Indices]:
    """Vertices and faces of an STL, OBJ or PLY file, in the file's units; see ``Mesh.from_file``."""
    kind = path.suffix.lower()
    if not path.is_file():
        raise InvalidInput("expected a file with a mesh, found none")
    if kind not in _KINDS:
        raise InvalidInput(f"the kind of file must be one of {', '.join(_KINDS)}; got {kind or 'none'!r}")
    if path.stat().st_size == 0:
        raise InvalidInput("the file is empty")
    pieces = [piece for piece in _pieces(path, kind[1:]) if len(piece[1])]
    if not pieces:
        raise InvalidInput("the file has no faces: a mesh is made of triangles")
    counts = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    vertices = checked_vertices(np.concatenate([vertices for vertices, _ in pieces]))
    faces = np.concatenate([faces + before for (_, faces), before in zip(pieces, counts[:-1], strict=True)])
    return merged(vertices, faces, _SAME * float(np.ptp(vertices, axis=0).max()))


def _pieces(path: Path, kind: str) -> list[tuple[Array, Indices]]:
    """Every geometry in a file, in its place: an OBJ may part one body by groups or materials."""
    try:
        import trimesh
    except ImportError:
        raise ImportError(f"reading {kind.upper()} needs trimesh: pip install 'regrasp[meshes]'") from None
    options: dict[str, Any] = {"skip_materials": True} if kind == "obj" else {}
    try:
        scene = trimesh.load_scene(path, file_type=kind, process=False, **options)
        dumped = [piece for piece in scene.dump() if isinstance(piece, trimesh.Trimesh)]
        return [(np.array(p.vertices, dtype=float), np.array(p.faces, dtype=np.int64)) for p in dumped]
    except Exception as error:  # the parsers raise whatever their numbers and strings raise
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InvalidInput(f"the file cannot be read as {kind.upper()}: {reason}") from None


def stl(vertices: Array, faces: Indices) -> bytes:
    """A binary STL: 80 bytes of title, a count; for each face its normal, corners and two bytes unused."""
    layout = [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")]
    rows = np.zeros(len(faces), dtype=layout)
    rows["corners"] = vertices[faces]
    rows["normal"] = -face_normals(vertices[faces])
    return b"regrasp".ljust(80) + np.array(len(faces), "<u4").tobytes() + rows.tobytes()
