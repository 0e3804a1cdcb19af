"""Whether fingers anywhere on an outline can regrasp, as a value."""

from dataclasses import dataclass

from regrasp.display import Pictured
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.planning.anywhere.cut import MOST_BOXES
from regrasp.planning.anywhere.hold_map import TIE
from regrasp.planning.anywhere.walk import MOST_HOLDS
from regrasp.plans.outline_cut import OutlineCut


@dataclass(frozen=True, eq=False, repr=False)
class OutlineRegrasps(ArrayValue, Pictured):
    """The map of all holds of two fingers on an outline at one orientation, and whether a regrasp exists.

    Args:
        outline: a polygon.
        start: three contacts.
        goal: three contacts.
        load: seen from the object [N].
        friction: of all fingers [-].
        exists: whether any regrasp leads from start to goal; None where that is open: places or regions
            within 1e-9 of a side or on a boundary, more than 5,000 holds on the way, or more than 20,000
            boxes of a proof.
        regions: convex polygons (m, 2) in the arc lengths of two fingers [m]: all holds, but for those that
            are only a line on the map, where one finger carries the whole load. The mirror image of each,
            fingers exchanged, holds too.
        components: of each region, a number; regrasps lead from a region to all others of its component.
        walk: (h, 2) arc lengths of the holds of a regrasp, each sharing one with the next [m]; empty without.
        certificate: the proof that none exists, for ``verify``; None without.
    """

    outline: Outline
    start: Grasp
    goal: Grasp
    load: Wrench
    friction: float
    exists: bool | None
    regions: tuple[Array, ...]
    components: tuple[int, ...]
    walk: Array
    certificate: OutlineCut | None

    _drawn_by = "regrasp.plots.regrasps.outline_map:outline_map_png"

    def __repr__(self) -> str:
        return (
            f"OutlineRegrasps(exists={self.exists}, {len(self.regions)} regions, "
            f"{len(set(self.components))} components)"
        )

    def __str__(self) -> str:
        if self.exists is None:
            return (
                f"open: start or goal is within {TIE:g} of where holds end, or a way takes more than "
                f"{MOST_HOLDS} holds, or a proof more than {MOST_BOXES} boxes"
            )
        if self.exists:
            return f"a regrasp exists on this outline at this orientation, through {len(self.walk)} holds"
        return f"no regrasp exists on this outline at this orientation: {self.certificate}"
