"""Of the rows of holds of as many moves and as wide a margin, that of fewest steps, then of least turning.

A row of arcs is walked at angles t_1, t_2, ..., one in each arc, from 0 to the goal's. Let the least turning
to an angle t of one arc be

    C + |t - p|    for t in [lo, hi], p in [lo, hi].

Then that to an angle of the next arc A, in n steps of at most T each, is C + |t - p| for t in A and in
[lo - n T, hi + n T]: on the way from p to t lies an angle of [lo, hi] that is near enough. So it has the same
form, p moved to the nearest angle of the new interval. Labels of that form are searched best first; what
remains to the goal's angle at the least bounds the turning from below.
"""

from collections.abc import Callable
from heapq import heappop, heappush
from math import ceil, floor, pi
from typing import NamedTuple

from regrasp.planning.holds.stances import REACH

Node = tuple[int, int, int]
"""A hold by its slot and the places of its fingers."""
Interval = tuple[float, float]

_ALIKE = 1e-9


class Label(NamedTuple):
    """Steps beyond one a hold, turning [rad] to ``at``, and where angles may be; of a hold in a layer."""

    steps: int
    turning: float
    at: float
    lo: float
    hi: float
    layer: int
    node: Node
    before: "Label | None"


def least_turning(
    first: list[Node],
    following: Callable[[int, Node], list[Node]],
    count: int,
    arcs: Callable[[Node], list[Interval]],
    goal: float,
    max_turn: float,
) -> list[tuple[Node, float]] | None:
    """Holds with their angles [rad], unwrapped; None where no arcs are near enough.

    first: holds of the first layer; following: those of the next layer after one, by layer from 0; count: of
    layers. goal: the angle in the end [rad], any whole turns added.
    """
    begin = Label(0, 0.0, 0.0, 0.0, 0.0, -1, (0, 0, 0), None)
    queue: list[tuple[int, float, int, int, Label]] = []
    known: dict[tuple[int, Node], list[Label]] = {}
    number = 0

    def push(label: Label) -> None:
        nonlocal number
        rest = abs((label.at - goal + pi) % (2 * pi) - pi)
        number += 1
        heappush(queue, (label.steps, round(label.turning + rest, 9), -label.layer, number, label))

    push(begin)
    while queue:
        *_, label = heappop(queue)
        if label.layer == count:
            return _walked(label)
        kept = known.setdefault((label.layer, label.node), [])
        if any(_no_worse(other, label) for other in kept):
            continue
        kept.append(label)
        if label.layer == count - 1:
            for new in _onward(label, (goal, goal), (0, 0, 0), max_turn):
                push(new)
            continue
        for node in first if label.layer < 0 else following(label.layer, label.node):
            for arc in arcs(node):
                for new in _onward(label, arc, node, max_turn):
                    push(new)
    return None


def _onward(label: Label, arc: Interval, node: Node, max_turn: float) -> list[Label]:
    """Labels of the next hold on an arc, whole turns added, in as many steps as it may take."""
    result = []
    lowest = ceil((label.lo - REACH - arc[1]) / (2 * pi))
    highest = floor((label.hi + REACH - arc[0]) / (2 * pi))
    for turns in range(lowest, highest + 1):
        lo, hi = arc[0] + 2 * pi * turns, arc[1] + 2 * pi * turns
        for steps in range(ceil(REACH / max_turn)):
            reach = min((steps + 1) * max_turn, REACH) + _ALIKE
            low, high = max(lo, label.lo - reach), min(hi, label.hi + reach)
            if low > high:
                continue
            at = min(max(label.at, low), high)
            turning = label.turning + abs(at - label.at)
            result.append(Label(label.steps + steps, turning, at, low, high, label.layer + 1, node, label))
            if low == lo and high == hi:
                break
    return result


def _no_worse(one: Label, other: Label) -> bool:
    """Whether a label reaches all that another of the same hold does, at no more cost; whole turns aside."""
    shift = 2 * pi * round((other.at - one.at) / (2 * pi))
    lo, hi, at = one.lo + shift, one.hi + shift, one.at + shift
    return (
        one.steps <= other.steps
        and lo <= other.lo + _ALIKE
        and hi >= other.hi - _ALIKE
        and one.turning + abs(at - other.at) <= other.turning + _ALIKE
    )


def _walked(label: Label) -> list[tuple[Node, float]]:
    """Angles from the last to the first, each the nearest of its interval to the one after it."""
    way = []
    at = label.at
    here = label.before
    while here is not None and here.before is not None:
        at = min(max(at, here.lo), here.hi)
        way.append((here.node, at))
        here = here.before
    return way[::-1]
