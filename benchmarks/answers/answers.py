"""Answers of regrasp as plain text and numbers: what one version says of a task, kept for the next.

A plan is told by what it says of itself (``steps``, ``scaling``, ``forces``), never by the name of its class,
so that classes may be split, joined and moved between two versions.
"""

import json
import traceback
from collections.abc import Callable, Iterator, Sequence
from math import prod
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import regrasp as rg

INSTANTS = 7
"""Times at which a plan is asked for its forces: the start, the end and five between."""


class Value(NamedTuple):
    """Numbers with what their differences are judged by: the largest force, or the largest of themselves."""

    numbers: np.ndarray
    scale: float

    @classmethod
    def of(cls, numbers: Any, scale: float | None = None) -> "Value":
        """Numbers of any shape; judged by the largest of them unless a scale is given."""
        array = np.array(numbers, dtype=float)
        return cls(array, largest(array) if scale is None else scale)


Values = dict[str, Value]


def largest(numbers: np.ndarray) -> float:
    """The largest magnitude that is finite; 1 where there is none but zeros."""
    return float(np.max(abs(numbers), where=np.isfinite(numbers), initial=0.0)) or 1.0


class Told(NamedTuple):
    """What came of a task. outcome: in short, or type and text of the error. words: all that is printed."""

    outcome: str
    values: Values
    words: str = ""


class Answer(NamedTuple):
    """What came of the task ``key`` of a kind."""

    kind: str
    key: str
    told: Told


def told_by(task: Callable[[], Any]) -> Told:
    """Work a task: what it returns, or the error it raises with the certificate's twist."""
    try:
        result = task()
        return result if isinstance(result, Told) else _described(result)
    except rg.RegraspError as error:
        certificate = getattr(error, "certificate", None)
        twist = getattr(certificate, "twist", None)
        values = {} if twist is None else {"twist": Value.of(twist)}
        words = "" if certificate is None else str(certificate)
        return Told(f"{type(error).__name__}: {error}", values, words)
    except Exception as error:  # a fault of this version or of the task; compared like any other outcome
        return Told(f"{type(error).__name__}: {error}", {}, traceback.format_exc())


def _described(result: Any) -> Told:
    """A state, a plan with its verdict, a whole regrasp or a list of them."""
    if isinstance(result, (list, tuple)):
        return _listed(result, _described)
    if not hasattr(result, "duration"):
        return _state(result)
    told, verdict = (_regrasp if hasattr(result, "steps") else _plan)(result), rg.verify(result)
    judged = "verified" if verdict.ok else "not verified"
    return Told(f"{told.outcome}; {judged}", told.values, f"{told.words}\n{verdict}")


def _listed(results: Sequence[Any], describe: Callable[[Any], Told]) -> Told:
    parts = [describe(result) for result in results]
    values = {f"{k} {name}": v for k, part in enumerate(parts, 1) for name, v in part.values.items()}
    outcome = "; ".join(f"{k} {part.outcome}" for k, part in enumerate(parts, 1))
    return Told(outcome, values, "\n".join(part.words for part in parts))


def _regrasp(plan: Any) -> Told:
    outcome, values, words = _listed(plan.steps, _plan)
    moves = [f"{m.origin_name} to {m.target_name} before step {m.step + 1}" for m in plan.moves]
    values |= {
        "orientations": Value.of(plan.orientations, 1.0),
        "margin": Value.of(plan.margin, 1.0),
        "duration": Value.of(plan.duration),
        "targets": Value.of([m.target for m in plan.moves]),
    }
    if plan.steps[0].grasp.dimension == 3:
        values["rotations"] = Value.of(plan.rotations, 1.0)
    return Told(f"{outcome}; moves: {', '.join(moves) or 'none'}", values, f"{plan}\n{words}")


def _plan(plan: Any) -> Told:
    t = np.linspace(0, plan.duration, INSTANTS)
    forces = Value.of(plan.forces(t))
    values = {
        "forces": forces,
        "start": Value.of(plan.start.forces, forces.scale),
        "end": Value.of(plan.end.forces, forces.scale),
        "rates": Value.of(plan.rates(t)),
        "loads": Value.of(plan.load(t)),
        "angles": Value.of(plan.orientation(t), 1.0),
        "duration": Value.of(plan.duration),
        "balancing": Value.of(plan.record.balancing, forces.scale),
    }
    chosen = ["given"]
    for choice in plan.record.choices:
        state = getattr(plan, choice.end)
        chosen.append(f"{choice.end} for {choice.objective} by {choice.method}")
        values[f"{choice.end} value"] = _worth(state, choice.objective.removeprefix("joint "))
        values[f"{choice.end} limits"] = Value.of(choice.force_limits)
    names = ", ".join(plan.grasp.names)
    what = f"{plan.kind} with {names}, {', '.join(chosen[1:] or chosen)}, path by {plan.record.path}"
    return Told(what, values, str(plan))


def _state(state: Any) -> Told:
    forces = Value.of(state.forces)
    unit = _unit(state.criteria.objective, forces.scale)
    values = {
        "forces": forces,
        "value": Value.of(state.value, unit),
        "limits": Value.of(state.force_limits),
    }
    if state.gap is not None:
        values["gap"] = Value.of(state.gap, unit)
    return Told(f"state for {state.criteria.objective} by {state.method}", values, str(state))


def _worth(state: Any, objective: str) -> Value:
    """An objective at the end of a plan, torques of soft fingers left out."""
    margins, sizes = state.margins, state.magnitudes
    along = (state.forces[:, : state.grasp.dimension] * state.grasp.normals).sum(axis=1)
    value = {
        "angle": margins.least_angle,
        "force": margins.least_force,
        "effort": (sizes**2).sum(),
        "peak": sizes.max(),
        "peak_normal": along.max(),
        "friction_use": margins.largest_friction_use,
    }[objective]
    return Value.of(value, _unit(objective, largest(state.forces)))


def _unit(objective: str, force: float) -> float:
    """What an objective's value is measured by: a radian, a fraction, or the largest force."""
    return {"angle": 1.0, "friction_use": 1.0, "effort": force * force}.get(objective, force)


def document(data: Any, words: str) -> Told:
    """A JSON document: numbers are values, named by where they stand; everything else is the outcome."""
    values: Values = {}

    def without_numbers(data: Any, place: str) -> Any:
        if _is_numeric(data):
            values[place] = Value.of(data)
            return "numbers"
        if isinstance(data, dict):
            return {key: without_numbers(data[key], f"{place}/{key}") for key in sorted(data)}
        if isinstance(data, list):
            return [without_numbers(entry, f"{place}/{k}") for k, entry in enumerate(data)]
        return data

    outcome = json.dumps(without_numbers(data, ""))
    force = max((v.scale for place, v in values.items() if place.endswith(("/start", "/end"))), default=1.0)
    for place, value in values.items():
        if place.endswith("/balancing"):  # mostly rounding of the forces
            values[place] = value._replace(scale=force)
    return Told(outcome, values, words)


def _is_numeric(data: Any) -> bool:
    if isinstance(data, list):
        return bool(data) and all(map(_is_numeric, data))
    return isinstance(data, (int, float)) and not isinstance(data, bool)


def save(path: Path, versions: dict[str, str], answers: Sequence[Answer]) -> None:
    """All numbers in one array, to their last bit, and what they are in JSON."""
    index, flat = [], [np.empty(0)]
    for kind, key, (outcome, values, words) in answers:
        layout = [[name, value.numbers.shape, value.scale] for name, value in values.items()]
        index.append([kind, key, outcome, words, layout])
        flat += [value.numbers.ravel() for value in values.values()]
    text = json.dumps({"versions": versions, "answers": index}).encode()
    with path.open("wb") as file:
        np.savez_compressed(file, index=np.frombuffer(text, np.uint8), numbers=np.concatenate(flat))


def load(path: Path) -> tuple[dict[str, str], list[Answer]]:
    """What ``save`` wrote: versions of the packages, and the answers."""
    with np.load(path) as file:
        index, numbers = json.loads(file["index"].tobytes()), file["numbers"]
    return index["versions"], list(_read(index["answers"], numbers))


def _read(index: list[Any], numbers: np.ndarray) -> Iterator[Answer]:
    place = 0
    for kind, key, outcome, words, layout in index:
        values = {}
        for name, shape, scale in layout:
            size = prod(shape)
            values[name] = Value(numbers[place : place + size].reshape(shape), scale)
            place += size
        yield Answer(kind, key, Told(outcome, values, words))
