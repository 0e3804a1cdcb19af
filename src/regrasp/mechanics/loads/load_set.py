"""Convex sets of loads: what a grasp may meet, instead of one wrench."""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import cos, pi, sin

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, not_huge, number, numbers_in, read_only
from regrasp.mechanics.loads.caps import around_cap
from regrasp.mechanics.loads.nearest import nearest_mean
from regrasp.mechanics.value import ArrayValue, numbers
from regrasp.mechanics.wrench import Wrench

# A member may lie this fraction of the set's size outside: rounding of whoever computed it.
_ROUNDING = 1e-9
# The work of loads up to ``LARGEST`` has a square.
_FASTEST = 1e50


@dataclass(frozen=True, eq=False, repr=False)
class LoadSet(ArrayValue, ABC):
    """A convex set of loads, center + factor (body - center), told by its support function.

    Make one by ``hull``, ``ball``, ``ellipsoid``, ``tilted`` or ``turned``.

    Args:
        center: a member that ``scaled`` keeps.
        factor: by which deviations from the center are multiplied, 1 unless scaled. Torques are about the
            centre of mass, in the object's frame like the forces.
    """

    center: Wrench
    factor: float

    @staticmethod
    def hull(loads: Iterable[Wrench], center: Wrench | None = None) -> "LoadSet":
        """The convex hull of loads; ``center`` is their mean if not given, and need not be one of them.

        Args:
            loads: one external wrench or more, all planar or all in space [N, N m].
            center: a load that ``scaled`` keeps.
        """
        given = list(loads) if isinstance(loads, Iterable) else []
        if not given or not all(isinstance(load, Wrench) for load in given):
            raise InvalidInput(f"a hull needs one Wrench or more, got {shown(loads)}")
        about = given[0] if center is None else _wrench(center, "center")
        if any(load.dimension != about.dimension for load in given):
            raise InvalidInput("loads of a hull must all be planar or all in space, like its center")
        points = not_huge(read_only(np.array([load.vector for load in given])), "loads")
        middle = sum(given[1:], start=given[0]) / len(given) if center is None else about
        return _Hull(middle, 1.0, points)

    @staticmethod
    def ball(center: Wrench, *, force: float = 0.0, torque: float = 0.0) -> "LoadSet":
        """The deviations (f, tau) with (|f| / force)^2 + (|tau| / torque)^2 <= 1 [N], [N m]; 0 for none.

        Args:
            center: the load in the middle [N, N m].
            force: radius of the deviations of the force [N].
            torque: radius of the deviations of the torque [N m].
        """
        middle = _wrench(center, "center")
        d, size = middle.dimension, middle.vector.size
        radii = [number(force, "force", least=0)] * d + [number(torque, "torque", least=0)] * (size - d)
        return _Ellipsoid(middle, 1.0, not_huge(read_only(np.diag(radii)), "radii of a ball"))

    @staticmethod
    def ellipsoid(center: Wrench, axes: ArrayLike) -> "LoadSet":
        """The loads center + A z with |z| <= 1.

        Args:
            center: the load in the middle [N, N m].
            axes: A, (3, k) or (6, k), of half axes, [N] and [N m].
        """
        middle = _wrench(center, "center")
        return _Ellipsoid(middle, 1.0, not_huge(array(axes, "axes", (middle.vector.size, None)), "axes"))

    @staticmethod
    def tilted(load: Wrench, angle: float) -> "LoadSet":
        """The hull of a load whose force turns by up to ``angle`` [rad], any way; its torque stays.

        Args:
            load: external wrench on the object about its centre of mass, object frame [N, N m].
            angle: from 0 to pi [rad].
        """
        most = number(angle, "angle", least=0)
        if most > pi:
            raise InvalidInput(f"angle must be at most pi, every direction, got {shown(angle)}")
        return _Cap(_wrench(load, "load"), 1.0, most)

    @staticmethod
    def turned(load: Wrench) -> "LoadSet":
        """The hull of a load in every orientation of the object: its force turns freely; its torque stays.

        Args:
            load: external wrench on the object about its centre of mass, object frame [N, N m].
        """
        return LoadSet.tilted(load, pi)

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return self.center.dimension

    @property
    def vertices(self) -> Array | None:
        """Of a hull the loads (m, 3) or (m, 6) that span it, scaled; None of round sets."""
        return None

    @property
    def half_axes(self) -> Array | None:
        """Of a ball or an ellipsoid the A of center + A z, |z| <= 1, scaled: (3, k) or (6, k); else None."""
        return None

    @property
    def cover(self) -> Array | None:
        """(m, 3) or (m, 6) loads whose hull holds the set, None for ellipsoids.

        A hull's vertices; around a tilt a polytope that is larger by 1e-3 at most in the plane, by 0.03 in
        space.
        """
        return self.vertices

    @property
    def deviations(self) -> "LoadSet":
        """The same set moved so that its center is no load: what may come on top of the center."""
        return self._moved(Wrench.from_vector(np.zeros_like(self.center.vector)))

    def scaled(self, factor: float) -> "LoadSet":
        """The set with deviations from the center ``factor`` times as large.

        Args:
            factor: at least 0 [-].
        """
        whole = not_huge(self.factor * number(factor, "factor", least=0), "factor")
        not_huge(whole * self._size(slice(None)), "deviations of a scaled set")
        return replace(self, factor=whole)

    def support(self, twist: ArrayLike) -> Array:
        """Max over the set of twist . load: the most work of a member along twists (..., 3) or (..., 6).

        Args:
            twist: (..., 3) or (..., 6) velocity of the centre of mass, then angular velocity.
        """
        y = self._twist(twist)
        middle = y @ self.center.vector
        result: Array = middle + self.factor * (self._support(y) - middle)
        return result

    def extreme(self, twist: ArrayLike) -> Wrench:
        """A load of the set that does the most work along a twist (3,) or (6,).

        Args:
            twist: (3,) or (6,) velocity of the centre of mass, then angular velocity.
        """
        y = self._twist(twist)
        if y.ndim != 1:
            raise InvalidInput(f"extreme is of one twist, got shape {y.shape}")
        middle = self.center.vector
        return Wrench.from_vector(middle + self.factor * (self._extreme(y) - middle))

    def contains(self, load: Wrench) -> bool:
        """Whether a load is in the set, its edge included but for rounding, 1e-9 of the set's size.

        Args:
            load: external wrench on the object about its centre of mass, object frame [N, N m].
        """
        away = _wrench(load, "load").vector
        if away.size != self.center.vector.size:
            raise InvalidInput("a planar load and a set in space, or the other way, cannot be compared")
        away = away - self.center.vector
        d = self.dimension
        # what counts as rounding, for forces and for torques by their own size
        sizes = np.array([self._size(slice(0, d))] * d + [self._size(slice(d, None))] * (away.size - d))
        slack = _ROUNDING * np.maximum(self.factor * sizes, np.abs(self.center.vector))
        if (self.factor * sizes <= slack).all():  # a point, but for rounding
            return bool((np.abs(away) <= slack).all())
        return self._contains(self.center.vector + away / self.factor, slack / self.factor)

    def _size(self, part: slice) -> float:
        """The largest deviation of the body's forces, or torques, along an axis."""
        axes = np.eye(self.center.vector.size)[part]
        middle = axes @ self.center.vector
        return float(max((self._support(axes) - middle).max(), (self._support(-axes) + middle).max()))

    def _twist(self, twist: ArrayLike) -> Array:
        y = numbers_in(twist, f"twist must have {self.center.vector.size} numbers")
        if not y.ndim or y.shape[-1] != self.center.vector.size or not np.isfinite(y).all():
            raise InvalidInput(
                f"twist must have {self.center.vector.size} finite numbers, got {shown(twist)}"
            )
        return not_huge(y, "twist", _FASTEST)

    @abstractmethod
    def _moved(self, center: Wrench) -> "LoadSet": ...
    @abstractmethod
    def _support(self, y: Array) -> Array: ...
    @abstractmethod
    def _extreme(self, y: Array) -> Array: ...
    @abstractmethod
    def _contains(self, load: Array, slack: Array) -> bool: ...
    @abstractmethod
    def _words(self) -> str: ...

    def __str__(self) -> str:
        times = "" if self.factor == 1 else f", deviations times {self.factor:.6g}"
        return f"{self._words()}{times}"

    def __repr__(self) -> str:
        return f"LoadSet({self})"


@dataclass(frozen=True, eq=False, repr=False)
class _Hull(LoadSet):
    points: Array

    @property
    def vertices(self) -> Array:
        """(m, 3) or (m, 6) the loads that span the hull, scaled; some may lie inside."""
        return self.center.vector + self.factor * (self.points - self.center.vector)

    def _moved(self, center: Wrench) -> LoadSet:
        return _Hull(center, self.factor, read_only(self.points + (center.vector - self.center.vector)))

    def _support(self, y: Array) -> Array:
        result: Array = (y @ self.points.T).max(axis=-1)
        return result

    def _extreme(self, y: Array) -> Array:
        chosen: Array = self.points[int((self.points @ y).argmax())]
        return chosen

    def _contains(self, load: Array, slack: Array) -> bool:
        unit = np.where(slack > 0, slack, 1.0) / _ROUNDING
        gap = np.abs(nearest_mean(self.points / unit, load / unit)) * unit
        return bool((gap <= slack).all())

    def _words(self) -> str:
        return f"hull of {len(self.points)} loads around {self.center!r}"


@dataclass(frozen=True, eq=False, repr=False)
class _Ellipsoid(LoadSet):
    axes: Array

    @property
    def half_axes(self) -> Array:
        """(3, k) or (6, k) the half axes, scaled [N, N m]."""
        return self.factor * self.axes

    def _moved(self, center: Wrench) -> LoadSet:
        return _Ellipsoid(center, self.factor, self.axes)

    def _support(self, y: Array) -> Array:
        result: Array = y @ self.center.vector + np.linalg.norm(y @ self.axes, axis=-1)
        return result

    def _extreme(self, y: Array) -> Array:
        z = y @ self.axes
        length = float(np.linalg.norm(z))
        result: Array = self.center.vector + (self.axes @ z / length if length else 0.0)
        return result

    def _contains(self, load: Array, slack: Array) -> bool:
        unit = np.where(slack > 0, slack, 1.0)[:, None] / _ROUNDING
        away = (load - self.center.vector)[:, None] / unit
        z = np.linalg.lstsq(self.axes / unit, away, rcond=1e-12)[0]
        off = np.abs(self.axes / unit @ z - away).max()
        return bool(off <= _ROUNDING and np.linalg.norm(z) <= 1 + _ROUNDING)

    def _words(self) -> str:
        half = np.linalg.norm(self.axes, axis=1)
        return f"ellipsoid around {self.center!r}, reaching {numbers(half)} along the axes"


@dataclass(frozen=True, eq=False, repr=False)
class _Cap(LoadSet):
    """The hull of a cap of a circle or sphere: {|f| <= m, f . a >= m cos(angle)}, a the load's direction."""

    angle: float

    @property
    def cover(self) -> Array:
        """(m, 3) or (m, 6) loads whose hull holds the cap."""
        (size, axis), middle = self._force, self.center.vector
        forces = size * around_cap(axis, self.angle) if size else np.zeros((1, self.dimension))
        torques = np.broadcast_to(self.center.torque, (len(forces), self.center.torque.size))
        return middle + self.factor * (np.hstack([forces, torques]) - middle)

    def _moved(self, center: Wrench) -> LoadSet:
        return _Moved(center, self.factor, self)

    @property
    def _force(self) -> tuple[float, Array]:
        force = self.center.force
        size = float(np.linalg.norm(force))
        return size, (force / size if size else force)

    def _support(self, y: Array) -> Array:
        d = self.dimension
        v, (size, axis) = y[..., :d], self._force
        along = v @ axis
        across = np.linalg.norm(v - along[..., None] * axis, axis=-1)
        inside = along >= cos(self.angle) * np.hypot(along, across)  # v itself points into the cap
        edge = cos(self.angle) * along + sin(self.angle) * across
        result: Array = (
            size * np.where(inside, np.hypot(along, across), edge) + y[..., d:] @ self.center.torque
        )
        return result

    def _extreme(self, y: Array) -> Array:
        d = self.dimension
        v, (size, axis) = y[:d], self._force
        along = float(v @ axis)
        rest = v - along * axis
        across = float(np.linalg.norm(rest))
        length = float(np.hypot(along, across))
        if across <= 1e-15 * length:  # straight ahead, or straight back: any direction across is as good
            rest = np.eye(d)[int(np.abs(axis).argmin())]
            rest = rest - (rest @ axis) * axis
            across = float(np.linalg.norm(rest)) or 1.0
            ahead = along >= 0
        else:
            ahead = along >= cos(self.angle) * length
        edge = cos(self.angle) * axis + sin(self.angle) * rest / across
        force = v / length if ahead and length else edge
        return np.concatenate([size * force, self.center.torque])

    def _contains(self, load: Array, slack: Array) -> bool:
        d, (size, axis) = self.dimension, self._force
        force, loose = load[:d], float(slack[:d].max())
        turned = np.abs(load[d:] - self.center.torque) <= slack[d:]
        within = np.linalg.norm(force) <= size + loose and force @ axis >= size * cos(self.angle) - loose
        return bool(within and turned.all())

    def _words(self) -> str:
        if self.angle == pi:
            return f"{self.center!r}, its force in every direction"
        return f"{self.center!r}, its force tilted by up to {np.degrees(self.angle):.6g} deg"


@dataclass(frozen=True, eq=False, repr=False)
class _Moved(LoadSet):
    """Another set, moved so that its center is this one's."""

    inner: LoadSet

    @property
    def _by(self) -> Array:
        return self.center.vector - self.inner.center.vector

    @property
    def cover(self) -> Array | None:
        """(m, 3) or (m, 6) loads whose hull holds the set."""
        around = replace(self.inner, factor=self.factor).cover
        return None if around is None else around + self._by

    def _moved(self, center: Wrench) -> LoadSet:
        return replace(self, center=center)

    def _support(self, y: Array) -> Array:
        result: Array = self.inner._support(y) + y @ self._by
        return result

    def _extreme(self, y: Array) -> Array:
        return self.inner._extreme(y) + self._by

    def _contains(self, load: Array, slack: Array) -> bool:
        return self.inner._contains(load - self._by, slack)

    def _words(self) -> str:
        return f"{self.inner._words()}, less the center"


def _wrench(value: Wrench, what: str) -> Wrench:
    if not isinstance(value, Wrench):
        raise InvalidInput(f"{what} must be a Wrench, got {shown(value)}")
    not_huge(value.vector, what)
    return value
