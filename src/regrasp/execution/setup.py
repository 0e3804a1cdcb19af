"""What a simulation adds to a plan: the body, the hand's controller, and errors on purpose."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, function, number
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.motions.value import Motions
from regrasp.outline.outline import Outline

_POSITIVE = (
    "mass", "gravity", "stiffness", "damping", "finger_mass", "tip_radius", "timestep", "settle", "hold",
    "move_time",
)  # fmt: skip


@dataclass(frozen=True, eq=False, kw_only=True)
class Setup(ArrayValue):
    """The body, the hand and its errors. What is not given follows from the plan's own forces and lengths.

    shape: an ``Outline`` or a ``Mesh``, from which the moments of inertia come; without it those of a disc
    or a ball that reaches to the farthest contact.
    mass: [N s^2/m]; by default the load's force over ``gravity``, 9.81 m/s^2 (981 for plans in centimetres).
    stiffness, damping: of every finger against its set-point [N/m, N s/m]; by default four times the largest
    force over the size of the grasp, and 0.6 of the damping at which the object on one finger never swings.
    finger_mass: what moves with a tip; an eighth of the mass by default.
    tip_radius: of the spheres that touch [m]; a sixteenth of the size by default.
    rolling: whether tips keep their orientation in the world, and so roll on an object that turns; otherwise
    they turn along with it.
    friction: the true coefficient, of all contacts or (n,) of each; the plan's by default.
    contact_errors: (n, d) where fingers touch less where the plan says [m], of which the part along the
    surface counts; n are all contacts of the plan in the order of their first use.
    delays: (k,) by which the clock of each finger is late [s].
    disturbance: a load, as a function of the time of the run [s], on top of the plan's, in the world frame.
    settle, hold, move_time: before the plan, after it, and for fingers that change places [s].
    motions: the ways of free fingers, as ``plan_motions`` has them for this plan, with its radius of tips;
    without them fingers fly over what is between, without touching it.
    timestep: of the simulation [s]. Longer steps than the default are refused: contacts then creep.
    """

    shape: Outline | Mesh | None = None
    mass: float | None = None
    gravity: float = 9.81
    stiffness: float | None = None
    damping: float | None = None
    finger_mass: float | None = None
    tip_radius: float | None = None
    rolling: bool = False
    friction: float | Array | None = None
    contact_errors: Array | None = None
    delays: Array | None = None
    disturbance: Callable[[float], Wrench] | None = None
    settle: float | None = None
    hold: float | None = None
    move_time: float | None = None
    motions: Motions | None = None
    timestep: float | None = None

    def __post_init__(self) -> None:
        for name in _POSITIVE:
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, number(value, name, above=0))
        if self.shape is not None and not isinstance(self.shape, (Outline, Mesh)):
            raise InvalidInput(f"shape must be an Outline or a Mesh, got {type(self.shape).__name__}")
        if self.motions is not None and (self.contact_errors is not None or self.tip_radius is not None):
            raise InvalidInput(
                "motions say where tips touch and their radius: leave contact_errors and tip_radius out"
            )
        if self.disturbance is not None:
            function(self.disturbance, "disturbance", "a function of time that returns a Wrench")
        if self.contact_errors is not None:
            errors = array(self.contact_errors, "contact_errors", (None, None))
            object.__setattr__(self, "contact_errors", errors)
        if self.delays is not None:
            delays = array(self.delays, "delays", (None,))
            if (delays < 0).any():
                raise InvalidInput(f"delays must be at least 0, got {shown(self.delays)}")
            object.__setattr__(self, "delays", delays)
        if self.friction is not None:
            object.__setattr__(self, "friction", _friction(self.friction))

    def disturbed(self, t: float, dimension: int) -> Wrench:
        """The disturbance at a time [s]."""
        assert self.disturbance is not None
        wrench = self.disturbance(t)
        if not isinstance(wrench, Wrench) or wrench.dimension != dimension:
            raise InvalidInput(
                f"disturbance must return a Wrench of the plan's dimension, at t = {t:g} it returned "
                f"{shown(wrench)}"
            )
        return wrench

    def inertia(self, mass: float, size: float, dimension: int) -> Array:
        """(3, 3) about the centre of mass; in the plane only the last number counts [N m s^2]."""
        if isinstance(self.shape, Outline):
            if dimension != 2:
                raise InvalidInput("the shape of a plan in space is a Mesh, got an Outline")
            return np.eye(3) * mass * self.shape.inertia / self.shape.area
        if isinstance(self.shape, Mesh):
            if dimension != 3:
                raise InvalidInput("the shape of a planar plan is an Outline, got a Mesh")
            return mass * self.shape.inertia / self.shape.volume
        return np.eye(3) * mass * size**2 * (0.5 if dimension == 2 else 0.4)


def _friction(value: Any) -> float | Array:
    given: ArrayLike = value
    if np.ndim(given) == 0:
        return number(value, "friction", least=0)
    values = array(given, "friction", (None,))
    if (values < 0).any():
        raise InvalidInput(f"friction must be at least 0, got {shown(value)}")
    return values
