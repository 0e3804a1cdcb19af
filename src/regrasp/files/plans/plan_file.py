"""A plan as a JSON file: self-contained, versioned, and read back as the equal plan, bit for bit.

A whole regrasp is of kind ``regrasp`` and lists its steps, each as the plan of a transition; in space it has
the object's ``rotations`` besides.
"""

import json
from math import inf
from pathlib import Path
from typing import Any

from regrasp.disk.staging import whole_file
from regrasp.errors import InvalidInput, shown
from regrasp.files.plans.json_text import data_of, in_lines
from regrasp.files.plans.plan_schema import StoredPlan, StoredRecord, StoredRegrasp, StoredTransition
from regrasp.files.source import MOST_BYTES, naming
from regrasp.files.strict import validated
from regrasp.mechanics.checks import array, file_path
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.robust.withstood import Withstood
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.placement.chosen import ChosenGrasp
from regrasp.plans.path import Path as ForcePath
from regrasp.plans.record import Choice, Record
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.sampled import SampledPath
from regrasp.plans.straight import STRAIGHT
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Transition
from regrasp.plans.turning import TurningPath

FORMAT = "regrasp plan"
KINDS = ("removal", "addition", "exchange", "rotation", "hold", "regrasp", "grasp")
VERSION = 1


def write_plan(plan: Transition | RegraspPlan | ChosenGrasp, path: str | Path) -> None:
    """Write a plan with everything needed to read it back and verify it.

    Args:
        plan: a ``Transition``, a ``RegraspPlan`` or a ``ChosenGrasp``.
        path: the file, in JSON.

    Raises:
        InvalidInput: For a plan with numbers that are not finite, for a proof of more than 256 MiB, which
            would not be read, and where the file cannot be written.
    """
    path = file_path(path)
    document = plan_document(plan, path)
    if isinstance(plan, ChosenGrasp):  # a proof may have millions of numbers
        text = in_lines(document)
        if len(text) > MOST_BYTES:
            boxes, most = plan.certificate.leaves, MOST_BYTES >> 20
            raise InvalidInput(
                f"{path}: with a proof of {boxes} boxes it takes {len(text) >> 20} MiB, and at most {most} "
                "are read: choose with fewer most_boxes, or a larger tolerance"
            )
    else:
        text = json.dumps(document, indent=1, allow_nan=False, ensure_ascii=False)
    with whole_file(path) as file:
        file.write(f"{text}\n")


def read_plan(path: str | Path) -> Transition | RegraspPlan | ChosenGrasp:
    """The plan of a file that ``write_plan`` wrote; judge it with ``regrasp.verify``.

    Args:
        path: a file that ``write_plan`` wrote.

    Raises:
        InvalidInput: In one message, which names the file and what is wrong in it.
    """
    path = file_path(path)
    return plan_of(data_of(path, "a plan"), path)


def plan_document(plan: Transition | RegraspPlan | ChosenGrasp, name: str | Path = "plan") -> dict[str, Any]:
    """What a plan file holds, as plain data. Raises ``InvalidInput``, which begins with ``name``."""
    header = {"format": FORMAT, "version": VERSION}
    if isinstance(plan, RegraspPlan):
        document = header | _regrasp_document(plan)
        validated(StoredRegrasp, document, name)
    elif isinstance(plan, ChosenGrasp):
        document = header | {"kind": "grasp"} | plan.to_dict()
    elif isinstance(plan, Transition):
        document = header | _document(plan)
        validated(StoredPlan, document, name)
    else:
        raise InvalidInput(
            f"write_plan writes a Transition, a RegraspPlan or a ChosenGrasp, got {shown(plan)}"
        )
    return document


def plan_of(data: Any, name: str | Path = "plan") -> Transition | RegraspPlan | ChosenGrasp:
    """The plan of what a plan file holds. Raises ``InvalidInput``, which begins with ``name``."""
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        found = data.get("format") if isinstance(data, dict) else None
        other = f'"format": {shown(found)}' if isinstance(found, str) else "other JSON"
        raise InvalidInput(f'{name}: expected a plan with "format": "{FORMAT}", found {other}')
    if data.get("version") != VERSION or type(data["version"]) is not int:  # True == 1
        raise InvalidInput(
            f"{name}: version: expected {VERSION}, got {shown(data.get('version'))}; "
            f"a plan of a newer regrasp needs that regrasp to be read"
        )
    if "kind" in data and data["kind"] not in KINDS:
        known = ", ".join(map(repr, KINDS[:-1]))
        raise InvalidInput(f"{name}: kind: expected {known} or {KINDS[-1]!r}, got {shown(data['kind'])}")
    if data.get("kind") == "regrasp":
        whole = validated(StoredRegrasp, data, name)
        with naming(name):
            return _regrasp(whole)
    if data.get("kind") == "grasp":
        with naming(name):
            return ChosenGrasp.from_dict(
                {key: value for key, value in data.items() if key not in ("format", "version", "kind")}
            )
    stored = validated(StoredPlan, data, name)
    with naming(name):
        return _plan(stored)


def _regrasp_document(plan: RegraspPlan) -> dict[str, Any]:
    turned = {"rotations": plan.rotations.tolist()} if plan.rotations is not None else {}
    return {
        "kind": "regrasp",
        "orientations": list(plan.orientations),
        "margin": plan.margin,
        **turned,
        "steps": [_document(step) for step in plan.steps],
    }


def _regrasp(stored: StoredRegrasp) -> RegraspPlan:
    steps = []
    for k, step in enumerate(stored.steps):
        with naming(f"steps[{k}]"):
            steps.append(_plan(step))
    count = len(stored.orientations)
    if count != len(steps) + 1:
        raise InvalidInput(
            f"orientations: expected {len(steps) + 1} angles, one more than the steps, got {count}"
        )
    given, in_space = stored.rotations, steps[0].grasp.dimension == 3
    if in_space != (given is not None):
        problem = "a required key is missing, for the steps are in space"
        raise InvalidInput(f"rotations: {problem if in_space else 'leave them out in the plane'}")
    rotations = None if given is None else array(given, "rotations", (count, 3, 3))
    plan = RegraspPlan(tuple(steps), tuple(stored.orientations), stored.margin, rotations=rotations)
    _ = plan.moves  # raises where a step has more fingers than the first
    return plan


def _document(plan: Transition) -> dict[str, Any]:
    scaling, record, course = plan.scaling, plan.record, plan.course
    document: dict[str, Any] = {
        "kind": plan.kind,
        "contact": plan.contact,
        "load": plan.start.load.vector.tolist(),
        "contacts": [c.to_dict() for c in plan.grasp],
        "start": plan.start.forces.tolist(),
        "end": plan.end.forces.tolist(),
        "scaling": {
            "duration": scaling.duration,
            "control": list(scaling.control),
            "degree": scaling.degree,
        },
        "course": None
        if course is None
        else {
            "times": course.times.tolist(),
            "forces": course.forces.tolist(),
            "loads": course.loads.tolist(),
        },
        "record": {
            "reserve": record.reserve,
            "choices": [
                {
                    "end": c.end,
                    "objective": c.objective,
                    "method": c.method,
                    "force_limits": [None if limit == inf else limit for limit in c.force_limits],
                }
                for c in record.choices
            ],
            "balancing": record.balancing,
            "path": record.path,
            "path_objective": record.path_objective,
            "rate_limits": [None if limit == inf else limit for limit in record.rate_limits],
            "least_normals": list(record.least_normals),
        },
    }
    if record.withstands is not None:
        document["record"]["withstands"] = record.withstands.to_dict()
    if plan.arrival is not None:
        document["arrival"] = plan.arrival
    if max(len(plan.leaving), len(plan.arriving)) > 1:
        document |= {"leaving": list(plan.leaving), "arriving": list(plan.arriving)}
    if plan.turn is not None:
        document["turn"] = {
            "angles": plan.turn.angles.tolist(),
            "forces": plan.turn.forces.tolist(),
            "end_load": plan.end.load.vector.tolist(),
            "axis": None if plan.turn.axis is None else plan.turn.axis.tolist(),
            "middles": None if plan.turn.middles is None else plan.turn.middles.tolist(),
        }
    return document


def _plan(stored: StoredTransition) -> Transition:
    grasp = Grasp(Contact.from_dict(c.model_dump()) for c in stored.contacts)
    for key in ("rate_limits", "least_normals"):
        count = len(getattr(stored.record, key))
        if count not in (0, len(grasp)):
            raise InvalidInput(f"record.{key}: expected {len(grasp)} numbers or none, got {count}")
    load = Wrench.from_vector(stored.load)
    given, turned = stored.course, stored.turn
    if given is not None and turned is not None:
        raise InvalidInput("a plan has a course or a turn, not both")
    path: ForcePath = STRAIGHT
    last = load
    if given is not None:
        path = SampledPath(given.times, given.forces, given.loads)
        last = Wrench.from_vector(given.loads[-1])
    elif turned is not None:
        path = TurningPath(turned.angles, turned.forces, turned.axis, turned.middles)
        last = Wrench.from_vector(turned.end_load)
    ends = GraspState(grasp, load, stored.start), GraspState(grasp, last, stored.end)
    scaling = TimeScaling(stored.scaling.duration, tuple(stored.scaling.control), stored.scaling.degree)
    record = _read_record(stored.record)
    return Transition(*ends, scaling, record, *_moving(stored), path)


def _moving(stored: StoredTransition) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The fingers that leave and those that arrive."""
    first, second = ([] if name is None else [name] for name in (stored.contact, stored.arrival))
    leaving, arriving = (second, first) if stored.kind == "addition" else (first, second)
    if stored.leaving is not None or stored.arriving is not None:
        leaving, arriving = stored.leaving or [], stored.arriving or []
    wanted = {"removal": (True, False), "addition": (False, True), "exchange": (True, True)}
    if wanted.get(stored.kind, (False, False)) != (bool(leaving), bool(arriving)):
        article = "an" if stored.kind[0] in "ae" else "a"
        raise InvalidInput(
            f"{article} {stored.kind} names the wrong fingers: "
            f"{shown(stored.contact)} and {shown(stored.arrival)}"
        )
    return tuple(leaving), tuple(arriving)


def _read_record(record: StoredRecord) -> Record:
    choices = (
        Choice(c.end, c.objective, c.method, tuple(_unlimited(limit) for limit in c.force_limits))
        for c in record.choices
    )
    return Record(
        record.reserve,
        tuple(choices),
        record.balancing,
        record.path,
        record.path_objective,
        tuple(_unlimited(limit) for limit in record.rate_limits),
        tuple(record.least_normals),
        None if record.withstands is None else _withstood(record.withstands),
    )


def _withstood(stored: dict[str, Any]) -> Withstood:
    try:
        return Withstood.from_dict(stored)
    except InvalidInput as error:
        raise InvalidInput(f"record.withstands: {error}") from None


def _unlimited(limit: float | None) -> float:
    return inf if limit is None else limit
