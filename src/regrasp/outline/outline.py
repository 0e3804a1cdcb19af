"""The outline of a planar object as a value."""

from collections.abc import Iterable
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, number, point, read_only
from regrasp.mechanics.contact import Contact
from regrasp.outline.boundary import Boundary, PolygonBoundary
from regrasp.outline.curve import CurveBoundary
from regrasp.outline.region import checked_polygon, refuse_crossing

# Chords of a smooth outline stay this near to it, as a fraction of its length, where a polygon stands for it.
_FLATNESS = 1e-4


class Outline:
    """The boundary of a planar object of uniform density: a polygon; smooth curves by ``Outline.smooth``.

    vertices: (k, 2) [m], in either direction, closed by itself. holes: polygons inside, which count for the
    centre of mass and not for contacts.
    Coordinates are taken as given; contacts are placed relative to the centre of mass, as everywhere.
    The arc length runs counter-clockwise from the first vertex.
    Raises ``InvalidInput`` for outlines that cross themselves, have no area, or have a hole outside.
    """

    def __init__(self, vertices: ArrayLike, holes: Iterable[ArrayLike] = ()) -> None:
        polygon = checked_polygon(vertices, "outline")
        self._set(PolygonBoundary(polygon), tuple(checked_polygon(hole, "hole") for hole in holes))

    @classmethod
    def smooth(cls, points: ArrayLike, holes: Iterable[ArrayLike] = ()) -> "Outline":
        """The periodic cubic spline through points (k, 2), three or more."""
        through = checked_polygon(points, "points of a smooth outline")
        return cls._of(CurveBoundary.spline(through), holes)

    @classmethod
    def ellipse(cls, a: float, b: float) -> "Outline":
        """The ellipse of half axes a along x and b along y [m]; a circle where they are equal."""
        return cls._of(CurveBoundary.ellipse(number(a, "a", above=0), number(b, "b", above=0)), ())

    @classmethod
    def from_file(cls, path: str | Path) -> "Outline":
        """The outline in an SVG, DXF or coordinate file (CSV, TXT, DAT); see ``regrasp.outline.readers``."""
        from regrasp.outline.readers import read_outline

        outer, holes = read_outline(Path(path))
        return cls(outer, holes)

    @classmethod
    def _of(cls, boundary: Boundary, holes: Iterable[ArrayLike]) -> "Outline":
        outline = cls.__new__(cls)
        outline._set(boundary, tuple(checked_polygon(hole, "hole") for hole in holes))
        return outline

    def _set(self, boundary: Boundary, holes: tuple[Array, ...]) -> None:
        self.boundary, self.holes = boundary, holes
        refuse_crossing(boundary.polygon(_FLATNESS * boundary.length), holes)

    # -- the object -------------------------------------------------------------------------------------

    @property
    def length(self) -> float:
        """Of the outer boundary [m]."""
        return self.boundary.length

    @cached_property
    def area(self) -> float:
        """Of the material, holes left out [m^2]."""
        return float(self._moments[0])

    @cached_property
    def centre_of_mass(self) -> Array:
        """(2,) [m], in the coordinates given; uniform density."""
        area, first = self._moments
        return read_only(first / area)

    @cached_property
    def _moments(self) -> tuple[float, Array]:
        area, first = self.boundary.moments
        for hole in self.holes:
            hole_area, hole_first = PolygonBoundary(hole).moments
            area, first = area - hole_area, first - hole_first
        return area, first

    def polygon(self, tolerance: float | None = None) -> Array:
        """(k, 2) a polygon for the outer boundary, relative to the centre of mass; exact if it is one [m].

        tolerance: how far a chord may be from a smooth boundary [m]; 1e-4 of its length if not given.
        """
        return self.boundary.polygon(_FLATNESS * self.length if tolerance is None else tolerance) - (
            self.centre_of_mass
        )

    # -- contacts ---------------------------------------------------------------------------------------

    def points(self, s: ArrayLike) -> Array:
        """(..., 2) points at arc lengths, relative to the centre of mass [m]."""
        result: Array = self.boundary.points(s) - self.centre_of_mass
        return result

    def normals(self, s: ArrayLike) -> Array:
        """(..., 2) unit normals into the object at arc lengths; at a corner that of the stretch after it."""
        t = self.boundary.tangents(s)
        return np.stack([-t[..., 1], t[..., 0]], axis=-1)

    def contact_at(
        self,
        arc_length: float,
        *,
        friction: float,
        max_force: float | None = None,
        name: str | None = None,
    ) -> Contact:
        """The contact at an arc length [m], modulo the length. ``InvalidInput`` at a corner."""
        s = number(arc_length, "arc_length") % self.length
        gap = self._distance_to_corners(np.array([s]))[0]
        if gap <= 1e-9 * self.length:
            raise InvalidInput(f"arc length {arc_length:.6g} is at a corner, where the normal is not defined")
        return Contact(self.points(s), self.normals(s), friction, max_force=max_force, name=name)

    def nearest(self, position: ArrayLike) -> float:
        """The arc length of the boundary point nearest to ``position`` (2,), in the coordinates given [m]."""
        where = point(position, "position")
        if where.size != 2:
            raise InvalidInput(f"position must have 2 numbers, got {where.size}")
        return self.boundary.nearest(where)

    def sample(self, count: int, *, clearance: float | None = None) -> Array:
        """(m,) arc lengths of ``count`` evenly spread candidates, those near a corner left out [m].

        clearance: least distance to a corner along the boundary [m]; a quarter of the spacing if not given.
        """
        if isinstance(count, bool) or not isinstance(count, int) or count < 3:
            raise InvalidInput(f"count must be a whole number of at least 3, got {count!r}")
        spacing = self.length / count
        keep = spacing / 4 if clearance is None else number(clearance, "clearance", least=0)
        s = (np.arange(count) + 0.5) * spacing
        return s[self._distance_to_corners(s) >= keep]

    def _distance_to_corners(self, s: Array) -> Array:
        """(m,) arc length to the nearest corner; infinite without corners."""
        corners = self.boundary.corners
        if not corners.size:
            return np.full(s.shape, np.inf)
        away = abs(s[:, None] - corners)
        result: Array = np.minimum(away, self.length - away).min(axis=1)
        return result

    def __repr__(self) -> str:
        kind = "polygon" if isinstance(self.boundary, PolygonBoundary) else "smooth"
        return f"Outline({kind}, length {self.length:.6g}, area {self.area:.6g}, {len(self.holes)} holes)"
