"""Why no regrasp exists anywhere on an outline: a cut of its places that no hold crosses."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import atan2, degrees
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array, number, numbers_in
from regrasp.mechanics.plain import entries
from regrasp.mechanics.value import ArrayValue

_WIDTHS = {"start": 2, "goal": 2, "reached": 3, "boxes": 6, "twists": 3}
_OPTIONAL = ("turned", "forbidden")
_LIMITS = ("min_normal", "max_force")


def limits_in_words(min_normal: float, max_force: float | None) -> str:
    """What every hold keeps; empty for nothing.

    Args:
        min_normal: least normal force [N].
        max_force: force limit [N], or None.
    """
    parts = [f"normal forces of at least {min_normal:g} N"] if min_normal > 0 else []
    parts += [f"forces of at most {max_force:g} N"] if max_force is not None else []
    return f", with {' and '.join(parts)} in every hold" if parts else ""


@dataclass(frozen=True, eq=False)
class OutlineCut(ArrayValue):
    """The places of an outline in two parts: no regrasp leads from a start in one to a goal in the other.

    The object keeps its orientation, or turns within bounds, and two of three fingers hold it while the third
    moves, so every hold shares a place with the next. Boxes of places cover all pairs of one place from
    either part; each has a twist along which the load does more work than any forces of fingers in it, within
    their limits, can take up, at both ends of the turn, so that none holds there or between. The start's
    pairs are on its side, or excluded too, the goal's on the other. ``verify`` decides all that in rationals,
    the tiling included.

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
        min_normal: with which both fingers of every hold push at the least [N]; what all three do at
            both ends is no matter of it.
        max_force: limit on the force of every finger [N]; None for none.
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
    min_normal: float = 0.0
    max_force: float | None = None

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
        object.__setattr__(self, "min_normal", number(self.min_normal, "min_normal", least=0))
        if self.max_force is not None:
            object.__setattr__(self, "max_force", number(self.max_force, "max_force", above=0))
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
        limits = {name: value for name in _LIMITS if (value := getattr(self, name))}
        return {"friction": self.friction, **limits} | {name: getattr(self, name).tolist() for name in tables}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "OutlineCut":
        """The cut of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``OutlineCut`` does.
        """
        return cls(
            **entries(
                data, "an outline cut", ("friction", "vertices", "force", *_WIDTHS), (*_OPTIONAL, *_LIMITS)
            )
        )

    def __repr__(self) -> str:
        return f"OutlineCut({len(self.vertices)} sides, {len(self.reached)} arcs, {len(self.boxes)} boxes)"

    def __str__(self) -> str:
        turned, (x, y) = np.asarray(self.turned), self.force
        turn = degrees(abs(atan2(x * turned[1] - y * turned[0], self.force @ turned)))
        return (
            f"a cut of {len(self.vertices)} sides into {len(self.reached)} arcs on the start's side and "
            f"the rest, with {len(self.boxes)} boxes that no hold is in at "
            f"{f'any orientation within a turn of {turn:.4g} deg' if turn else 'this orientation'}"
            + limits_in_words(self.min_normal, self.max_force)
        )
