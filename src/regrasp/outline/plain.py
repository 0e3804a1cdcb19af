"""Outlines to and from plain data, in the words of scenario files."""

from collections.abc import Iterable, Mapping
from typing import Any

from regrasp.errors import InvalidInput
from regrasp.mechanics.plain import entries, listed
from regrasp.outline.boundary import Boundary
from regrasp.outline.curves import EllipseBoundary, SplineBoundary
from regrasp.outline.polygon import PolygonBoundary

SHAPES = ("vertices", "points", "ellipse")
"""Of a polygon; of a smooth curve through them; half axes of an ellipse, about its ``centre``."""


def boundary_data(boundary: Boundary) -> dict[str, Any]:
    """One closed curve as a dictionary."""
    if isinstance(boundary, PolygonBoundary):
        return {"vertices": boundary.vertices.tolist()}
    if isinstance(boundary, SplineBoundary):
        return {"points": boundary.through.tolist()}
    if isinstance(boundary, EllipseBoundary):
        return {"ellipse": boundary.axes.tolist(), "centre": boundary.centre.tolist()}
    raise InvalidInput(f"a boundary of type {type(boundary).__name__} has no plain data")


def outline_data(boundary: Boundary, holes: Iterable[Boundary]) -> dict[str, Any]:
    """An outline as a dictionary."""
    return boundary_data(boundary) | {"holes": [boundary_data(hole) for hole in holes]}


def shape_of(data: Any, what: str = "an outline") -> tuple[str, dict[str, Any]]:
    """Which of ``SHAPES`` a dictionary gives, and its entries, ``holes`` and ``centre`` among them."""
    given = entries(data, what, (), (*SHAPES, "centre", "holes"))
    shapes = [shape for shape in SHAPES if shape in given]
    if len(shapes) != 1:
        found = ", ".join(shapes) or "none of them"
        raise InvalidInput(f"{what} must have exactly one of {', '.join(SHAPES)}, found {found}")
    if "centre" in given and shapes[0] != "ellipse":
        raise InvalidInput(f"{what}: centre goes with ellipse, found {shapes[0]}")
    return shapes[0], given


def holes_of(given: dict[str, Any]) -> list[Any]:
    """The holes among the entries of an outline, each without holes of its own."""
    holes = listed(given.get("holes", []), "holes of an outline")
    for i, hole in enumerate(holes):
        if isinstance(hole, Mapping) and hole.get("holes"):
            raise InvalidInput(f"hole {i} has holes itself; what is inside a hole is another object")
    return holes
