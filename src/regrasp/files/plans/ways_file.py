"""Ways through the air as a JSON file beside their plan, with the shape that they go around."""

import json
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from regrasp.disk.staging import whole_file
from regrasp.errors import InvalidInput, shown
from regrasp.files.plans.json_text import data_of
from regrasp.files.plans.setpoints import check_plan
from regrasp.files.source import naming
from regrasp.files.strict import Strict, validated
from regrasp.mechanics.checks import array, file_path
from regrasp.mesh.mesh import Mesh
from regrasp.motions.rounded import RoundedWay
from regrasp.motions.value import Motion, Motions
from regrasp.outline.outline import Outline
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
_ROUNDING = 1e-9  # of a side: how far two roundings may meet
_LONGEST = 1e5  # a capsule, in clearances: it is judged at points half a clearance apart


class _Mesh(Strict):
    vertices: list[list[float]]
    faces: list[list[int]]
    smooth: bool
    crease: float


class _Shape(Strict):
    outline: dict[str, Any] | None = None
    mesh: _Mesh | None = None


class _Motion(Strict):
    step: Annotated[int, Field(ge=0)]
    finger: Annotated[int, Field(ge=0)]
    origin: str
    target: str
    points: list[list[float]]
    cuts: list[Positive]
    duration: Positive
    start: NotNegative
    to_object: float | None  # JSON has no infinity: None where there is nothing
    to_tips: float | None


class _Ways(Strict):
    format: Literal["regrasp ways"]
    version: Literal[1]
    shape: _Shape
    tip_radius: Positive
    clearance: Positive
    capsules: list[list[float]]
    tips: list[list[list[float]]]
    contacts: list[list[bool]]
    motions: list[_Motion]


class Ways(NamedTuple):
    """Ways of a plan's fingers, and what they go around.

    Args:
        motions: as ``plan_motions`` returned them.
        shape: the ``Outline`` or ``Mesh`` that they go around.
    """

    motions: Motions
    shape: Outline | Mesh


def write_ways(motions: Motions, shape: Outline | Mesh, path: str | Path) -> None:
    """Write the ways of fingers with everything that, beside their plan, is needed to judge them and go them.

    Args:
        motions: what ``plan_motions`` returns.
        shape: the ``Outline`` or ``Mesh`` that it was given.
        path: the file, in JSON; every number reads back as the same double.

    Raises:
        InvalidInput: For what is no motions or no shape, and where the file cannot be written.
    """
    if not isinstance(motions, Motions):
        raise InvalidInput(f"write_ways needs motions, got {shown(motions)}")
    if not isinstance(shape, Outline | Mesh):
        raise InvalidInput(f"shape must be an Outline or a Mesh, got {shown(shape)}")
    document = {
        "format": "regrasp ways",
        "version": 1,
        "shape": {"outline": shape.to_dict()} if isinstance(shape, Outline) else {"mesh": _solid(shape)},
        "tip_radius": motions.tip_radius,
        "clearance": motions.clearance,
        "capsules": motions.capsules.tolist(),
        "tips": motions.tips.tolist(),
        "contacts": motions.contacts.tolist(),
        "motions": [_written(motion) for motion in motions.motions],
    }
    path = file_path(path)
    with naming(path):
        _motions(validated(_Ways, document, path), motions.plan)
    with whole_file(path) as file:
        json.dump(document, file, indent=1, allow_nan=False, ensure_ascii=False)
        file.write("\n")


def read_ways(path: str | Path, plan: Transition | RegraspPlan) -> Ways:
    """The ways of a file that ``write_ways`` wrote, and their shape; ``verify_motions`` judges them.

    Args:
        path: the file.
        plan: whose fingers go them.

    Raises:
        InvalidInput: In one message that names the file, for what is no such file, or one of another plan.
    """
    path = file_path(path)
    check_plan(plan)
    data = data_of(path, "ways of fingers")
    if not isinstance(data, dict) or data.get("format") != "regrasp ways":
        raise InvalidInput(f'{path}: expected ways of fingers with "format": "regrasp ways"')
    stored = validated(_Ways, data, path)
    with naming(path):
        return Ways(_motions(stored, plan), _shape(stored.shape))


def _solid(mesh: Mesh) -> dict[str, Any]:
    return {
        "vertices": mesh.vertices.tolist(),
        "faces": mesh.faces.tolist(),
        "smooth": mesh.smooth,
        "crease": mesh.crease,
    }


def _shape(stored: _Shape) -> Outline | Mesh:
    if (stored.outline is None) == (stored.mesh is None):
        raise InvalidInput("shape must have either outline or mesh")
    if stored.outline is not None:
        return Outline.from_dict(stored.outline)
    assert stored.mesh is not None
    given = stored.mesh
    return Mesh(given.vertices, given.faces, smooth=given.smooth, crease=given.crease)


def _written(motion: Motion) -> dict[str, Any]:
    return {
        "step": motion.step,
        "finger": motion.finger,
        "origin": motion.origin,
        "target": motion.target,
        "points": motion.way.points.tolist(),
        "cuts": motion.way.cuts.tolist(),
        "duration": motion.duration,
        "start": motion.start,
        "to_object": None if np.isinf(motion.to_object) else motion.to_object,
        "to_tips": None if np.isinf(motion.to_tips) else motion.to_tips,
    }


def _motions(stored: _Ways, plan: Transition | RegraspPlan) -> Motions:
    """Of a plan; whether they keep clear of anything is not asked here."""
    steps = plan.steps if isinstance(plan, RegraspPlan) else (plan,)
    fingers = len(plan.fingers[0]) if isinstance(plan, RegraspPlan) else len(steps[0].grasp)
    d, known = steps[0].grasp.dimension, {str(name) for step in steps for name in step.grasp.names}
    tips = array(stored.tips, "tips", (len(steps) + 1, fingers, d))
    capsules = array(stored.capsules, "capsules", (fingers, d))
    if [len(row) for row in stored.contacts] != [fingers] * (len(steps) + 1):
        raise InvalidInput(
            f"contacts: expected {len(steps) + 1} rows, one more than steps, of {fingers} each"
        )
    if np.linalg.norm(capsules, axis=1).max() > _LONGEST * stored.clearance:
        raise InvalidInput(f"capsules: at most {_LONGEST:g} times the clearance long")
    motions = []
    for i, motion in enumerate(stored.motions):
        with naming(f"motions[{i}]"):
            motions.append(_motion(motion, len(steps), fingers, known, d))
    return Motions(
        plan, tuple(motions), tips, np.array(stored.contacts), stored.tip_radius, stored.clearance, capsules
    )


def _motion(stored: _Motion, steps: int, fingers: int, known: set[str], d: int) -> Motion:
    if stored.step > steps or stored.finger >= fingers:
        raise InvalidInput(f"the plan has {steps} steps and {fingers} fingers")
    for name in (stored.origin, stored.target):
        if name not in known:
            raise InvalidInput(f"the plan has no contact {shown(name)}")
    points = array(stored.points, "points", (None, d))
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if len(points) < 2 or not (lengths > 0).all():
        raise InvalidInput("points: expected two or more, no two in a row alike")
    cuts = array(stored.cuts, "cuts", (len(points) - 2,))
    taken = np.append(cuts, 0.0) + np.append(0.0, cuts)
    if (taken > lengths * (1 + _ROUNDING)).any():
        raise InvalidInput("cuts: corners are rounded farther than their sides are long")
    far = [np.inf if gap is None else gap for gap in (stored.to_object, stored.to_tips)]
    way = RoundedWay(points, cuts)
    return Motion(
        stored.step,
        stored.finger,
        stored.origin,
        stored.target,
        way,
        stored.duration,
        stored.start,
        far[0],
        far[1],
    )
