"""Bodies of load sets, a class for each kind: their support functions, extreme loads and members."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.loads.caps import around_cap
from regrasp.mechanics.loads.nearest import nearest_mean
from regrasp.mechanics.value import ArrayValue, numbers
from regrasp.mechanics.wrench import Wrench

ROUNDING = 1e-9
"""A member may lie this fraction of the set's size outside: rounding of whoever computed it."""


class Body(ArrayValue, ABC):
    """A convex set of loads (3,) or (6,), told by its support function."""

    @property
    def vertices(self) -> Array | None:
        """(m, 3) or (m, 6) loads that span it; None of round ones."""
        return None

    @property
    def half_axes(self) -> Array | None:
        """(3, k) or (6, k) of an ellipsoid; None of others."""
        return None

    @property
    def cover(self) -> Array | None:
        """(m, 3) or (m, 6) loads whose hull holds it; None for ellipsoids."""
        return self.vertices

    @abstractmethod
    def support(self, y: Array) -> Array:
        """(...) the most work of a member along twists (..., 3) or (..., 6)."""

    @abstractmethod
    def extreme(self, y: Array) -> Array:
        """A member that does the most work along a twist."""

    @abstractmethod
    def contains(self, load: Array, slack: Array) -> bool:
        """Whether a load is a member, up to ``slack`` for each of its numbers."""

    def moved(self, by: Array) -> "Body":
        """All members with ``by`` added."""
        return Moved(self, read_only(by))

    @abstractmethod
    def words(self, center: Wrench) -> str:
        """In words, around the center of its set."""


@dataclass(frozen=True, eq=False)
class Hull(Body):
    """The convex hull of ``points`` (m, 3) or (m, 6)."""

    points: Array

    @property
    def vertices(self) -> Array:
        """The loads that span it; some may lie inside."""
        return self.points

    def moved(self, by: Array) -> Body:
        """All points with ``by`` added."""
        return Hull(read_only(self.points + by))

    def support(self, y: Array) -> Array:
        """That of the best point."""
        result: Array = (y @ self.points.T).max(axis=-1)
        return result

    def extreme(self, y: Array) -> Array:
        """The best point."""
        chosen: Array = self.points[int((self.points @ y).argmax())]
        return chosen

    def contains(self, load: Array, slack: Array) -> bool:
        """Whether the nearest mean of the points is no further than ``slack``."""
        unit = np.where(slack > 0, slack, 1.0) / ROUNDING
        gap = np.abs(nearest_mean(self.points / unit, load / unit)) * unit
        return bool((gap <= slack).all())

    def words(self, center: Wrench) -> str:
        """How many loads."""
        return f"hull of {len(self.points)} loads around {center!r}"


@dataclass(frozen=True, eq=False)
class Ellipsoid(Body):
    """middle + A z with |z| <= 1, A = ``axes`` (3, k) or (6, k)."""

    middle: Array
    axes: Array

    @property
    def half_axes(self) -> Array:
        """A."""
        return self.axes

    def moved(self, by: Array) -> Body:
        """The same around another middle."""
        return Ellipsoid(read_only(self.middle + by), self.axes)

    def support(self, y: Array) -> Array:
        """The work of the middle, and |A^T y|."""
        result: Array = y @ self.middle + np.linalg.norm(y @ self.axes, axis=-1)
        return result

    def extreme(self, y: Array) -> Array:
        """The middle + A A^T y / |A^T y|."""
        z = y @ self.axes
        length = float(np.linalg.norm(z))
        result: Array = self.middle + (self.axes @ z / length if length else 0.0)
        return result

    def contains(self, load: Array, slack: Array) -> bool:
        """Whether the least z that comes near enough is no longer than 1."""
        unit = np.where(slack > 0, slack, 1.0)[:, None] / ROUNDING
        away = (load - self.middle)[:, None] / unit
        z = np.linalg.lstsq(self.axes / unit, away, rcond=1e-12)[0]
        off = np.abs(self.axes / unit @ z - away).max()
        return bool(off <= ROUNDING and np.linalg.norm(z) <= 1 + ROUNDING)

    def words(self, center: Wrench) -> str:
        """How far it reaches."""
        half = np.linalg.norm(self.axes, axis=1)
        return f"ellipsoid around {center!r}, reaching {numbers(half)} along the axes"


@dataclass(frozen=True, eq=False)
class Cap(Body):
    """The hull of a cap of a circle or sphere: {|f| <= m, f . a >= m cos(angle)}, m a = ``force``.

    The torque is the same for all members.
    """

    force: Array
    torque: Array
    angle: float

    @property
    def cover(self) -> Array:
        """Tangents of the cap meet in them."""
        size, axis = self._polar
        forces = size * around_cap(axis, self.angle) if size else np.zeros((1, axis.size))
        return np.hstack([forces, np.broadcast_to(self.torque, (len(forces), self.torque.size))])

    @property
    def _polar(self) -> tuple[float, Array]:
        size = float(np.linalg.norm(self.force))
        return size, (self.force / size if size else self.force)

    def support(self, y: Array) -> Array:
        """Of the sphere where y points into the cap, else of its edge."""
        d = self.force.size
        v, (size, axis) = y[..., :d], self._polar
        along = v @ axis
        across = np.linalg.norm(v - along[..., None] * axis, axis=-1)
        inside = along >= cos(self.angle) * np.hypot(along, across)  # v itself points into the cap
        edge = cos(self.angle) * along + sin(self.angle) * across
        result: Array = size * np.where(inside, np.hypot(along, across), edge) + y[..., d:] @ self.torque
        return result

    def extreme(self, y: Array) -> Array:
        """On the sphere along y, or on the edge."""
        d = self.force.size
        v, (size, axis) = y[:d], self._polar
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
        return np.concatenate([size * force, self.torque])

    def contains(self, load: Array, slack: Array) -> bool:
        """Whether the force is in the sphere and beyond the plane of the edge, and the torque the same."""
        d, (size, axis) = self.force.size, self._polar
        force, loose = load[:d], float(slack[:d].max())
        turned = np.abs(load[d:] - self.torque) <= slack[d:]
        within = np.linalg.norm(force) <= size + loose and force @ axis >= size * cos(self.angle) - loose
        return bool(within and turned.all())

    def words(self, center: Wrench) -> str:
        """How far it is tilted."""
        if self.angle == pi:
            return f"{center!r}, its force in every direction"
        return f"{center!r}, its force tilted by up to {np.degrees(self.angle):.6g} deg"


@dataclass(frozen=True, eq=False)
class Moved(Body):
    """Another body with ``by`` (3,) or (6,) added to all members."""

    inner: Body
    by: Array

    @property
    def cover(self) -> Array | None:
        """That of the body, moved."""
        around = self.inner.cover
        return None if around is None else around + self.by

    def moved(self, by: Array) -> Body:
        """Further moved."""
        return Moved(self.inner, read_only(self.by + by))

    def support(self, y: Array) -> Array:
        """That of the body, and the work of what was added."""
        result: Array = self.inner.support(y) + y @ self.by
        return result

    def extreme(self, y: Array) -> Array:
        """That of the body, moved."""
        return self.inner.extreme(y) + self.by

    def contains(self, load: Array, slack: Array) -> bool:
        """Whether the body has the load moved back."""
        return self.inner.contains(load - self.by, slack)

    def words(self, center: Wrench) -> str:
        """Those of the body."""
        return f"{self.inner.words(Wrench.from_vector(center.vector - self.by))}, less the center"
