"""Meshes written as text, without the writer of regrasp."""

from pathlib import Path
from typing import Any

import numpy as np

import regrasp as rg

BOX = rg.Mesh.box(1, 2, 3)


def text(folder: Path, content: str | bytes, name: str) -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def obj(vertices, faces, head: str = "") -> str:
    lines = [head, *(f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices, dtype=float).tolist())]
    return "\n".join([*lines, *("f " + " ".join(map(str, face)) for face in np.asarray(faces) + 1)]) + "\n"


def facets(vertices: Any, faces: Any) -> str:
    """The facets of an ASCII STL."""
    lines = []
    for face in faces:
        corners = "".join(f"   vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in vertices[face])
        lines.append(f" facet normal 0 0 0\n  outer loop\n{corners}  endloop\n endfacet\n")
    return "".join(lines)
