"""Compiling beforehand what is compiled when first used."""

from time import perf_counter
from typing import Any

import click

from regrasp.cli.speech import json_option, say


@click.command("warm-up")
@json_option
def warm_up() -> dict[str, Any]:
    """Compile all that is compiled when first used: batches, regrasps, places, wrench balls.

    A minute, once after an installation. What is compiled is kept for later runs.
    """
    took = {}
    for what, work in _WORKS.items():
        started = perf_counter()
        work()
        took[what] = perf_counter() - started
        say(f"{what}: {took[what]:.1f} s")
    return {"seconds": took}


def _least_forces() -> None:
    """What is compiled after thousands of choices."""
    import regrasp as rg
    from regrasp.planning.states.degenerate import flat_minima

    patience, flat_minima.PATIENCE = flat_minima.PATIENCE, 0
    try:
        sides = ((1.0, 0.1, 0.0), (-1.0, 0.0, 0.1), (0.0, 1.0, 0.1), (0.1, -1.0, 0.0))
        for d in (2, 3):
            grasp = rg.Grasp(
                rg.Contact(side[:d], normal=[-round(x) for x in side[:d]], friction=0.8) for side in sides
            )
            rg.choose_state(grasp, rg.Wrench([0.1, -1.0, 0.0][:d]), "peak")
    finally:
        flat_minima.PATIENCE = patience


def _batches() -> None:
    import regrasp as rg

    many = [[0.1, -1.0]] * 2_000  # a few go by the formulas themselves
    pairs = ([-1.0, 0.0], [1.0, 0.0], 0.5, [1.0, 0.0], [-1.0, 0.0], 0.5, many)
    rg.locus_intervals(*pairs)
    rg.best_squeezes(*pairs)
    three = [[1.0, 0.0], [-0.5, 0.9], [-0.5, -0.9]]
    rg.choose_states(three, [[-x, -y] for x, y in three], 0.6, force=[0.1, -1.0])


def _planar_regrasps() -> None:
    import numpy as np

    import regrasp as rg
    from regrasp.planning.holds.turning import margins

    load = rg.Wrench([0.0, -1.0])
    angles = np.linspace(0, 2 * np.pi, 13)[:-1]
    outline = rg.Outline.smooth(np.column_stack([2 * np.cos(angles), np.sin(angles)]))
    start, goal = (
        rg.Grasp(outline.contact_at(share * outline.length, friction=0.6) for share in shares)
        for shares in ((0.03, 0.37, 0.71), (0.13, 0.47, 0.81))
    )
    for weights in (None, rg.RegraspWeights()):
        rg.plan_regrasp(
            outline, start, goal, load, friction=0.6, candidates=12, orientations=4, weights=weights
        )
    patience, margins.PATIENCE = margins.PATIENCE, 0
    try:
        rg.plan_regrasp(outline, start, goal, load, friction=0.6, candidates=12)
    finally:
        margins.PATIENCE = patience
    graph = rg.RegraspProblem(outline, start, goal, load, friction=0.6, candidates=12).graph
    assert isinstance(graph, rg.HoldGraph)
    graph.widest()


def _regrasps_in_space() -> None:
    import regrasp as rg

    box, load = rg.Mesh.box(0.06, 0.04, 0.05), rg.Wrench([0.0, 0.0, -1.0])
    ends = (
        ((0.03, 0.004, 0.003), (-0.03, 0.003, -0.004), (0.004, 0.02, 0.002), (0.003, -0.02, 0.004)),
        ((0.03, 0.006, -0.005), (-0.03, -0.006, 0.004), (0.01, -0.004, 0.025), (0.003, 0.004, -0.025)),
    )
    start, goal = (rg.Grasp(box.contact_at(point, friction=0.6) for point in points) for points in ends)
    _ = rg.RegraspProblem(box, start, goal, load, friction=0.6, candidates=12).graph.margins  # many compile
    rg.plan_regrasp(box, start, goal, load, friction=0.6, candidates=12)


def _places() -> None:
    import regrasp as rg
    from regrasp.planning.placement.levels import searching

    square = rg.Outline([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    rg.choose_grasp(square, 2, rg.Wrench([0.1, -1.0]), friction=0.6)
    pushes = rg.LoadSet.hull([rg.Wrench([0.1, 0.0]), rg.Wrench([-0.1, 0.0])])
    rg.choose_grasp(
        square, 2, rg.Wrench([0.1, -1.0]), friction=0.6, objective="wrench", max_force=3.0,
        disturbance=pushes, tolerance=0.2,
    )  # fmt: skip
    few = rg.LoadSet.hull([rg.Wrench([0.1, -1.0]), rg.Wrench([-0.1, -1.0])])
    rg.choose_grasp(square, 3, few, friction=0.6, objective="force", max_force=3.0, tolerance=0.2)
    corners = ((1.0, 0.6), (-0.9, 0.0), (-0.4, -0.9))
    loads = rg.LoadSet.hull([rg.Wrench(at, turn) for at in corners for turn in (0.05, -0.05)])
    rg.choose_grasp(rg.Outline(corners), 3, loads, friction=0.4, objective="friction_use", max_force=4.0)
    many, searching.MANY = searching.MANY, 0
    try:
        rg.choose_grasp(rg.Outline(corners), 3, loads, friction=0.4, objective="friction_use", max_force=4.0)
    finally:
        searching.MANY = many
    rg.choose_grasp(
        rg.Outline.ellipse(2, 1), 3, loads, friction=0.4, objective="friction_use", max_force=4.0,
        most_boxes=512,
    )  # fmt: skip
    rg.choose_grasp(rg.Mesh.box(1, 1, 1), 3, rg.Wrench([0, 0, -1.0]), friction=0.6, tolerance=0.1)


def _wrench_balls() -> None:
    import regrasp as rg

    sides = ((1.0, 0.1, 0.0), (-1.0, 0.0, 0.1), (0.0, 1.0, 0.1), (0.1, -1.0, 0.0))
    for d in (2, 3):
        grasp = rg.Grasp(
            rg.Contact(side[:d], normal=[-round(x) for x in side[:d]], friction=0.5) for side in sides
        )
        for norm in ("Linf", "L1"):
            rg.wrench_ball(grasp, limit=1.0, norm=norm)


_WORKS = {
    "least forces": _least_forces,
    "batches of grasps": _batches,
    "regrasps in the plane": _planar_regrasps,
    "regrasps in space": _regrasps_in_space,
    "places of fingers": _places,
    "wrench balls": _wrench_balls,
}
