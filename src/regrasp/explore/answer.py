"""What regrasp says of a question, as plain data to draw: states, locus, plan, proof, or the escape."""

from math import isfinite
from time import perf_counter
from typing import Any

import numpy as np

from regrasp.errors import Infeasible, RegraspError
from regrasp.explore.plain import plain
from regrasp.explore.question import Question, Shape
from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.planning.changes.finger_change import plan_removal
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.two_fingers import EquilibriumLocus
from regrasp.plans.transition import Transition
from regrasp.verification import verify

INSTANTS = 41
_ALONG_LOCUS = 41


def answer(question: Question, shape: Shape | None = None) -> dict[str, Any]:
    """Forces over time with their margins and proof, or why there are none.

    Args:
        question: what is asked.
        shape: contacts move to its nearest points, and take its normals.

    Returns:
        Plain data: ``contacts`` as they are used, ``holds``, ``says``, and ``locus``, ``plan``, ``state`` and
        ``escape`` where there is one; ``milliseconds`` it took.
    """
    began = perf_counter()
    found: dict[str, Any] = {"holds": False}
    try:
        asked = question.on(shape)
        found["contacts"] = list(asked.contacts)
        _answer(asked, found)
    except Infeasible as error:  # what would help takes too long to say while something is dragged
        found |= {"holds": False, "says": error.reason}
        if isinstance(error.certificate, EscapeTwist):
            found["escape"] = _escape(error.certificate)
    except RegraspError as error:
        found |= {"holds": False, "says": str(error)}
    return found | {"milliseconds": 1e3 * (perf_counter() - began)}


def _answer(asked: Question, found: dict[str, Any]) -> None:
    grasp, load = asked.grasp, asked.wrench
    whole = choose_state(grasp, load, "force" if asked.leaves else asked.objective)
    found["state"] = _state(whole)
    if asked.leaves is None:
        found |= {"holds": True, "says": _held(whole)}
        return
    rest = grasp.without(asked.leaves)
    end = None
    if len(rest) == 2 and asked.dimension == 2:
        locus = EquilibriumLocus(rest, load)
        if not locus.is_empty:
            best = choose_state(rest, load, asked.objective)
            end = best if asked.squeeze is None else _nearest(locus, asked.squeeze)
            found["locus"] = _locus(locus, locus.squeeze(best), locus.squeeze(end))
    plan = plan_removal(whole, asked.leaves, objective=asked.objective, end=end, duration=asked.duration)
    verdict = verify(plan)
    found |= {"holds": bool(verdict.ok), "says": _planned(plan, verdict.ok), "plan": _plan(plan)}


def _nearest(locus: EquilibriumLocus, squeeze: float) -> GraspState:
    """The state on the locus nearest to a squeeze, a little inside its ends."""
    low, high = locus.interval
    inside = 1e-9 * (high - low) if isfinite(high - low) else 0.0
    return locus.state(min(max(squeeze, low + inside), high - inside))


def _held(state: GraspState) -> str:
    least = np.degrees(state.margins.least_angle)
    return (
        f"Held: the least angle margin is {least:.2f} deg, the largest force {_largest(state.forces):.3g} N."
    )


def _planned(plan: Transition, proven: bool) -> str:
    least = float(np.degrees(np.nanmin(plan.margins(np.array([0.0, plan.duration])).angle)))
    proof = "proven at every instant in exact arithmetic" if proven else "NOT proven"
    return f"{plan.contact} can leave: {proof}. The least angle margin is {least:.2f} deg."


def _largest(forces: Array) -> float:
    return float(np.linalg.norm(forces, axis=-1).max())


def _state(state: GraspState) -> dict[str, Any]:
    found = {"forces": plain(_pure(state.forces)), "margins": plain(np.degrees(state.margins.angle))}
    if state.grasp.dimension == 2:
        found |= {"wrenches": plain(state.wrenches), "cones": plain(_cones(state.grasp))}
    return found


def _pure(forces: Array) -> Array:
    """Forces of soft fingers without their torques about the normal."""
    return forces[..., :3]


def _cones(grasp: Grasp) -> Array:
    """(n, 2, 3) wrenches of unit length along both edges of each planar cone."""
    normals, slopes = grasp.normals[:, None], np.array([-1.0, 1.0])[:, None] * grasp.frictions[:, None, None]
    edges = normals + slopes * np.stack([-grasp.normals[:, 1], grasp.normals[:, 0]], axis=-1)[:, None]
    edges /= np.linalg.norm(edges, axis=-1, keepdims=True)
    x, y = grasp.positions.T
    torque = x[:, None] * edges[..., 1] - y[:, None] * edges[..., 0]
    return np.concatenate([edges, torque[..., None]], axis=-1)


def _plan(plan: Transition) -> dict[str, Any]:
    times = np.linspace(0, plan.duration, INSTANTS)
    planar = {} if plan.grasp.dimension == 3 else {"wrenches": plain(plan.wrenches(times))}
    return planar | {
        "times": plain(times),
        "clock": plain(plan.scaling(times)),
        "forces": plain(_pure(plan.forces(times))),
        "margins": plain(np.degrees(plan.margins(times).angle)),
        "leaving": list(plan.leaving),
    }


def _locus(locus: EquilibriumLocus, best: float, chosen: float) -> dict[str, Any]:
    """LS_B with the least angle margin along it; an end at infinity is cut off beyond the best state."""
    low, high = locus.interval
    reach = 2 * max(abs(best), abs(chosen), _largest(locus.forces(best)))
    start, stop = (low if isfinite(low) else best - reach), (high if isfinite(high) else best + reach)
    along = np.linspace(start, stop, _ALONG_LOCUS)
    with np.errstate(all="ignore"):
        margins = np.degrees(np.fmin(*locus.margins(along).angle.T))
    return {
        "names": list(locus.grasp.names),
        "interval": plain(np.array([start, stop])),
        "bounded": [isfinite(low), isfinite(high)],
        "squeezes": plain(along),
        "margins": plain(np.maximum(margins, 0.0)),
        "best": best,
        "chosen": chosen,
        "ends": plain(locus.forces(np.array([start, stop]))),
        "wrenches": [plain(locus.state(float(x)).wrenches) for x in (start, stop)],
    }


def _escape(twist: EscapeTwist) -> dict[str, Any]:
    return {
        "names": list(twist.grasp.names),
        "centre": None if twist.centre is None else plain(twist.centre),
        "axis": None if twist.axis is None else [plain(part) for part in twist.axis],
        "twist": plain(twist.twist / twist.amount),
        "velocities": plain(twist.velocities / twist.amount),
        "helpless": list(twist.helpless),
        "proof": twist.is_proof,
    }
