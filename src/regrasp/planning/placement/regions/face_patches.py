"""Polygons on faces of a mesh within which the fingers of a grasp may be."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.plain import listed
from regrasp.mesh.mesh import Mesh
from regrasp.planning.placement.proofs.sealed import Sealed
from regrasp.planning.placement.proofs.shape_data import shape_of

_ENDED = 1e-5


@dataclass(frozen=True, eq=False, repr=False)
class FaceRegions(Sealed):
    """Polygons on flat faces, one for each finger: wherever in them the fingers are, they hold the loads.

    Args:
        shape: the mesh.
        grasp: the contacts in the middle of it all.
        patches: (m, 3) corners of each polygon, relative to the centre of mass [m].
        radius: every finger may be so far off along its face, in any direction, all at once; where the face
            ends nearer, to a line through its nearest point [m].
        radii: (k,) the same of each finger by itself: those whose patches could grow have more [m].
        alone: (k,) how far one finger may be off while the others are at their places; not proven by
            ``forces``, nor judged by ``regrasp.verify`` [m].
        max_force: no force need be larger [N].
        loads: (l, 6) that are held, and all between [N, N m].
        moments: (l, k) about each finger's normal, which corners hold on top of a load, both ways [N m].
        tilts: (l, k, 3) along the face: forces are nearly along the normal, plus the tilt, plus the focus
            times the way from the finger's place.
        focus: (l, k) of the same [1/m].
        forces: (l, c, s, k, 3) at all combinations of corners, under each load with all signs of moments:
            they prove the regions [N].
    """

    _what = "regions"
    shape: Mesh
    grasp: Grasp
    patches: tuple[Array, ...]
    radius: float
    radii: Array
    alone: Array
    max_force: float
    loads: Array
    moments: Array
    tilts: Array
    focus: Array
    forces: Array

    @property
    def reach(self) -> Array:
        """(k,) ``radii``, or how far the polygon's farthest corner is, where its face ends before [m]."""
        places = zip(self.patches, self.grasp.positions, strict=True)
        farthest = [np.linalg.norm(patch - place, axis=1).max() for patch, place in places]
        return np.minimum(self.radii, farthest)

    @property
    def ended(self) -> np.ndarray:
        """(k,) whether a face ends before a finger is ``radius`` off."""
        nearest = []
        for patch, place in zip(self.patches, self.grasp.positions, strict=True):
            sides = np.roll(patch, -1, axis=0) - patch
            away = np.linalg.norm(np.cross(place - patch, sides), axis=1)
            lengths = np.linalg.norm(sides, axis=1)
            nearest.append(min(away[lengths > 0] / lengths[lengths > 0], default=0.0))
        return np.asarray(np.array(nearest) < self.radius * (1 - _ENDED))

    def __repr__(self) -> str:
        reach = ", ".join(f"{r:.4g}" for r in self.reach)
        return f"FaceRegions(all off by {self.radius:.4g}{self._to_ends}, each by {reach})"

    def __str__(self) -> str:
        off = f"{self.radius:.6g} any way{self._to_ends}"
        rows = [f"how far fingers may miss along their faces: all at once {off}"]
        rows.append(f"{'':10}{'each by':>14}{'alone':>14}")
        for name, all_, alone in zip(self.grasp.names, self.reach, self.alone, strict=True):
            rows.append(f"{name:10}{all_:14.6g}{alone:14.6g}")
        return "\n".join(rows)

    @property
    def _to_ends(self) -> str:
        return " or to the end of the face" if self.ended.any() else ""

    @classmethod
    def _checked(cls, given: dict[str, Any]) -> Self:
        grasp, shape = Grasp.from_dict(given["grasp"]), shape_of(given["shape"])
        k = len(grasp)
        if grasp.dimension != 3 or not isinstance(shape, Mesh):
            raise InvalidInput("regions on faces have a mesh and a grasp in space")
        loads = array(given["loads"], "loads", (None, 6))
        patches = [array(p, "patches", (None, 3)) for p in listed(given["patches"], "patches")]
        signs = 2 ** sum(len(patch) > 1 for patch in patches)
        return cls(
            shape,
            grasp,
            tuple(patches),
            number(given["radius"], "radius", least=0),
            array(given["radii"], "radii", (k,)),
            array(given["alone"], "alone", (k,)),
            number(given["max_force"], "max_force", above=0),
            loads,
            array(given["moments"], "moments", (len(loads), k)),
            array(given["tilts"], "tilts", (len(loads), k, 3)),
            array(given["focus"], "focus", (len(loads), k)),
            array(given["forces"], "forces", (len(loads), None, signs, k, 3)),
        )
