"""Plans and what people do today, carried out in MuJoCo: ``python benchmarks/execution/execution.py``.

Every case removes one finger in one second. Starts, cases and seeds stand here and are all reported.
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
from execution_rivals import RIVALS
from regrasp.execution import critical_friction, simulate
from regrasp.mechanics.margins import friction_needed
from regrasp.mesh import parts

RESULTS = Path(__file__).parents[1] / "results" / "execution.json"
FRICTIONS = (0.06, 0.08, 0.09, 0.1, 0.12, 0.15, 0.18, 0.19, 0.2, 0.22, 0.25, 0.28, 0.31, 0.35, 0.4)
STIFFNESSES = (1.0, 4.0)  # of the default
ERRORS = (0.0125, 0.05)  # of the size: 1 and 4 mm in the paper's example
DELAYS = (0.02, 0.1)  # [s] at most
SHAKES = (0.1, 0.3)  # of the weight, across it, at 2 Hz
DRAWS = 3
PLANAR_SEEDS, SPACE_SEEDS = (1, 2, 3), (1, 2)


@dataclass(frozen=True)
class Case:
    """A start and the finger that leaves it."""

    name: str
    start: rg.GraspState
    leaves: str
    shape: Any = None


def paper() -> Case:
    """The paper's example in metres, with its start."""
    places = (([-4, -4], [1, 1]), ([4, -5], [-1, 2]), ([0, 8], [0, -1]))
    grasp = rg.Grasp(rg.Contact(0.01 * np.array(p), n, 0.3) for p, n in places)
    forces = [[3.7897, 3.0034], [-3.0096, 4.4156], [0.7199, -3.9190]]
    return Case("paper", rg.GraspState(grasp, rg.Wrench([-1.5, -3.5]), forces).balanced(), "P3")


def triangle(seed: int) -> Case:
    """Three fingers around a disc of 50 mm, places and normals by chance; the third leaves."""
    rng = np.random.default_rng(seed)
    while True:
        angles = np.array([3.6, 5.8, 1.6]) + rng.uniform(-0.3, 0.3, 3)
        points = 0.05 * np.column_stack([np.cos(angles), np.sin(angles)])
        normals = -points / 0.05 + 0.15 * rng.normal(size=points.shape)
        grasp = rg.Grasp(rg.Contact(p, n, 0.6) for p, n in zip(points, normals, strict=True))
        try:
            return Case(f"triangle {seed}", checked(grasp, rg.Wrench([0, -3.0]), "P3"), "P3")
        except rg.Infeasible:
            continue  # two of these fingers hold nothing: the next draw


def bracket() -> Case:
    """Four fingers on the bracket of the README; the fourth leaves."""
    tips = ((0.02, 0.02, -0.0105), (-0.0156, 0.02, 0.015), (-0.005, -0.02, -0.0105), (-0.0156, -0.02, 0.02))
    solid = parts.bracket()
    grasp = rg.Grasp(solid.contact_at(solid.centre_of_mass + tip, friction=0.8) for tip in tips)
    return Case("bracket", checked(grasp, rg.Wrench([0, 0, -1.82]), "P4"), "P4", solid)


def ball(seed: int) -> Case:
    """Three fingers around a ball of 50 mm near its equator and a fourth above; the fourth leaves."""
    rng = np.random.default_rng(seed)
    while True:
        turns = np.array([0.0, 2.1, 4.2]) + rng.uniform(-0.3, 0.3, 3)
        ring = np.column_stack([np.cos(turns), np.sin(turns), rng.uniform(-0.3, 0.1, 3)])
        points = np.vstack([ring, [*rng.uniform(-0.3, 0.3, 2), 1.0]])
        points *= 0.05 / np.linalg.norm(points, axis=1)[:, None]
        normals = -points / 0.05 + 0.1 * rng.normal(size=points.shape)
        grasp = rg.Grasp(rg.Contact(p, n, 0.6) for p, n in zip(points, normals, strict=True))
        try:
            return Case(f"ball {seed}", checked(grasp, rg.Wrench([0, 0, -2.0]), "P4"), "P4")
        except rg.Infeasible:
            continue


def checked(grasp: rg.Grasp, load: rg.Wrench, leaves: str) -> rg.GraspState:
    """The start with the widest force margin, if 0.7 of the friction holds the load without the finger."""
    rest = grasp.without(leaves)
    rg.choose_state(rg.Grasp(rg.Contact(c.position, c.normal, 0.7 * c.friction) for c in rest), load)
    return rg.choose_state(grasp, load, "force")


def cases() -> Iterator[Case]:
    """All cases."""
    yield paper()
    yield from map(triangle, PLANAR_SEEDS)
    yield bracket()
    yield from map(ball, SPACE_SEEDS)


def critical(case: Case) -> Iterator[dict[str, Any]]:
    """What each rival needs by computation and in physics."""
    for name, rival in RIVALS.items():
        row: dict[str, Any] = {"part": "critical", "case": case.name, "rival": name}
        try:
            plan = rival(case.start, case.leaves, 1.0)
        except rg.RegraspError as error:
            yield row | {"failed": str(error)}
            continue
        row["planned with"] = float(case.start.grasp.frictions[0])
        row["needs"] = needs(plan)
        totals = (
            case.start.grasp.wrenches(plan.forces(np.linspace(0, 1, 101))).sum(axis=1)
            + case.start.load.vector
        )
        row["imbalance"] = float(np.linalg.norm(totals[:, : case.start.grasp.dimension], axis=1).max())
        try:
            row["in physics"] = critical_friction(plan, tolerance=0.02, shape=case.shape)
        except rg.InvalidInput as error:
            row["in physics"] = None
            row["said"] = str(error)
        yield row


def needs(plan: rg.Transition) -> float:
    """The least friction by computation, over forces of a hundredth of the largest or more, as in physics."""
    forces = plan.forces(np.linspace(0, plan.duration, 501))
    sizes = np.linalg.norm(forces, axis=2, keepdims=True)
    counted = np.where(sizes > 0.01 * sizes.max(), forces, 0.0)
    return float(friction_needed(counted, plan.grasp.normals).max())


def slips(case: Case) -> Iterator[dict[str, Any]]:
    """The picture: slip against true friction."""
    for name, rival in RIVALS.items():
        plan = rival(case.start, case.leaves, 1.0)
        for friction in FRICTIONS:
            yield measured(plan, case, "slip", name, friction, friction=friction)


def disturbed(case: Case) -> Iterator[dict[str, Any]]:
    """Contacts elsewhere, clocks late, the hand shaken; friction as planned."""
    size, grasp = case.start.grasp.size, case.start.grasp
    weight, d = float(np.linalg.norm(case.start.load.force)), grasp.dimension
    rng = np.random.default_rng(7)
    trials: list[tuple[str, float, dict[str, Any]]] = []
    for part in ERRORS:
        for _ in range(DRAWS):
            trials.append(
                ("contact error", part, {"contact_errors": part * size * rng.uniform(-1, 1, (len(grasp), d))})
            )
    for late in DELAYS:
        for _ in range(DRAWS):
            trials.append(("delay", late, {"delays": rng.uniform(0, late, len(grasp))}))
    for part in SHAKES:

        def shake(t: float, push: float = part * weight) -> rg.Wrench:
            return rg.Wrench([push * np.sin(4 * np.pi * t), *[0.0] * (d - 1)])

        trials.append(("shake", part, {"disturbance": shake}))
    for name, rival in RIVALS.items():
        try:
            plan = rival(case.start, case.leaves, 1.0)
        except rg.RegraspError:
            continue  # reported by ``critical``
        for factor in STIFFNESSES:
            stiffness = factor * 4 * case.start.magnitudes.max() / size
            for kind, amount, options in trials:
                yield measured(plan, case, kind, name, amount, stiffness=stiffness, **options)


def measured(
    plan: rg.Transition, case: Case, part: str, name: str, amount: float, **options: Any
) -> dict[str, Any]:
    """One run as a row."""
    run = simulate(plan, shape=case.shape, **options)
    return {
        "part": part,
        "case": case.name,
        "rival": name,
        "amount": amount,
        "stiffness": options.get("stiffness"),
        "held": run.held,
        "dropped": run.dropped,
        "slip": float(run.slip.max()),
        "drift": float(run.drift.max()),
        "tilt": float(run.tilt.max()),
        "error": run.error,
    }


def main() -> None:
    began, rows = perf_counter(), list[dict[str, Any]]()
    found = list(cases())
    work = [
        slips(found[0]),
        *map(critical, found),
        *(disturbed(c) for c in found if c.name in ("paper", "bracket")),
    ]
    for part in work:
        for row in part:
            rows.append(row)
            print(json.dumps(row), flush=True)
    import mujoco

    head = {"seconds": perf_counter() - began, "mujoco": mujoco.__version__, "python": sys.version.split()[0]}
    RESULTS.write_text(json.dumps({"head": head, "rows": rows}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
