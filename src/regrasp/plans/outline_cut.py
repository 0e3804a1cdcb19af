"""Why no regrasp exists anywhere on an outline: a cut of its places that no hold crosses."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array, number, numbers_in
from regrasp.mechanics.plain import entries
from regrasp.mechanics.value import ArrayValue

_WIDTHS = {"start": 2, "goal": 2, "reached": 3, "boxes": 6, "twists": 3}
_OPTIONAL = ("turned", "forbidden")


@dataclass(frozen=True, eq=False)
class OutlineCut(ArrayValue):
    """The places of an outline in two parts: no regrasp leads from a start in one to a goal in the other.

    The object keeps its orientation, or turns within bounds, and two of three fingers hold it while the third
    moves, so every hold shares a place with the next. Boxes of places cover all pairs of one place from
    either part; each has a twist that does work against no force of fingers in it while the load does work
    at both ends of the turn, so that none holds there or between. The start's pairs are on its side, or
    excluded too, the goal's on the other. ``verify`` decides all that in rationals, the tiling included.

    Not covered: other orientations, fingers that slide or roll, fingers on holes.

    Args:
        vertices: (k, 2) of a polygon, counter-clockwise, relative to the centre of mass [m]; side i runs from
            vertex i to the next.
        friction: Coulomb coefficient of all fingers [-].
        force: (2,) on the object, through its centre of mass [N].
        start: (3, 2) places: a side, and the fraction of it passed.
        goal: (3, 2) places.
        reached: (r, 3) the start's part: a side and the fractions where an arc begins and ends.
        boxes: (m, 6) two sides, then the ends on the one and on the other.
        twists: (m, 3) velocity of the centre of mass and angular velocity, any scale.
        turned: (2,) the force where the object has turned as far as it may, less than half a turn from
            ``force``, which is then that at the other end [N]; the same if not given.
        forbidden: sides that no finger touches.
    """

    vertices: Array
    friction: float
    force: Array
    start: Array
    goal: Array
    reached: Array
    boxes: Array
    twists: Array
    turned: Array | None = None
    forbidden: Array = ()  # type: ignore[assignment]

    def __post_init__(self) -> None:
        vertices = array(self.vertices, "vertices of a cut", (None, 2))
        if len(vertices) < 3:
            raise InvalidInput(f"vertices of a cut must be three or more, got {len(vertices)}")
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "friction", number(self.friction, "friction", above=0))
        object.__setattr__(self, "force", array(self.force, "force", (2,)))
        turned = self.force if self.turned is None else self.turned
        object.__setattr__(self, "turned", array(turned, "turned", (2,)))
        sides = numbers_in(self.forbidden, "forbidden must be numbers of sides")
        sides = array(sides, "forbidden", (None,)) if sides.size else np.empty(0)
        sides.setflags(write=False)
        object.__setattr__(self, "forbidden", sides)
        if not np.isin(self.forbidden, np.arange(len(vertices))).all():
            raise InvalidInput(f"forbidden must be sides, whole numbers from 0 to {len(vertices) - 1}")
        for name, width in _WIDTHS.items():
            rows = numbers_in(getattr(self, name), f"{name} must be rows of {width} numbers")
            rows = array(rows.reshape(-1, width) if rows.size == 0 else rows, name, (None, width))
            object.__setattr__(self, name, rows)
        if len(self.start) != 3 or len(self.goal) != 3:
            raise InvalidInput("start and goal of a cut must be three places each")
        if len(self.boxes) != len(self.twists):
            raise InvalidInput(
                f"a cut has a twist for every box, got {len(self.twists)} for {len(self.boxes)}"
            )
        placed = {"start": (0,), "goal": (0,), "reached": (0,), "boxes": (0, 1)}
        for name, columns in placed.items():
            sides = getattr(self, name)[:, columns]
            if (sides != np.floor(sides)).any() or (sides < 0).any() or (sides >= len(vertices)).any():
                raise InvalidInput(f"sides in {name} must be whole numbers from 0 to {len(vertices) - 1}")
            fractions = np.delete(getattr(self, name), columns, axis=1)
            if (fractions < 0).any() or (fractions > 1).any():
                raise InvalidInput(f"fractions of sides in {name} must be from 0 to 1")

    def to_dict(self) -> dict[str, Any]:
        """The cut as plain data, which JSON can hold; ``from_dict`` gives back the equal cut."""
        tables = ("vertices", "force", *_WIDTHS, *_OPTIONAL)
        return {"friction": self.friction} | {name: getattr(self, name).tolist() for name in tables}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "OutlineCut":
        """The cut of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``OutlineCut`` does.
        """
        return cls(**entries(data, "an outline cut", ("friction", "vertices", "force", *_WIDTHS), _OPTIONAL))

    def __repr__(self) -> str:
        return f"OutlineCut({len(self.vertices)} sides, {len(self.reached)} arcs, {len(self.boxes)} boxes)"

    def __str__(self) -> str:
        still = np.array_equal(self.turned, self.force)  # type: ignore[arg-type]
        return (
            f"a cut of {len(self.vertices)} sides into {len(self.reached)} arcs on the start's side and "
            f"the rest, with {len(self.boxes)} boxes that no hold is in at "
            f"{'this orientation' if still else 'any orientation between'}"
        )
