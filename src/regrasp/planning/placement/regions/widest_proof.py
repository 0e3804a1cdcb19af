"""The proof that no regions around a grasp have a wider least arc."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from regrasp.mechanics.checks import Array, array, number, read_only
from regrasp.mechanics.plain import entries, listed
from regrasp.mechanics.value import ArrayValue


@dataclass(frozen=True, eq=False, repr=False)
class WidestProof(ArrayValue):
    """Boxes of places where arcs may begin, each with a placement that is in all of these arcs and fails.

    A place is u, the number of an edge plus the fraction of it passed.

    Args:
        bound: no arcs around all places, on their sides, are all longer and hold the loads [m].
        places: (k,) u that the arcs are around.
        starts: (c, k, 2) boxes of u, least and largest, which cover all where such arcs could begin.
        at: (c, k) u of fingers of a placement that is within all arcs that begin in the box.
        loads: (c, 3) that these do not hold by forces below the limit [N, N m].
        twists: (c, 3) which show it: velocity of the centre of mass, then angular velocity.
    """

    bound: float
    places: Array
    starts: Array
    at: Array
    loads: Array
    twists: Array

    def to_dict(self) -> dict[str, Any]:
        """The proof as plain data, which JSON can hold."""
        return {
            "bound": self.bound,
            "places": self.places.tolist(),
            "starts": self.starts.tolist(),
            "at": self.at.tolist(),
            "loads": self.loads.tolist(),
            "twists": self.twists.tolist(),
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], fingers: int) -> Self:
        """The proof of plain data, of so many fingers. Raises ``InvalidInput`` for what is none."""
        given = entries(data, "a proof of the widest", ("bound", "places", "starts", "at", "loads", "twists"))
        starts = listed(given["starts"], "starts")
        c, k = len(starts), fingers

        def rows(name: str, *shape: int) -> Array:
            none = c == 0 and given[name] == []  # where sides end, no box is needed
            return read_only(np.zeros((0, *shape))) if none else array(given[name], name, (c, *shape))

        return cls(
            number(given["bound"], "bound", least=0),
            array(given["places"], "places", (k,)),
            rows("starts", k, 2),
            rows("at", k),
            rows("loads", 3),
            rows("twists", 3),
        )

    def __repr__(self) -> str:
        return f"WidestProof(no least arc above {self.bound:.6g}, {len(self.at)} boxes)"
