"""What a change of fingers starts from, as asked: grasp, loads at both ends, criteria and demands."""

from dataclasses import replace
from typing import NamedTuple, Self, cast

from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.ends import Change, End, shared
from regrasp.planning.changes.given_ends import grasp_and_load, kept_limits, limited
from regrasp.planning.changes.joining import Demands, LoadFunction, joined, series_and_clock
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import ChangeOptions, criteria_of
from regrasp.plans.loads import LoadSeries
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Transition


class Asked(NamedTuple):
    """The arguments of a verb, read once: the grasp it starts with, its loads, and what it must keep to.

    state: the start, where it is one. series: the load where it varies in time. clock: None for the shortest.
    """

    grasp: Grasp
    first: Wrench
    last: Wrench
    state: GraspState | None
    criteria: Criteria
    demands: Demands
    series: LoadSeries | None
    clock: TimeScaling | None
    options: ChangeOptions

    @classmethod
    def of(
        cls,
        start: GraspState | Grasp,
        load: Wrench | LoadSeries | LoadFunction | None,
        objective: str | Objective | Criteria,
        options: ChangeOptions,
        **idle: float | None,
    ) -> Self:
        """What a call asks; ``idle`` are the times of ``Demands``."""
        options = kept_limits(start, objective, options)
        criteria = criteria_of(objective, options)
        demands = Demands.of(options, **idle)
        series, clock = series_and_clock(load, options, demands)
        given = series(0.0) if series is not None else cast(Wrench | None, load)
        grasp, first = grasp_and_load(start, given)
        last = series(series.duration) if series is not None else first
        state = start if isinstance(start, GraspState) else None
        return cls(grasp, first, last, state, criteria, demands, series, clock, options)

    def joined(self, grasp: Grasp, start: End, end: End) -> Transition:
        """The transition between two ends of all contacts in play."""
        criteria = shared(self.criteria, start, end)
        change = Change.between(limited(grasp, criteria.max_force), start, end, self.options)
        if criteria.withstands:
            record = replace(change.record, withstands=criteria.withstood)
            change = change._replace(record=record)
        return joined(change, self.clock, self.series, criteria, self.demands)
