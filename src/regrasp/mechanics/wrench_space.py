"""The sets of Section III: where in wrench space (f_x, f_y, tau) a planar contact can act."""

from dataclasses import dataclass
from math import hypot

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, number
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import torque


@dataclass(frozen=True, eq=False)
class WrenchPlane(ArrayValue):
    """Pi_i: all wrenches (f, r_i x f) of forces at a contact, a plane through the origin of wrench space."""

    contact: Contact

    def __post_init__(self) -> None:
        if self.contact.dimension != 2:
            raise InvalidInput("wrench planes are defined for planar contacts; this one is in space")

    @property
    def normal(self) -> Array:
        """(3,): w lies in the plane when normal . w = 0; (r_y, -r_x, 1), from tau = r_x f_y - r_y f_x."""
        x, y = self.contact.position
        return np.array([y, -x, 1.0])

    def wrench(self, force: ArrayLike) -> Array:
        """(..., 3) wrench of forces (..., 2) at the contact."""
        f = np.asarray(force, dtype=float)
        return np.concatenate([f, torque(self.contact.position, f)], axis=-1)


@dataclass(frozen=True, eq=False)
class WrenchCone(WrenchPlane):
    """S Pi_i: the part of Pi_i with the force inside the friction cone, from an ``apex`` in wrench space.

    ``sign`` -1 gives S Pi_i^-1, the same cone turned about its apex.
    """

    apex: Array = None  # type: ignore[assignment]
    sign: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "apex", array((0, 0, 0) if self.apex is None else self.apex, "apex", (3,)))
        if self.sign not in (1, -1):
            raise InvalidInput(f"sign must be 1 or -1, got {shown(self.sign)}")

    def inverse(self) -> "WrenchCone":
        """S Pi_i^-1, the inverse through the apex."""
        return WrenchCone(self.contact, self.apex, -self.sign)

    def moved(self, apex: ArrayLike) -> "WrenchCone":
        """The same cone with its apex elsewhere: wrenches are free vectors."""
        return WrenchCone(self.contact, np.asarray(apex, dtype=float), self.sign)

    @property
    def edges(self) -> Array:
        """(2, 3) wrenches of unit forces along both edges of the friction cone, sign included."""
        n, mu = self.contact.normal, self.contact.friction
        t = np.array([-n[1], n[0]])
        return self.sign * self.wrench(np.array([n - mu * t, n + mu * t]) / hypot(1, mu))

    def contains(self, point: ArrayLike, tolerance: float = 1e-9) -> bool:
        """Whether a point of wrench space lies on the cone; ``tolerance`` is relative to its distance."""
        w = self.sign * (np.asarray(point, dtype=float) - self.apex)
        n, mu, f = self.contact.normal, self.contact.friction, w[:2]
        slack = tolerance * hypot(*f)
        off_plane = abs(float(self.normal @ w))
        arm = hypot(*self.contact.position)
        tangential, normal = abs(n[0] * f[1] - n[1] * f[0]), float(f @ n)
        return bool(tangential <= mu * normal + slack and off_plane <= slack * arm + tolerance * abs(w[2]))


@dataclass(frozen=True, eq=False)
class IsoTorqueLine(ArrayValue):
    """L_i: the heads of all forces at a contact that make one torque, a line parallel to r_i (Fig. 2)."""

    contact: Contact
    torque: float

    def __post_init__(self) -> None:
        number(self.torque, "torque")
        if not self.contact.position.any():
            raise InvalidInput("a contact at the centre of mass makes no torque and has no iso-torque lines")

    @property
    def distance(self) -> float:
        """d_i, from the contact to the line, positive to the left of r_i [force]: tau_i = |r_i| d_i."""
        return self.torque / hypot(*self.contact.position)

    @property
    def direction(self) -> Array:
        """(2,) unit vector along the line, that of r_i."""
        result: Array = self.contact.position / hypot(*self.contact.position)
        return result

    @property
    def force(self) -> Array:
        """(2,) the smallest force with this torque: its head is the line's point nearest to the contact."""
        u = self.direction
        return self.distance * np.array([-u[1], u[0]])

    @property
    def friction_segment(self) -> Array | None:
        """(2, 2) forces where the line enters and leaves the friction cone, or None if it misses the cone.

        A line that stays in the cone on one side ends at infinity there: that row is infinite.
        """
        n, mu, u = self.contact.normal, self.contact.friction, self.direction
        t = np.array([-n[1], n[0]])
        lo, hi = -np.inf, np.inf
        for edge in (mu * n - t, mu * n + t, n):  # edge . (force + s u) >= 0
            slope, offset = float(edge @ u), float(edge @ self.force)
            if abs(slope) <= 1e-12 * hypot(1, mu):
                if offset < 0:
                    return None
            elif slope > 0:
                lo = max(lo, -offset / slope)
            else:
                hi = min(hi, -offset / slope)
        if lo > hi:
            return None
        return np.array([self.force + s * u if np.isfinite(s) else np.full(2, np.inf) for s in (lo, hi)])


def iso_torque_line(contact: Contact, force: ArrayLike) -> IsoTorqueLine:
    """The line L_i that a force (2,) at a contact has its head on."""
    f = array(force, "force", (2,))
    return IsoTorqueLine(contact, float(torque(contact.position, f)[0]))


@dataclass(frozen=True, eq=False)
class WrenchLoop(ArrayValue):
    """The wrench loop: load and finger wrenches tail to head, closed in equilibrium (Section III-B).

    order: the contacts as the loop visits them after the load; as in the grasp by default.
    """

    state: GraspState
    order: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        names = self.state.grasp.names
        if self.state.grasp.dimension != 2:
            raise InvalidInput("the wrench loop is drawn for planar grasps; this one is in space")
        order = self.order or names
        if sorted(order) != sorted(names):
            raise InvalidInput(f"order must name each of {', '.join(names)} once, got {order}")
        object.__setattr__(self, "order", tuple(order))

    @property
    def vertices(self) -> Array:
        """(n + 2, 3): the origin, the head of the load, then the head of each wrench; last = residual."""
        wrenches = [self.state.wrenches[self.state.grasp.index(name)] for name in self.order]
        return np.cumsum([np.zeros(3), self.state.load.vector, *wrenches], axis=0)

    @property
    def gap(self) -> Array:
        """(3,) from the origin to the last head: G f + w_ext, zero for a closed loop."""
        result: Array = self.vertices[-1]
        return result

    def cones(self) -> tuple[WrenchCone, ...]:
        """The generic wrench loop at this state: each cone where its wrench starts, the last one inverted.

        The last contact's wrench ends at the origin, so its set is S Pi^-1 from the origin.
        """
        heads, grasp = self.vertices, self.state.grasp
        cones = [WrenchCone(grasp[name], heads[i + 1]) for i, name in enumerate(self.order[:-1])]
        return (*cones, WrenchCone(grasp[self.order[-1]], np.zeros(3), -1))
