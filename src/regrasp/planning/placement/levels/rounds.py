"""Rounds of boxes that are judged side by side, by threads that share them, and then taken one by one.

What is judged depends on the level alone, and boxes are dealt out to as many parts on any machine: threads
change the time that a search takes, and no number of it. A round is judged at one level: after a better one
the boxes that are left of it are judged again, so the first round at each level is short.
"""

from collections import deque
from collections.abc import Callable
from itertools import islice
from typing import Any, Generic, TypeVar

from regrasp.planning.placement.parts import PARTS, side_by_side
from regrasp.planning.placement.search import Search

_FIRST, _MOST = 8, 64  # boxes of a round

Verdict = TypeVar("Verdict")
Judge = Callable[[Search, int, Any], Verdict]
"""Of a box of a search, in memory that is its own: changes nothing else."""


class Rounds(Generic[Verdict]):
    """The rounds of a search.

    memory: makes that of one part.
    """

    def __init__(self, search: Search, judge: Judge[Verdict], memory: Callable[[], Any]) -> None:
        self._search, self._judge = search, judge
        self._rooms, self._size = [memory() for _ in range(PARTS)], _FIRST

    def begin(self) -> None:
        """At another level."""
        self._size = _FIRST

    def next(self, waiting: deque[int]) -> list[tuple[int, Verdict]]:
        """The first boxes that wait, judged."""
        nodes = list(islice(waiting, self._size))
        self._size = min(2 * self._size, _MOST)
        parts = side_by_side(lambda i: self._part(nodes, i), len(nodes))
        return [(node, parts[n % PARTS][n // PARTS]) for n, node in enumerate(nodes)]

    def _part(self, nodes: list[int], first: int) -> list[Verdict]:
        search = self._search.beside()
        return [self._judge(search, node, self._rooms[first]) for node in nodes[first::PARTS]]
