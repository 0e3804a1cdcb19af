"""Verdicts on plans, and what is shown of how far a command is."""

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from regrasp.cli.statuses import VERIFIED, Unverified

if TYPE_CHECKING:
    from rich.progress import Progress

    from regrasp.planning.placement.chosen import ChosenGrasp
    from regrasp.plans.regrasp_plan import RegraspPlan
    from regrasp.plans.transition import Transition
    from regrasp.verification import MotionRowsVerification, MotionsVerification, Verification

Judged = TypeVar("Judged", bound="Verification | MotionsVerification | MotionRowsVerification")

# A plan with a thousand bad set-points says the same thing a thousand times.
_SHOWN = 10


def verified(verdict: Judged, name: str | Path) -> Judged:
    """The verdict, if it is good; else an error that lists what is broken."""
    if verdict.ok:
        return verdict
    shown, more = verdict.violations[:_SHOWN], len(verdict.violations) - _SHOWN
    lines = [*shown, f"and {more} more"] if more > 0 else shown
    raise Unverified("\n  ".join([f"{name}: does not verify:", *lines]), verdict.violations)


def verdict_facts(
    planned: "Transition | RegraspPlan | ChosenGrasp", verdict: "Verification", count: int
) -> dict[str, Any]:
    """What JSON says of a plan that verified, with ``count`` set-points."""
    return {
        "status": "verified",
        "exit": VERIFIED,
        "plan": _plan_facts(planned),
        "verification": {f.name: getattr(verdict, f.name) for f in fields(verdict)},
        "setpoints": count,
    }


def _plan_facts(planned: "Transition | RegraspPlan | ChosenGrasp") -> dict[str, Any]:
    from regrasp.planning.placement.chosen import ChosenGrasp
    from regrasp.plans.regrasp_plan import RegraspPlan

    if isinstance(planned, ChosenGrasp):
        return {
            "kind": "grasp",
            "objective": planned.objective,
            "value": planned.value,
            "bound": planned.bound,
            "gap": planned.gap,
            "places": planned.places,
            "contacts": planned.grasp.names,
            "positions": planned.grasp.positions,
            "normals": planned.grasp.normals,
        }
    if isinstance(planned, RegraspPlan):
        return {
            "kind": "regrasp",
            "duration": planned.duration,
            "margin": planned.margin,
            "finger_moves": len(planned.moves),
            "steps": [_plan_facts(step) for step in planned.steps],
        }
    return {
        "kind": planned.kind,
        "contact": planned.contact,
        "arrival": planned.arrival,
        "duration": planned.duration,
        "contacts": planned.grasp.names,
        "start": planned.start.forces,
        "end": planned.end.forces,
    }


def names_of(planned: "Transition | RegraspPlan | ChosenGrasp") -> list[str]:
    """Of all contacts of a plan."""
    return [name for step in getattr(planned, "steps", [planned]) for name in step.grasp.names]


def progress_bar() -> "Progress":
    """A display of how far something is, on stderr if that is a terminal."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    return Progress(console=console, transient=True, disable=not console.is_terminal)
