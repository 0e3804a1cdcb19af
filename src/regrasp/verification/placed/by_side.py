"""Boxes with some twists, of which one excludes each side of the finger that is on most sides.

Of a finger on several straight sides one twist need not exclude them all: each side with the arcs of the
other fingers is a box of its own, and is where for one of the twists

    (-w) . y > T (largest sigma on that side + largest sigma on each of the other arcs).

Sides in boxes that one is split into are left to these.
"""

from fractions import Fraction

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.clear_boxes import ROUNDING, clearance, times
from regrasp.verification.placed.protocol import Proof
from regrasp.verification.placed.straight import StraightEdges

Arc = tuple[int, int, float, float]
_AT_ONCE = 20_000  # sides


def wrong_by_side(proof: Proof) -> list[str]:
    """What is wrong with the shapes of such twists, in words."""
    boxes, twists = proof.by_side, proof.side_twists
    if boxes is None:
        return []
    limited = proof.max_force is not None or proof.min_normal > 0
    if twists is None or proof.norm != "largest" or proof.control is not None or limited:
        return ["proof: twists for each side go with boxes, a largest force and straight sides"]
    if np.shape(boxes) != (len(boxes), 2) or np.shape(twists) != (len(boxes), 3):
        return [f"proof: by_side and side_twists must have shape {(len(boxes), 2)} and {(len(boxes), 3)}"]
    if not np.isfinite(twists).all():
        return ["proof: its numbers must be finite"]
    there = np.isin(np.asarray(boxes)[:, 0], np.arange(len(proof.children)))
    return [] if there.all() else [f"proof: by_side is about boxes from 0 to {len(proof.children) - 1}"]


class BySide:
    """Such boxes of one proof, each with its loads and twists."""

    def __init__(self, proof: Proof, boundary: StraightEdges, sides: list[tuple[int, Fraction, Fraction]]):
        self.proof, self.boundary, self.sides = proof, boundary, sides
        self.rows: dict[int, list[int]] = {}
        if proof.by_side is not None:
            for row, box in enumerate(np.asarray(proof.by_side)[:, 0].tolist()):
                self.rows.setdefault(box, []).append(row)
        self._clear = np.zeros(len(proof.children), bool)

    def decide(self) -> None:
        """Which boxes doubles show to be excluded, by more than all of their rounding together."""
        if not self.rows:
            return
        arcs, loads = np.asarray(self.proof.arcs), np.arange(len(self.proof.loads))
        good = np.isin(np.asarray(self.proof.by_side)[:, 1], loads)
        told = [
            box
            for box, rows in self.rows.items()
            if 0 <= box < len(arcs) and good[rows].all() and not self._wrong(box)
        ]
        sides = np.cumsum((arcs[told, :, 1] - arcs[told, :, 0] + 1).sum(axis=1))
        with np.errstate(all="ignore"):
            for some in np.split(np.array(told, int), np.flatnonzero(np.diff(sides // _AT_ONCE)) + 1):
                if len(some):
                    self._decide(some)

    def violations(self, box: int) -> list[str]:
        """What is wrong with a box, in words."""
        rows = [(int(self.proof.by_side[row, 1]), self.proof.side_twists[row]) for row in self.rows[box]]  # type: ignore[index]
        if not all(0 <= load < len(self.proof.loads) for load, _ in rows):
            return [f"proof: box {box} has no load"]
        if self._wrong(box):
            return [f"proof: box {box} is not covered by the boxes it is split into, of one finger's sides"]
        bound = Fraction(self.proof.bound)
        if bound <= 0 or self._clear[box] or self._is_excluded(box, rows):
            return []
        return [f"proof: the twists of box {box} do not exclude each side"]

    def _wide(self, box: int) -> int:
        arcs = np.asarray(self.proof.arcs)[box]
        return int((arcs[:, 1] - arcs[:, 0]).argmax())

    def _inside(self, box: int) -> range:
        first, count = (int(c) for c in self.proof.children[box])
        return range(first, first + count)

    def _wrong(self, box: int) -> bool:
        """Whether an arc has no sides, or boxes inside are not of whole stretches of the widest."""
        arcs, ends, inside = np.asarray(self.proof.arcs), np.asarray(self.proof.ends), self._inside(box)
        m, wide = len(self.sides), self._wide(box)
        if ((arcs[box] < 0) | (arcs[box] >= m)).any() or (arcs[box, :, 0] > arcs[box, :, 1]).any():
            return True
        (first, last), (lo, hi) = arcs[box, wide].tolist(), ends[box, wide].tolist()
        others = np.delete(np.arange(self.proof.fingers), wide)
        for part in inside:
            if not 0 <= part < len(arcs):
                return True
            (a, b), at = arcs[part, wide].tolist(), ends[part, wide].tolist()
            if not first <= a <= b <= last:
                return True
            whole = lo if a == first else self.sides[a][1], hi if b == last else self.sides[b][2]
            same = arcs[part, others] == arcs[box, others], ends[part, others] == ends[box, others]
            if (at[0], at[1]) != whole or not (same[0].all() and same[1].all()):
                return True
        return False

    def _left(self, box: int) -> np.ndarray:
        """The sides of the widest arc that are in no box inside."""
        arcs, wide = np.asarray(self.proof.arcs), self._wide(box)
        first, last = arcs[box, wide].tolist()
        open_: np.ndarray = np.ones(last - first + 1, bool)
        for part in self._inside(box):
            a, b = arcs[part, wide].tolist()
            open_[a - first : b - first + 1] = False
        left: np.ndarray = first + np.flatnonzero(open_)
        return left

    def _decide(self, boxes: np.ndarray) -> None:
        proof, k = self.proof, self.proof.fingers
        left = [self._left(box) for box in boxes.tolist()]
        of = np.repeat(np.arange(len(boxes)), [len(each) for each in left])
        edges, lo, hi = self._stretches(np.repeat(boxes, [len(e) for e in left]), None, np.concatenate(left))
        arcs = np.asarray(proof.arcs)[boxes]
        narrow = [np.delete(np.arange(k), self._wide(box)) for box in boxes.tolist()]
        rest = np.array([(n, f) for n, fingers in enumerate(narrow) for f in fingers.tolist()], int).reshape(
            -1, 2
        )
        counts = (arcs[rest[:, 0], rest[:, 1], 1] - arcs[rest[:, 0], rest[:, 1], 0]) + 1
        begins = np.cumsum(counts) - counts
        at = np.repeat(rest, counts, axis=0)
        on = np.arange(counts.sum()) - np.repeat(begins, counts) + arcs[at[:, 0], at[:, 1], 0]
        others = self._stretches(boxes[at[:, 0]], at[:, 1], on)
        rows = [self.rows[box] for box in boxes.tolist()]
        open_ = np.arange(len(of))
        for rank in range(max(map(len, rows))):
            has = np.array([len(each) > rank for each in rows])
            row = np.array([each[min(rank, len(each) - 1)] for each in rows])
            y, load = np.asarray(proof.side_twists)[row], np.asarray(proof.by_side)[row, 1]
            work, room, sure = clearance(proof, y, load)
            most = self.boundary.roughly(*others, y[at[:, 0]])
            done = k * room
            if len(rest):
                done = done + np.bincount(rest[:, 0], np.maximum.reduceat(most, begins), len(boxes))
            trying = has[of[open_]]
            each = open_[trying]
            n = of[each]
            most = self.boundary.roughly(edges[each], lo[each], hi[each], y[n])
            gone = sure[n] & (work[n] > times(proof) * (most + done[n]) * (1 + ROUNDING))
            open_ = np.concatenate([open_[~trying], each[~gone]])
        self._clear[boxes] = np.bincount(of[open_], minlength=len(boxes)) == 0

    def _stretches(
        self, boxes: np.ndarray, fingers: np.ndarray | None, sides: np.ndarray
    ) -> tuple[np.ndarray, Array, Array]:
        """Edges of sides on arcs, and from which to which fraction; on the widest arcs without fingers."""
        arcs, ends = np.asarray(self.proof.arcs)[boxes], np.asarray(self.proof.ends)[boxes]
        if fingers is None:
            fingers = (arcs[:, :, 1] - arcs[:, :, 0]).argmax(axis=1)
        each = np.arange(len(boxes))
        arcs, ends = arcs[each, fingers], ends[each, fingers]
        edge, least, most = np.asarray(self.proof.sides)[sides].T
        lo = np.where(sides == arcs[:, 0], ends[:, 0], least)
        hi = np.where(sides == arcs[:, 1], ends[:, 1], most)
        return edge.astype(int), lo - edge, hi - edge

    def _is_excluded(self, box: int, rows: list[tuple[int, Array]]) -> bool:
        """In rationals."""
        limit = Fraction(1) if self.proof.size == "margin" else Fraction(self.proof.bound)
        wide, told = self._wide(box), []
        for load, twist in rows:
            y = [Fraction(c) for c in twist.tolist()]
            work = -sum(Fraction(w) * c for w, c in zip(self.proof.loads[load].tolist(), y, strict=True))
            done = [self._most(box, i, y) for i in range(self.proof.fingers) if i != wide]
            told.append((y, work / limit - sum(done, start=Fraction(0))))
        return all(
            any(self.boundary.most(*self._part(box, wide, side), y) < rest for y, rest in told)
            for side in self._left(box).tolist()
        )

    def _most(self, box: int, finger: int, y: list[Fraction]) -> Fraction:
        first, last = np.asarray(self.proof.arcs)[box, finger].tolist()
        return max(self.boundary.most(*self._part(box, finger, j), y) for j in range(first, last + 1))

    def _part(self, box: int, finger: int, side: int) -> tuple[int, Fraction, Fraction]:
        (first, last), ends = np.asarray(self.proof.arcs)[box, finger].tolist(), self.proof.ends[box, finger]
        edge, lo, hi = self.sides[side]
        lo = Fraction(float(ends[0])) if side == first else lo
        hi = Fraction(float(ends[1])) if side == last else hi
        return edge, lo - edge, hi - edge
