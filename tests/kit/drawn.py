"""Artists of a picture, found by what they are of."""

from typing import Any

import numpy as np

PNG = b"\x89PNG\r\n\x1a\n"
"""What a file of this format begins with."""


def by_gid(ax: Any, gid: str, kind: type = object) -> list[Any]:
    """Artists of a group and a class."""
    return [artist for artist in ax.get_children() if artist.get_gid() == gid and isinstance(artist, kind)]


def one(ax: Any, gid: str, kind: type = object) -> Any:
    """The only artist of a group and a class."""
    (artist,) = by_gid(ax, gid, kind)
    return artist


def lines_by_label(ax: Any) -> dict[str, Any]:
    return {line.get_label(): line for line in ax.get_lines()}


def ends(arrow: Any) -> np.ndarray:
    """(2, 2) tail and head of an arrow."""
    return np.array(arrow._posA_posB)


def points_of(line: Any) -> np.ndarray:
    """(m, 3) points of a line in space."""
    return np.transpose(line.get_data_3d())


def corners(collection: Any) -> np.ndarray:
    """(m, 3) corners of a collection of polygons in space, as they were given."""
    return np.vstack(collection._faces)
