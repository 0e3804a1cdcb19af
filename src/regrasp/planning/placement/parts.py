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
from typing import TypeVar

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.threads import threads

PARTS = 4
"""Of a round."""
_SHARED = 8  # boxes of a round at least: a thread takes longer to begin than fewer to be judged
_EACH = 256  # boxes that a part looks at in a round, at most
_FROM = 4096  # boxes: smaller searches stay in one part, and as quick as they are
_OPEN = 64  # boxes of a part at least, or the first of them are much better than what is split after them

Result = TypeVar("Result")
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
        return bool(self.state[0] >= _FROM and self.state[1] >= PARTS * _OPEN)

    @property
    def has_room(self) -> bool:
        """Whether a round in parts fits into the memory."""
        return len(self.boxes[2]) - int(self.state[0]) >= PARTS * _stretch(self.fingers)


def memory(room: int, k: int, old: Boxes = ()) -> Boxes:
    """Arrays for so many boxes, as the compiled search takes them; with those that were."""
    boxes = (
        np.zeros((room, k, 2), np.int64), np.zeros((room, k, 2)), np.zeros(room), np.zeros((room, 3)),
        np.zeros(room, np.int64), np.zeros(room, np.int64), np.zeros((room, 2), np.int64),
        np.zeros((room, k, 8)), np.zeros((room, 3)), np.full(room, -1), np.zeros((1, 3)),
    )  # fmt: skip
    for values, known in zip(boxes[:-1], old, strict=False):
        values[: len(known)] = known
    return boxes


def side_by_side(work: Callable[[int], Result], boxes: int = PARTS * _EACH) -> list[Result]:
    """What ``work`` returns of each part, by number; threads share parts of so many boxes together."""
    beside = min(threads(), PARTS)
    if beside < 2 or boxes < _SHARED:
        return [work(i) for i in range(PARTS)]
    with ThreadPoolExecutor(beside) as pool:
        return list(pool.map(work, range(PARTS)))


def whole(work: Callable[[], Result]) -> Result:
    """What ``work`` returns: an interrupt, which reaches the main thread alone, waits for its end."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(work).result()


def split(
    boxes: Boxes, start: int, node: int, finger: int, u: float, sides: tuple[int, Array] | None
) -> range:
    """Make the boxes, from ``start`` on, that one is split into: an arc at ``u``, or after one of its sides.

    sides: the last side on the left, its end and the beginning of the next.
    """
    arcs, ends, _, _, _, kinds, children, _, _, other, _ = boxes
    same = (arcs[node] == arcs[node, finger]).all(axis=1) & (ends[node] == ends[node, finger]).all(axis=1)
    alike = np.flatnonzero(same)
    made = range(start, start + len(alike) + 1)
    kinds[node], children[node] = 2, (start, len(made))
    for right, child in enumerate(made):
        arcs[child], ends[child], kinds[child], other[child] = arcs[node], ends[node], 0, -1
        lefts, rights = alike[: len(alike) - right], alike[len(alike) - right :]
        ends[child, lefts, 1] = ends[child, rights, 0] = u
        if sides is not None:
            arcs[child, lefts, 1], arcs[child, rights, 0] = sides[0], sides[0] + 1
            ends[child, lefts, 1], ends[child, rights, 0] = sides[1]
    return made


def search_in_parts(queue: Queue, search: PartSearch, each: int = _EACH) -> list[int]:
    """One round of ``each`` boxes a part; why each part ended. There is room for it (``has_room``)."""
    return whole(lambda: _round(queue, search, min(each, _EACH)))


def _round(whole: Queue, search: PartSearch, each: int) -> list[int]:
    made, stretch = int(whole.state[0]), _stretch(whole.fingers)
    waiting = _ordered(whole.heap[: whole.state[1]], whole.boxes)
    best, rest = np.split(waiting, [PARTS * _EACH])
    dealt = [best[i::PARTS] for i in range(PARTS)]
    starts = [made + i * stretch for i in range(PARTS)]
    parts = [_part(whole, nodes, start) for nodes, start in zip(dealt, starts, strict=True)]
    ended = side_by_side(lambda i: search(parts[i], each))
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
