"""Warnings where a mesh or a place on it may not be what was meant."""

from pathlib import Path
from warnings import warn

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.value import numbers
from regrasp.mesh.closest import at, touching

_LARGE = 10.0  # a side in a unit that nobody gave
_OFF = 0.03  # of the largest side


def warn_of_unit(file: Path, size: Array) -> None:
    """Where a mesh is so large that its unit is hardly the metre."""
    if size.max() > _LARGE:
        warn(
            f"{file}: the largest side is {size.max():.6g}, and the file does not say its unit: give "
            "scale=1e-3 to have millimetres in metres, scale=1 to keep the file's unit",
            stacklevel=4,
        )


def warn_of_distance(point: Array, away: float, size: Array) -> None:
    """Where a contact is so far from the point asked for that the point may be in another unit."""
    if away > _OFF * size.max():
        warn(
            f"the contact is {away:.3g} away from the point {numbers(point)}, on an object of size "
            f"{numbers(size)}; if they are in different units, read the mesh with scale=",
            stacklevel=4,
        )


def warn_of_walls(point: Array, away: float, opposed: Array) -> None:
    """Where some of the faces (k, 3, 3) ``opposed`` to the one chosen are not twice as far."""
    if not len(opposed):
        return
    _, faces, weights = touching(point[None], opposed, 1e-9 * away)
    far = float(np.linalg.norm(at(opposed[faces], weights)[0] - point))
    if far < 2 * away:
        warn(
            f"the point {numbers(point)} is {away:.3g} from the wall that the contact is put on and "
            f"{far:.3g} from one that faces the other way; say which with along= or outside=True",
            stacklevel=4,
        )


def warn_of_cavities(file: Path, notes: list[str]) -> None:
    """Where reading a mesh has filled what was hollow."""
    for note in notes:
        if note.startswith("filled: "):
            warn(f"{file}: {note}", stacklevel=4)
