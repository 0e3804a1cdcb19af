"""How far the fingers of a grasp may miss their places: regions within which every choice holds."""

from typing import overload

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline
from regrasp.planning.placement.loads import check_planar, inner_and_outer
from regrasp.planning.placement.regions.contact_arcs import ContactRegions
from regrasp.planning.placement.regions.curved import on_curve
from regrasp.planning.placement.regions.face_patches import FaceRegions
from regrasp.planning.placement.regions.on_faces import regions_on_faces
from regrasp.planning.placement.regions.straight import on_sides
from regrasp.planning.placement.space.choosing import check_space

_STATES = 1 << 14  # at corners, some milliseconds and kilobytes each
_LOADS_IN_SPACE = 128  # of some thousand states each
WIDEST = ("together", "least", "product")


@overload
def contact_regions(
    shape: Outline,
    grasp: Grasp,
    load: Wrench | LoadSet,
    *,
    max_force: float | None = None,
    widest: str = "together",
) -> ContactRegions: ...
@overload
def contact_regions(
    shape: Mesh,
    grasp: Grasp,
    load: Wrench | LoadSet,
    *,
    max_force: float | None = None,
    widest: str = "together",
) -> FaceRegions: ...
def contact_regions(
    shape: Outline | Mesh,
    grasp: Grasp,
    load: Wrench | LoadSet,
    *,
    max_force: float | None = None,
    widest: str = "together",
) -> ContactRegions | FaceRegions:
    """Independent regions around the contacts of a grasp: every choice within them holds the loads.

    On straight sides every placement of a box of arcs holds a load, with forces below a limit, if and only if
    the box's corners do: between two ends of one arc, forces are mixed so that the centre of pressure of that
    finger is where it stands. So corners prove regions, and the half width is exact to rounding. From there
    the ends of the arcs are moved out one after the other as far as they go. On a curve chords beside parts
    of the arcs, and the cones that all points of a part share, take the place of sides (``curved``):
    what is returned is proven, too, if not always the widest; so are regions that go on past vertices of a
    polygon that are no corners. On a mesh regions are polygons on
    flat faces, around discs; their corners prove them where forces there hold a little torque about each
    normal on top.

    Args:
        shape: a polygon, a smooth outline, or a mesh of flat faces.
        grasp: contacts on its outer boundary, or of a polygon in holes that are polygons, to a millionth, all
            of one friction, relative to the centre of mass; up to six, on a mesh three or four, away from
            edges. Regions are around the points of the boundary that are nearest to them.
        load: external wrench on the object about its centre of mass, or a set of them [N, N m]: of k fingers
            16,384 / 2^k at most, on a mesh 128.
        max_force: limit on every force, beside those of the contacts, of which the least counts for all [N];
            three times the least that the grasp needs if there is none.
        widest: what is as large as can be: how far all may be off ``together``, the ``least`` arc, or the
            ``product`` of all arcs. On polygons how wide a least arc can be is proven, of arcs on one side
            each (``ContactRegions.widest``); the product is found by trading one end of an arc for others
            while that helps, which nothing proves the largest. On curves both are what up to a hundred
            questions find, from regions that are wide together; on a mesh the least radius is that of all
            together, and the product, of the areas of the polygons, is sought as on curves.

    Raises:
        Infeasible: Where the grasp itself does not hold the loads.
        InvalidInput: For arguments that are not what they must be.
    """
    if not isinstance(shape, Outline | Mesh):
        raise InvalidInput(f"shape must be an Outline or a Mesh, got {shown(shape)}")
    where, d = ("planar Grasp", 2) if isinstance(shape, Outline) else ("Grasp in space", 3)
    if not isinstance(grasp, Grasp) or grasp.dimension != d or not 2 <= len(grasp) <= 6:
        raise InvalidInput(f"grasp must be a {where} of two to six contacts, got {shown(grasp)}")
    refuse_limits(grasp, "a search for regions")
    if len(set(grasp.frictions.tolist())) > 1:
        raise InvalidInput("contacts of a grasp with regions must all have the same friction")
    limits = [c.max_force for c in grasp if c.max_force is not None]
    if max_force is not None:
        limits.append(number(max_force, "max_force", above=0))
    given = min(limits, default=None)
    if not isinstance(widest, str) or widest not in WIDEST:
        raise InvalidInput(f"widest must be one of {', '.join(WIDEST)}; got {shown(widest)}")
    if isinstance(shape, Mesh):
        in_space = check_space(shape, load)
        _check_count(len(in_space), _LOADS_IN_SPACE, grasp)
        return regions_on_faces(shape, grasp, in_space, given, widest)
    check_planar(load)
    _, loads = inner_and_outer(load, 1e-3)
    _check_count(len(loads), _STATES // 2 ** len(grasp), grasp)
    control = shape.cubics()
    if control is not None:
        return on_curve(shape, control, grasp, loads, given, widest)
    return on_sides(shape, grasp, loads, given, widest)


def _check_count(count: int, most: int, grasp: Grasp) -> None:
    if count > most:
        raise InvalidInput(
            f"regions of {len(grasp)} fingers are proven under {most} loads at most, each by states at all "
            f"corners; got {count}: give fewer whose hull contains them"
        )
