"""The tasks of ``same_answers.py`` about states: choices of forces, loci, surveys, refusals."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

import regrasp as rg
from answer_grasps import OBJECTIVES, Draw, draws, options_of
from answers import Told, Value
from degenerate import degenerate_cases

Tasks = Iterator[tuple[str, Callable[[], Any]]]

# Every solver that comes with regrasp, and some that do not: where one is missing, that is the outcome.
SOLVERS = ("clarabel", "osqp", "cvxpy", "daqp", "piqp", "quadprog", "scs")


def numbers(**arrays: Any) -> Told:
    """Arrays by name, each judged by its own largest number."""
    return Told("answered", {name: Value.of(array) for name, array in arrays.items()})


def choices(dimension: int, counts: dict[int, int], soft: bool = False) -> Tasks:
    """counts: draws by number of fingers."""
    for count, number in counts.items():
        for k, draw in draws(10 + count, number, count=count, dimension=dimension, soft=soft):
            grasp = draw.limited(4.0) if k % 5 == 4 else draw.grasp
            options = options_of(k, draw.force)
            for objective in OBJECTIVES:
                task = partial(rg.choose_state, grasp, draw.load, objective, **options)
                yield f"{count} fingers, {k}, {objective}, {options}", task


def choices_by_solvers() -> Tasks:
    """Two fingers through programs, several back ends, polygons and pyramids."""
    for method in SOLVERS:
        facets = None if method in ("clarabel", "cvxpy") else 12
        for count in (2, 3):
            for k, draw in draws(30 + count, 3, count=count):
                options = options_of(k, draw.force) | {"method": method, "facets": facets}
                for objective in OBJECTIVES:
                    task = partial(rg.choose_state, draw.grasp, draw.load, objective, **options)
                    yield f"plane, {count} fingers, {k}, {objective}, {options}", task
    for facets in (4, 8, 16):
        for k, draw in draws(35, 4, count=4, dimension=3):
            for objective in OBJECTIVES:
                task = partial(rg.choose_state, draw.grasp, draw.load, objective, facets=facets)
                yield f"space, {k}, {objective}, {facets} facets", task


def degenerate_choices() -> Tasks:
    for case in degenerate_cases():
        for objective in OBJECTIVES:
            limit = None if any(case.load) else 3.0
            task = partial(rg.choose_state, case.grasp, case.wrench, objective, max_force=limit)
            yield f"{case.name}, {objective}", task


def best_on_loci() -> Tasks:
    for k, draw in draws(40, 60, count=2):
        locus = rg.EquilibriumLocus(draw.grasp, draw.load)
        options = options_of(k, draw.force)
        for objective in OBJECTIVES:
            yield f"{k}, {objective}, {options}", partial(locus.best, objective, **options)
    for k, draw in draws(41, 20, count=3):
        locus = rg.SqueezeLocus(draw.grasp, draw.load)
        yield f"squeezes {k}", partial(_squeezes, locus)
        yield f"squeezes {k}, best", partial(locus.best, "force")


def _squeezes(locus: rg.SqueezeLocus) -> Told:
    found = numbers(bounds=locus.bounds, internal=locus.internal, least=locus.least)
    return found._replace(outcome=str(locus.why or "held"), words=repr(locus))


def batches() -> Tasks:
    """Pairs in one call, told pair by pair: the interval, and the best squeezes without and with a limit."""
    rng = np.random.default_rng(50)
    count = 400
    r1, r2, n1, n2, force = rng.normal(size=(5, count, 2))
    n1, n2 = (r2 - r1) + 0.5 * n1, (r1 - r2) + 0.5 * n2
    mu1, mu2 = rng.uniform(0.1, 1.0, (2, count))
    pairs = (r1, n1, mu1, r2, n2, mu2, force, 0.2 * rng.normal(size=count))
    made: dict[str, np.ndarray] = {}

    def pair(k: int) -> Told:
        if not made:  # when it is asked for, not before: a failure is the outcome of a task
            made["interval"] = np.stack(rg.locus_intervals(*pairs), axis=1)
            for objective in OBJECTIVES:
                every = [rg.best_squeezes(*pairs, objective=objective, max_force=m) for m in (None, 5.0)]
                made[objective] = np.stack(every, axis=1)
        return numbers(**{name: array[k] for name, array in made.items()})

    for k in range(count):
        yield f"{k}", partial(pair, k)


def held() -> Tasks:
    for count in (2, 3, 4, 5):
        for k, draw in draws(60 + count, 25, count=count):
            yield f"{count} fingers, {k}", partial(_held, draw.grasp)
    for k, draw in draws(66, 3, count=3, dimension=3):
        yield f"sphere {k}", partial(_sphere, draw.grasp)


def _held(grasp: rg.Grasp) -> Told:
    found = rg.held_directions(grasp)
    arc = {} if found.arc is None else {"arc": Value.of(found.arc, 1.0)}
    return Told(found.kind, arc, str(found))


def _sphere(grasp: rg.Grasp) -> Told:
    found = rg.held_sphere(grasp, count=50)
    told = numbers(values=found.values, forces=found.forces, twists=[t.twist for t in found.twists])
    return told._replace(words=str(found))


def sensitivities() -> Tasks:
    for count in (2, 3, 4):
        for k, draw in draws(70 + count, 4, count=count):
            grasp, options = draw.limited(3.0) if k % 2 else draw.grasp, options_of(k, draw.force)
            for objective in OBJECTIVES:
                task = partial(_sensitivity, grasp, draw.load, objective, options)
                yield f"{count} fingers, {k}, {objective}, {options}", task


def _sensitivity(grasp: rg.Grasp, load: rg.Wrench, objective: str, options: dict[str, float]) -> Told:
    found = rg.sensitivity(grasp, load, objective, **options)
    names = ("friction", "position", "normal", "limit", "load", "value")
    told = numbers(forces=found.state.forces, **{name: getattr(found, name) for name in names})
    return told._replace(words=str(found))


def pyramids() -> Tasks:
    for k, draw in draws(80, 6, count=4, dimension=3):
        for objective in ("effort", "peak", "force"):
            yield f"{k}, {objective}", partial(_pyramids, draw, objective)


def _pyramids(draw: Draw, objective: str) -> Told:
    found = rg.pyramid_losses(draw.grasp, draw.load, objective, facets=(4, 8))
    return numbers(exact=found.exact, losses=list(found.losses.values()))._replace(words=str(found))


STATES: dict[str, Callable[[], Tasks]] = {
    "choice in the plane": partial(choices, 2, {2: 30, 3: 20, 4: 12, 5: 12, 6: 8}),
    "choice in space": partial(choices, 3, {3: 16, 4: 12}),
    "choice, soft fingers": partial(choices, 3, {2: 8, 3: 8, 4: 4}, soft=True),
    "choice by solvers": choices_by_solvers,
    "choice, degenerate": degenerate_choices,
    "best on a locus": best_on_loci,
    "batch": batches,
    "held directions": held,
    "sensitivity": sensitivities,
    "pyramid losses": pyramids,
}
