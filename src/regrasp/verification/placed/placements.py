"""The check of a proof that no placement of fingers on a shape is better than a bound.

It is a tree of boxes. A finger at p on a straight side of normal n and tangent t, with force f in its
cone K = { n.f >= 0, |t.f| <= mu n.f }, does work v . f along a twist y = (v0, v1, omega),

    v = (v0 - omega p_y, v1 + omega p_x),

affine in p. With sigma(v) the most of v . f over f in K of size 1, a convex function,

    (-w) . y = sum_i v_i . f_i <= sum_i sigma(v_i) size(f_i) <= N*(sigma(v_1), ...) N(size(f_1), ...)

for the norm N and its dual N*: so N is at least (-w) . y / N*(largest sigma of each arc), and the largest
sigma of an arc is at an end of one of its sides (``straight``); on curves there is a bound of it (``cubic``).
Two twists, each with a load, bound a box together by the largest of each arc of the sum of their sigma, where
N is the largest: N is at least the sum of their work over the sum of these.
Of forces that keep a distance from the edges of their cones and a limit the most work is convex, too, and a
box is excluded by (-w) . y > sum_i largest v_i . f_i (``eroded``), and where forces have limits in ways of
their own (``limited``). What is withstood is bounded by all loads together (``groups``), and a box also by
twists of some loads that move with the fingers (``whole_sets``, on curves ``curves.turning``).
Everything is decided in rationals; roots are rounded to the safe side.
"""

from fractions import Fraction
from math import inf, prod
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.by_side import BySide, wrong_by_side
from regrasp.verification.placed.clear_boxes import clear_boxes, is_plain
from regrasp.verification.placed.cubic import CubicEdges
from regrasp.verification.placed.curves.circles import play_of
from regrasp.verification.placed.curves.turning import is_excluded_in_turn, numbers_of
from regrasp.verification.placed.forces.limited import is_excluded as is_excluded_within
from regrasp.verification.placed.forces.limited import is_least, wrong_limits
from regrasp.verification.placed.groups import MOST, MOST_AT_CORNERS, Groups, Stretch
from regrasp.verification.placed.protocol import Point, Proof
from regrasp.verification.placed.roots import root_above
from regrasp.verification.placed.straight import StraightEdges
from regrasp.verification.placed.whole_sets import Most, is_excluded, ties_of

Arc = tuple[int, int, float, float]
Motion = tuple[list[float], list[float]]
"""A load, and its twist with what fingers add to it."""

_MOST_MOVING = 7  # fingers: 2^7 corners, or 3^7 coefficients of a polynomial of degree 2


def check_proof(proof: Proof) -> list[str]:
    """What is wrong with the tree of boxes or with what excludes them, in words; nothing for a proof."""
    try:
        return _shapes(proof) or _Checked(proof).violations()
    except (ArithmeticError, LookupError, TypeError, ValueError):
        return ["proof: its numbers are none to compute with"]


def _shapes(proof: Proof) -> list[str]:
    n, k, m = len(proof.children), proof.fingers, len(proof.sides)
    wanted: list[tuple[str, Any, tuple[int, ...]]] = [
        ("vertices", proof.vertices, (len(proof.vertices), 2)),
        ("centre_of_mass", proof.centre_of_mass, (2,)),
        ("sides", proof.sides, (m, 3)), ("loads", proof.loads, (len(proof.loads), 3)),
        ("arcs", proof.arcs, (n, k, 2)), ("ends", proof.ends, (n, k, 2)),
        ("children", proof.children, (n, 2)), ("number", proof.number, (n,)),
        ("twists", proof.twists, (n, 3)),
    ]  # fmt: skip
    if proof.control is not None:
        wanted.append(("control", proof.control, (len(proof.vertices), 4, 2)))
    if proof.pairs is not None:
        q = len(proof.pairs)
        wanted += [("pairs", proof.pairs, (q, 2)), ("seconds", proof.seconds, (q, 3))]
        if (proof.seconds is None) or proof.norm != "largest" or proof.control is not None:
            return ["proof: second twists go with their boxes, a largest force and straight sides"]
    if proof.movers is not None:
        q = len(proof.movers)
        columns = 3 + 2 * k if proof.control is None else numbers_of(k)
        wanted += [("movers", proof.movers, (q, 2)), ("motions", proof.motions, (q, columns))]
        if k > _MOST_MOVING:
            return [f"proof: twists that move go with up to {_MOST_MOVING} fingers"]
        if proof.motions is None or proof.norm != "largest":
            return ["proof: twists that move go with boxes and a largest force"]
        if proof.control is not None and proof.size != "force":
            return ["proof: twists that turn with fingers on curves are for the length of a force"]
    if wrong := wrong_limits(proof) or wrong_by_side(proof):
        return wrong
    if proof.rings is not None:
        first = np.asarray(proof.rings)
        apart = np.diff(np.append(first, len(proof.vertices))) >= 3
        if proof.control is not None or first[:1].tolist() != [0] or not apart.all():
            return ["proof: rings must begin at vertices, three or more apart, the first at 0"]
    if proof.turned:
        more = (proof.pairs, proof.movers, proof.tied, proof.max_force)
        plain = all(other is None for other in more) and not proof.min_normal
        if proof.control is None or proof.size == "margin" or not plain:
            return ["proof: turns go with a smooth boundary, forces of any size and one twist for each box"]
    if proof.tied is not None:
        columns = 3 * len(proof.loads) + ties_of(k) * (len(proof.loads) - 1)
        wanted.append(("tied", proof.tied, (len(proof.tied), columns)))
        if (proof.size, proof.norm) != ("force", "largest"):
            return ["proof: loads are tied for a largest force alone"]
    broken = [f"proof: {name} must have shape {shape}" for name, a, shape in wanted if np.shape(a) != shape]
    finite = all(np.isfinite(a).all() for _, a, _ in wanted) and np.isfinite(proof.bound)
    if not finite:
        broken.append("proof: its numbers must be finite")
    if not (n and k and m and len(proof.loads) and proof.friction >= 0):
        broken.append("proof: boxes, fingers, sides, loads and friction are needed")
    if not 0 <= proof.min_distance < inf:
        broken.append("proof: min_distance must be 0 or more")
    if not 0 <= proof.margin < inf or (proof.size == "margin") != (proof.margin > 0):
        broken.append("proof: margin must be 0 or more, and goes with a size of its name")
    if proof.size == "margin" and not (proof.norm == "largest" and proof.friction > 0):
        broken.append("proof: a margin is of a largest force, and friction")
    if proof.size not in ("normal", "force", "margin") or proof.norm not in ("sum", "squares", "largest"):
        broken.append("proof: size or norm has no meaning")
    if not broken and proof.control is not None and (proof.control[:, 0] != proof.vertices).any():
        broken.append("proof: its control points must begin at its vertices")
    return broken


class _Checked:
    """One proof in exact numbers."""

    def __init__(self, proof: Proof) -> None:
        self.proof = proof
        self.boundary = StraightEdges(proof) if proof.control is None else CubicEdges(proof)
        self.groups = Groups(proof, self.boundary)
        self.clear: np.ndarray = np.zeros(len(proof.children), bool)  # boxes that doubles decide
        self.play, self.reach = Fraction(0), Fraction(0)  # of a circle
        self.limited = proof.max_force is not None or proof.min_normal > 0
        pairs = () if proof.pairs is None else zip(proof.pairs.tolist(), proof.seconds.tolist(), strict=True)  # type: ignore[union-attr]
        self.second = {box: (load, twist) for (box, load), twist in pairs}
        self.moving: dict[int, list[tuple[int, list[float]]]] = {}
        if proof.movers is not None:
            for (box, load), motion in zip(proof.movers.tolist(), proof.motions.tolist(), strict=True):  # type: ignore[union-attr]
                self.moving.setdefault(box, []).append((load, motion))
        self.sides = [(int(e), Fraction(lo), Fraction(hi)) for e, lo, hi in proof.sides.tolist()]
        self.by_side = BySide(proof, self.boundary, self.sides)  # type: ignore[arg-type]

    def violations(self) -> list[str]:
        """What is wrong, in words."""
        broken = [
            f"proof: side {i} is no stretch of an edge"
            for i, (e, lo, hi) in enumerate(self.sides)
            if not (e == self.proof.sides[i, 0] and 0 <= e < self.boundary.count and e <= lo < hi <= e + 1)
            or not self.boundary.turns_little(e, lo - e, hi - e)
        ]
        broken += [
            f"proof: side {i + 1} does not come after the one before"
            for i, (a, b) in enumerate(zip(self.sides, self.sides[1:], strict=False))
            if b[1] < a[2]
        ]
        if broken:
            return broken[:1]
        ends = float(self.proof.sides[0, 1]), float(self.proof.sides[-1, 2])
        root = [(0, len(self.sides) - 1, *ends)] * self.proof.fingers
        if self.proof.turned:
            root[0] = (0, 0, ends[0], ends[0])
            found = play_of(self.proof, self.boundary.control)  # type: ignore[union-attr]
            if found is None:
                return ["proof: its boundary is no circle about the centre of mass, all of it"]
            self.play, self.reach = found
        if self._arcs(0) != root:
            return ["proof: box 0 must give every finger the whole boundary"]
        if is_plain(self.proof, self.boundary):
            self.clear = clear_boxes(self.proof, self.boundary, float(self.play))
            self.by_side.decide()
            self.groups.plain = True
        left, waiting = set(range(1, len(self.proof.children))), [0]
        while waiting:
            box = waiting.pop()
            first, count = (int(c) for c in self.proof.children[box])
            if count == 0:
                if wrong := self._excluded(box):  # one is enough, and rationals take their time
                    return wrong
                continue
            inside = range(first, first + count)
            if not all(b in left for b in inside):
                return [f"proof: box {box} is split into boxes that are not there, or not its own"]
            left.difference_update(inside)
            waiting += inside
            sided = box in self.by_side.rows
            if wrong := self.by_side.violations(box) if sided else self._covered(box, inside):
                return wrong  # no box inside need be one
        return ["proof: some boxes belong to no other"] if left else []

    def _arcs(self, box: int) -> list[Arc]:
        pairs = zip(self.proof.arcs[box].tolist(), self.proof.ends[box].tolist(), strict=True)
        return [(a, b, lo, hi) for (a, b), (lo, hi) in pairs]  # numbers as they are given compare exactly

    def _covered(self, box: int, inside: range) -> list[str]:
        """That the boxes inside are all ways to share out the fingers on one arc to its two parts."""
        arcs, parts = self._arcs(box), [self._arcs(b) for b in inside]
        wrong = [f"proof: box {box} is not covered by the boxes it is split into"]
        split = [f for f, arc in enumerate(arcs) if any(part[f] != arc for part in parts)]
        count = len(inside) - 1
        if not split or any(arcs[f] != arcs[split[0]] for f in split):
            return wrong
        at = split[0]
        left, right = parts[0][at], parts[-1][at]
        if not self._halves(arcs[at], left, right):
            return wrong
        for part, lefts in zip(parts, range(count, -1, -1), strict=True):
            if [part[f] for f in split] != [left] * lefts + [right] * (count - lefts):
                return wrong
        return []

    def _halves(self, arc: Arc, left: Arc, right: Arc) -> bool:
        """Whether two arcs make one: at a place within a side, or between two sides."""
        a, b, lo, hi = arc
        if left[0] != a or left[2] != lo or right[1] != b or right[3] != hi:
            return False
        if a == b:
            return left[1] == right[0] == a and left[3] == right[2] and lo < left[3] < hi
        c = left[1]
        return (
            a <= c < b
            and right[0] == c + 1
            and left[3] == self.sides[c][2]
            and right[2] == self.sides[c + 1][1]
        )

    def _excluded(self, box: int) -> list[str]:
        number, arcs = int(self.proof.number[box]), self._arcs(box)
        if box in self.by_side.rows:
            return self.by_side.violations(box)
        if number == -1:
            return [] if self._near(arcs) else [f"proof: fingers of box {box} may be far enough apart"]
        if number < 0 and self.proof.tied is not None and -2 - number < len(self.proof.tied):
            return self._tied(box, self.proof.tied[-2 - number], arcs)
        if box in self.moving:
            return [] if self.clear[box] else self._moved(box, arcs)
        told = [(number, self.proof.twists[box].tolist())]
        told += [self.second[box]] if box in self.second else []
        if not all(0 <= load < len(self.proof.loads) for load, _ in told):
            return [f"proof: box {box} has no load"]
        twists = [[Fraction(c) for c in twist] for _, twist in told]
        work = -sum(
            Fraction(w) * c
            for (load, _), y in zip(told, twists, strict=True)
            for w, c in zip(self.proof.loads[load].tolist(), y, strict=True)
        )
        bound = Fraction(self.proof.bound)
        if bound <= 0 or self.clear[box]:
            return []
        if self.limited:
            parts = [
                [part for at in self._stretches(arc) for part in self.boundary.parts(*at, *twists)]
                for arc in arcs
            ]
            excluded = is_least(self.proof) or is_excluded_within(self.proof, Fraction(work), parts)
            return [] if excluded else [f"proof: the twist of box {box} does not exclude it"]
        x, y, turn = map(abs, twists[0])
        more = self.play * (1 + self.boundary.mu) * (x + y + turn * self.reach)
        most = [self._most(arc, twists) + more for arc in arcs]
        if self.proof.size == "margin":  # forces below the limit do no more than these together
            done = sum(most, start=Fraction(0))
            return [] if work > done else [f"proof: the twist of box {box} does not exclude it"]
        if self.proof.norm == "sum":
            dual = max(most)
        elif self.proof.norm == "largest":
            dual = sum(most, start=Fraction(0))
        else:
            dual = root_above(sum((s * s for s in most), start=Fraction(0)))
        if work <= 0 or work < bound * dual:
            return [f"proof: the twist of box {box} does not exclude it"]
        return []

    def _tied(self, box: int, row: Array, arcs: list[Arc]) -> list[str]:
        """The same by all loads together."""
        ways = prod(b - a + 1 for a, b, *_ in arcs)
        corners = ways * self.groups.points ** len(arcs)
        if corners > MOST or corners * len(self.proof.loads) > MOST_AT_CORNERS:
            more = f"{MOST} corners" if corners > MOST else f"{MOST_AT_CORNERS} loads at corners"
            return [f"proof: box {box} has more than {more}, too many for duals of all loads"]
        if not self.groups.excludes(row, [self._stretches(arc) for arc in arcs]):
            return [f"proof: the duals of box {box} do not exclude it"]
        return []

    def _moved(self, box: int, arcs: list[Arc]) -> list[str]:
        """The same by twists of some loads that move with the fingers."""
        loads = self.proof.loads.tolist()
        if not all(0 <= n < len(loads) for n, _ in self.moving[box]):
            return [f"proof: box {box} has no load"]
        motions = [(loads[n], motion) for n, motion in self.moving[box]]
        bound = Fraction(self.proof.bound)
        if bound <= 0:
            return []
        # forces below the limit that keep a margin do no more than what is given, of size 1 as often as it is
        times = Fraction(1) if self.proof.size == "margin" else bound
        if any(self.sides[a][0] != self.sides[b][0] for a, b, *_ in arcs):
            excluded = self._joined(motions, times, arcs)
        elif self.proof.control is None:
            excluded = is_excluded(motions, times, [self._hull(*arc) for arc in arcs], self._along(arcs))
        else:
            hulls = [self._hull(*arc) for arc in arcs]
            excluded = is_excluded_in_turn(motions, bound, hulls, self.proof.friction)
        if excluded:
            return []
        return [f"proof: the twists of box {box} do not exclude it"]

    def _joined(self, motions: list[Motion], times: Fraction, arcs: list[Arc]) -> bool:
        """The same on arcs of several straight sides, by twists that stay."""
        if self.proof.control is not None or any(c != 0 for _, motion in motions for c in motion[3:]):
            return False
        twists = [[Fraction(c) for c in motion[:3]] for _, motion in motions]
        work = -sum(
            Fraction(w) * c
            for (load, _), y in zip(motions, twists, strict=True)
            for w, c in zip(load, y, strict=True)
        )
        return work > times * sum((self._most(arc, twists) for arc in arcs), start=Fraction(0))

    def _along(self, arcs: list[Arc]) -> Most:
        """The most along a velocity of a finger anywhere on its arc, of one side."""

        def most(finger: int, v: Point) -> Fraction:
            side, _, lo, hi = arcs[finger]
            edge = self.sides[side][0]
            return self.boundary.most_along(edge, Fraction(lo) - edge, Fraction(hi) - edge, [v])

        return most

    def _most(self, arc: Arc, twists: list[list[Fraction]]) -> Fraction:
        """An upper bound of sigma over an arc, or of the sum of those of several twists."""
        parts = self._stretches(arc)
        if len(twists) > 1:  # the sum is convex along a side
            parts = [(edge, u, u) for edge, *ends in parts for u in ends]
        return max(sum((self.boundary.most(*at, y) for y in twists), start=Fraction(0)) for at in parts)

    def _stretches(self, arc: Arc) -> list[Stretch]:
        """Of each edge of an arc, from which to which fraction of it."""
        sides = self.sides[arc[0] : arc[1] + 1]
        sides[0] = sides[0][0], Fraction(arc[2]), sides[0][2]
        sides[-1] = *sides[-1][:2], Fraction(arc[3])
        return [(edge, lo - edge, hi - edge) for edge, lo, hi in sides]

    def _near(self, arcs: list[Arc]) -> bool:
        """Whether two fingers on one side each are nearer than they must be, wherever they are."""
        least2 = max(Fraction(self.proof.min_distance) - 2 * self.play * self.reach, Fraction(0)) ** 2
        corners = [self._hull(*arc) for arc in arcs if arc[0] == arc[1]]
        for i, one in enumerate(corners):
            for other in corners[:i]:
                if all((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 < least2 for p in one for q in other):
                    return True
        return False

    def _hull(self, side: int, _: int, lo: float, hi: float) -> list[Point]:
        edge = self.sides[side][0]
        return self.boundary.hull(edge, Fraction(lo) - edge, Fraction(hi) - edge)
