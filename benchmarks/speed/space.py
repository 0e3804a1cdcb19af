"""Speed in space: states, paths and many contacts by programs, cones and pyramids, triples, a whole regrasp.

    python benchmarks/speed/space.py                 measures, writes results/space.json, README.md
    python benchmarks/speed/space.py --quick -o DIR  a short run into another folder, to see it work

Every ratio compares two things measured in turn in this one process. Answers are compared before times are.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from math import pi
from statistics import median
from time import perf_counter

import numpy as np

import regrasp as rg
import triples
from closed_form import PACKAGES
from closed_form import QUICK as QUICK_EFFORT
from closed_form import Effort as Times
from command import command
from programs import first_row, overhead_row, path_growth, path_task
from regrasp.mesh import parts
from report import Measure, Row
from timing import Side

FRICTION = 0.6
AXES = np.array([1.0, 0.8, 0.5])
WEIGHT = rg.Wrench([0.1, 0.2, -1.0], [0.01, -0.02, 0.03])
FACETS = (4, 8, 16, 32)


@dataclass(frozen=True)
class Effort:
    """How much to measure: instants, contacts, grasps to try pyramids on, candidates and directions."""

    times: Times
    triples: triples.Effort
    instants: tuple[int, ...] = (10, 100, 1_000)
    contacts: tuple[int, ...] = (8, 64, 512)
    grasps: int = 100
    regrasp: tuple[int, int] = (40, 42)


FULL = Effort(Times(rounds=15), triples.FULL)
QUICK = Effort(
    replace(QUICK_EFFORT, rounds=2), triples.QUICK, (10, 30, 100), (8, 16, 32), grasps=3, regrasp=(16, 6)
)


def overhead(effort: Effort) -> Iterator[Row]:
    """``choose_state`` through Clarabel over exact cones, against bare Clarabel."""
    for objective in ("effort", "peak", "peak_normal"):
        yield overhead_row(effort.times, tripod(), WEIGHT, objective, "4 contacts in space")
    yield first_row(effort.times, tripod(), WEIGHT, "4 contacts in space")


def paths(effort: Effort) -> Iterator[Row]:
    """A path program over second-order cones: how its cost grows with the instants."""
    start = rg.choose_state(tripod(), WEIGHT, "force")
    tasks = {count: path_task(count, start) for count in effort.instants}
    yield from path_growth(effort.times, tasks, "path program in space")


def many_contacts(effort: Effort) -> Iterator[Row]:
    """A hold by very many contacts, forces in exact equilibrium: how its cost grows with them."""
    first, *_, second, last = effort.contacts
    for objective in ("effort", "peak"):
        sides = {
            n: Side(lambda _, n=n, o=objective: rg.choose_state(ellipsoid(n), WEIGHT, o))
            for n in effort.contacts
        }
        for few in (first, second):
            yield Row.growth(
                f"contacts_{objective}_{few}_{last}",
                f"`choose_state`, `{objective}`, {last} contacts in space beside {few}",
                effort.times.of(sides[last], sides[few]), last / few, 1.1, "more iterations of Clarabel",
            )  # fmt: skip


def pyramids(effort: Effort) -> Iterator[Row]:
    """Inner pyramids against exact cones: time by Clarabel and by a QP solver; the loss over some grasps."""
    grasp = tripod()
    for objective, method in (("effort", "clarabel"), ("peak", "clarabel"), ("effort", "piqp")):
        exact = Side(lambda _, o=objective: rg.choose_state(grasp, WEIGHT, o))
        for m in FACETS:
            inner = Side(
                lambda _, o=objective, b=method, m=m: rg.choose_state(grasp, WEIGHT, o, method=b, facets=m)
            )
            yield Row.of(
                f"pyramid_{objective}_{method}_{m}",
                f"`choose_state`, `{objective}`, 4 contacts, pyramids of {m} facets by {method}",
                "exact cones by clarabel", effort.times.of(inner, exact), Measure.TIMES,
            )  # fmt: skip
    for objective in ("effort", "peak", "force"):
        found = [rg.pyramid_losses(g, WEIGHT, objective, FACETS).losses for g in held(effort.grasps)]
        for m in FACETS:
            lost = 100 * np.array([losses[m] for losses in found])  # NaN where the pyramids do not hold
            missed, most = np.isnan(lost).sum(), np.nanmax(lost)
            what = (
                f"`{objective}` of {len(found)} random grasps of 4 contacts, lost by pyramids of {m} facets"
            )
            yield Row.alone(
                f"loss_{objective}_{m}",
                f"{what}: the median; the most is {most:.2g} %, and {missed} hold no longer",
                float(np.nanmedian(lost)), Measure.PERCENT,
            )  # fmt: skip


def regrasp(effort: Effort) -> Iterator[Row]:
    """A whole regrasp of a bracket, laid on its side; and its proof in exact arithmetic."""
    plan = planned(effort)
    verdict = rg.verify(plan)
    if not verdict.ok:
        raise RuntimeError(f"the regrasp does not verify: {verdict}")
    candidates, orientations = effort.regrasp
    what = f"{len(plan.steps)} steps, {candidates} candidates, {orientations} directions of the load"
    rounds = min(effort.times.rounds, 5)
    yield Row.alone(
        "regrasp", f"`plan_regrasp` of four fingers on a bracket, end to end: {what}",
        median(timed(lambda: planned(effort)) for _ in range(rounds)), Measure.SECONDS, 10.0,
        "margins of all triples in all directions",
    )  # fmt: skip
    yield Row.alone(
        "verify_regrasp", f"`verify` of that plan, {len(plan.steps)} steps",
        median(timed(lambda: rg.verify(plan)) for _ in range(rounds)), Measure.SECONDS,
    )  # fmt: skip
    state = rg.choose_state(tripod(), WEIGHT, "force")
    instants = effort.instants[1]

    def swung(t: float) -> rg.Wrench:
        return rg.Wrench((1 + 0.1 * np.sin(2 * pi * t)) * WEIGHT.force, WEIGHT.torque)

    shaking = rg.LoadSet.ball(rg.Wrench([0, 0, 0]), force=0.02, torque=0.01)
    makers = {
        "removal": ("a removal", lambda: rg.plan_removal(state, 3)),
        "turn": ("a turn by 90 degrees", lambda: rg.plan_rotation(state, pi / 2, axis=[1, 0, 0])),
        "path": (
            f"a removal under a load that swings, {instants} instants",
            lambda: rg.plan_removal(state.grasp, 3, load=swung, instants=instants),
        ),
        "withstood": (
            f"the same that withstands a ball of disturbances, {instants} instants",
            lambda: rg.plan_removal(
                state.grasp, 3, load=swung, instants=instants, disturbance=shaking, max_force=5.0
            ),
        ),
    }
    for key, (name, make) in makers.items():
        plan = make()
        if not rg.verify(plan).ok:
            raise RuntimeError(f"{name} does not verify")
        yield Row.of(
            f"verify_{key}", f"`verify`, {name} in space", "planning it",
            effort.times.of(Side(lambda _, p=plan: rg.verify(p)), Side(lambda _, m=make: m())), Measure.TIMES,
        )  # fmt: skip


def table(effort: Effort) -> Iterator[Row]:
    """The triple graph, and what its pyramids miss."""
    yield from triples.rows(effort.triples)
    yield from triples.losses(effort.triples)


@cache
def tripod() -> rg.Grasp:
    """Three fingers around an ellipsoid that can hold the weight alone, and a fourth on top of it."""
    on_ball = np.array([[1, 0, 0.1], [-0.5, 0.85, 0], [-0.5, -0.85, -0.1], [0.1, 0, 1]])
    return rg.Grasp(rg.Contact(p * AXES, -p / AXES, FRICTION) for p in on_ball)


@cache
def ellipsoid(count: int) -> rg.Grasp:
    """Contacts spread over an ellipsoid along a spiral."""
    z = 1 - (2 * np.arange(count) + 1) / count
    around = np.arange(count) * pi * (3 - 5**0.5)
    on_ball = np.column_stack([np.sqrt(1 - z**2) * np.cos(around), np.sqrt(1 - z**2) * np.sin(around), z])
    return rg.Grasp(rg.Contact(p * AXES, -p / AXES, FRICTION) for p in on_ball)


def held(count: int) -> list[rg.Grasp]:
    """Random grasps of four contacts on an ellipsoid that hold the weight in their exact cones."""
    rng, found = np.random.default_rng(4), []
    while len(found) < count:
        on_ball = rng.normal(size=(4, 3))
        on_ball /= np.linalg.norm(on_ball, axis=1)[:, None]
        grasp = rg.Grasp(rg.Contact(p * AXES, -p / AXES, FRICTION) for p in on_ball)
        try:
            rg.choose_state(grasp, WEIGHT, "effort")
        except rg.Infeasible:
            continue
        found.append(grasp)
    return found


def planned(effort: Effort) -> rg.RegraspPlan:
    """Four fingers of an angle bracket go elsewhere while it is laid on its side."""
    mesh = parts.bracket()
    start, goal = (rg.Grasp(mesh.contacts(4, friction=FRICTION, seed=seed)) for seed in (1, 2))
    candidates, orientations = effort.regrasp
    return rg.plan_regrasp(
        mesh, start, goal, rg.Wrench([0, 0, -1.0]), friction=FRICTION, candidates=candidates,
        orientations=orientations, goal_rotation=[[1, 0, 0], [0, 0, -1], [0, 1, 0]],
    )  # fmt: skip


def timed(call) -> float:
    """Seconds of one call."""
    began = perf_counter()
    call()
    return perf_counter() - began


def rows(quick: bool) -> Iterator[Row]:
    """Every row of the benchmark."""
    effort = QUICK if quick else FULL
    for part in (overhead, paths, many_contacts, pyramids, table, regrasp):
        yield from part(effort)


def main() -> None:
    """Measure, print and write."""
    command("space", __doc__ or "", rows, (*PACKAGES, "piqp"))


if __name__ == "__main__":
    main()
