"""Arcs of an outline within which the fingers of a grasp may be."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.plain import listed
from regrasp.mechanics.state import GraspState
from regrasp.outline.outline import Outline
from regrasp.planning.placement.proofs.sealed import Sealed
from regrasp.planning.placement.regions.widest_proof import WidestProof

_ENDED = 1e-5


@dataclass(frozen=True, eq=False, repr=False)
class ContactRegions(Sealed):
    """Arcs of an outline, one for each finger: wherever in them the fingers are, they hold the loads.

    Args:
        shape: the outline.
        grasp: the contacts in the middle of it all.
        places: (k,) their arc lengths [m].
        arcs: (k, 2) arc lengths at which regions begin and end: all may be anywhere in theirs at once [m].
        half_width: every finger may be so far off, to either side or to the corner that ends its side less
            two millionths of the way, all at once [m].
        alone: (k, 2) how far one finger may be off, back and ahead, while the others are at their places: not
            proven by ``corners``, nor judged by ``regrasp.verify`` [m].
        max_force: no force need be larger [N].
        corners: states at all combinations of ends of the arcs, load by load: the proof (fact 12). On curves,
            and past vertices that are no corners, they are beside them, at the ends of chords, with the cones
            that all points of a part share, cell by cell.
        spans: (k, 2) of arcs on a curve or past vertices, number of the cubic or of the side and fraction of
            it passed; None of arcs on one side each.
        cells: (c, k, 2) boxes of parts of the arcs, as ``spans``, which cover all of them; None without.
        widest: the proof that around the same places no least arc is longer than its ``bound``, where that is
            what was asked for, of arcs on one side each; None elsewhere.
    """

    _what = "regions"
    shape: Outline
    grasp: Grasp
    places: Array
    arcs: Array
    half_width: float
    alone: Array
    max_force: float
    corners: tuple[GraspState, ...]
    spans: Array | None = None
    cells: Array | None = None
    widest: WidestProof | None = None

    @property
    def widths(self) -> Array:
        """(k,) of the arcs [m]."""
        result: Array = self.arcs[:, 1] - self.arcs[:, 0]
        return result

    @property
    def ended(self) -> np.ndarray:
        """(k, 2) whether there is a corner, back or ahead, before a finger is ``half_width`` off."""
        away = np.abs(self.arcs - self.places[:, None])
        return np.asarray(away < self.half_width * (1 - _ENDED))

    def __repr__(self) -> str:
        widths = ", ".join(f"{w:.4g}" for w in self.widths)
        ended = " or to the end of the side" if self.ended.any() else ""
        # a finger is at an end of its arc where other arcs were to be wide
        off = f"all off by {self.half_width:.4g}{ended}, " if self.half_width else ""
        return f"ContactRegions({off}widths {widths})"

    def __str__(self) -> str:
        ended = ", or to the end of its side" if self.ended.any() else ""
        off = f": all at once {self.half_width:.6g} either way{ended}" if self.half_width else ""
        rows = [f"how far fingers may miss along the outline{off}"]
        rows.append(f"{'':10}{'anywhere from':>14}{'to':>14}{'alone, back':>14}{'ahead':>14}")
        ways = np.hstack([self.arcs, self.alone])
        ways[np.abs(ways) < _ENDED * self.shape.length] = 0.0
        for name, numbers in zip(self.grasp.names, ways, strict=True):
            rows.append(f"{name:10}" + "".join(f"{number:14.6g}" for number in numbers))
        return "\n".join(rows)

    @classmethod
    def _checked(cls, given: dict[str, Any]) -> Self:
        grasp, spans, cells = Grasp.from_dict(given["grasp"]), given.get("spans"), given.get("cells")
        widest = given.get("widest")
        k = len(grasp)
        if grasp.dimension != 2:
            raise InvalidInput("regions on an outline have a grasp in the plane")
        return cls(
            Outline.from_dict(given["shape"]),
            grasp,
            array(given["places"], "places", (k,)),
            array(given["arcs"], "arcs", (k, 2)),
            number(given["half_width"], "half_width", least=0),
            array(given["alone"], "alone", (k, 2)),
            number(given["max_force"], "max_force", above=0),
            tuple(GraspState.from_dict(state) for state in listed(given["corners"], "corners")),
            None if spans is None else array(spans, "spans", (k, 2)),
            None if cells is None else array(cells, "cells", (None, k, 2)),
            None if widest is None else WidestProof.from_dict(widest, k),
        )
