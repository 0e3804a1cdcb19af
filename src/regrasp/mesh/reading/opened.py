"""A mesh from a file: read, mended, scaled; what is wrong or doubtful names the file."""

from collections.abc import Callable
from os import PathLike
from typing import Any, Protocol, TypeVar

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, choice, file_path, number
from regrasp.mesh.doubts import warn_of_cavities, warn_of_unit
from regrasp.mesh.reading.files import advice, read
from regrasp.mesh.reading.mending import BODIES
from regrasp.outline.opening import naming


class _Extended(Protocol):
    @property
    def size(self) -> Array: ...


Body = TypeVar("Body", bound=_Extended)


def opened(
    make: Callable[..., Body],
    path: str | PathLike[str],
    scale: Any,
    bodies: Any,
    close_holes: Any,
) -> tuple[Body, tuple[str, ...]]:
    """The mesh that ``make`` makes of vertices and faces, and notes; arguments as of ``Mesh.from_file``."""
    factor = 1.0 if scale is None else number(scale, "scale", above=0)
    how, widest = choice(bodies, "bodies", BODIES), number(close_holes, "close_holes", least=0)
    file = file_path(path)
    with naming(file):
        vertices, faces, notes = read(file, how, widest)
        try:
            mesh = make(factor * vertices, faces)
        except InvalidInput as error:
            raise InvalidInput(f"{error}{advice(faces, error)}") from None
    warn_of_cavities(file, notes)
    if scale is None:
        warn_of_unit(file, mesh.size)
    return mesh, tuple(notes)
