"""A cost of forces of a user's own."""

from dataclasses import dataclass, field

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import LARGEST, Array, ArrayLike, array, numbers_in
from regrasp.mechanics.grasp import Grasp
from regrasp.planning.states.objectives.known import OBJECTIVES
from regrasp.planning.states.objectives.objective import ConvexObjective


@dataclass(frozen=True, eq=False, repr=False)
class ForceCost(ConvexObjective):
    """The least sum of weights_i |f_i - towards_i|^2 + prices_i . f_i, of a user's own.

    Args:
        name: its word, in messages and files.
        weights: a number or (n,), each at least 0.
        towards: (n, w) forces to stay near [N], zero if not given.
        prices: (n, w) what a force costs in each direction, object frame. n, w are those of the grasps it is
            used for; forces are as the cones measure them, so that a soft finger's torque counts as mu m /
            torsion.

    Raises:
        InvalidInput: For costs that are not convex or bounded by nothing.
    """

    weights: Array = field(default_factory=lambda: np.ones(()))
    towards: Array | None = None
    prices: Array | None = None

    def __init__(
        self,
        name: str = "cost",
        weights: ArrayLike = 1.0,
        towards: ArrayLike | None = None,
        prices: ArrayLike | None = None,
    ) -> None:
        several = numbers_in(weights, "weights must be a number or (n,)").ndim > 0
        given = array(weights, "weights", (None,) if several else ())
        if (given < 0).any() or not given.any():
            raise InvalidInput(f"weights must be at least 0, and one of them above it, got {shown(weights)}")
        heaviest = float(given.max())
        if not 1 / LARGEST <= heaviest <= LARGEST:
            raise InvalidInput(
                f"the largest weight must be from {1 / LARGEST:g} to {LARGEST:g}, got {shown(weights)}; "
                f"only their ratios to one another and to prices count"
            )
        if not isinstance(name, str) or name in OBJECTIVES:
            raise InvalidInput(
                f"name must be a word that is not one of {', '.join(OBJECTIVES)}, got {shown(name)}"
            )
        super().__init__(name, f"least {name}", name, "sum", "-")
        object.__setattr__(self, "weights", given)
        for key, value in (("towards", towards), ("prices", prices)):
            object.__setattr__(self, key, None if value is None else array(value, key, (None, None)))
        if self.towards is not None and abs(self.towards).max(initial=0.0) > LARGEST:
            raise InvalidInput(f"towards must be at most {LARGEST:g} N in size, got {shown(towards)}")
        if self.prices is not None and abs(self.prices).max(initial=0.0) / LARGEST > heaviest:
            raise InvalidInput(
                f"prices must be at most {LARGEST:g} times the largest weight of {heaviest:g}, beside "
                f"which forces cost nothing, got {shown(prices)}"
            )

    def of_contacts(self, forces: Array, grasp: Grasp) -> Array:
        """(..., n) weights_i |f_i - towards_i|^2 + prices_i . f_i.

        Args:
            forces: (..., n, w) as the cones measure them [N].
            grasp: of n contacts.
        """
        self._check(grasp)
        away = forces if self.towards is None else forces - self.towards
        cost: Array = self.weights * (away**2).sum(axis=-1)
        return cost if self.prices is None else cost + (self.prices * forces).sum(axis=-1)

    def squares(self, grasp: Grasp) -> Array:
        """(n,) the weights, the largest one 1.

        Args:
            grasp: of n contacts.
        """
        self._check(grasp)
        return np.broadcast_to(self.weights / self.weights.max(), (len(grasp),))

    def linear(self, grasp: Grasp, unit: float) -> Array | None:
        """(n, w) (prices_i - 2 weights_i towards_i) / (unit times the largest weight).

        Args:
            grasp: of n contacts.
            unit: of the forces in the program [N].
        """
        if self.towards is None and self.prices is None:
            return None
        cost = np.zeros((len(grasp), grasp.width)) if self.prices is None else self.prices
        if self.towards is not None:
            cost = cost - 2 * np.broadcast_to(self.weights, (len(grasp),))[:, None] * self.towards
        return cost / (unit * float(self.weights.max()))

    @property
    def follows_unit(self) -> bool:
        """Whether it has a linear part besides the squares."""
        return self.towards is not None or self.prices is not None

    @property
    def rests(self) -> bool:
        """Whether no forces at all are best where there is no load: with squares alone."""
        return not self.follows_unit

    def scale(self, unit: float) -> float:
        """unit^2 times the largest weight.

        Args:
            unit: of the forces in the program [N].
        """
        return unit**2 * float(self.weights.max())

    def _check(self, grasp: Grasp) -> None:
        if self.weights.ndim and self.weights.shape != (len(grasp),):
            raise InvalidInput(
                f"weights of {self.name!r} must be one number or {len(grasp)}, for {', '.join(grasp.names)} "
                f"which it is asked for, got {self.weights.size}"
            )
        for key, value in (("towards", self.towards), ("prices", self.prices)):
            if value is not None and value.shape != (len(grasp), grasp.width):
                raise InvalidInput(
                    f"{key} of {self.name!r} must have shape ({len(grasp)}, {grasp.width}), for "
                    f"{', '.join(grasp.names)} which it is asked for, got {value.shape}"
                )
