"""The outline of a planar object as a value."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike
from typing import Any, Union

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import (
    Array,
    ArrayLike,
    array,
    choice,
    file_path,
    finite,
    items,
    number,
    read_only,
    whole,
)
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.value import ArrayValue
from regrasp.outline.boundary import Boundary
from regrasp.outline.curve import CurveBoundary
from regrasp.outline.curves import EllipseBoundary, SplineBoundary
from regrasp.outline.plain import holes_of, outline_data, shape_of
from regrasp.outline.polygon import PolygonBoundary
from regrasp.outline.region import check_holes, check_spread, checked_ring, checked_size

# Chords of a smooth outline stay this near to it, as a fraction of its length, where a polygon stands for it.
_FLATNESS = 1e-4
_AT_CORNER = 1e-9
MOST_SAMPLED = 10_000_000
"""Points of a boundary."""

Hole = Union[ArrayLike, "Outline"]


@dataclass(frozen=True, eq=False, repr=False)
class Outline(ArrayValue):
    """The boundary of a planar object of uniform density: a polygon; ``smooth`` and ``ellipse`` make curves.

    Coordinates are taken as given; contacts are placed relative to the centre of mass, as everywhere. The
    arc length runs counter-clockwise from the first vertex. A vertex is a corner, where no finger can touch,
    if the boundary turns there by more than 5 degrees; a shallower one, as on a curve made of chords, takes
    the normal of the side after it.

    Args:
        vertices: (k, 2) [m], in either direction, closed by itself.
        holes: vertices, or outlines without holes; they count for the centre of mass and not for contacts.

    Raises:
        InvalidInput: For an outline that crosses or touches itself or has no area, and for a hole that is not
            strictly inside or meets another.
    """

    boundary: Boundary
    holes: tuple[Boundary, ...]
    notes: tuple[str, ...] = field(default=(), compare=False)
    """What reading the file has left out or mended, in words."""

    def __init__(self, vertices: ArrayLike, holes: Iterable[Hole] = ()) -> None:
        self._set(PolygonBoundary(checked_ring(vertices, "outline")), holes)

    @classmethod
    def smooth(cls, points: ArrayLike, holes: Iterable[Hole] = ()) -> "Outline":
        """The periodic cubic spline through points (k, 2) [m], three or more.

        Args:
            points: (k, 2) in order along the boundary, either way round [m].
            holes: vertices (k, 2) of each hole, or outlines without holes, as of ``Outline`` [m].
        """
        through = checked_ring(points, "outline")
        check_spread(through, "outline")
        boundary = SplineBoundary(through)
        if boundary.moments[0] < 0:  # few points can turn against the curve through them
            boundary = SplineBoundary(read_only(np.roll(through[::-1], 1, axis=0)))
        return cls._of(boundary, holes)

    @classmethod
    def ellipse(
        cls, a: float, b: float, *, centre: ArrayLike = (0.0, 0.0), holes: Iterable[Hole] = ()
    ) -> "Outline":
        """The ellipse of half axes a along x and b along y [m]; a circle where they are equal.

        Args:
            a: half axis along x [m].
            b: half axis along y [m].
            centre: (2,) [m].
            holes: points (k, 2) of each hole, as of ``smooth`` [m].
        """
        axes = np.array([number(a, "a", above=0), number(b, "b", above=0)])
        checked_size(np.array([-axes, axes]), "outline")
        return cls._of(EllipseBoundary(read_only(axes), array(centre, "centre", (2,))), holes)

    @classmethod
    def from_file(
        cls,
        path: str | PathLike[str],
        *,
        scale: float = 1.0,
        tolerance: float | None = None,
        layers: str | Iterable[str] | None = None,
        unit: str | None = None,
    ) -> "Outline":
        """The polygon in an SVG, DXF or coordinate file (CSV, TXT, DAT), in the file's units times ``scale``.

        Of several closed curves the largest is the outline and those inside it are holes. Curves become
        chords within ``tolerance`` of them [file's units], which turn by 2 degrees at most; ends of pieces
        that near are joined. It is 1e-4 of the drawing's larger side if not given. SVG's y axis, which points
        down, is turned up.

        Args:
            path: a file that ends in .svg, .dxf, .csv, .txt or .dat.
            scale: factor on its coordinates [-].
            tolerance: of chords and of ends that are joined [file's units].
            layers: read these layers only, of a DXF, or groups of an SVG by ``id`` or label, hidden ones too.
                Without it what is hidden is left out, and what is a centre line or a dimension by its name.
            unit: convert from the unit that the file states to this one: mm, cm, m, in and others. ``notes``
                of the result say what was left out, closed or recovered, and the file's unit; a file that had
                to be recovered gives a warning too. DXF needs the extra ``regrasp[outlines]``.

        Raises:
            InvalidInput: For a file that cannot be read and for an outline that is open, crosses itself, is
                empty or one of several.
            ImportError: Without the extra.
        """
        from regrasp.outline.drawing import UNITS, checked_layers
        from regrasp.outline.opening import naming
        from regrasp.outline.readers import read_rings

        factor = number(scale, "scale", above=0)
        within = None if tolerance is None else number(tolerance, "tolerance", above=0)
        names = checked_layers(layers)
        wanted = None if unit is None else choice(unit, "unit", tuple(UNITS))
        file = file_path(path)
        with naming(file):
            found = read_rings(file, within, names, wanted)
            outer, *holes = (factor * ring for ring in found.rings)
            outline = cls(outer, holes)
        object.__setattr__(outline, "notes", found.notes)
        return outline

    @classmethod
    def _of(cls, boundary: Boundary, holes: Iterable[Hole]) -> "Outline":
        outline = cls.__new__(cls)
        outline._set(boundary, holes)
        return outline

    def _set(self, boundary: Boundary, holes: Iterable[Hole]) -> None:
        inner = tuple(_hole(hole, f"hole {i}") for i, hole in enumerate(items(holes, "holes")))
        check_holes(_chords(boundary), [_chords(hole) for hole in inner])
        object.__setattr__(self, "boundary", boundary)
        object.__setattr__(self, "holes", inner)
        object.__setattr__(self, "notes", ())

    def to_dict(self) -> dict[str, Any]:
        """The outline as plain data, which JSON can hold; ``from_dict`` gives back the equal outline.

        ``vertices`` of a polygon, ``points`` of a smooth curve, or half axes ``ellipse`` about a ``centre``;
        ``holes`` is a list of such dictionaries.
        """
        return outline_data(self.boundary, self.holes)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Outline":
        """The outline of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``Outline`` does.
        """
        shape, given = shape_of(data)
        holes = [cls.from_dict(hole) for hole in holes_of(given)]
        if shape == "vertices":
            return cls(given["vertices"], holes)
        if shape == "points":
            return cls.smooth(given["points"], holes)
        a, b = array(given["ellipse"], "ellipse", (2,)).tolist()
        return cls.ellipse(a, b, centre=given.get("centre", (0.0, 0.0)), holes=holes)

    # -- the object -------------------------------------------------------------------------------------

    @property
    def length(self) -> float:
        """Of the outer boundary [m]."""
        return self.boundary.length

    @cached_property
    def area(self) -> float:
        """Of the material, holes left out [m^2]."""
        return self.boundary.moments[0] - sum(hole.moments[0] for hole in self.holes)

    @cached_property
    def centre_of_mass(self) -> Array:
        """(2,) [m], in the coordinates given; uniform density."""
        _, centroid = self.boundary.moments
        shift = np.zeros(2)
        for area, at in (hole.moments for hole in self.holes):
            shift += area * (centroid - at)
        return read_only(centroid + shift / self.area)

    @cached_property
    def inertia(self) -> float:
        """About the centre of mass for a density of 1 [m^4]: times mass / area in kg m^2."""

        def part(region: Boundary) -> float:  # the parallel axis theorem
            area, centroid = region.moments
            return region.second_moment + area * float(((centroid - self.centre_of_mass) ** 2).sum())

        return part(self.boundary) - sum(part(hole) for hole in self.holes)

    def polygon(self, tolerance: float | None = None) -> Array:
        """(k, 2) a polygon for the outer boundary, relative to the centre of mass; exact if it is one [m].

        Args:
            tolerance: how far a chord may be from a smooth boundary [m]; 1e-4 of its length if not given.
        """
        return _chords(self.boundary, tolerance) - self.centre_of_mass

    def cubics(self) -> Array | None:
        """(k, 4, 2) control points of the cubic Bezier pieces of a smooth outer boundary; None of a polygon.

        Relative to the centre of mass [m], one piece after the other, counter-clockwise. A spline is its
        pieces to rounding; an ellipse is in 160, off it by less than 1e-13 of its larger half axis.
        """
        if isinstance(self.boundary, CurveBoundary):
            return read_only(self.boundary.cubics()[1] - self.centre_of_mass)
        return None

    def hole_polygons(self, tolerance: float | None = None) -> tuple[Array, ...]:
        """The same for every hole.

        Args:
            tolerance: largest distance of a chord from its curve [m], as of ``polygon``.
        """
        return tuple(_chords(hole, tolerance) - self.centre_of_mass for hole in self.holes)

    # -- contacts ---------------------------------------------------------------------------------------

    def points(self, s: ArrayLike) -> Array:
        """(..., 2) points at arc lengths, relative to the centre of mass [m].

        Args:
            s: (...) arc lengths [m], modulo the length.
        """
        result: Array = self.boundary.points(_finite(s)) - self.centre_of_mass
        return result

    def normals(self, s: ArrayLike) -> Array:
        """(..., 2) unit normals into the object at arc lengths; at a corner that of the stretch after it.

        Args:
            s: (...) arc lengths [m], modulo the length.
        """
        t = self.boundary.tangents(_finite(s))
        return np.stack([-t[..., 1], t[..., 0]], axis=-1) + 0.0  # no -0

    def contact_at(
        self,
        arc_length: float,
        *,
        friction: float,
        max_force: float | None = None,
        name: str | None = None,
    ) -> Contact:
        """The contact at an arc length [m], modulo the length. ``InvalidInput`` at a corner.

        Args:
            arc_length: from the first vertex, counter-clockwise, modulo the length [m].
            friction: Coulomb coefficient [-].
            max_force: largest force magnitude of the finger [N]; no limit if not given.
            name: how to address the contact.
        """
        s = number(arc_length, "arc_length") % self.length
        if self._to_corners(np.array([s]))[0] <= _AT_CORNER * self.length:
            raise InvalidInput(f"arc length {s:.6g} is at a corner, where no normal is defined")
        return Contact(self.points(s), self.normals(s), friction, max_force=max_force, name=name)

    def nearest(self, position: ArrayLike) -> float:
        """The arc length of the boundary point nearest to ``position`` (2,), in the coordinates given [m].

        For a point relative to the centre of mass, such as a contact's, add ``centre_of_mass``.

        Args:
            position: (2,) in the coordinates given [m].
        """
        return self.boundary.nearest(array(position, "position", (2,)))

    def sample(self, count: int, *, clearance: float | None = None) -> Array:
        """(m,) arc lengths of ``count`` evenly spread candidates, those near a corner left out [m].

        Args:
            count: how many candidates, before those near a corner are left out.
            clearance: least distance to a corner along the boundary [m]; a quarter of the spacing if not
                given.
        """
        whole(count, "count", least=1, most=MOST_SAMPLED)
        spacing = self.length / count
        keep = spacing / 4 if clearance is None else number(clearance, "clearance", least=0)
        s: Array = (np.arange(count, dtype=np.float64) + 0.5) * spacing
        return s[self._to_corners(s) >= max(keep, 2 * _AT_CORNER * self.length)]

    def _to_corners(self, s: Array) -> Array:
        """(m,) arc length to the nearest corner; infinite without corners."""
        corners = self.boundary.corners
        if not corners.size:
            return np.full(s.shape, np.inf)
        i = np.searchsorted(corners, s)
        behind, ahead = (s - corners[i - 1]) % self.length, (corners[i % corners.size] - s) % self.length
        return np.minimum(behind, ahead)

    def __repr__(self) -> str:
        kind = "polygon" if isinstance(self.boundary, PolygonBoundary) else "smooth"
        holes = f", {len(self.holes)} hole{'s'[: len(self.holes) - 1]}" if self.holes else ""
        return f"Outline({kind}, length {self.length:.6g}, area {self.area:.6g}{holes})"


def _hole(hole: Hole, what: str) -> Boundary:
    if not isinstance(hole, Outline):
        return PolygonBoundary(checked_ring(hole, what))
    if hole.holes:
        raise InvalidInput(f"{what} has holes itself; what is inside a hole is another object")
    return hole.boundary


def _chords(boundary: Boundary, tolerance: float | None = None) -> Array:
    if tolerance is None:
        return boundary.polygon(_FLATNESS * boundary.length)
    return boundary.polygon(number(tolerance, "tolerance", above=0))


def _finite(s: ArrayLike) -> Array:
    return finite(s, "arc lengths")
