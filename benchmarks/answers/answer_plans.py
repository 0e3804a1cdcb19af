"""The tasks of ``same_answers.py`` about plans: removals, additions, turns, paths, regrasps, scenarios."""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import regrasp as rg
from answer_grasps import OBJECTIVES, Draw, draws, options_of
from answers import Told, document
from regrasp.outline import parts

Tasks = Iterator[tuple[str, Callable[[], Any]]]

EXAMPLES = Path(__file__).parents[2] / "examples"
WEIGHT, GRIP = rg.Wrench([0, -3.0]), 0.5
STARTS = ("chosen", "given", "rounded", "quickest")


def changes(verb: str, dimension: int, counts: dict[int, int], soft: bool = False) -> Tasks:
    """Removals and additions along the straight path. counts: draws by number of fingers."""
    for count, number in counts.items():
        for k, draw in draws(100 + count, number, count=count, dimension=dimension, spare=1, soft=soft):
            options, start = options_of(k, draw.force), STARTS[k % 4]
            for i, objective in enumerate(OBJECTIVES):
                whole = OBJECTIVES[(i + k) % 6]
                task = partial(_change, verb, draw, start, (objective, whole), options)
                yield f"{count} fingers, {k}, {start}, {objective}, {whole}, {options}", task


def _change(verb: str, draw: Draw, start: str, objectives: tuple[str, str], options: dict[str, Any]) -> Any:
    grasp, load, last = draw.grasp, draw.load, len(draw.grasp) - 1
    first = grasp if verb == "removal" else grasp.without(last)
    more: dict[str, Any] = {"objective": objectives[0], "whole_objective": objectives[1]}
    if start == "chosen":
        more |= {"load": load, "scaling": rg.TimeScaling.minimum_jerk(0.7)}
    else:
        forces = rg.choose_state(first, load, "force", **options).forces
        if start == "rounded":
            forces = np.round(forces / draw.force, 4) * draw.force
        first = rg.GraspState(first, load, forces)
    if start == "quickest":
        more["rate_limit"] = 5 * draw.force
    if verb == "removal":
        return rg.plan_removal(first, last, **options, **more)
    return rg.plan_addition(first, grasp[last], **options, **more)


def backwards() -> Tasks:
    """Plans run backwards and at another speed; one through instants has no other."""
    for k, draw in draws(120, 12, count=3, spare=1):
        for what in ("removal", "sampled", "rotation"):
            for way in ("reversed", "fastest"):
                yield f"{k}, {what}, {way}", partial(_backwards, draw, what, way)


def _backwards(draw: Draw, what: str, way: str) -> Any:
    if what == "rotation":
        plan = rg.plan_rotation(draw.grasp, 1.9, load=draw.load)
    else:
        bent = {"path_objective": "change", "instants": 11} if what == "sampled" else {}
        plan = rg.plan_removal(draw.grasp, 2, load=draw.load, **bent)
    return plan.reversed() if way == "reversed" else plan.fastest(3 * draw.force)


def paths(dimension: int, number: int) -> Tasks:
    """Bent paths: every demand in turn, alone and together with a load that swings."""
    everything = ("change", "effort", "peak", "force")
    for k, draw in draws(130 + dimension, number, count=dimension + 1, dimension=dimension, spare=1):
        grasp, force, swing = draw.grasp, draw.force, 0.3 * draw.another_load(0.05)
        demands: dict[str, dict[str, Any]] = {
            "rates": {"rate_limit": 4 * force},
            "tight rates": {"rate_limit": 1.5 * force},
            "least normals": {"min_normal": 0.02 * force},
            "idle": {"idle_from": 0.8},
            "all": {"rate_limit": 6 * force, "min_normal": 0.01 * force, "idle_from": 0.9},
            "limit": {"rate_limit": 9 * force, "max_force": 5 * force, "reserve": 0.05},
        }
        for what, demand in demands.items():
            for swings in (False, True):
                for objective in everything if what in ("all", "limit") else (None,):
                    options = demand | {"path_objective": objective, "duration": 1.0, "instants": 21}
                    options["load"] = partial(_swinging, draw.load, swing) if swings else draw.load
                    key = f"{k}, {what}, {objective}, {'swinging' if swings else 'constant'}"
                    yield f"removal {key}", partial(rg.plan_removal, grasp, dimension, **options)
                    if "idle_from" in options:
                        options["idle_until"] = 1.0 - options.pop("idle_from")
                    rest, new = grasp.without(dimension), grasp[dimension]
                    yield f"addition {key}", partial(rg.plan_addition, rest, new, **options)


def _swinging(load: rg.Wrench, swing: rg.Wrench, t: float) -> rg.Wrench:
    return load + float(np.sin(2 * np.pi * t)) * swing


def paths_by_solvers() -> Tasks:
    for method in ("clarabel", "osqp", "cvxpy", "daqp", "piqp", "quadprog"):
        facets = None if method in ("clarabel", "cvxpy") else 12
        for k, draw in draws(140, 3, count=3, spare=1):
            times = [0.0, 0.3, 0.5, 1.2]
            series = rg.LoadSeries(times, [draw.another_load(0.05).vector for _ in times])
            for what, load in (("constant", draw.load), ("series", series)):
                options = {"path_objective": "change", "instants": 11, "method": method, "facets": facets}
                yield f"{k}, {what}, {method}", partial(rg.plan_removal, draw.grasp, 2, load=load, **options)


def rotations(dimension: int, counts: dict[int, int]) -> Tasks:
    for count, number in counts.items():
        for k, draw in draws(150 + count, number, count=count, dimension=dimension):
            size, objective = draw.rng.uniform(0.2, 4.0), OBJECTIVES[k % 6]
            options = {"objective": objective, "load": draw.load if k % 2 else draw.another_load(0.0)}
            options |= options_of(k // 2, draw.force)
            if dimension == 3:
                options["axis"] = draw.rng.normal(size=3).round(2).tolist()
            for angle in (size, -size):
                task = partial(rg.plan_rotation, draw.grasp, angle, **options)
                yield f"{count} fingers, {k}, {angle:.3f} rad, {options}", task


def regrasps() -> Tasks:
    """Planar parts: fewest moves, trade-offs, joint states, weights, margins, arcs, turns, and why not."""
    usual: dict[str, Any] = {"friction": GRIP, "orientations": 12, "candidates": 40}
    variants: dict[str, dict[str, Any]] = {
        "usual": {},
        "no turn": {"orientations": 1},
        "upside down": {"goal_orientation": np.pi},
        "joint": {"states": "joint"},
        "weights": {"weights": rg.RegraspWeights(moves=0.5, turning=0.3, time=0.1, effort=0.2)},
        "margin": {"least_margin": 0.1},
        "too wide": {"least_margin": 0.45},
        "slippery": {"friction": 0.05},
        "weak": {"max_force": 2.0},
        "strong": {"max_force": 9.0, "objective": "force", "step_duration": 0.3},
        "apart": {"min_distance": 0.05, "one_finger": True, "reserve": 0.1},
        "trade-off": {"extra": 4},
    }
    for name in ("ellipse", "wrench", "cam", "gear", "bracket", "bottle", "puzzle_piece"):
        for k in range(2):
            for what, options in variants.items():
                yield f"{name}, {k}, {what}", partial(_regrasp, name, k, usual | options)
    for k in range(4):
        yield f"ellipse, arcs, {k}", partial(_regrasp, "ellipse", k, usual, (-0.2, 0.5))


@cache
def _outline(name: str) -> rg.Outline:
    return rg.Outline.ellipse(0.2, 0.1) if name == "ellipse" else getattr(parts, name)()


def _regrasp(name: str, k: int, options: dict[str, Any], arc: tuple[float, ...] = ()) -> Any:
    outline = _outline(name)
    rng = np.random.default_rng([160, k])
    start, goal = (_three(outline, rng, end, options["friction"]) for end in "AB")
    if arc:  # of each finger, from where it starts
        at = [outline.nearest(contact.position + outline.centre_of_mass) for contact in start]
        options = options | {"arcs": [[s + part * outline.length for part in arc] for s in at]}
    verb = rg.plan_regrasps if "extra" in options else rg.plan_regrasp
    return verb(outline, start, goal, WEIGHT, **options)


def _three(outline: rg.Outline, rng: np.random.Generator, name: str, friction: float) -> rg.Grasp:
    """Three fingers of which two hold the weight, if their friction is ``GRIP`` or more."""
    while True:
        places = (rng.uniform(0, 1, 3) * outline.length).tolist()
        firm = rg.Grasp(outline.contact_at(s, friction=GRIP) for s in places)
        if any(not rg.EquilibriumLocus(firm.without(i), WEIGHT).is_empty for i in range(3)):
            return rg.Grasp(
                outline.contact_at(s, friction=friction, name=f"{name}{i}") for i, s in enumerate(places)
            )


def solid_regrasps() -> Tasks:
    """A box in four fingers: without turning, turned, joint states, and why not."""
    box = rg.Mesh.box(0.06, 0.04, 0.05)
    turned = [[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]
    usual: dict[str, Any] = {"friction": 0.6, "orientations": 12, "candidates": 12}
    for what, options in {
        "no turn": {"orientations": 1, "candidates": 24},
        "turned": {"goal_rotation": turned},
        "joint": {"states": "joint"},
        "trade-off": {"orientations": 1, "extra": 2},
        "slippery": {"friction": 0.01},
        "too wide": {"least_margin": 1.0},
    }.items():
        yield f"box, {what}", partial(_solid_regrasp, box, usual | options)


def _solid_regrasp(mesh: rg.Mesh, options: dict[str, Any]) -> Any:
    """From four places on the faces across x and y to four others."""
    first = [(0.03, 0.004, 0.003), (-0.03, 0.003, -0.004), (0.004, 0.02, 0.002), (0.003, -0.02, 0.004)]
    last = [(0.03, 0.006, -0.005), (-0.03, -0.006, 0.004), (0.01, -0.004, 0.025), (0.003, 0.004, -0.025)]
    places, mu = np.array([first, last]) + mesh.centre_of_mass, options["friction"]
    start, goal = (rg.Grasp(mesh.contact_at(p, friction=mu) for p in end) for end in places)
    verb = rg.plan_regrasps if "extra" in options else rg.plan_regrasp
    return verb(mesh, start, goal, rg.Wrench([0, 0, -1.0]), **options)


def bottlenecks() -> Tasks:
    for name in ("ellipse", "cam", "puzzle_piece"):
        yield name, partial(_bottleneck, name)


def _bottleneck(name: str) -> Told:
    outline = _outline(name)
    ends = (
        rg.Grasp(outline.contact_at(s * outline.length, friction=0.5) for s in row)
        for row in ((0.02, 0.35, 0.7), (0.2, 0.5, 0.85))
    )
    problem = rg.RegraspProblem(outline, *ends, WEIGHT, friction=0.5, orientations=8, candidates=30)
    found = problem.bottleneck()
    return Told(str(found), {})


def refusals() -> Tasks:
    """Tasks that cannot be: nearly frictionless, far too weak, rates far too low, wrong arguments."""
    for dimension in (2, 3):
        for k, draw in draws(170 + dimension, 20, count=dimension + 1, dimension=dimension):
            grasp, load, force = draw.grasp, draw.load, draw.force
            slick = rg.Grasp(rg.Contact(c.position, c.normal, 0.01) for c in grasp)
            axis = {"axis": [0, 0, 1]} if dimension == 3 else {}
            for what, task in {
                "slick": partial(rg.choose_state, slick, load),
                "weak": partial(rg.choose_state, grasp, load, max_force=0.2 * force),
                "slick removal": partial(rg.plan_removal, slick, 0, load=load),
                "weak addition": partial(
                    rg.plan_addition, grasp.without(1), grasp[1], load=load, max_force=0.3 * force
                ),
                "slow removal": partial(
                    rg.plan_removal, grasp, 0, load=load, duration=1.0, rate_limit=0.01 * force
                ),
                "pushed removal": partial(rg.plan_removal, grasp, 0, load=load, min_normal=9 * force),
                "slick turn": partial(rg.plan_rotation, slick, 1.0, load=load, **axis),
                "weak turn": partial(rg.plan_rotation, grasp, 2.0, load=load, max_force=force, **axis),
                "unbalanced": partial(rg.plan_removal, rg.GraspState(grasp, load, 0 * grasp.positions), 0),
                "no such finger": partial(rg.plan_removal, grasp, "P9", load=load),
                "no load": partial(rg.plan_removal, grasp, 0),
                "no objective": partial(rg.choose_state, grasp, load, "luck"),
                "no turn": partial(rg.plan_rotation, grasp, 0.0, load=load, **axis),
                "no weight": partial(rg.choose_state, grasp, 0.0 * load),
            }.items():
                yield f"{dimension}d, {k}, {what}", task


def scenarios() -> Tasks:
    """The examples through the command line, and their plans read back from the file."""
    for path in sorted(EXAMPLES.glob("*.toml")):
        folder = TemporaryDirectory()
        yield f"{path.stem}: file", partial(_by_command, path, Path(folder.name))
        yield f"{path.stem}: read back", partial(_read_back, Path(folder.name))
        folder.cleanup()


def _by_command(path: Path, folder: Path) -> Told:
    command = (sys.executable, "-m", "regrasp", "plan", path, "-o", "out", "--no-figures")
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        return Told(f"exit status {done.returncode}", {}, done.stdout + done.stderr)
    return document(json.loads((folder / "out" / "plan.json").read_text(encoding="utf-8")), done.stdout)


def _read_back(folder: Path) -> Any:
    from regrasp.files import read_plan

    return read_plan(folder / "out" / "plan.json")


PLANS: dict[str, Callable[[], Tasks]] = {
    "removal in the plane": partial(changes, "removal", 2, {3: 32, 4: 16}),
    "removal in space": partial(changes, "removal", 3, {4: 16}),
    "removal, soft fingers": partial(changes, "removal", 3, {3: 8}, soft=True),
    "addition in the plane": partial(changes, "addition", 2, {3: 32, 4: 16}),
    "addition in space": partial(changes, "addition", 3, {4: 16}),
    "backwards": backwards,
    "path in the plane": partial(paths, 2, 10),
    "path in space": partial(paths, 3, 4),
    "path by solvers": paths_by_solvers,
    "turn in the plane": partial(rotations, 2, {2: 24, 3: 36}),
    "turn in space": partial(rotations, 3, {3: 18, 4: 18}),
    "regrasp of a planar part": regrasps,
    "regrasp of a solid": solid_regrasps,
    "bottleneck": bottlenecks,
    "refusal": refusals,
    "scenario": scenarios,
}
