"""One small example of every kind of value that regrasp hands out, made when it is asked for."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD, STATE


@cache
def removal() -> rg.Transition:
    return rg.plan_removal(STATE, "P3")


@cache
def bent() -> rg.Transition:
    return rg.plan_removal(GRASP, "P3", load=shaken, rate_limit=15.0, instants=11)


def shaken(t: float) -> rg.Wrench:
    return rg.Wrench([-1.5, -3.5 + np.sin(t)])


@cache
def rotation() -> rg.Transition:
    return rg.plan_rotation(removal().end.without("P3"), 0.1)


@cache
def ellipse() -> rg.Outline:
    return rg.Outline.ellipse(2, 1)


def three_on_ellipse(*places: float) -> rg.Grasp:
    outline = ellipse()
    return rg.Grasp(outline.contact_at(p * outline.length, friction=0.5) for p in places)


@cache
def problem() -> rg.RegraspProblem:
    first, last = three_on_ellipse(0.02, 0.35, 0.7), three_on_ellipse(0.2, 0.5, 0.85)
    return rg.RegraspProblem(
        ellipse(), first, last, rg.Wrench([0, -3]), friction=0.5, candidates=20, orientations=8
    )


@cache
def regrasp() -> rg.RegraspPlan:
    return problem().plans()[0]


@cache
def escape() -> rg.EscapeTwist:
    with pytest.raises(rg.Infeasible) as caught:
        rg.plan_removal(STATE, "P1")
    certificate: rg.EscapeTwist = caught.value.certificate
    return certificate


@cache
def space_grasp() -> rg.Grasp:
    arms = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]], dtype=float)
    return rg.Grasp(rg.Contact(r, -r, 0.8) for r in arms)


@cache
def mesh() -> rg.Mesh:
    return rg.Mesh.box(0.1, 0.08, 0.06)


@cache
def four_on_box() -> rg.Grasp:
    box = mesh()
    tips = ((0.05, 0.01, 0.0), (-0.05, 0.01, 0.0), (0.01, 0.04, 0.0), (0.01, -0.04, 0.01))
    return rg.Grasp(box.contact_at(box.centre_of_mass + tip, friction=0.8) for tip in tips)


@cache
def space_problem() -> rg.RegraspProblem:
    load = rg.Wrench([0, 0, -1.0])
    return rg.RegraspProblem(
        mesh(), four_on_box(), four_on_box(), load, friction=0.8, candidates=4, orientations=1
    )


WEIGHT = rg.Wrench([0, 0, -1.0])
PAIR = GRASP.without("P3")
SQUARE = [[0, 0], [4, 0], [4, 3], [0, 3]]

SQUARE_OUTLINE = rg.Outline(SQUARE)
WEIGHT_IN_PLANE = rg.Wrench([0, -1.0])


@cache
def placed() -> rg.ChosenGrasp:
    return rg.choose_grasp(SQUARE_OUTLINE, 2, rg.LoadSet.tilted(WEIGHT_IN_PLANE, 1.0), friction=0.5)


@cache
def on_faces() -> rg.FaceRegions:
    box = rg.Mesh.box(0.4, 0.3, 0.5)
    places = [[-0.1, -0.08, -0.25], [0.1, -0.08, -0.25], [0, 0.1, -0.25]]
    return rg.contact_regions(box, rg.Grasp(box.contact_at(p, friction=0.3) for p in places), WEIGHT)


@cache
def mapped() -> rg.SurfaceMap:
    return rg.surface_map(rg.Mesh.box(0.4, 0.3, 0.5), 3, WEIGHT, friction=0.5, objective="peak", count=16)


def on_outline(friction: float) -> Any:
    """Fingers on two sides of a rectangle, which hold its weight where friction is enough."""
    start, goal = (
        rg.Grasp(SQUARE_OUTLINE.contact_at(s, friction=friction) for s in places)
        for places in ((5.0, 5.5, 12.0), (5.2, 12.5, 13.0))
    )
    return rg.regrasps_on_outline(SQUARE_OUTLINE, start, goal, WEIGHT_IN_PLANE, friction=friction)


VALUES: dict[str, Callable[[], Any]] = {
    "Contact": lambda: rg.Contact([1, 2], [3, 4], 0.5, max_force=2.0, name="thumb"),
    "soft Contact": lambda: rg.Contact([1, 2, 0], [3, 4, 0], 0.5, torsion=0.01),
    "limited Contact": lambda: rg.Contact([1, 2], [3, 4], 0.5, limits=([[1, 0], [-1, 2]], [3, 4])),
    "ForceLimits": lambda: rg.torque_limits([[1.0, 0.0], [0.5, 2.0]], [1.0, 3.0]),
    "Wrench": lambda: LOAD,
    "Grasp": lambda: GRASP,
    "GraspState": lambda: STATE,
    "Margins": lambda: removal().end.margins,  # one of them is not a number
    "ChosenState": lambda: rg.choose_state(GRASP, LOAD),
    "Criteria": lambda: rg.Criteria("effort", max_force=9.0, min_normal=(0.1, 0.2)),
    "ForceCost": lambda: rg.ForceCost("mine", [1, 2], towards=[[1, 0], [0, 1]], prices=[[0, 1], [1, 0]]),
    "StraightPath": lambda: removal().path,
    "SampledPath": lambda: bent().path,
    "TurningPath": lambda: rotation().path,
    "EquilibriumLocus": lambda: rg.EquilibriumLocus(PAIR, LOAD),
    "SqueezeLocus": lambda: rg.SqueezeLocus(GRASP, LOAD),
    "EscapeTwist": escape,
    "TimeScaling": lambda: rg.TimeScaling.minimum_jerk(2.0),
    "LoadSeries": lambda: rg.LoadSeries([0, 1], [[0, 0, 0], [1, 1, 1]]),
    "straight Transition": removal,
    "bent Transition": bent,
    "turning Transition": rotation,
    "RegraspPlan": regrasp,
    "FingerMove": lambda: regrasp().moves[0],
    "RegraspProblem": problem,
    "RegraspProblem in space": space_problem,
    "RegraspWeights": lambda: rg.RegraspWeights(turning=0.5),
    "Bottleneck": lambda: problem().bottleneck(),
    "HoldGraph": lambda: problem().graph,
    "OutlineRegrasps": lambda: on_outline(0.5),
    "OutlineCut": lambda: on_outline(0.01).certificate,
    "RegraspCut": lambda: rg.RegraspCut(
        tuple(three_on_ellipse(0.1, 0.3, 0.5, 0.8)), (0, 1, 2), (0, 1, 3), (2,), 0.2, 0.5
    ),
    "Outline, polygon with a hole": lambda: rg.Outline(SQUARE, holes=[[[1, 1], [2, 1], [2, 2]]]),
    "Outline, smooth": lambda: rg.Outline.smooth(SQUARE),
    "Outline, ellipse": ellipse,
    "Mesh": mesh,
    "Verification": lambda: rg.verify(removal()),
    "HeldDirections": lambda: rg.held_directions(PAIR),
    "HeldSphere": lambda: rg.held_sphere(space_grasp(), count=12),
    "PyramidLosses": lambda: rg.pyramid_losses(space_grasp(), WEIGHT, facets=(3, 4)),
    "Closure": lambda: rg.closure(GRASP),
    "Closure, none": lambda: rg.closure(PAIR.subset(["P1"])),
    "WrenchBall": lambda: rg.wrench_ball(GRASP, limit=1.0),
    "Measure": lambda: rg.quality(GRASP).measures[0],
    "Quality": lambda: rg.quality(GRASP),
    "BatchStates": lambda: rg.choose_states(PAIR.positions, PAIR.normals, PAIR.frictions, LOAD.force),
    "BatchTolerances": lambda: rg.batch_tolerances(
        GRASP.positions, GRASP.normals, GRASP.frictions, STATE.forces
    ),
    "MarginCurve": lambda: rg.margin_curve(PAIR, LOAD, count=3),
    "Tolerances": lambda: rg.tolerances(STATE.balanced()),
    "LeastFriction": lambda: rg.least_friction(PAIR, LOAD),
    "LargestLoad": lambda: rg.largest_load(PAIR, LOAD, max_force=20.0),
    "HeldCentres": lambda: rg.held_centres(PAIR, rg.Wrench(LOAD.force), max_force=20.0),
    "ChosenGrasp": placed,
    "ContactRegions": lambda: rg.contact_regions(SQUARE_OUTLINE, placed().grasp, WEIGHT_IN_PLANE),
    "PlacementMap": lambda: rg.placement_map(SQUARE_OUTLINE, WEIGHT_IN_PLANE, friction=0.5, count=8),
    "FaceRegions": on_faces,
    "SurfaceMap": mapped,
    "OtherGrasp": lambda: placed().others[0],
    "PlacementProof": lambda: placed().certificate,
    "LoadSet": lambda: rg.LoadSet.ball(LOAD, force=1.0, torque=0.1),
    "LoadSet, hull": lambda: rg.LoadSet.hull([LOAD, rg.Wrench([0, -1.0])]),
    "LoadSet, tilted": lambda: rg.LoadSet.tilted(LOAD, 0.3).scaled(2.0),
    "LoadSet, tilts": lambda: rg.LoadSet.tilted(LOAD, 0.3).deviations,
    "Sensitivity": lambda: rg.sensitivity(PAIR, LOAD),
}
