"""What the explorer begins with: a scenario, a shape with fingers on it, or the paper's example."""

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from regrasp.errors import InvalidInput, shown
from regrasp.explore.answer import answer
from regrasp.explore.placing import drawn, question_of, three_and_one, two_and_one
from regrasp.explore.question import MOST_FINGERS, OBJECTIVES, Question, Shape
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.mesh.parts import PARTS as SOLIDS
from regrasp.outline.outline import Outline
from regrasp.outline.parts import PARTS

_DRAWINGS = (".svg", ".dxf", ".csv", ".txt", ".dat")
_MESHES = (".stl", ".obj", ".ply")
_SOLID = "solid-"


@dataclass(frozen=True)
class Start:
    """A title, a first question, and the outline or mesh contacts stay on, if there is one."""

    title: str
    question: Question
    shape: Shape | None = None

    def to_dict(self) -> dict[str, Any]:
        """Plain data for a page: the first question with its answer, and what stays."""
        return {
            "title": self.title,
            "question": self.question.to_dict(),
            "answer": answer(self.question, self.shape),
            "objectives": OBJECTIVES,
            "most": MOST_FINGERS,
            **drawn(self.shape),
        }


def start_of(given: str | None = None) -> Start:
    """What to begin with.

    Args:
        given: a scenario (.toml), a drawing (.svg, .dxf, .csv, .txt, .dat), a mesh (.stl, .obj, .ply), the
            name of a part that comes with regrasp, as a solid with ``solid-`` before it, or None for the
            paper's example.

    Raises:
        InvalidInput: For anything else, and as the readers do.
    """
    if given is None:
        text = (files("regrasp.files.scenarios") / "paper.toml").read_text(encoding="utf-8")
        from regrasp.files import parse_scenario

        return _of_scenario(parse_scenario(text, "paper.toml"), "the paper's example")
    if given in PARTS:
        return of_shape(PARTS[given](), given.replace("_", " "))
    if given.removeprefix(_SOLID) in SOLIDS:
        return of_shape(SOLIDS[given.removeprefix(_SOLID)](), given.removeprefix(_SOLID))
    kind, name = Path(given).suffix.lower(), Path(given).name
    if kind in _DRAWINGS:
        return of_shape(Outline.from_file(given), name)
    if kind in _MESHES:
        return of_shape(Mesh.from_file(given), name)
    if kind != ".toml":
        parts = ", ".join([*PARTS, *(_SOLID + solid for solid in SOLIDS)])
        raise InvalidInput(
            f"expected a scenario (.toml), a drawing ({', '.join(_DRAWINGS)}), a mesh ({', '.join(_MESHES)}) "
            f"or one of the parts {parts}; got {shown(given)}"
        )
    from regrasp.files import read_scenario

    return _of_scenario(read_scenario(Path(given)), name)


def of_shape(shape: Shape, title: str = "object") -> Start:
    """Fingers on a shape, one more than hold it.

    Args:
        shape: an outline or a mesh.
        title: shown above it.
    """
    return Start(title, two_and_one(shape) if isinstance(shape, Outline) else three_and_one(shape), shape)


def _of_scenario(scenario: Any, title: str) -> Start:
    from regrasp.files import GraspScenario, RegraspScenario, Scenario, SpaceGraspScenario

    title = scenario.title or title
    if isinstance(scenario, GraspScenario):
        return of_shape(scenario.outline.value, title)
    if isinstance(scenario, SpaceGraspScenario):
        return of_shape(scenario.object.value, title)
    if not isinstance(scenario, Scenario):  # a regrasp
        grasp, load = scenario.start_grasp, Wrench(scenario.load.force)
        given = scenario.outline if isinstance(scenario, RegraspScenario) else scenario.object
        return Start(title, question_of(grasp, load, leaves=grasp.names[0]), given.value)
    leaves = getattr(scenario.task, "contact", None)
    asked = {"leaves": leaves} if leaves is not None else {}
    if scenario.task.objective in OBJECTIVES:
        asked["objective"] = scenario.task.objective
    mesh = None if scenario.object is None else scenario.object.value
    return Start(title, question_of(scenario.grasp, scenario.wrench("start"), **asked), mesh)
