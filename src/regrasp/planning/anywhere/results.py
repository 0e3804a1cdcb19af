"""Whether fingers anywhere on an outline can regrasp, as a value."""

from dataclasses import dataclass
from math import atan, cos

import numpy as np

from regrasp.display import Pictured
from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import RESERVE
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.planning.anywhere.cut import MOST_BOXES
from regrasp.planning.anywhere.hold_map import MOST_LINKS, MOST_REGIONS, TIE
from regrasp.planning.anywhere.limits import PARTS
from regrasp.planning.anywhere.walk import MOST_HOLDS
from regrasp.planning.states.criteria import PEAK_RATIO
from regrasp.planning.states.objectives import Objective
from regrasp.plans.outline_cut import OutlineCut, limits_in_words
from regrasp.plans.regrasp_plan import RegraspPlan


@dataclass(frozen=True, eq=False, repr=False)
class OutlineRegrasps(ArrayValue, Pictured):
    """The map of holds of two fingers on an outline, and whether a regrasp exists.

    Args:
        outline: a polygon.
        start: three contacts.
        goal: three contacts.
        load: seen from the object [N].
        friction: of all fingers [-].
        exists: whether any regrasp leads from start to goal; None where that is open: places or regions
            within 1e-9 of a side or on a boundary, more than 5,000 holds on the way, more than 20,000 boxes
            of a proof, more than 20,000 regions, or two million pairs of them that overlap.
        regions: convex polygons (m, 2) in the arc lengths of two fingers [m]: all holds, but for those that
            are only a line on the map, where one finger carries the whole load. The mirror image of each,
            fingers exchanged, holds too. Where the object turns those of several orientations.
        components: of each region, a number; regrasps lead from a region to all others of its component.
        walk: (h, 2) arc lengths of the holds of a regrasp, each sharing one with the next [m]; empty without.
        certificate: the proof that none exists, for ``verify``; None without.
        angles: (h,) of the object in the holds of the walk [rad].
        exchanges: the fewest exchanges of a finger that any walk has, but for near ties, and those of this
            one; None without a walk. Where the object turns, of walks at the orientations looked at.
        turns: the least and the largest angle of the object [rad].
        min_normal: with which both fingers of every hold push at the least, and all three at both ends [N].
        max_force: limit on the force of every finger [N]; None for none. With one the regions lie within all
            holds, by up to the fraction 1 - cos(atan(friction) / 16) of the limit.
        goal_orientation: the object's angle in the end [rad].
        forbidden: (k, 2) arc lengths where arcs begin and end within which no finger may touch [m].
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
    angles: Array
    exchanges: tuple[int, int] | None
    turns: tuple[float, float]
    min_normal: float = 0.0
    max_force: float | None = None
    goal_orientation: float = 0.0
    forbidden: Array = ()  # type: ignore[assignment]

    _drawn_by = "regrasp.plots.regrasps.outline_map:outline_map_png"

    def plan(
        self,
        objective: str | Objective = "angle",
        *,
        states: str = "each",
        max_turn: float | None = None,
        peak_ratio: float = PEAK_RATIO,
        reserve: float = RESERVE,
        step_duration: float = 1.0,
    ) -> RegraspPlan:
        """The regrasp of as few exchanges as the walk, and of these of the widest margin, anywhere.

        ``verify`` judges it like any other; places sampled on the outline may all miss it. Its holds are
        those of the walk, or of one of as many exchanges at places where friction cones may be narrowed by
        the most, to a thousandth of them, without regard to ``peak_ratio``. Under a force limit a walk that
        turns stays as it is.

        Args:
            objective: as of ``RegraspProblem``.
            states: as of ``RegraspProblem``.
            max_turn: of one step [rad]; what turns between two holds is one step if not given.
            peak_ratio: as of ``RegraspProblem`` [-].
            reserve: as of ``RegraspProblem`` [-].
            step_duration: as of ``RegraspProblem`` [s].

        Raises:
            Infeasible: Without a walk, with the proof as ``certificate`` where there is one; or where what is
                kept in reserve, or a smaller ``max_turn``, leaves a state on it no forces.
        """
        from regrasp.planning.anywhere.planned import planned_anywhere

        if not self.exists:
            raise Infeasible(f"there is no walk to plan along: {self}", self.certificate)
        options = {
            "objective": objective,
            "states": states,
            "max_turn": max_turn,
            "peak_ratio": peak_ratio,
            "reserve": reserve,
            "step_duration": step_duration,
        }
        return planned_anywhere(self, options)

    def __repr__(self) -> str:
        return (
            f"OutlineRegrasps(exists={self.exists}, {len(self.regions)} regions, "
            f"{len(set(self.components))} components)"
        )

    def __str__(self) -> str:
        lo, hi = np.degrees(self.turns)
        at = "at this orientation" if lo == hi else f"while the object turns within {lo:.4g} to {hi:.4g} deg"
        if self.exists is None:
            return (
                f"open: start or goal is within {TIE:g} of where holds end, or a way takes more than "
                f"{MOST_HOLDS:,} holds, a proof more than {MOST_BOXES:,} boxes, or the map has more than "
                f"{MOST_REGIONS:,} regions, or {MOST_LINKS:,} pairs of them that overlap" + self._nearly()
            )
        at += limits_in_words(self.min_normal, self.max_force)
        if self.exists:
            least, most = self.exchanges or (0, 0)
            count = f"{most} exchanges" if least == most else f"{most} exchanges, {least} at the least"
            return f"a regrasp exists on this outline {at}, through {len(self.walk)} holds by {count}"
        return f"no regrasp exists on this outline {at}: {self.certificate}"

    def _nearly(self) -> str:
        """What else is open with a force limit."""
        if self.max_force is None:
            return ""
        turning = (
            ", or a walk turns farther than its forces leave room for"
            if self.turns[0] < self.turns[1]
            else ""
        )
        lost = 1 - cos(atan(self.friction) / PARTS[-1])
        return (
            f", or it takes a force limit known within {100 * lost:.2g} % by {PARTS[-1]} tangents" + turning
        )
