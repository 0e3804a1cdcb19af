"""Meshes from files mended: faces without area, holes, several bodies. Each says in words what it did."""

from collections import defaultdict

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mesh.arrays import Indices, merged
from regrasp.mesh.build import polygon_triangles
from regrasp.mesh.reading.cavities import filled
from regrasp.mesh.solid import doubled_areas, moments, solid

BODIES = ("one", "largest", "fuse")
"""What to do with several closed surfaces: refuse them, take the largest, or unite them."""

_ROUNDS = 60
_MOST_FLAT, _MOST_OPEN, _MOST_FUSED = 100_000, 50_000, 1_000

Mended = tuple[Array, Indices, list[str]]


class _Edges:
    """The edges of faces (m, 3); half-edge 3 f + k runs in face f from its corner k to the next."""

    def __init__(self, faces: Indices) -> None:
        self._base = int(faces.max()) + 1
        self.start, self.end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
        self.key = self.number(self.start, self.end)
        self._order = np.argsort(self.key, kind="stable")
        self._sorted = self.key[self._order]

    def number(self, a: Indices, b: Indices) -> Indices:
        """The same for both directions."""
        result: Indices = np.minimum(a, b) * self._base + np.maximum(a, b)
        return result

    def halves(self, key: int) -> list[int]:
        """The half-edges with a number."""
        begin, end = np.searchsorted(self._sorted, [key, key + 1])
        return [int(half) for half in self._order[begin:end]]

    def pairs(self) -> tuple[Indices, Indices]:
        """Half-edges that are one edge of two faces."""
        first = np.flatnonzero(np.diff(self._sorted, prepend=-1))
        alone = first[np.diff(first, append=self._sorted.size) == 2]
        return self._order[alone], self._order[alone + 1]

    def open(self) -> Indices:
        """Half-edges of one face only."""
        first = np.flatnonzero(np.diff(self._sorted, prepend=-1))
        result: Indices = self._order[first[np.diff(first, append=self._sorted.size) == 1]]
        return result


# -- faces without area -------------------------------------------------------------------------------------


def without_slivers(vertices: Array, faces: Indices, flat: float) -> Mended:
    """Faces lower than ``flat`` [m] taken out of a surface that stays closed.

    Such a face has its third corner b on its longest side a c. The face on the other side of a c, with the
    corner d, is divided at b instead: a b d and b c d take the place of both.
    """
    faces, mended, looked_at = faces.copy(), 0, 0
    for _ in range(_ROUNDS):
        corners = vertices[faces]
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        length, longest = sides.max(axis=1), np.argmax(sides, axis=1)
        low = np.flatnonzero(doubled_areas(corners) <= flat * length)
        looked_at += low.size
        if looked_at > _MOST_FLAT:
            break
        turned = _turn_edges(faces, low[np.argsort(-length[low])], longest) if low.size else 0
        mended += turned
        if not turned:
            break
    return (
        vertices,
        faces,
        [f"mended: {mended} faces without area, at which neighbours end"] if mended else [],
    )


def _turn_edges(faces: Indices, low: Indices, longest: Indices) -> int:
    edges = _Edges(faces)
    touched: set[int] = set()
    made: set[int] = set()
    for f in map(int, low):
        half = 3 * f + int(longest[f])
        both = edges.halves(int(edges.key[half]))
        if len(both) != 2:
            continue
        other = both[0] if both[1] == half else both[1]
        g = other // 3
        if g == f or f in touched or g in touched:
            continue
        b = faces[f, (longest[f] + 2) % 3]
        p, q, d = (faces[g, (other + k) % 3] for k in range(3))  # in g the shared side runs from p to q
        new = int(edges.number(b, d))
        if b == d or new in made or edges.halves(new):
            continue
        faces[f], faces[g] = (p, b, d), (b, q, d)
        touched.update((f, g))
        made.add(new)
    return len(made)


# -- holes --------------------------------------------------------------------------------------------------


def without_holes(vertices: Array, faces: Indices, widest: float) -> Mended:
    """Holes up to ``widest`` [m] across closed by triangles between the vertices of their rims."""
    edges = _Edges(faces)
    halves = edges.open()
    if halves.size > _MOST_OPEN:
        raise InvalidInput(f"there are {halves.size} open edges, too many to close")
    closed, largest = [faces], 0.0
    for ring in _rims(edges.start[halves], edges.end[halves]):
        points = vertices[ring]
        across = 2 * float(np.linalg.norm(points - points.mean(axis=0), axis=1).max())
        if across > widest:
            continue
        closed.append(ring[_lid(points)])
        largest = max(largest, across)
    count = len(closed) - 1
    words = f"closed: {count} hole{'s' * (count != 1)} up to {largest:.3g} across"
    return vertices, np.concatenate(closed), [words] if count else []


def _rims(start: Indices, end: Indices) -> list[Indices]:
    """Closed chains of edges, each vertex once."""
    around: dict[int, list[int]] = defaultdict(list)
    for a, b in zip(start.tolist(), end.tolist(), strict=True):
        around[a].append(b)
        around[b].append(a)
    rims = []
    for first in list(around):
        while around[first]:
            path, places, at = [first], {first: 0}, first
            while around[at]:
                after = around[at].pop()
                around[after].remove(at)
                at = after
                if at in places:
                    begin = places[at]
                    if len(path) - begin > 2:
                        rims.append(np.array(path[begin:], dtype=np.int64))
                    for vertex in path[begin + 1 :]:
                        del places[vertex]
                    path = path[: begin + 1]
                else:
                    places[at] = len(path)
                    path.append(at)
    return rims


def _lid(points: Array) -> Indices:
    """(m, 3) triangles between points (k, 3) of a rim: those of its picture in a plane, or a fan."""
    from shapely import Polygon

    fan = np.array([(0, i, i + 1) for i in range(1, len(points) - 1)], dtype=np.int64)
    if len(points) < 5:
        return fan
    middle = points - points.mean(axis=0)
    axes = np.linalg.svd(middle, full_matrices=False)[2]
    flat = middle @ axes[:2].T
    return polygon_triangles([flat]) if Polygon(flat).is_valid else fan


# -- bodies -------------------------------------------------------------------------------------------------


def one_of(vertices: Array, faces: Indices, bodies: str) -> Mended:
    """The largest of several closed surfaces, or their union; ``bodies`` is one of ``BODIES``."""
    parts = parted(faces)
    if bodies == "one" or len(parts) == 1:
        return vertices, faces, []
    solids = [merged(vertices, part) for part in parts]
    if bodies == "fuse":
        largest = int(np.argmax([np.ptp(points, axis=0).prod() for points, _ in solids]))
        vertices, faces, notes = _fused(solids)
        return vertices, faces, notes + filled(solids, largest)
    volumes = []
    for points, part in solids:
        try:
            volumes.append(moments(points, solid(points, part))[0])
        except InvalidInput:
            volumes.append(0.0)
    best = int(np.argmax(volumes))
    rest = sum(volumes) - volumes[best]
    words = f"kept: the largest of {len(parts)} surfaces, volume {volumes[best]:.6g}; left out: {rest:.6g}"
    return *solids[best], [words, *filled(solids, best)]


def parted(faces: Indices) -> list[Indices]:
    """The faces of each surface: those that go on into one another across edges of two faces."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    first, second = _Edges(faces).pairs()
    links = coo_array((np.ones(first.size), (first // 3, second // 3)), shape=(len(faces),) * 2)
    count, label = connected_components(links, directed=False)
    order = np.argsort(label, kind="stable")
    return np.split(faces[order], np.cumsum(np.bincount(label, minlength=count))[:-1])


def _fused(solids: list[tuple[Array, Indices]]) -> Mended:
    try:
        import manifold3d
    except ImportError:
        raise ImportError("fusing bodies needs manifold3d: pip install 'regrasp[meshes]'") from None
    if len(solids) > _MOST_FUSED:
        raise InvalidInput(
            f"there are {len(solids)} closed surfaces, more than the {_MOST_FUSED} that are fused"
        )
    parts = []
    for points, faces in solids:
        wound = np.ascontiguousarray(solid(points, faces), dtype=np.uint64)
        part = manifold3d.Manifold(manifold3d.Mesh64(vert_properties=points, tri_verts=wound))
        if part.status() != manifold3d.Error.NoError:
            raise InvalidInput(f"a surface cannot be fused: {part.status().name}")
        parts.append(part)
    whole = manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add)
    mesh, apart = whole.to_mesh64(), sum(part.volume() for part in parts)
    vertices, faces = np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts, dtype=np.int64)
    words = f"fused: {len(parts)} surfaces, volume {apart:.6g} in all, into one of {whole.volume():.6g}"
    return vertices, faces, [words]
