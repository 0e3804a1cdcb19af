"""From one end to the other: Eq. 1-3 where that serves, else a path program."""

from dataclasses import dataclass, replace
from math import inf
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, choice, limits, number, whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.planning.states.choosing import DEFAULT_BACKEND, check_facets
from regrasp.planning.states.criteria import Criteria
from regrasp.plans.course import Course
from regrasp.plans.loads import MOST_INSTANTS, LoadSeries
from regrasp.plans.sampled import SampledTransition
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Record, Transition

_INSTANTS = 101

PathObjective = Literal["change", "effort", "force", "peak"]
PATH_OBJECTIVES = get_args(PathObjective)

# Where T stands still the least change still moves with time, at this fraction of the average pace.
_LEAST_PACE = 1e-6


@dataclass(frozen=True)
class Demands:
    """What a path must keep to besides equilibrium and cones; see ``plan_removal``."""

    rate_limit: ArrayLike | None = None
    min_normal: float | None = None
    path_objective: str | None = None
    idle_time: float | None = None
    instants: int = _INSTANTS
    method: str = "auto"
    facets: int | None = None

    def __post_init__(self) -> None:
        if self.min_normal is not None:
            number(self.min_normal, "min_normal", least=0)
        if self.path_objective is not None:
            choice(self.path_objective, "path_objective", PATH_OBJECTIVES)
        whole(self.instants, "instants", least=3, most=MOST_INSTANTS)
        check_facets(self.facets)
        if self.idle_time is not None:
            number(self.idle_time, "idle_from or idle_until", least=0)

    @classmethod
    def of(
        cls,
        rate_limit: ArrayLike | None,
        min_normal: float | None,
        path_objective: str | None,
        idle_time: float | None,
        instants: int,
        method: str,
        facets: int | None,
    ) -> "Demands":
        """The demands of a call; one value for the many calls without any, which take microseconds."""
        given = (rate_limit, min_normal, path_objective, idle_time, facets)
        usual = type(instants) is int and instants == _INSTANTS and method == "auto"
        if usual and all(demand is None for demand in given):
            return _NONE
        return cls(rate_limit, min_normal, path_objective, idle_time, instants, method, facets)

    @property
    def bends(self) -> bool:
        """Whether anything is asked for that a straight path may not keep."""
        return not (
            self.rate_limit is None
            and self.min_normal is None
            and self.path_objective is None
            and self.idle_time is None
        )

    def rates(self, grasp: Grasp) -> Array:
        """(n,) force-rate limits, infinite for none [N/s]."""
        if self.rate_limit is None:
            return np.full(len(grasp), inf)
        return limits(self.rate_limit, "rate_limit", len(grasp))


_NONE = Demands()


def joined(
    kind: Literal["removal", "addition"],
    contact: int,
    start: GraspState,
    end: GraspState,
    scaling: TimeScaling | None,
    load: LoadSeries | None,
    record: Record,
    criteria: Criteria,
    demands: Demands,
) -> Transition:
    """The transition between two states: straight where that keeps every demand, else through instants.

    scaling: None for the shortest one under the rate limit. load: None where it is constant.
    """
    grasp = start.grasp
    if load is None and scaling is not None and not demands.bends:  # the usual case, in microseconds
        return Transition(kind, grasp.names[contact], start, end, scaling, record)
    rates, least = demands.rates(grasp), np.full(len(grasp), demands.min_normal or 0.0)
    stays = np.arange(len(grasp)) != contact
    least[contact] = 0.0
    _refuse_weak_ends(start, end, least)
    has_rates = bool((rates < inf).any())
    record = replace(record, least_normals=tuple(least.tolist()) if least.any() else ())
    if load is None:
        plan = Transition(kind, grasp.names[contact], start, end, scaling or TimeScaling.spline(1.0), record)
        if scaling is None:
            plan = plan.fastest(rates)
        fast_enough = not has_rates or scaling is None or bool((plan.steepest <= rates * (1 + 1e-12)).all())
        if demands.path_objective is None and demands.idle_time is None and fast_enough:
            return plan
        load = LoadSeries([0.0, plan.duration], [start.load.vector] * 2)
        scaling = plan.scaling
    assert scaling is not None  # a load in time brings its clock
    if grasp.is_soft:
        raise InvalidInput("paths through instants are planned for point contacts; a finger of these is soft")
    if demands.method == "closed-form":
        raise InvalidInput(
            "Eq. 1-3 holds under a constant load, and no straight path keeps these demands; use method='auto'"
        )
    objective = demands.path_objective or "change"
    if objective in ("effort", "peak") and not has_rates:
        raise InvalidInput(f"path_objective {objective!r} would jump at both ends; give rate_limit as well")
    backend = DEFAULT_BACKEND if demands.method == "auto" else demands.method
    course = _course(
        kind, contact, start, end, scaling, load, rates, least, stays, criteria, demands, backend
    )
    record = replace(
        record,
        path=backend,
        path_objective=objective,
        rate_limits=tuple(rates.tolist()) if has_rates else (),
    )
    return SampledTransition(kind, grasp.names[contact], start, end, scaling, record, course=course)


def _course(
    kind: str,
    contact: int,
    start: GraspState,
    end: GraspState,
    scaling: TimeScaling,
    load: LoadSeries,
    rates: Array,
    least: Array,
    stays: NDArray[np.bool_],
    criteria: Criteria,
    demands: Demands,
    backend: str,
) -> Course:
    from regrasp.planning.changes.path_program import PathTask
    from regrasp.planning.changes.path_search import planned_path

    grasp, idle = start.grasp, demands.idle_time
    if idle is not None and not (1e-6 < idle / scaling.duration < 1 - 1e-6):
        raise InvalidInput(
            f"the finger's idle time must lie inside (0, {scaling.duration:g}) s, got {idle:g}"
        )
    fine = load.refined(demands.instants, *(() if idle is None else (idle,)))
    times = fine.times
    active = np.ones((times.size, len(grasp)), dtype=bool)
    active[-1 if kind == "removal" else 0, contact] = False
    if idle is not None:
        active[times >= idle if kind == "removal" else times <= idle, contact] = False
    steps = np.maximum(-np.diff(scaling(times)), _LEAST_PACE * np.diff(times) / scaling.duration)
    phases = np.append(0.0, np.cumsum(steps) / steps.sum())
    size = grasp.size or 1.0
    d = grasp.dimension
    largest = max(float(abs(fine.vectors[:, :d]).max()), float(abs(fine.vectors[:, d:]).max()) / size)
    task = PathTask(
        grasp=grasp,
        times=times,
        loads=fine.vectors,
        start=start.forces,
        end=end.forces,
        active=active,
        phases=phases,
        frictions=np.array(criteria.frictions(grasp)),
        limits=np.array(criteria.limits(grasp)),
        rates=rates,
        least_normals=least,
        stays=stays,
        unit=largest or float(max(start.magnitudes.max(), end.magnitudes.max())) or 1.0,
    )
    forces = planned_path(task, demands.path_objective or "change", criteria, backend, demands.facets)
    return Course(times, forces, fine.vectors)


def _refuse_weak_ends(start: GraspState, end: GraspState, least: Array) -> None:
    for label, state in (("start", start), ("end", end)):
        normal = state.grasp.cones.normal(state.forces)
        for name, has, needs in zip(state.grasp.names, normal, least, strict=True):
            if has < needs:
                raise InvalidInput(
                    f"{label}: {name} pushes with a normal force of {has:.4g}, below min_normal {needs:g}; "
                    f"give another state, choose it for 'force' with a higher max_force, or lower min_normal"
                )
