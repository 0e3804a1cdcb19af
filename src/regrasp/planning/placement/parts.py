"""A round of the branch and bound in parts, which threads run side by side.

The open boxes, the best first, are dealt out to the parts in turn. Each searches its own queue for so many
boxes, from the best value known when the round began, and keeps what it makes in a stretch of the memory;
then queues, values and placements tried are put together again. How many parts there are does not depend
on the machine, nor do they on one another within a round: threads change the time that a search takes, and
no number of it.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.threads import threads

_PARTS = 4
_EACH = 256  # boxes that a part looks at in a round, at most
_FROM = 4096  # boxes: smaller searches stay in one part, and as quick as they are
_OPEN = 64  # boxes of a part at least, or the first of them are much better than what is split after them

Boxes = tuple[np.ndarray, ...]
PartSearch = Callable[["Queue", int], int]
"""Goes on with a queue for so many boxes and says why it ended, as the compiled search does."""


@dataclass
class Queue:
    """What a search goes on from, as the compiled search takes it; see there.

    heap: open boxes, of which ``state`` says how many; and how many boxes there are, and placements tried.
    """

    boxes: Boxes
    heap: np.ndarray
    state: np.ndarray
    found: Array
    tried: Array

    @property
    def fingers(self) -> int:
        """How many."""
        return int(self.boxes[0].shape[1])

    @property
    def is_for_parts(self) -> bool:
        """Whether it is long enough."""
        return bool(self.state[0] >= _FROM and self.state[1] >= _PARTS * _OPEN)

    @property
    def has_room(self) -> bool:
        """Whether a round in parts fits into the memory."""
        return len(self.boxes[2]) - int(self.state[0]) >= _PARTS * _stretch(self.fingers)


def memory(room: int, k: int) -> Boxes:
    """Arrays for so many boxes, as the compiled search takes them."""
    return (
        np.zeros((room, k, 2), np.int64), np.zeros((room, k, 2)), np.zeros(room), np.zeros((room, 3)),
        np.zeros(room, np.int64), np.zeros(room, np.int64), np.zeros((room, 2), np.int64),
        np.zeros((room, k, 8)), np.zeros((room, 3)), np.full(room, -1), np.zeros((1, 3)),
    )  # fmt: skip


def search_in_parts(whole: Queue, search: PartSearch, each: int = _EACH) -> list[int]:
    """One round of ``each`` boxes a part; why each part ended. There is room for it (``has_room``)."""
    # an interrupt reaches the main thread alone, and the round is whole before it ends the search
    with ThreadPoolExecutor(1 + threads()) as pool:
        return pool.submit(_round, whole, search, pool, min(each, _EACH)).result()


def _round(whole: Queue, search: PartSearch, pool: ThreadPoolExecutor, each: int) -> list[int]:
    made, stretch = int(whole.state[0]), _stretch(whole.fingers)
    waiting = _ordered(whole.heap[: whole.state[1]], whole.boxes)
    best, rest = np.split(waiting, [_PARTS * _EACH])
    dealt = [best[i::_PARTS] for i in range(_PARTS)]
    starts = [made + i * stretch for i in range(_PARTS)]
    parts = [_part(whole, nodes, start) for nodes, start in zip(dealt, starts, strict=True)]
    ended = list(pool.map(lambda part: search(part, each), parts))
    left = [rest]
    for part, nodes, start in zip(parts, dealt, starts, strict=True):
        left.append(_put_back(whole, part, nodes, start))
    waiting = _ordered(np.concatenate(left), whole.boxes)
    whole.heap[: len(waiting)], whole.state[1] = waiting, len(waiting)
    return ended


def _stretch(fingers: int) -> int:
    """Boxes that a part makes at most."""
    return _EACH * (fingers + 1)


def _ordered(nodes: np.ndarray, boxes: Boxes) -> np.ndarray:
    """Boxes, the least bound first: a heap, too."""
    ordered: np.ndarray = nodes[np.argsort(boxes[2][nodes], kind="stable")]
    return ordered


def _part(whole: Queue, nodes: np.ndarray, start: int) -> Queue:
    """A queue of these boxes, which makes its own from ``start`` on."""
    room = _stretch(whole.fingers)
    boxes = (*(values[: start + room] for values in whole.boxes[:-1]), np.zeros_like(whole.boxes[-1]))
    heap = np.concatenate([nodes, np.zeros(room, np.int64)])
    tried = np.zeros((2 * _EACH, whole.tried.shape[1]))  # two of a box at most
    return Queue(boxes, heap, np.array([start, len(nodes), 0]), whole.found.copy(), tried)


def _put_back(whole: Queue, part: Queue, nodes: np.ndarray, start: int) -> np.ndarray:
    """Move what a part made behind the boxes that there are; the open ones under their new numbers.

    nodes: what it began with.
    """
    at, made = int(whole.state[0]), int(part.state[0]) - start
    for values in whole.boxes[:-1]:
        values[at : at + made] = values[start : start + made]
    kinds, children = whole.boxes[5], whole.boxes[6]
    touched = np.concatenate([nodes, np.arange(at, at + made)])
    split = touched[kinds[touched] == 2]
    children[split, 0] += at - start
    tries = int(part.state[2])
    rows = (whole.state[2] + np.arange(tries)) % len(whole.tried)
    whole.tried[rows] = part.tried[:tries]
    whole.state[0] += made
    whole.state[2] += tries
    if part.found[0] < whole.found[0]:
        whole.found[:] = part.found
    left = part.heap[: part.state[1]]
    return np.where(left >= start, left + (at - start), left)
