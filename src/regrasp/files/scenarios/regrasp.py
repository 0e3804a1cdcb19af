"""The scenario of a whole regrasp: an outline, where the fingers start and where they are to be."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Discriminator, Field, PrivateAttr, Tag, ValidationInfo, model_validator

from regrasp.errors import InvalidInput
from regrasp.files.scenarios.disturbance import Disturbance
from regrasp.files.scenarios.keys import Positive, Vector
from regrasp.files.scenarios.motions_entry import MotionsEntry
from regrasp.files.scenarios.regrasp_task import CommonTask, Ended
from regrasp.files.strict import Strict
from regrasp.mechanics.contact import Contact
from regrasp.outline.outline import Outline
from regrasp.outline.parts import PARTS
from regrasp.planning.holds.pairs import MOST_ORIENTATIONS
from regrasp.planning.holds.sequences import MAX_TURN
from regrasp.planning.regrasps.options import MOST_CANDIDATES

Ring = Annotated[list[Vector], Field(min_length=3)]
Candidates = Annotated[
    Annotated[int, Tag("number"), Field(ge=1, le=MOST_CANDIDATES)]
    | Annotated[list[float], Tag("list"), Field(min_length=1, max_length=MOST_CANDIDATES)],
    Discriminator(lambda value: "list" if isinstance(value, list) else "number"),
]

_SHAPES = ("vertices", "points", "ellipse", "part", "file")
_OF_FILES = ("scale", "unit", "layers", "tolerance")

# A position farther from the outline than this fraction of its length is in other coordinates or units.
_NEAR = 0.05

# A goal this near to one of the orientations is that one [degrees].
_SAME_DEGREES = 1e-6


class Weight(Strict):
    """The external force on the object, through its centre of mass and fixed in the world."""

    force: Vector = Field(description="[N], x and y in the object frame before it turns")
    disturbance: Disturbance | None = Field(
        None, description="deviations that every state and step withstands, in the object's frame"
    )


class OutlineEntry(Strict):
    """The boundary of the object, in one of five ways."""

    vertices: Ring | None = Field(None, description="[m], of a polygon, in either direction")
    points: Ring | None = Field(None, description="[m], of a smooth curve through them")
    ellipse: Annotated[list[Positive], Field(min_length=2, max_length=2)] | None = Field(
        None, description="[m], half axes along x and y"
    )
    part: Literal["wrench", "cam", "gear", "bracket", "bottle", "puzzle_piece"] | None = Field(
        None, description="a part that comes with regrasp"
    )
    file: Annotated[str, Field(min_length=1)] | None = Field(
        None, description="SVG, DXF or coordinates (CSV, TXT, DAT), relative to the scenario"
    )
    holes: list[Ring] = Field(
        [], description="[m], vertices of holes, of an outline from vertices, points or ellipse"
    )
    scale: Positive | None = Field(None, description="metres per unit of the file; 1 if absent")
    unit: Literal["um", "mm", "cm", "dm", "m", "km", "in", "ft", "yd", "mil", "px"] | None = Field(
        None, description="what coordinates are converted to from the unit that an SVG or DXF states"
    )
    layers: list[Annotated[str, Field(min_length=1)]] | None = Field(
        None, description="only these layers of a DXF or groups of an SVG are read; hidden ones, too"
    )
    tolerance: Positive | None = Field(
        None, description="of chords for curves and of ends that are joined [the file's units]"
    )

    _value: Outline = PrivateAttr()

    @property
    def value(self) -> Outline:
        """The outline."""
        return self._value

    @model_validator(mode="after")
    def _is_an_outline(self, info: ValidationInfo) -> "OutlineEntry":
        given = [shape for shape in _SHAPES if getattr(self, shape) is not None]
        if len(given) != 1:
            raise ValueError(
                f"expected exactly one of {', '.join(_SHAPES)}, found {', '.join(given) or 'none of them'}"
            )
        problems = []
        if self.holes and given[0] in ("part", "file"):
            problems.append(f"holes go with vertices, points or ellipse; a {given[0]} has its own")
        problems += [
            f"{key} goes with file, found {given[0]}"
            for key in _OF_FILES
            if getattr(self, key) is not None and given[0] != "file"
        ]
        if problems:
            raise ValueError("\n".join(problems))
        try:
            self._value = self._made((info.context or {}).get("folder", Path()))
        except (InvalidInput, ImportError) as error:
            raise ValueError(str(error)) from None
        return self

    def _made(self, folder: Path) -> Outline:
        if self.vertices is not None:
            return Outline(self.vertices, self.holes)
        if self.points is not None:
            return Outline.smooth(self.points, self.holes)
        if self.ellipse is not None:
            return Outline.ellipse(*self.ellipse, holes=self.holes)
        if self.part is not None:
            return PARTS[self.part]()
        asked = {key: getattr(self, key) for key in _OF_FILES if getattr(self, key) is not None}
        return Outline.from_file(folder / str(self.file), **asked)


class Places(Strict):
    """Where three fingers touch: by arc lengths or by positions."""

    arc_lengths: Annotated[list[float], Field(min_length=3, max_length=3)] | None = Field(
        None, description="[m], counter-clockwise along the outline from its first vertex"
    )
    positions: Annotated[list[Vector], Field(min_length=3, max_length=3)] | None = Field(
        None, description="[m], relative to the centre of mass; fingers touch at the nearest boundary points"
    )

    @model_validator(mode="after")
    def _one_way_to_say_it(self) -> "Places":
        if (self.arc_lengths is None) == (self.positions is None):
            found = "neither" if self.positions is None else "both"
            raise ValueError(f"expected either arc_lengths or positions, found {found}")
        return self


class RegraspTask(CommonTask):
    """How to get from the start to the goal."""

    orientations: Annotated[int, Field(ge=1, le=MOST_ORIENTATIONS)] | None = Field(
        None, description="angles of the object that are tried; all if absent; 1 forbids turning"
    )
    goal_degrees: float = Field(
        0.0,
        description="the object's angle in the end, counter-clockwise; one of the orientations if given",
    )
    candidates: Candidates = Field(
        120,
        description="points on the outline where fingers may touch: how many, or a list of arc lengths [m]",
    )
    max_turn_degrees: Annotated[float, Field(gt=0, lt=180)] | None = Field(
        None, description=f"largest turn in one step; {np.degrees(MAX_TURN):.4g} if absent"
    )
    one_finger: bool = Field(False, description="whether one finger of a hold may carry the whole load")
    arcs: Annotated[list[list[Vector]], Field(min_length=3, max_length=3)] | None = Field(
        None,
        description="[m], for each finger the arcs it may touch, counter-clockwise from one arc length to "
        "another; an empty list is the whole outline",
    )

    @model_validator(mode="after")
    def _goal_is_tried(self) -> "RegraspTask":
        if self.orientations is None:
            return self
        step = 360 / self.orientations
        if abs((self.goal_degrees + step / 2) % step - step / 2) > _SAME_DEGREES:
            raise ValueError(
                f"goal_degrees must be a multiple of 360 / orientations = {step:g}, got {self.goal_degrees:g}"
            )
        return self


class RegraspScenario(Ended):
    """A planar object with its outline, three fingers on it, and where they are to be."""

    title: str | None = Field(None, description="shown above the plan")
    friction: float = Field(ge=0, description="Coulomb coefficient all along the outline")
    load: Weight
    outline: OutlineEntry
    start: Places
    goal: Places
    motions: MotionsEntry | None = Field(None, description="ways of free fingers, asked for by --motions")
    task: RegraspTask

    @model_validator(mode="after")
    def _fits_together(self) -> "RegraspScenario":
        problems = self._end_problems()
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def _placed(self, end: Literal["start", "goal"]) -> tuple[str, list[Any], Callable[[Any], Contact]]:
        places: Places = getattr(self, end)
        if places.arc_lengths is not None:
            return "arc_lengths", places.arc_lengths, self._at
        return "positions", places.positions or [], lambda position: self._at(self._nearest(position))

    def _at(self, arc_length: float) -> Contact:
        return self.outline.value.contact_at(arc_length, friction=self.friction)

    def _nearest(self, position: list[float]) -> float:
        outline = self.outline.value
        s = outline.nearest(np.array(position) + outline.centre_of_mass)
        off = float(np.linalg.norm(outline.points(s) - position))
        if off > _NEAR * outline.length:
            raise InvalidInput(
                f"({position[0]:g}, {position[1]:g}) is {off:.3g} m from the outline; "
                f"positions are relative to its centre of mass, in metres"
            )
        return s
