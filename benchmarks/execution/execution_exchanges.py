"""Exchanges and regrasps in MuJoCo, by plan and as people do them.

    python benchmarks/execution/execution_exchanges.py

Cases and seeds stand here and all are reported. In an exchange one finger takes over from another in one
second; a regrasp is the removal, exchanges and addition of a plan without turning, and every rival goes
through the same contacts in the same steps, each from where its own step before ended.
"""

import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

import regrasp as rg
from execution import needs
from execution_rivals import RIVALS, Rival
from regrasp.execution import critical_friction, simulate

RESULTS = Path(__file__).parents[1] / "results" / "execution_exchanges.json"
EXCHANGE_SEEDS, REGRASP_SEEDS = (1, 2, 3), (1, 2, 3)
FRICTION = 0.6


@dataclass(frozen=True)
class Exchange:
    """A start, the finger that leaves, and the one that takes over, which is in the start without force."""

    name: str
    start: rg.GraspState
    leaves: str
    arrives: str


def paper() -> Exchange:
    """The paper's example in metres with a fourth finger beside the third, which takes over from it."""
    places = (([-4, -4], [1, 1]), ([4, -5], [-1, 2]), ([0, 8], [0, -1]), ([-1, 8], [0.2, -1]))
    grasp = rg.Grasp(rg.Contact(0.01 * np.array(p), n, 0.4) for p, n in places)
    return started("paper", grasp, rg.Wrench([-1.5, -3.5]), "P3", "P4")


def disc(seed: int) -> Exchange:
    """Three fingers around a disc of 50 mm, and a fourth beside the third, which leaves."""
    rng = np.random.default_rng(seed)
    while True:
        angles = np.array([3.6, 5.8, 1.6, 1.2]) + rng.uniform(-0.3, 0.3, 4)
        points = 0.05 * np.column_stack([np.cos(angles), np.sin(angles)])
        normals = -points / 0.05 + 0.15 * rng.normal(size=points.shape)
        grasp = rg.Grasp(rg.Contact(p, n, FRICTION) for p, n in zip(points, normals, strict=True))
        try:
            return started(f"disc {seed}", grasp, rg.Wrench([0, -3.0]), "P3", "P4")
        except rg.Infeasible:
            continue


def started(name: str, grasp: rg.Grasp, load: rg.Wrench, leaves: str, arrives: str) -> Exchange:
    """The start with the widest force margin of the fingers before, if the ones after hold the load, too."""
    rg.choose_state(grasp.without(leaves), load)
    held = rg.choose_state(grasp.without(arrives), load, "force")
    forces = [np.zeros(2) if n == arrives else held.forces[held.grasp.index(n)] for n in grasp.names]
    return Exchange(name, rg.GraspState(grasp, load, forces), leaves, arrives)


def regrasp(seed: int) -> rg.RegraspPlan:
    """Three fingers on an ellipse of 80 x 40 mm from places by chance to others, without turning."""
    rng = np.random.default_rng(seed)
    outline = rg.Outline.ellipse(0.04, 0.02)
    while True:
        first, last = (
            rg.Grasp(
                outline.contact_at(outline.length * ((k + o) / 3 + rng.uniform(-0.1, 0.1)), friction=FRICTION)
                for k in range(3)
            )
            for o in (0.0, 0.5)
        )
        try:
            return rg.plan_regrasp(
                outline,
                first,
                last,
                rg.Wrench([0, -3.0]),
                friction=FRICTION,
                orientations=1,
                objective="force",
            )
        except rg.Infeasible:
            continue


def by(rival: Rival, plan: rg.RegraspPlan) -> rg.RegraspPlan:
    """The steps of a plan as a rival takes them."""
    steps, forces = [], dict(zip(plan.steps[0].grasp.names, plan.steps[0].start.forces, strict=True))
    for step in plan.steps:
        held = [forces.get(n, np.zeros(2)) for n in step.grasp.names]
        start = rg.GraspState(step.grasp, step.start.load, held)
        leaves, arrives = ((*names, None)[0] for names in (step.leaving, step.arriving))
        steps.append(rival(start, leaves, step.duration, arrives))
        forces = dict(zip(steps[-1].grasp.names, steps[-1].end.forces, strict=True))
    return rg.RegraspPlan(tuple(steps), plan.orientations, 0.0)


def rows() -> Iterator[dict[str, Any]]:
    """What every rival needs by computation and in physics, and what it does with the friction planned."""
    plans: list[tuple[str, str, Any]] = []
    for case in (paper(), *map(disc, EXCHANGE_SEEDS)):
        for name, rival in RIVALS.items():
            plans.append(
                (f"exchange, {case.name}", name, lambda r=rival, c=case: r(c.start, c.leaves, 1.0, c.arrives))
            )
    for seed in REGRASP_SEEDS:
        base = regrasp(seed)
        plans.append((f"regrasp {seed}", "plan", lambda p=base: p))
        for name, rival in list(RIVALS.items())[2:]:
            plans.append((f"regrasp {seed}", name, lambda r=rival, p=base: by(r, p)))
    for case_name, name, made in plans:
        row: dict[str, Any] = {"case": case_name, "rival": name}
        try:
            plan = made()
        except (rg.RegraspError, AssertionError) as error:
            yield row | {"failed": str(error)}
            continue
        row["needs"] = max(map(needs, plan.steps)) if isinstance(plan, rg.RegraspPlan) else needs(plan)
        try:
            run = simulate(plan)
            row |= {"held": run.held, "dropped": run.dropped, "slip": float(run.slip.max())}
            row["in physics"] = critical_friction(plan, tolerance=0.02)
        except rg.InvalidInput as error:
            row |= {"in physics": None, "said": str(error)}
        yield row


def main() -> None:
    began, found = perf_counter(), []
    for row in rows():
        found.append(row)
        print(row)
    facts = {"python": sys.version.split()[0], "seconds": perf_counter() - began, "rows": found}
    RESULTS.write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
