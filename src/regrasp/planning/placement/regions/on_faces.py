"""Regions of contacts on flat faces in space: polygons such that every choice within them holds."""

from collections.abc import Callable
from functools import partial
from itertools import product
from math import atan, inf, log, prod, sqrt, tan

import numpy as np

from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.planning.placement.laws import LAWS
from regrasp.planning.placement.regions.face_patches import FaceRegions
from regrasp.planning.placement.regions.needs import LESS, ON_EDGE, limit_of
from regrasp.planning.placement.regions.seeking import MOST, Seeking
from regrasp.planning.placement.sides import moved
from regrasp.planning.placement.space.face_pieces import FacePlace, place_on
from regrasp.planning.states.choosing import choose_state

_SIDES = {3: 6, 4: 4}  # of polygons around discs
_MOST_CORNERS = 4096
_HALVINGS, _OWN_HALVINGS = 9, 5
_KEPT = 1e-3  # of friction, given up so that what a search leaves of the balance can be made good
_ROUNDING = 1e-12  # of forces, as if they were off by so much
_PRECISE = 5e-2  # of efforts: any forces do
_NO_AREA = 1e-24  # in sizes
_ROUNDS, _MORE = 8, 1.1  # of moments, and by how much more than needed is tried next


def regions_on_faces(mesh: Mesh, grasp: Grasp, loads: Array, given: float | None, widest: str) -> FaceRegions:
    """What ``contact_regions`` finds on a mesh. The radius of all together is the largest least one, too."""
    search = _Regions(mesh, grasp, loads)
    grasp = search.grasp
    limit = search.limit = limit_of(search.need(), given, grasp, loads)
    k, far = len(grasp), float(np.linalg.norm(mesh.size))
    none = np.zeros(k)
    if not search.holds(none):
        raise Infeasible(ON_EDGE)
    radius = _farthest(lambda r: search.holds(none + r), 0.0, far, _HALVINGS)
    radii, alone = none + radius, none.copy()
    for i in range(k):
        radii[i] = _farthest(partial(search.holds_with, radii, i), radius, far, _OWN_HALVINGS)
        alone[i] = _farthest(partial(search.holds_with, none, i), radius, far, _OWN_HALVINGS)
    if widest == "product":
        radii = Seeking(search.holds, none + far, MOST[widest]).product(radii, search.log_areas)
        radius = min(radius, float(radii.min()))
    ends = [
        float(np.linalg.norm(p - c.position, axis=1).max())
        for p, c in zip(search.patches(alone), grasp, strict=True)
    ]
    alone = np.maximum(radius, np.minimum(alone, ends))  # a face that holds everywhere ends there
    moments, tilts, focus, forces = map(read_only, search.proof(radii))
    return FaceRegions(
        mesh, grasp, tuple(map(read_only, search.patches(radii))), radius, read_only(radii), read_only(alone),
        limit * (1 + LESS), read_only(loads.copy()), moments, tilts, focus, forces,
    )  # fmt: skip


class _Regions:
    """Whether regions hold, and forces that show it."""

    def __init__(self, mesh: Mesh, grasp: Grasp, loads: Array) -> None:
        if len(grasp) not in _SIDES:
            raise InvalidInput(
                f"regions on faces are of three or four fingers, got {len(grasp)}: two points hold no torque "
                "about the line through them"
            )
        self.loads = loads
        self.places: list[FacePlace] = [place_on(mesh, contact) for contact in grasp]
        at = [Contact(p.point, np.cross(*p.axes), 0.0) for p in self.places]
        self.grasp = Grasp(map(moved, grasp, at))
        self.alpha = atan(float(grasp.frictions[0]) * (1 - _KEPT))
        self.size = float(np.linalg.norm(mesh.surface()[0], axis=1).max())
        self.unit = float(np.abs(loads / np.repeat([1.0, self.size], 3)).max()) or 1.0
        self.limit = inf
        self._hard = [0] * len(loads)
        self._held: list[tuple[Array, Array]] = []

    def need(self) -> float:
        """The least largest force with which the grasp holds all loads as it is [N]."""
        try:
            return max(choose_state(self.narrow, Wrench.from_vector(w), "peak").value for w in self.loads)
        except Infeasible:
            return inf

    @property
    def narrow(self) -> Grasp:
        """The grasp with a little of its friction kept back."""
        return Grasp(Contact(c.position, c.normal, tan(self.alpha), name=c.name) for c in self.grasp)

    def patches(self, radii: Array) -> list[Array]:
        """A polygon for each finger, a point where the radius is 0."""
        sides = _SIDES[len(self.grasp)]
        return [
            place.piece(float(r), sides) if r > 0 else place.point[None]
            for place, r in zip(self.places, radii, strict=True)
        ]

    def log_areas(self, radii: Array) -> float:
        """The sum of logarithms of the polygons' areas, in sizes."""
        total = 0.0
        for patch, place in zip(self.patches(radii), self.places, strict=True):
            x, y = ((patch - place.point) @ place.axes.T / self.size).T
            total += log(max(0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1)), _NO_AREA))
        return total

    def holds(self, radii: Array) -> bool:
        """Whether every choice within so far of the places holds all loads, as far as it can be proven."""
        patches = self.patches(radii)
        if prod(map(len, patches)) > _MOST_CORNERS:
            return False
        known, found = self._known_within(radii), []
        for load in range(len(self.loads)):
            proven = self._proven(patches, load, known[load])
            if proven is None:
                return False
            found.append(proven[0])
        self._held.append((radii.copy(), np.array(found)))
        return True

    def _known_within(self, radii: Array) -> Array:
        """(l, k) moments that the largest regions need that hold within others, load by load."""
        within = [held for held in self._held if (held[0] <= radii).all()]
        none = np.zeros((len(self.loads), len(radii)))
        return max(within, key=lambda held: float(held[0].sum()))[1] if within else none

    def holds_with(self, radii: Array, i: int, own: float) -> bool:
        """The same with another radius of one finger."""
        return self.holds(np.where(np.arange(len(radii)) == i, own, radii))

    def proof(self, radii: Array) -> tuple[Array, Array, Array, Array]:
        """Moments (l, k), tilts (l, k, 3), focus (l, k) and forces (l, c, s, k, 3) of regions that hold."""
        patches = self.patches(radii)
        known = self._known_within(radii)
        found = [self._proven(patches, load, known[load]) for load in range(len(self.loads))]
        return tuple(map(np.array, zip(*filter(None, found), strict=True)))  # type: ignore[return-value]

    def _proven(self, patches: list[Array], load: int, moments: Array) -> tuple[Array, ...] | None:
        """Moments, tilts, focus and forces, which prove that the patches hold a load; None for none."""
        for _ in range(_ROUNDS):
            forces = self._at_corners(patches, load, moments)
            if forces is None:
                return None
            needed, tilts, focus = self._needed(patches, forces)
            if (needed * (1 + LESS) <= moments).all():
                return moments, tilts, focus, forces
            moments = np.maximum(moments, _MORE * needed)
        return None

    def _at_corners(self, patches: list[Array], load: int, moments: Array) -> Array | None:
        """(c, s, k, 3) forces at all corners that make a load with moments about normals; None for none."""
        from regrasp.closed_form.compiled.patches.patch_corners import corner_forces
        from regrasp.closed_form.compiled.patches.patch_search import spare

        k, normals = len(patches), self.grasp.normals
        unit = np.repeat([1.0, self.size], 3) * self.unit
        loads = signed_loads(self.loads[load], moments, normals, [len(p) == 1 for p in patches]) / unit
        corners = np.array(list(product(*map(range, map(len, patches)))))
        points = np.zeros((k, max(map(len, patches)), 3))
        for i, patch in enumerate(patches):
            points[i, : len(patch)] = patch / self.size
        forces, limit = np.zeros((len(corners), len(loads), k, 3)), self.limit / self.unit
        failed = corner_forces(
            points, np.ascontiguousarray(normals), corners, self._hard[load] % len(corners), -loads,
            (tan(self.alpha), *LAWS["effort"].codes(), _PRECISE), sqrt(k) * limit, forces,
            np.zeros((k, 6)), spare(k),
        )  # fmt: skip
        if failed >= 0:
            self._hard[load] = failed
            return None
        matrices = _matrices(points[np.arange(k), corners])
        inverses = np.swapaxes(np.linalg.pinv(matrices), 1, 2)
        for _ in range(2):  # all fingers take up what rounding left of the balance
            left = -loads - forces.reshape(*forces.shape[:2], -1) @ np.swapaxes(matrices, 1, 2)
            forces += (left @ inverses).reshape(forces.shape)
        along = (forces * normals).sum(axis=3)
        across = np.linalg.norm(forces - along[..., None] * normals, axis=3)
        good = (across <= self.grasp.frictions[0] * (1 - LESS) * along).all()
        return forces * self.unit if good and np.linalg.norm(forces, axis=3).max() <= limit else None

    def _needed(self, patches: list[Array], forces: Array) -> tuple[Array, Array, Array]:
        """The moments that mixtures of the forces may lack, and the directions (tilts, focus) that say so."""
        k = len(patches)
        needed, tilts, focus = np.zeros(k), np.zeros((k, 3)), np.zeros(k)
        corners = np.array(list(product(*map(range, map(len, patches)))))
        for i, (patch, place, n) in enumerate(zip(patches, self.places, self.grasp.normals, strict=True)):
            if len(patch) == 1:
                continue
            off = np.repeat((patch - place.point)[corners[:, i]], forces.shape[1], axis=0)
            f = forces[:, :, i].reshape(-1, 3)
            tilts[i], focus[i] = _directions(off @ place.axes.T, f @ place.axes.T, f @ n, place.axes)
            needed[i] = lacking(patch - place.point, off, f, n, tilts[i], focus[i])
        return needed, tilts, focus


def lacking(patch: Array, off: Array, forces: Array, normal: Array, tilt: Array, focus: float) -> float:
    """The most torque about its normal that mixtures of a finger's forces may lack [N m].

    patch, off: corners of its polygon, and where each of the forces is, from its place [m].
    """
    along = forces @ normal
    aside = forces - along[:, None] * (normal + tilt + focus * off)
    sizes = np.linalg.norm(aside, axis=1) + _ROUNDING * np.linalg.norm(forces, axis=1)
    used = along > 0
    slope = float((sizes[used] / along[used]).max(initial=0.0))
    wide = float(np.linalg.norm(patch[:, None] - patch, axis=2).max())
    radius = float(np.linalg.norm(patch, axis=1).max())
    return min(float(along.max()) * slope * radius, float(sizes.max()) * wide)


def signed_loads(load: Array, moments: Array, normals: Array, alone: list[bool]) -> Array:
    """(s, 6) a load with moments about normals on top, both ways, of the fingers that have patches."""
    some = np.flatnonzero(~np.array(alone))
    result = np.repeat(load[None], 2 ** len(some), axis=0)
    for row, signs in zip(result, product((-1.0, 1.0), repeat=len(some)), strict=True):
        row[3:] += (np.array(signs) * moments[some]) @ normals[some]
    return result


def _directions(off: Array, across: Array, along: Array, axes: Array) -> tuple[Array, float]:
    """Tilt and focus: forces are nearly along the normal, plus the tilt, plus the focus times the offset.

    off, across: (m, 2) along ``axes``, by least squares, weighted with the normal parts (m,).
    """
    rows = np.zeros((2 * len(off), 3))
    rows[::2, 0] = rows[1::2, 1] = along
    rows[::2, 2], rows[1::2, 2] = along * off[:, 0], along * off[:, 1]
    scale = np.array([1.0, 1.0, float(np.abs(off).max())])
    found = np.linalg.lstsq(rows / scale, across.reshape(-1), rcond=None)[0] / scale
    return found[:2] @ axes, float(found[2])


def _matrices(points: Array) -> Array:
    """(c, 6, 3 k) grasp matrices of fingers at points (c, k, 3)."""
    count, k, _ = points.shape
    matrices = np.zeros((count, 6, k, 3))
    for c in range(3):
        a, b = (c + 1) % 3, (c + 2) % 3
        matrices[:, c, :, c] = 1.0
        matrices[:, 3 + c, :, b], matrices[:, 3 + c, :, a] = points[..., a], -points[..., b]
    return matrices.reshape(count, 6, 3 * k)


def _farthest(holds: Callable[[float], bool], least: float, most: float, halvings: int) -> float:
    """The largest that was seen to hold: doubled while it does, then halved between. ``least`` holds."""
    lo, hi = least, most
    step = max(least, most / 256)
    while lo + step < most and holds(lo + step):
        lo, step = lo + step, 2 * step
    hi = min(lo + step, most)
    for _ in range(halvings):
        middle = 0.5 * (lo + hi)
        lo, hi = (middle, hi) if holds(middle) else (lo, middle)
    return lo
