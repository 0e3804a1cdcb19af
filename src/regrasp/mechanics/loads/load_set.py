"""Convex sets of loads: what a grasp may meet, instead of one wrench."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from math import pi
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import (
    Array,
    ArrayLike,
    array,
    instance,
    not_huge,
    number,
    numbers_in,
    read_only,
)
from regrasp.mechanics.loads.bodies import ROUNDING, Body, Cap, Ellipsoid, Hull
from regrasp.mechanics.loads.plain_bodies import body_of, plain_body
from regrasp.mechanics.plain import entries
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench

# The work of loads up to ``LARGEST`` has a square.
_FASTEST = 1e50


@dataclass(frozen=True, eq=False, repr=False)
class LoadSet(ArrayValue):
    """A convex set of loads, center + factor (body - center), told by its support function.

    Make one by ``hull``, ``ball``, ``ellipsoid``, ``tilted`` or ``turned``.

    Args:
        center: a member that ``scaled`` keeps.
        factor: by which deviations from the center are multiplied, 1 unless scaled. Torques are about the
            centre of mass, in the object's frame like the forces.
        body: the set for the factor 1 (``regrasp.mechanics.loads.bodies``).
    """

    center: Wrench
    factor: float
    body: Body

    def __post_init__(self) -> None:
        instance(self.body, "body", Body, "; make a set by LoadSet.hull, .ball or another")

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
        return LoadSet(middle, 1.0, Hull(points))

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
        axes = not_huge(read_only(np.diag(radii)), "radii of a ball")
        return LoadSet(middle, 1.0, Ellipsoid(middle.vector, axes))

    @staticmethod
    def ellipsoid(center: Wrench, axes: ArrayLike) -> "LoadSet":
        """The loads center + A z with |z| <= 1.

        Args:
            center: the load in the middle [N, N m].
            axes: A, (3, k) or (6, k), of half axes, [N] and [N m].
        """
        middle = _wrench(center, "center")
        half = not_huge(array(axes, "axes", (middle.vector.size, None)), "axes")
        return LoadSet(middle, 1.0, Ellipsoid(middle.vector, half))

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
        whole = _wrench(load, "load")
        return LoadSet(whole, 1.0, Cap(whole.force, whole.torque, most))

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
        return self._around(self.body.vertices)

    @property
    def half_axes(self) -> Array | None:
        """Of a ball or an ellipsoid the A of center + A z, |z| <= 1, scaled: (3, k) or (6, k); else None."""
        axes = self.body.half_axes
        return None if axes is None else self.factor * axes

    @property
    def cover(self) -> Array | None:
        """(m, 3) or (m, 6) loads whose hull holds the set, None for ellipsoids.

        A hull's vertices; around a tilt a polytope that is larger by 1e-3 at most in the plane, by 0.03 in
        space.
        """
        return self._around(self.body.cover)

    def _around(self, loads: Array | None) -> Array | None:
        middle = self.center.vector
        return None if loads is None else middle + self.factor * (loads - middle)

    @property
    def deviations(self) -> "LoadSet":
        """The same set moved so that its center is no load: what may come on top of the center."""
        none = np.zeros_like(self.center.vector)
        return LoadSet(Wrench.from_vector(none), self.factor, self.body.moved(none - self.center.vector))

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
        result: Array = middle + self.factor * (self.body.support(y) - middle)
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
        return Wrench.from_vector(middle + self.factor * (self.body.extreme(y) - middle))

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
        slack = ROUNDING * np.maximum(self.factor * sizes, np.abs(self.center.vector))
        if (self.factor * sizes <= slack).all():  # a point, but for rounding
            return bool((np.abs(away) <= slack).all())
        return self.body.contains(self.center.vector + away / self.factor, slack / self.factor)

    def _size(self, part: slice) -> float:
        """The largest deviation of the body's forces, or torques, along an axis."""
        axes = np.eye(self.center.vector.size)[part]
        middle = axes @ self.center.vector
        return float(max((self.body.support(axes) - middle).max(), (self.body.support(-axes) + middle).max()))

    def _twist(self, twist: ArrayLike) -> Array:
        y = numbers_in(twist, f"twist must have {self.center.vector.size} numbers")
        if not y.ndim or y.shape[-1] != self.center.vector.size or not np.isfinite(y).all():
            raise InvalidInput(
                f"twist must have {self.center.vector.size} finite numbers, got {shown(twist)}"
            )
        return not_huge(y, "twist", _FASTEST)

    def to_dict(self) -> dict[str, Any]:
        """The set as plain data, which JSON can hold; ``from_dict`` gives back the equal set."""
        return {"center": self.center.vector.tolist(), "factor": self.factor, "body": plain_body(self.body)}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "LoadSet":
        """The set of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys, shapes and numbers.
        """
        given = entries(data, "a load set", ("center", "factor", "body"))
        center = _wrench(Wrench.from_vector(given["center"]), "center")
        body = body_of(given["body"], center.vector.size)
        return cls(center, 1.0, body).scaled(given["factor"])

    def __str__(self) -> str:
        times = "" if self.factor == 1 else f", deviations times {self.factor:.6g}"
        return f"{self.body.words(self.center)}{times}"

    def __repr__(self) -> str:
        return f"LoadSet({self})"


def _wrench(value: Wrench, what: str) -> Wrench:
    if not isinstance(value, Wrench):
        raise InvalidInput(f"{what} must be a Wrench, got {shown(value)}")
    not_huge(value.vector, what)
    return value
