"""Where fingers can stand and which of their holds hold, for the searches over finger moves."""

from abc import ABC, abstractmethod
from copy import copy
from itertools import permutations
from math import pi
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array

if TYPE_CHECKING:
    from regrasp.closed_form.compiled.hold_paths import Moves

Places = tuple[int, ...]
"""Contacts of a stance by their places in a graph, in the order of the fingers where that matters."""

Holds = tuple[int, ...]
"""The numbers of the holds of a stance: all its contacts but one."""


REACH = pi - 1e-6
"""Two holds farther apart [rad] may hold nothing between them."""


class Stances(ABC):
    """Stances of some fingers on contacts, all but one of which hold (``hold_paths``).

    holds: how holds are numbered, as the compiled ``stances`` take it. rows: (H,) the row of margins of each
    hold. margins: (rows, O) [rad], -1 where it does not hold, or was not looked at. count: of contacts.
    near: (O, k) from where the object may turn to an orientation within a stance, the nearest first; turning:
    (O, k) these turns [rad]. apart: (O, O) angles between all orientations [rad]; further: (O, O) how many
    steps such a turn takes beyond one, inf where it is too large. largest: turn in a step, and within a
    stance [rad]. least: margin below which a hold is none [rad]. allowed: (fingers, V) which finger may touch
    which contact; None where all may touch all.
    """

    fingers: ClassVar[int]
    holds: tuple[Any, ...]
    rows: NDArray[np.int64]
    margins: NDArray[np.float32]
    count: int
    near: NDArray[np.int64]
    turning: Array
    apart: Array
    further: Array
    allowed: NDArray[np.bool_] | None
    largest: tuple[float, float]
    least: float

    def look_at(self, holds: Any) -> None:  # noqa: B027 - where all margins are known already
        """Holds (n,) by their numbers whose margins are about to be read."""

    def look_around(  # noqa: B027 - as above
        self, frontier: NDArray[np.int64], wanted: NDArray[np.bool_]
    ) -> None:
        """The same for the holds of all stances of a frontier (n,) that have one of the ``wanted`` (H,)."""

    def look_at_all(self) -> None:  # noqa: B027 - as above
        """The same for all holds."""

    def lower(self, row: int, o: int, margin: float) -> None:
        """Of a hold no more than a margin [rad] counts."""
        now = min(float(self.margins[row, o]), margin)
        self.margins[row, o] = now if now >= self.least else -1.0

    @property
    @abstractmethod
    def moves(self) -> "Moves":
        """The compiled loops over stances."""

    @abstractmethod
    def of(self, contacts: Places) -> Holds:
        """The holds of a stance."""

    @abstractmethod
    def points(self, hold: int) -> tuple[int, ...]:
        """The contacts of a hold, rising."""

    @abstractmethod
    def renumbered(self, numbers: NDArray[np.int64], kept: NDArray[np.int64]) -> tuple[Any, ...]:
        """``holds`` with other numbers, of the holds ``kept``."""

    def turns(self, max_turn: float, reach: float) -> None:
        """Sets what follows from ``apart``: steps of ``max_turn`` at most, ``reach`` in all [rad].

        Two holds of one stance, less than pi apart, hold everything between them together (docs/facts.md, 6):
        where that is more than a step may turn, all fingers of the stance take part on the way.
        """
        self.largest = max_turn, reach
        self.near, self.turning = nearest_turns(self.apart, reach)
        steps = np.maximum(np.ceil(self.apart / max_turn - 1e-9), 1.0)
        self.further = np.where(self.apart <= reach + 1e-9, steps - 1, np.inf)

    def start(self, contacts: Places) -> Places:
        """The contacts in the order in which ``ways`` gives them."""
        return contacts if self.allowed is not None else tuple(sorted(contacts))

    def ways(self, contacts: Places) -> list[Places]:
        """How the fingers may take contacts: one way where it does not matter which is which."""
        if self.allowed is None:
            return [tuple(sorted(contacts))]
        return [w for w in permutations(contacts) if all(self.allowed[f, v] for f, v in enumerate(w))]

    def only(self, useful: NDArray[np.bool_]) -> "Stances":
        """The same with useful holds numbered alone; the last number stands for all others: no holds."""
        few = copy(self)
        kept = np.append(np.flatnonzero(useful), 0)
        numbers = np.where(useful, np.cumsum(useful) - 1, kept.size - 1)
        few.margins = self.margins[self.rows[kept]]
        few.margins[-1] = -1.0
        few.holds = self.renumbered(numbers, kept)
        few.rows = np.arange(kept.size)
        return few


def nearest_turns(apart: Array, reach: float) -> tuple[NDArray[np.int64], Array]:
    """(O, k) orientations within ``reach`` [rad] of each, the nearest first; the turns [rad]."""
    within = apart <= reach + 1e-9
    order = np.argsort(np.round(apart, 9), axis=1, kind="stable")[:, : within.sum(axis=1).max()]
    own = np.arange(len(order))[:, None]  # fills the row where fewer are near
    near = np.where(np.take_along_axis(within, order, axis=1), order, own).astype(np.int64)
    return near, np.take_along_axis(apart, near, axis=1)
