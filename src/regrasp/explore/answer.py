"""What regrasp says of a question, as plain data to draw: states, locus, plan, proof, or the escape."""

from math import isfinite
from time import perf_counter
from typing import Any

import numpy as np

from regrasp.errors import Infeasible, RegraspError
from regrasp.explore.question import Question
from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.state import GraspState
from regrasp.outline.outline import Outline
from regrasp.planning.changes.finger_change import plan_removal
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.two_fingers import EquilibriumLocus
from regrasp.plans.transition import Transition
from regrasp.verification import verify

INSTANTS = 41
_ALONG_LOCUS = 41


def answer(question: Question, outline: Outline | None = None) -> dict[str, Any]:
    """Forces over time with their margins and proof, or why there are none.

    Args:
        question: what is asked.
        outline: contacts move to its nearest points, and take its normals.

    Returns:
        Plain data: ``contacts`` as they are used, ``holds``, ``says``, and ``locus``, ``plan``, ``state`` and
        ``escape`` where there is one; ``milliseconds`` it took.
    """
    began = perf_counter()
    found: dict[str, Any] = {"holds": False}
    try:
        asked = question.on(outline)
        found["contacts"] = list(asked.contacts)
        _answer(asked, found)
    except Infeasible as error:
        found |= {"holds": False, "says": str(error)}
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
    if len(rest) == 2:
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
    return float(np.hypot(*np.moveaxis(forces, -1, 0)).max())


def _state(state: GraspState) -> dict[str, Any]:
    return {"forces": _plain(state.forces), "margins": _plain(np.degrees(state.margins.angle))}


def _plan(plan: Transition) -> dict[str, Any]:
    times = np.linspace(0, plan.duration, INSTANTS)
    return {
        "times": _plain(times),
        "clock": _plain(plan.scaling(times)),
        "forces": _plain(plan.forces(times)),
        "margins": _plain(np.degrees(plan.margins(times).angle)),
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
        "interval": _plain(np.array([start, stop])),
        "bounded": [isfinite(low), isfinite(high)],
        "squeezes": _plain(along),
        "margins": _plain(np.maximum(margins, 0.0)),
        "best": best,
        "chosen": chosen,
        "ends": _plain(locus.forces(np.array([start, stop]))),
    }


def _escape(twist: EscapeTwist) -> dict[str, Any]:
    return {
        "names": list(twist.grasp.names),
        "centre": None if twist.centre is None else _plain(twist.centre),
        "twist": _plain(twist.twist / twist.amount),
        "velocities": _plain(twist.velocities / twist.amount),
        "helpless": list(twist.helpless),
        "proof": twist.is_proof,
    }


def _plain(values: Array) -> Any:
    """Nested lists of seven digits, null where a number is none."""
    rounded: Any = np.vectorize(lambda v: float(f"{v:.7g}"), otypes=[float])(values)
    return _finite(rounded.tolist())


def _finite(value: Any) -> Any:
    if isinstance(value, list):
        return [_finite(entry) for entry in value]
    return value if isfinite(value) else None
