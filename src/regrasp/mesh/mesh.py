"""A solid object as a value: a closed surface of triangles."""

from dataclasses import dataclass, field
from functools import cached_property, partial
from os import PathLike

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, number, read_only, whole
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.value import ArrayValue, numbers
from regrasp.mesh.arrays import Indices, checked_points
from regrasp.mesh.solid import checked_body, doubled_areas, inertia, moments
from regrasp.mesh.touch import Touch
from regrasp.outline import Outline

CREASE = float(np.radians(35.0))
"""An edge is sharp where the surface turns there by more than this [rad], if not said otherwise."""


@dataclass(frozen=True, eq=False, repr=False)
class Mesh(ArrayValue):
    """The surface of a solid object of uniform density, by triangles without gaps.

    Coordinates are taken as given; contacts are placed relative to the centre of mass, as everywhere. Any
    unit of length will do, as long as forces and torques follow it.

    Whether the surface passes through itself is not checked.

    Args:
        vertices: (k, 3) [m]; equal ones become one.
        faces: (m, 3) vertex numbers from 0. A surface wound inside out, or unevenly, is turned the right way:
            which way that is follows from its being closed.
        smooth: whether the triangles stand for a curved surface. Normals are then interpolated between
            vertices wherever neighbours turn by ``crease`` [rad] or less; otherwise each is that of its
            triangle.
        crease: largest turn between neighbouring triangles over which normals are interpolated [rad].

    Raises:
        InvalidInput: For a mesh that is empty, not watertight or without volume, for faces without area and
            for several bodies.
    """

    vertices: Array
    faces: Indices
    smooth: bool
    crease: float
    notes: tuple[str, ...] = field(default=(), compare=False)
    """What reading the file has mended or left out, in words."""

    def __init__(
        self, vertices: ArrayLike, faces: ArrayLike, *, smooth: bool = False, crease: float = CREASE
    ) -> None:
        if not isinstance(smooth, bool | np.bool_):
            raise InvalidInput(f"smooth must be True or False, got {shown(smooth)}")
        points, triangles = checked_body(vertices, faces)
        triangles.setflags(write=False)
        limit = number(crease, "crease", above=0)
        if limit >= np.pi / 2:
            raise InvalidInput(f"crease must be less than pi / 2, got {shown(crease)}; it is in radians")
        object.__setattr__(self, "vertices", read_only(points))
        object.__setattr__(self, "faces", triangles)
        object.__setattr__(self, "smooth", bool(smooth))
        object.__setattr__(self, "crease", limit)
        object.__setattr__(self, "notes", ())

    @classmethod
    def from_file(
        cls,
        path: str | PathLike[str],
        *,
        scale: float | None = None,
        smooth: bool = False,
        crease: float = CREASE,
        bodies: str = "one",
        close_holes: float = 0.0,
    ) -> "Mesh":
        """The body in an STL, OBJ or PLY file, in the file's units times ``scale``.

        Files of triangles do not say their unit: look at ``size``; without ``scale`` a side above 100 gives
        a warning. Vertices within 1e-6 of the largest side are one, faces lower than that are taken out, and
        all groups or materials of a file together are the body.

        Args:
            path: a file that ends in .stl, .obj or .ply.
            scale: factor on its coordinates [-]; 1 if not given.
            smooth: whether the triangles stand for a curved surface, as of ``Mesh``.
            crease: as of ``Mesh`` [rad].
            bodies: "one" refuses several closed surfaces, "largest" takes the one of the largest volume,
                "fuse" unites them; a cavity is filled by both, with a warning.
            close_holes: holes up to this part of the largest side across are closed by triangles between
                their rims. ``notes`` of the result say what was done. Needs the extra ``regrasp[meshes]``.

        Raises:
            InvalidInput: For a file that cannot be read and for what ``Mesh`` refuses.
            ImportError: Without the extra.
        """
        from regrasp.mesh.reading.opened import opened

        if not isinstance(smooth, bool):
            raise InvalidInput(f"smooth must be True or False, got {shown(smooth)}")
        mesh, notes = opened(partial(cls, smooth=smooth, crease=crease), path, scale, bodies, close_holes)
        object.__setattr__(mesh, "notes", notes)
        return mesh

    @classmethod
    def box(cls, a: float, b: float, c: float) -> "Mesh":
        """The box of sides a, b and c along x, y and z [m], about the origin.

        Args:
            a: along x [m].
            b: along y [m].
            c: along z [m].
        """
        from regrasp.mesh.build import box

        return cls(*box(number(a, "a", above=0), number(b, "b", above=0), number(c, "c", above=0)))

    @classmethod
    def cylinder(cls, radius: float, height: float, *, segments: int = 64) -> "Mesh":
        """The cylinder about z, from -height / 2 to height / 2 [m], as a prism of ``segments`` sides.

        Its corners lie on the cylinder, so its volume is smaller: by 0.16 % with 64. Normals are the
        cylinder's own.

        Args:
            radius: [m], greater than 0.
            height: [m], greater than 0.
            segments: sides of the prism.
        """
        r, half = number(radius, "radius", above=0), number(height, "height", above=0) / 2
        return cls.revolved([(0, -half), (r, -half), (r, half), (0, half)], segments=segments)

    @classmethod
    def sphere(cls, radius: float, *, divisions: int = 8) -> "Mesh":
        """The sphere about the origin [m]: an icosahedron, each edge in ``divisions`` parts, blown up.

        Its corners lie on the sphere; with 8 divisions, 1280 faces, its volume is 0.9 % smaller and its
        normals, interpolated, are the sphere's within 0.3 degrees.

        Args:
            radius: [m], greater than 0.
            divisions: parts of each edge of the icosahedron.
        """
        from regrasp.mesh.build import ball

        return cls(
            *ball(number(radius, "radius", above=0), whole(divisions, "divisions", least=2, most=500)),
            smooth=True,
        )

    @classmethod
    def extruded(cls, outline: Outline, height: float) -> "Mesh":
        """The plate of an outline and its holes, from z = 0 to ``height`` [m].

        In the coordinates of the outline. A smooth one makes a smooth mesh, of chords as in its ``polygon``.

        Args:
            outline: the section, with its holes [m].
            height: [m], greater than 0.
        """
        from regrasp.mesh.build import plate
        from regrasp.outline.polygon import PolygonBoundary

        if not isinstance(outline, Outline):
            raise InvalidInput(f"outline must be an Outline, got {shown(outline)}")
        rings = [ring + outline.centre_of_mass for ring in (outline.polygon(), *outline.hole_polygons())]
        straight = isinstance(outline.boundary, PolygonBoundary)
        return cls(*plate(rings, number(height, "height", above=0)), smooth=not straight)

    @classmethod
    def revolved(cls, profile: ArrayLike, *, segments: int = 64) -> "Mesh":
        """The body that a profile sweeps about z, in ``segments`` steps; smooth.

        Args:
            profile: (k, 2) radius and z [m], from a point on the axis to another, off it in between.
            segments: steps of a full turn.
        """
        from regrasp.mesh.build import revolution

        return cls(*revolution(profile, whole(segments, "segments", least=3, most=100_000)), smooth=True)

    # -- the object -------------------------------------------------------------------------------------

    @property
    def volume(self) -> float:
        """[m^3]."""
        return self._moments[0]

    @cached_property
    def area(self) -> float:
        """Of the surface [m^2]."""
        return float(doubled_areas(self._touch.corners).sum()) / 2

    @cached_property
    def centre_of_mass(self) -> Array:
        """(3,) [m], in the coordinates given; uniform density."""
        return read_only(self._moments[1])

    @cached_property
    def inertia(self) -> Array:
        """(3, 3) inertia about the centre of mass for a density of 1 [m^5]: times mass / volume in kg m^2."""
        return read_only(inertia(self.vertices, self.faces))

    @cached_property
    def size(self) -> Array:
        """(3,) how far it extends along x, y and z [m]."""
        return read_only(np.ptp(self.vertices, axis=0))

    def surface(self) -> tuple[Array, Indices]:
        """Vertices (k, 3) relative to the centre of mass [m] and faces (m, 3), to draw."""
        return self.vertices - self.centre_of_mass, self.faces

    def save_stl(self, path: str | PathLike[str]) -> None:
        """Write a binary STL, in the coordinates given, rounded to single precision.

        Args:
            path: the file to write.
        """
        from regrasp.mesh.reading.files import write_stl

        write_stl(self.vertices, self.faces, path)

    # -- contacts ---------------------------------------------------------------------------------------

    def nearest(self, points: ArrayLike) -> Array:
        """(..., 3) the points of the surface nearest to ``points`` (..., 3), in the coordinates given [m].

        For points relative to the centre of mass, such as a contact's, add ``centre_of_mass``.

        Args:
            points: (..., 3) in the coordinates given [m].
        """
        given = checked_points(points)
        return self._touch.nearest(given.reshape(-1, 3)).reshape(given.shape)

    def normals(self, points: ArrayLike) -> Array:
        """(..., 3) unit normals into the object where the surface is nearest to ``points`` (..., 3).

        At an edge that of one of the faces there.

        Args:
            points: (..., 3), in the coordinates given [m].
        """
        given = checked_points(points)
        return self._touch.normals(given.reshape(-1, 3)).reshape(given.shape)

    def contact_at(
        self,
        point: ArrayLike,
        *,
        friction: float,
        max_force: float | None = None,
        torsion: float | None = None,
        name: str | None = None,
        along: ArrayLike | None = None,
        outside: bool = False,
    ) -> Contact:
        """The contact where the surface is nearest to ``point`` (3,), in the coordinates given [m].

        Args:
            point: (3,) in the coordinates given [m].
            friction: Coulomb coefficient [-].
            max_force: as of ``Contact`` [N].
            torsion: as of ``Contact`` [m].
            name: as of ``Contact``.
            along: (3,) the way the finger comes; the contact is then where a line through the point along it
                enters the object, nearest to the point.
            outside: only where nothing is in front of the surface, so not on the inner side of a wall.
                Without either a warning says when the point is off the surface and another wall, which faces
                the other way, is about as near, or when it is so far off that the unit may be another.

        Raises:
            InvalidInput: At an edge or corner where the normals of the faces that meet differ by more than 5
                degrees, and for a point farther from the surface than a tenth of the object's largest side.
        """
        given = array(point, "point", (3,))
        if not isinstance(outside, bool):
            raise InvalidInput(f"outside must be True or False, got {shown(outside)}")
        if along is not None and outside:
            raise InvalidInput("give one of along and outside")
        way = None if along is None else array(along, "along", (3,))
        foot, normal = self._touch.place(checked_points(given), way, outside)
        place = foot - self.centre_of_mass
        return Contact(place, normal, friction, max_force=max_force, torsion=torsion, name=name)

    def sample(self, count: int, *, seed: int = 0, clearance: float | None = None) -> Array:
        """(count, 3) points spread evenly over the surface, in the coordinates given [m].

        Args:
            count: how many points.
            seed: of the random choice; the same seed, the same choice.
            clearance: least distance to sharp edges and corners [m]; if not given, a quarter of the spacing
                sqrt(area / count), halved until half of the surface is that far from them. Faces turned by
                more than 75 degrees do not crowd one another, so that both sides and the rim of a plate get
                their points. The same seed gives the same points of the object, in any unit and frame.

        Raises:
            InvalidInput: Where the clearance leaves no room.
        """
        return self._sample(count, seed, clearance)[0]

    def contacts(
        self,
        count: int,
        *,
        friction: float,
        max_force: float | None = None,
        seed: int = 0,
        clearance: float | None = None,
    ) -> tuple[Contact, ...]:
        """Contacts at the points of ``sample``.

        Args:
            count: how many points.
            friction: Coulomb coefficient [-].
            max_force: largest force magnitude of the finger [N]; no limit if not given.
            seed: of the random choice; the same seed, the same choice.
            clearance: as of ``sample`` [m].
        """
        points, normals = self._sample(count, seed, clearance)
        places = zip(points - self.centre_of_mass, normals, strict=True)
        return tuple(Contact(r, n, friction, max_force=max_force) for r, n in places)

    def _sample(self, count: int, seed: int, clearance: float | None) -> tuple[Array, Array]:
        n = whole(count, "count", least=1, most=1_000_000)
        keep = None if clearance is None else number(clearance, "clearance", least=0)
        return self._touch.sample(n, whole(seed, "seed", least=0), keep)

    # -- what they stand on -----------------------------------------------------------------------------

    @cached_property
    def _touch(self) -> Touch:
        return Touch(self.vertices, self.faces, self.smooth, self.crease)

    @cached_property
    def _moments(self) -> tuple[float, Array]:
        return moments(self.vertices, self.faces)

    def __repr__(self) -> str:
        kind = ", smooth" if self.smooth else ""
        size = numbers(self.size)
        return f"Mesh({len(self.faces)} faces{kind}, size {size}, volume {self.volume:.6g})"
