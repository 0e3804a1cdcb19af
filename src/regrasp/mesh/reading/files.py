"""Meshes from files, by trimesh, and as STL without it."""

import io
import warnings
from os import PathLike
from pathlib import Path

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, file_path
from regrasp.mesh.arrays import Indices, checked_vertices, merged
from regrasp.mesh.reading.encodings import check_count, prepared
from regrasp.mesh.reading.mending import Mended, one_of, parted, without_holes, without_slivers
from regrasp.mesh.shading import face_normals
from regrasp.outline.opening import quiet, read_bytes, reason
from regrasp.outline.region import checked_size

_KINDS = (".stl", ".obj", ".ply")
_MOST = 64_000_000  # bytes
# Vertices nearer than this, as a fraction of the largest side, are one: single precision keeps 6e-8.
_SAME = 1e-6


def read(path: Path, bodies: str = "one", close_holes: float = 0.0) -> Mended:
    """Vertices, faces and words on what was mended, in the file's units; see ``Mesh.from_file``."""
    kind = path.suffix.lower()
    if kind not in _KINDS and path.is_file():
        raise InvalidInput(
            f"the kind of file must be one of {', '.join(_KINDS)}; got {shown(kind or 'none')}"
        )
    data = read_bytes(path, "a mesh", _MOST)
    if not data:
        raise InvalidInput("the file is empty")
    found, notes = _pieces(data, kind[1:])
    pieces = [piece for piece in found if len(piece[1])]
    if not pieces:
        raise InvalidInput("the file has no faces: a mesh is made of triangles")
    check_count(sum(len(faces) for _, faces in pieces))
    counts = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    vertices = checked_vertices(np.concatenate([vertices for vertices, _ in pieces]))
    faces = np.concatenate([faces + before for (_, faces), before in zip(pieces, counts[:-1], strict=True)])
    vertices, faces, words = _mended(vertices, faces, bodies, close_holes)
    return vertices, faces, notes + words


def _mended(vertices: Array, faces: Indices, bodies: str, close_holes: float) -> Mended:
    size = checked_size(vertices, "the mesh")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise InvalidInput(f"a face names a vertex that is not there; there are {len(vertices)}")
    vertices, faces = merged(vertices, faces, _SAME * size)
    if not faces.size:
        raise InvalidInput("the mesh is empty: every face has two corners in one place")
    vertices, faces, notes = without_slivers(vertices, faces, _SAME * size)
    if close_holes:
        vertices, faces, words = without_holes(vertices, faces, close_holes * size)
        notes += words
    vertices, faces, words = one_of(vertices, faces, bodies)
    return vertices, faces, notes + words


def advice(faces: Indices, error: InvalidInput) -> str:
    """What ``Mesh.from_file`` can do about a mesh that was refused."""
    if "not watertight" in str(error):
        return "; close_holes=0.05 closes holes up to a twentieth of its size"
    if len(parted(faces)) > 1:
        return '; bodies="largest" takes the largest, bodies="fuse" unites them'
    return ""


def _pieces(data: bytes, kind: str) -> tuple[list[tuple[Array, Indices]], list[str]]:
    """Every geometry in a file, in its place, and what was mended in its text.

    An OBJ may part one body by groups or materials.
    """
    try:
        import trimesh
    except ImportError:
        raise ImportError(f"reading {kind.upper()} needs trimesh: pip install 'regrasp[meshes]'") from None
    clean, notes = prepared(data, kind)
    stream = io.BytesIO(clean)
    try:
        with quiet("trimesh"), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # text that stops being numbers is an error
            warnings.filterwarnings("error", message="string or file could not be read")
            scene = trimesh.load_scene(stream, file_type=kind, process=False)
            dumped = [piece for piece in scene.dump() if isinstance(piece, trimesh.Trimesh)]
        pieces = [(np.array(p.vertices, dtype=float), np.array(p.faces, dtype=np.int64)) for p in dumped]
    except Exception as error:  # the parsers raise whatever their numbers and strings raise
        words = reason(error)
        if "string or file could not be read" in words:
            words = "it has text where numbers are expected (with decimal commas?)"
        raise InvalidInput(f"the file cannot be read as {kind.upper()}: {words}") from None
    return pieces, notes


def stl(vertices: Array, faces: Indices) -> bytes:
    """A binary STL: 80 bytes of title, a count; for each face its normal, corners and two bytes unused."""
    layout = [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")]
    rows = np.zeros(len(faces), dtype=layout)
    rows["corners"] = vertices[faces]
    rows["normal"] = -face_normals(vertices[faces])
    return b"regrasp".ljust(80) + np.array(len(faces), "<u4").tobytes() + rows.tobytes()


def write_stl(vertices: Array, faces: Indices, path: str | PathLike[str]) -> None:
    """Write ``stl`` to a file."""
    file = file_path(path)
    try:
        file.write_bytes(stl(vertices, faces))
    except OSError as error:
        raise InvalidInput(f"{file}: cannot be written: {error.strerror or error}") from None
