"""From one end to the other: Eq. 1-3 where that serves, else a path program."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, choice, limits, number, whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.ends import Change
from regrasp.planning.changes.given_ends import scaling_of
from regrasp.planning.changes.lost_loads import refuse_lost, refuse_lost_load
from regrasp.planning.states.choosing import DEFAULT_BACKEND, check_facets
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.options import INSTANTS, ChangeOptions, PlanOptions
from regrasp.planning.states.withstanding.demand import Demand
from regrasp.plans.loads import MOST_INSTANTS, LoadSeries
from regrasp.plans.sampled import SampledPath
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Transition

LoadFunction = Callable[[float], Wrench]
PathObjective = Literal["change", "effort", "force", "peak"]
PATH_OBJECTIVES = get_args(PathObjective)

# Where T stands still the least change still moves with time, at this fraction of the average pace.
_LEAST_PACE = 1e-6
_SQUEEZED = 0.3
"""Of the largest force at the ends: a unit of programs in which fingers squeeze far more than the load."""


@dataclass(frozen=True)
class Demands:
    """What a path must keep to besides equilibrium and cones; see ``plan_removal``."""

    rate_limit: ArrayLike | None = None
    min_normal: float | None = None
    path_objective: str | None = None
    idle_from: float | None = None
    idle_until: float | None = None
    instants: int = INSTANTS
    method: str = "auto"
    facets: int | None = None

    def __post_init__(self) -> None:
        if self.min_normal is not None:
            number(self.min_normal, "min_normal", least=0)
        if self.path_objective is not None:
            choice(self.path_objective, "path_objective", PATH_OBJECTIVES)
        whole(self.instants, "instants", least=3, most=MOST_INSTANTS)
        check_facets(self.facets)
        for name in ("idle_from", "idle_until"):
            if getattr(self, name) is not None:
                number(getattr(self, name), name, least=0)

    @classmethod
    def of(cls, options: ChangeOptions, **idle: float | None) -> "Demands":
        """The demands of a call; one value for the many calls without any, which take microseconds."""
        given: dict[str, Any] = {name: time for name, time in idle.items() if time is not None}
        if options:
            given |= {name: value for name, value in options.items() if name in _DEMANDS}
        return cls(**given) if given else _NONE

    @property
    def bends(self) -> bool:
        """Whether anything is asked for that a straight path may not keep."""
        return not (
            self.rate_limit is None
            and self.min_normal is None
            and self.path_objective is None
            and self.idle_from is None
            and self.idle_until is None
        )

    @property
    def idle_times(self) -> tuple[float, ...]:
        """When fingers are to become idle, or to start work [s]."""
        return tuple(time for time in (self.idle_from, self.idle_until) if time is not None)

    def rates(self, grasp: Grasp) -> Array:
        """(n,) force-rate limits, infinite for none [N/s]."""
        if self.rate_limit is None:
            return np.full(len(grasp), inf)
        return limits(self.rate_limit, "rate_limit", len(grasp))


_NONE = Demands()
_DEMANDS = frozenset(("rate_limit", "min_normal", "path_objective", "instants", "method", "facets"))


def joined(
    change: Change,
    scaling: TimeScaling | None,
    load: LoadSeries | None,
    criteria: Criteria,
    demands: Demands,
) -> Transition:
    """The transition between two states: straight where that keeps every demand, else through instants.

    scaling: None for the shortest one under the rate limit. load: None where it is constant.
    """
    if criteria.presses and demands.min_normal is None:
        demands = replace(demands, min_normal=criteria.least_normal)
    start, end, record = change.start, change.end, change.record
    grasp = start.grasp
    leaving = tuple([str(grasp.contacts[i].name) for i in change.leaving])
    arriving = tuple([str(grasp.contacts[i].name) for i in change.arriving])
    is_straight = demands is _NONE or not demands.bends
    if load is None and scaling is not None and is_straight:  # the usual case, in microseconds
        return refuse_lost_load(Transition(start, end, scaling, record, leaving, arriving))
    rates, least = demands.rates(grasp), np.full(len(grasp), demands.min_normal or 0.0)
    stays = ~np.isin(np.arange(len(grasp)), (*change.leaving, *change.arriving))
    least[~stays] = 0.0
    refuse_weak_ends(start, end, least)
    has_rates = bool((rates < inf).any())
    promised = tuple(rates.tolist()) if has_rates else ()
    record = replace(record, least_normals=tuple(least.tolist()) if least.any() else (), rate_limits=promised)
    if load is None:
        plan = Transition(start, end, scaling or TimeScaling.spline(1.0), record, leaving, arriving)
        if scaling is None:
            plan = plan.fastest(rates)
        fast_enough = not has_rates or scaling is None or bool((plan.steepest <= rates * (1 + 1e-13)).all())
        if demands.path_objective is None and not demands.idle_times and fast_enough:
            return refuse_lost_load(plan)
        load = LoadSeries([0.0, plan.duration], [start.load.vector] * 2)
        scaling = plan.scaling
    assert scaling is not None  # a load in time brings its clock
    if demands.method == "closed-form":
        raise InvalidInput(
            "Eq. 1-3 holds under a constant load, and no straight path keeps these demands; use method='auto'"
        )
    objective = demands.path_objective or "change"
    if objective in ("effort", "peak") and not has_rates:
        raise InvalidInput(
            f"path_objective {shown(objective)} would jump at both ends; give rate_limit as well"
        )
    backend = DEFAULT_BACKEND if demands.method == "auto" else demands.method
    ends = load.vectors[[0, -1]]
    refuse_lost(grasp, np.stack([start.forces, end.forces]), ends)  # before a program with numbers far apart
    path, method = _path(change, scaling, load, rates, least, stays, criteria, demands, backend)
    record = replace(record, path=method, path_objective=objective)
    return refuse_lost_load(Transition(start, end, scaling, record, leaving, arriving, path))


def _path(
    change: Change,
    scaling: TimeScaling,
    load: LoadSeries,
    rates: Array,
    least: Array,
    stays: NDArray[np.bool_],
    criteria: Criteria,
    demands: Demands,
    backend: str,
) -> tuple[SampledPath, str]:
    from regrasp.planning.changes.path_program import PathTask
    from regrasp.planning.changes.path_search import planned_path

    start, end = change.start, change.end
    grasp = start.grasp
    for idle in demands.idle_times:
        if not (1e-6 < idle / scaling.duration < 1 - 1e-6):
            raise InvalidInput(
                f"the finger's idle time must lie inside (0, {scaling.duration:g}) s, got {idle:g}"
            )
    demand = None
    if criteria.withstands:
        moving = {*change.leaving, *change.arriving}
        demand = criteria.of_some(grasp, range(len(grasp)), moving).demand(grasp)
    fine = load.refined(demands.instants, *demands.idle_times)
    times = fine.times
    active = np.ones((times.size, len(grasp)), dtype=bool)
    gone = times >= (times[-1] if demands.idle_from is None else demands.idle_from)
    away = times <= (times[0] if demands.idle_until is None else demands.idle_until)
    for i in change.leaving:
        active[gone, i] = False
    for i in change.arriving:
        active[away, i] = False
    steps = np.maximum(-np.diff(scaling(times)), _LEAST_PACE * np.diff(times) / scaling.duration)
    phases = np.append(0.0, np.cumsum(steps) / steps.sum())
    size = grasp.size or 1.0
    d = grasp.dimension
    largest = max(float(abs(fine.vectors[:, :d]).max()), float(abs(fine.vectors[:, d:]).max()) / size)
    task = PathTask(
        grasp=grasp,
        times=times,
        loads=fine.vectors,
        start=grasp.cones.measured(start.forces),
        end=grasp.cones.measured(end.forces),
        active=active,
        phases=phases,
        frictions=np.array(criteria.frictions(grasp)),
        limits=np.array(criteria.limits(grasp)),
        rates=rates,
        least_normals=least,
        stays=stays,
        unit=max(largest, _SQUEEZED * float(max(start.magnitudes.max(), end.magnitudes.max()))) or 1.0,
        set_back=None if demand is None or d == 3 else demand.set_back(),
        row_bounds=None if grasp.limit_rows is None else grasp.limit_rows.bounds,
    )
    if demand is not None:  # what limits keep for the set; ends may know better, and all of it is checked
        ends = np.maximum(*(np.linalg.norm(f, axis=1) for f in (task.start, task.end)))
        task = replace(
            task,
            limits=np.maximum(task.limits - demand.largest_changes(), ends),
            row_bounds=demand.row_bounds(),
        )
    found = planned_path(task, demands.path_objective or "change", criteria, backend, demands.facets)
    forces = grasp.cones.forces(found.forces)
    forces[0], forces[-1] = start.forces, end.forces
    if demand is not None:
        refuse_giving_path(demand, forces, times, np.array(criteria.limits(grasp)))
    return SampledPath(times, forces, fine.vectors), found.method


def refuse_giving_path(demand: Demand, forces: Array, times: Array, limits: Array) -> None:
    """Raise ``Infeasible`` where forces (K, n, d) between the ends do not withstand what they must."""
    measured = demand.grasp.cones.measured(forces[1:-1])
    spares = [demand.spare(f, limits, on_the_way=True) for f in measured]
    least = int(np.argmin(spares))
    if spares[least] < 0:
        raise Infeasible(
            f"the path that bends does not withstand the disturbance at t = {times[1 + least]:.4g} s: some "
            f"finger misses its cone or limit by {-spares[least]:.3g} N; a straight path between the same "
            f"ends does, under a constant load and without rate limits and idle times"
        )


def refuse_weak_ends(start: GraspState, end: GraspState, least: Array) -> None:
    """Raise ``InvalidInput`` for given ends whose fingers push with less than ``least`` (n,) [N]."""
    for label, state in (("start", start), ("end", end)):
        normal = state.grasp.cones.normal(state.forces)
        for name, has, needs in zip(state.grasp.names, normal, least, strict=True):
            if has < needs:
                raise InvalidInput(
                    f"{label}: {name} pushes with a normal force of {has:.4g}, below min_normal {needs:g}; "
                    f"give another state, choose it for 'force' with a higher max_force, or lower min_normal"
                )


def series_and_clock(
    load: Wrench | LoadSeries | LoadFunction | None, options: PlanOptions, demands: Demands
) -> tuple[LoadSeries | None, TimeScaling | None]:
    """The load in time, None if it is constant, and T(t); None where the rate limit sets the duration."""
    if load is None and not options:
        return None, scaling_of(None, None)
    duration, scaling = options.get("duration"), options.get("scaling")
    if isinstance(load, LoadSeries):
        if duration is None and scaling is None:
            duration = load.duration
        clock = scaling_of(duration, scaling)
        if clock.duration != load.duration:
            raise InvalidInput(
                f"the load series lasts {load.duration:g} s, the plan {clock.duration:g} s; make them equal"
            )
        return load, clock
    if demands.rate_limit is not None and duration is None and scaling is None and not callable(load):
        return None, None
    clock = scaling_of(duration, scaling)
    if callable(load):
        return LoadSeries.sampled(load, clock.duration, demands.instants, also=demands.idle_times), clock
    return None, clock
