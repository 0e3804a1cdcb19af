"""What the explorer begins with: a scenario, a shape with three fingers on it, or the paper's example."""

from contextlib import suppress
from dataclasses import dataclass
from importlib.resources import files
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.explore.answer import answer
from regrasp.explore.question import LONGEST_NAME, MOST_FINGERS, OBJECTIVES, Question
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.outline.parts import PARTS
from regrasp.planning.states.two_fingers import EquilibriumLocus

# Places on an outline and friction, until two fingers hold it.
_TRIED = ((24, 0.5), (60, 0.5), (60, 1.0), (120, 1.0))
_PUSH = 3.0  # the most force of a finger, for a load of 1
_SHAPES = (".svg", ".dxf", ".csv", ".txt", ".dat")


@dataclass(frozen=True)
class Start:
    """A title, a first question, and the outline contacts stay on, if there is one."""

    title: str
    question: Question
    outline: Outline | None = None

    def to_dict(self) -> dict[str, Any]:
        """Plain data for a page: the first question with its answer, and what stays."""
        rings: list[Array] = []
        if self.outline is not None:
            flat = 2e-4 * float(np.ptp(self.outline.polygon(), axis=0).max())
            rings = [self.outline.polygon(flat), *self.outline.hole_polygons(flat)]
        return {
            "title": self.title,
            "question": self.question.to_dict(),
            "answer": answer(self.question, self.outline),
            "rings": [ring.tolist() for ring in rings],
            "objectives": OBJECTIVES,
            "most": MOST_FINGERS,
        }


def start_of(given: str | None = None) -> Start:
    """What to begin with.

    Args:
        given: a scenario (.toml), a drawing (.svg, .dxf, .csv, .txt, .dat), the name of a part that comes
            with regrasp, or None for the paper's example.

    Raises:
        InvalidInput: For anything else, for objects in space, and as the readers do.
    """
    if given is None:
        text = (files("regrasp.files.scenarios") / "paper.toml").read_text(encoding="utf-8")
        from regrasp.files import parse_scenario

        return _of_scenario(parse_scenario(text, "paper.toml"), "the paper's example")
    if given in PARTS:
        return of_outline(PARTS[given](), given.replace("_", " "))
    kind = Path(given).suffix.lower()
    if kind in _SHAPES:
        return of_outline(Outline.from_file(given), Path(given).name)
    if kind != ".toml":
        raise InvalidInput(
            f"expected a scenario (.toml), a drawing ({', '.join(_SHAPES)}) or one of the parts "
            f"{', '.join(PARTS)}; got {shown(given)}"
        )
    from regrasp.files import read_scenario

    return _of_scenario(read_scenario(Path(given)), Path(given).name)


def of_outline(outline: Outline, title: str = "outline") -> Start:
    """Three fingers on an outline under a load of 1 N, two of which hold it best; the third is far from both.

    Args:
        outline: the object.
        title: shown above it.
    """
    load = Wrench([0.0, -1.0])
    for places, friction in _TRIED:
        contacts = [outline.contact_at(s, friction=friction) for s in outline.sample(places).tolist()]
        pair = _best_pair(contacts, load)
        if pair is not None:
            break
    held = [contacts[i] for i in pair or (0, len(contacts) // 2)]
    third = max(
        (c for c in contacts if c not in held),
        key=lambda c: min(float(np.hypot(*(c.position - h.position))) for h in held),
    )
    grasp = Grasp([*held, third])
    return Start(title, question_of(grasp, load, leaves=grasp.names[2]), outline)


def _best_pair(contacts: list[Contact], load: Wrench) -> tuple[int, int] | None:
    """The two contacts that hold a load with the widest force margin, so that both push."""
    best: tuple[float, tuple[int, int] | None] = (0.0, None)
    for pair in combinations(range(len(contacts)), 2):
        locus = EquilibriumLocus(Grasp(contacts[i] for i in pair), load)
        if not locus.is_empty:
            with suppress(Infeasible):  # but for a reserve
                margin = float(locus.best("force", max_force=_PUSH).margins.force.min())
                best = max(best, (margin, pair), key=lambda b: b[0])
    return best[1]


def question_of(grasp: Grasp, load: Wrench, **asked: Any) -> Question:
    """The question about a planar grasp; ``InvalidInput`` where the explorer has no place for it.

    Args:
        grasp: planar contacts.
        load: object frame [N, N m].
        asked: other fields of ``Question``.
    """
    if grasp.dimension != 2:
        raise InvalidInput("the explorer works in the plane; of a plan in space, html writes a page to turn")
    if len(grasp) > MOST_FINGERS or len(grasp) < 2:
        raise InvalidInput(f"the explorer takes 2 to {MOST_FINGERS} contacts, got {len(grasp)}")
    refuse_limits(grasp, "the explorer")
    contacts = [
        {
            "name": str(c.name)[:LONGEST_NAME],
            "position": c.position.tolist(),
            "normal": c.normal.tolist(),
            "friction": c.friction,
        }
        | ({} if c.max_force is None else {"max_force": c.max_force})
        for c in grasp
    ]
    return Question.of({"contacts": contacts, "load": load.vector.tolist()} | asked)


def _of_scenario(scenario: Any, title: str) -> Start:
    from regrasp.files import GraspScenario, RegraspScenario, Scenario

    if isinstance(scenario, RegraspScenario):
        grasp, load = scenario.start_grasp, Wrench(scenario.load.force)
        question = question_of(grasp, load, leaves=grasp.names[0])
        return Start(scenario.title or title, question, scenario.outline.value)
    if isinstance(scenario, GraspScenario):
        return of_outline(scenario.outline.value, scenario.title or title)
    if not isinstance(scenario, Scenario):
        raise InvalidInput(f"{title}: the explorer works in the plane, this scenario is in space")
    leaves = getattr(scenario.task, "contact", None)
    asked = {"leaves": leaves} if leaves is not None else {}
    if scenario.task.objective in OBJECTIVES:
        asked["objective"] = scenario.task.objective
    return Start(scenario.title or title, question_of(scenario.grasp, scenario.wrench("start"), **asked))
