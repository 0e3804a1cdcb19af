"""What a map of placements holds: values over the places of one or two fingers."""

from dataclasses import dataclass

import numpy as np

from regrasp.mechanics.checks import Array, Flags
from regrasp.mechanics.value import ArrayValue
from regrasp.outline.outline import Outline
from regrasp.planning.placement.maps.rings import Rings


@dataclass(frozen=True, eq=False, repr=False)
class PlacementMap(ArrayValue):
    """The value of an objective where fingers are at places of an outline.

    Args:
        shape: the outline.
        objective: its word.
        fixed: (f,) arc lengths of the fingers that stay [m].
        places: (m,) arc lengths of the others [m].
        values: (m,) for one finger, (m, m) for two, the same both ways; NaN where the loads are not held.
        best: (m,) the best value with one of the fingers at a place; NaN for none.
        more: whether more is better.
        allowed: (m,) or (m, m) where fingers may be at all; not two at one place, for one.
        in_holes: whether places are those of holes, too, whose arc lengths go on after the outline's.
    """

    shape: Outline
    objective: str
    fixed: Array
    places: Array
    values: Array
    best: Array
    more: bool
    allowed: Flags
    in_holes: bool = False

    @property
    def at(self) -> Array:
        """(1,) or (2,) arc lengths of the best of the placements [m]; empty if none holds."""
        if np.isnan(self.best).all():
            return np.zeros(0)
        sought = np.nanargmax(self.values) if self.more else np.nanargmin(self.values)
        return self.places[np.array(np.unravel_index(sought, self.values.shape))]

    @property
    def share(self) -> float:
        """The share of the placements that are allowed that hold the loads [-]; 0 of none."""
        return float((~np.isnan(self.values)).sum() / max(self.allowed.sum(), 1))

    @property
    def rings(self) -> Rings:
        """The closed curves that arc lengths are of."""
        return Rings(self.shape, self.in_holes)

    def __repr__(self) -> str:
        return (
            f"PlacementMap({self.objective} of {self.values.ndim} beside {len(self.fixed)}, "
            f"{len(self.places)} places, {self.share:.0%} hold)"
        )
