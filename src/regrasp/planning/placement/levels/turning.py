"""Twists about where lines of force meet, made one for all placements of a box on curves.

Fingers on parts of cubics turn with their places, and a twist y = (v, omega) of a load w is a polynomial of
degree 2 in the places t, from 0 to 1 along each part. So is s_i, which bounds what finger i does along it:

    s_i >= 0,    s_i(t) |p_i'| >= (v(t) + omega(t) J p_i) . g,    g the corners of a polygon around the sector

of the cone of size 1, as polynomials, by their coefficients in t^a (1 - t)^b. No placement at which

    sum_l (-w_l) . y_l(t) - limit sum_l sum_i s_il(t)

is above zero holds all loads w_l. Good twists are those along which edges of the cones of two fingers do no
work: y is the cross product of their wrenches, the turn about where the two lines meet. A small linear
program mixes those of all loads, by weights that change along the parts, and polynomials go near what it
mixes at the 3^k places of ends and middles. The proof stands in the documentation, page "Where to put the
fingers".
"""

from functools import cached_property, reduce
from itertools import combinations
from math import comb

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.levels.mixture import best_mixture

_SURE = 1e-9  # of the terms, more than rounding adds
_ROUNDING = 1e-12  # of the largest coefficient, more than any sum of products of them is off by
_SHORT = 0.01  # of the size: ends of shorter legs are rounded by more of them
_SMALL = 1e-3  # what fingers do along a twist of length 1 counts as more
_VARIED = 0.3  # of a weight, its change from the middle of a part to an end
_LEAST = 1e-9  # of the largest weight
_CORNERS = 3  # of the polygon, besides 0


class TurningTwists:
    """Twists of degree 2 in the places of k fingers, and bounds of what the fingers do along them."""

    def __init__(self, fingers: int) -> None:
        self.fingers = fingers

    @cached_property
    def powers(self) -> np.ndarray:
        """(m, k) of the places, in each term of a polynomial: none, one, then two of them."""
        k = self.fingers
        single = np.eye(k, dtype=int)
        both = [single[i] + single[j] for i in range(k) for j in range(i, k)]
        return np.vstack([np.zeros((1, k), int), single, both])

    @cached_property
    def at_nodes(self) -> Array:
        """(3^k, m) by which a polynomial becomes its values at ends and middles."""
        places = np.indices([3] * self.fingers).reshape(self.fingers, -1).T / 2
        return np.asarray(np.prod(places[:, None] ** self.powers, axis=2))

    @cached_property
    def through(self) -> Array:
        """(m, 3^k) by which values become the polynomial nearest to them."""
        return np.asarray(np.linalg.pinv(self.at_nodes), dtype=float)

    @cached_property
    def coefficients(self) -> Array:
        """(3^k, m) by which a polynomial becomes its Bernstein coefficients of degree 2 in each place."""
        return self._bent @ self.at_nodes

    @cached_property
    def _bent(self) -> Array:
        one = np.array([[1.0, 0, 0], [-0.5, 2, -0.5], [0, 0, 1]])
        return reduce(np.kron, [one] * self.fingers)

    @cached_property
    def _weights(self) -> Array:
        """(3^k, 2 k) weights that rise or fall along a part."""
        slopes = _VARIED * (np.indices([3] * self.fingers).reshape(self.fingers, -1).T - 1.0)
        return np.hstack([1 + slopes, 1 - slopes])

    @cached_property
    def _pairs(self) -> np.ndarray:
        """(2, c) kinks of what fingers do along a twist, four of each finger."""
        return np.array(list(combinations(range(4 * self.fingers), 2))).T

    def excluding(self, parts: Array, friction: float, loads: Array) -> tuple[np.ndarray, Array] | None:
        """Loads (n,) and polynomials (n, 3 + k, m) that exclude a box for forces of at most 1; or None.

        The polynomials are of velocities, angular velocity and the bound of each finger.

        parts: (k, 4, 2) control points. loads: (L, 3) to be made.
        """
        if friction <= 0:
            return None
        twists, most = self._turns(parts, friction)
        mixed = self._mixed(twists, most, loads)
        if mixed is None:
            return None
        few, values = mixed
        polynomials = np.einsum("mc,ncd->ndm", self.through, values)
        above = self._raised(polynomials, parts, friction)
        work = np.einsum("cm,nd,ndm->c", self.coefficients, loads[few], above[:, :3])
        done = np.einsum("cm,nim->c", self.coefficients, above[:, 3:])
        size = np.abs(work).max() + np.abs(done).max()
        return (few, above) if (work - done > _SURE * size).all() else None

    def _turns(self, parts: Array, friction: float) -> tuple[Array, Array]:
        """(c, 3^k, 3) twists at the nodes, and (c, 3^k, k) what fingers do along them at most."""
        points = _POINTS @ parts
        along = _SLOPES @ np.diff(parts, axis=1)
        t = along / np.linalg.norm(along, axis=2, keepdims=True)
        n = np.stack([-t[..., 1], t[..., 0]], axis=2)
        slant = np.hypot(1.0, friction)
        corners = np.stack([(n + friction * t) / slant, (n - friction * t) / slant, slant * n], axis=2)
        kinks = np.concatenate(
            [corners[:, :, :2], (corners[:, :, :2] - corners[:, :, 2:]) / friction], axis=2
        )
        forces = np.concatenate([corners, kinks], axis=2)
        arms = points[:, :, None]
        around = arms[..., 0] * forces[..., 1] - arms[..., 1] * forces[..., 0]
        wrenches = np.concatenate([forces, around[..., None]], axis=3)
        nodes = np.indices([3] * self.fingers).reshape(self.fingers, -1)
        there = wrenches[np.arange(self.fingers)[:, None], nodes]  # (k, 3^k, 7, 3)
        lines = there[:, :, _CORNERS:].transpose(0, 2, 1, 3).reshape(4 * self.fingers, -1, 3)
        a, b = self._pairs
        twists = np.cross(lines[a], lines[b])
        middle = twists[:, twists.shape[1] // 2]
        twists /= np.linalg.norm(middle, axis=1)[:, None, None] + 1e-300
        twists = np.concatenate([twists, -twists])
        corner = there[:, :, :_CORNERS].transpose(1, 3, 0, 2)
        done = twists.transpose(1, 0, 2) @ corner.reshape(len(corner), 3, -1)
        done[np.abs(done) < 1e-13] = 0.0
        most = done.reshape(*done.shape[:2], self.fingers, _CORNERS).max(axis=3)
        return twists, np.maximum(most, 0.0).transpose(1, 0, 2)

    def _mixed(self, twists: Array, most: Array, loads: Array) -> tuple[np.ndarray, Array] | None:
        """Loads (n,), and (n, 3^k, 3 + k) their twists and bounds mixed such that together they exclude."""
        total = most.sum(axis=2)
        left = (twists @ loads.T).transpose(2, 0, 1) - total
        share = left / np.maximum(total, 1e-9)
        share[(left <= 0).all(axis=2)] = -np.inf
        best = share.argmax(axis=1)  # of each load at each node
        pairs = np.unique(np.stack([np.indices(best.shape)[0], best], axis=2).reshape(-1, 2), axis=0)
        load, turn = pairs[np.isfinite(share[tuple(pairs.T)]).all(axis=1)].T
        if not len(load):
            return None
        weights = self._weights
        above = (self._bent @ (left[load, turn].T[:, :, None] * weights[:, None]).reshape(len(weights), -1)).T
        sizes = np.maximum((total[turn] @ weights).ravel() / len(weights), _SMALL)
        above /= sizes[:, None]
        found = best_mixture(above)
        if found is None:
            return None
        factors = (found / sizes).reshape(len(load), -1)
        factors[factors < _LEAST * factors.max()] = 0.0
        shares = factors @ weights.T
        few = np.unique(load[shares.any(axis=1)])
        both = np.concatenate([twists[turn], most[turn]], axis=2) * shares[..., None]
        return few, np.array([both[load == one].sum(axis=0) for one in few])

    def _raised(self, polynomials: Array, parts: Array, friction: float) -> Array:
        """The same with bounds as much higher as makes them bounds."""
        k, slant = self.fingers, np.hypot(1.0, friction)
        found = polynomials.copy()
        grid = (len(found), 3 + k) + (3,) * k
        coefficients = (found @ self.coefficients.T).reshape(grid)
        for i in range(k):
            own = np.moveaxis(coefficients, 2 + i, 2).reshape(len(found), 3 + k, 3, -1)
            tangent = np.diff(parts[i], axis=0)
            length = np.linalg.norm(tangent[1])
            tangent = tangent / length
            normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
            ahead, aside = (_along(parts[i], way) for way in (normal, tangent))
            ahead, aside = (np.einsum("drb,ndbx->nrx", way, own[:, :3]) for way in (ahead, aside))
            speed = _SQUARED @ slowest(tangent)
            bound = np.einsum("rb,nbx->nrx", speed, own[:, 3 + i])
            edge = ahead + friction * np.abs(aside)
            lacking = np.maximum(edge / slant, slant * ahead) - bound
            room = _ROUNDING * (1 + _SHORT / length) * np.abs(own).max(axis=(1, 2, 3))
            per_one = speed.sum(axis=1)
            if per_one.min() <= 0:
                found[:, 3 + i, 0] = np.inf
                continue
            more = ((lacking + room[:, None, None]) / per_one[:, None]).max(axis=(1, 2))
            found[:, 3 + i, 0] += np.maximum(np.maximum(more, room - own[:, 3 + i].min(axis=(1, 2))), 0.0)
        return found


def slowest(tangent: Array) -> Array:
    """(3,) coefficients of a polynomial of degree 2 at or below the length of one of vectors (3, 2), or 0."""
    a, c = (float(np.hypot(*tangent[i])) for i in (0, 2))
    ways = [float(tangent[i] @ tangent[1]) for i in (0, 2)]
    square = tangent[1] @ tangent[1] + (tangent[0] @ tangent[2] - a * c) / 2
    if min(a, c, *ways, square) <= 0:
        return np.zeros(3)
    return np.array([a, min(ways[0] / a, ways[1] / c, float(np.sqrt(square))), c])


def _along(control: Array, way: Array) -> Array:
    """(3, 8, 3) by which coefficients of a twist become those of its velocity along a normal or tangent.

    control: (4, 2) of the part. way: (3, 2) coefficients.
    """
    x, y = way.T
    around = (_CUBED @ y) @ control[:, 0] - (_CUBED @ x) @ control[:, 1]
    return np.stack([_SQUARED @ x, _SQUARED @ y, _OF_FIFTH @ around])


def _products(m: int, n: int) -> Array:
    """(m + n + 1, m + 1, n + 1) by which coefficients of two polynomials become those of their product."""
    found = np.zeros((m + n + 1, m + 1, n + 1))
    i, j = np.indices((m + 1, n + 1))
    found[i + j, i, j] = np.outer(_binomials(m), _binomials(n)) / _binomials(m + n)[i + j]
    return found


def _binomials(n: int) -> Array:
    return np.array([comb(n, i) for i in range(n + 1)], dtype=float)


def _bernstein(degree: int, at: Array) -> Array:
    """(m, degree + 1) the values of Bernstein polynomials."""
    i = np.arange(degree + 1)
    t = at[:, None]
    result: Array = _binomials(degree) * t**i * (1 - t) ** (degree - i)
    return result


# at both ends and the middle; then products of coefficients, all to the degree 7 of what a finger does in its
# own place: 2 of the twist, 3 of the point and 2 of the normal
_POINTS, _SLOPES = (_bernstein(degree, np.array([0.0, 0.5, 1.0])) for degree in (3, 2))
_CUBED, _OF_FIFTH = _products(3, 2), _products(2, 5)
_SQUARED = np.tensordot(_products(4, 3).sum(axis=2), _products(2, 2), 1)
