"""Proofs about placements as plain values, made by hand, and to which bound they prove, to fifty digits."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np


def planar(vertices, loads, nodes, **changes) -> SimpleNamespace:
    """A proof on a polygon; nodes: (arcs, children, number, twist) of boxes, an arc (first, last, lo, hi)."""
    k = len(nodes[0][0])
    given = {
        "fingers": k,
        "friction": 0.5,
        "size": "normal",
        "norm": "sum",
        "min_distance": 0.0,
        "bound": 0.0,
    }
    count = len(vertices)
    return SimpleNamespace(
        **given
        | {
            "vertices": np.array(vertices, dtype=float),
            "centre_of_mass": np.zeros(2),
            "sides": np.array([[e, e, e + 1] for e in range(count)], dtype=float),
            "loads": np.array(loads, dtype=float),
            "arcs": np.array([[arc[:2] for arc in node[0]] for node in nodes]),
            "ends": np.array([[arc[2:] for arc in node[0]] for node in nodes], dtype=float),
            "children": np.array([node[1] for node in nodes]),
            "number": np.array([node[2] for node in nodes]),
            "twists": np.array([node[3] for node in nodes], dtype=float),
            "control": None,
            "margin": 0.0,
            "rings": None,
            "pairs": None,
            "seconds": None,
            "tied": None,
            "movers": None,
            "motions": None,
            "by_side": None,
            "side_twists": None,
            "max_force": None,
            "min_normal": 0.0,
            "turned": False,
        }
        | changes
    )


def solid(corners, normals, loads, patches, nodes, **changes) -> SimpleNamespace:
    """A proof on triangles; ``nodes``: (patches, children, number, twist) of each box."""
    given = {"friction": 0.5, "size": "normal", "norm": "sum", "min_distance": 0.0, "bound": 0.0}
    return SimpleNamespace(
        **given
        | {
            "corners": np.array(corners, dtype=float),
            "normals": np.array(normals, dtype=float),
            "fingers": len(nodes[0][0]),
            "loads": np.array(loads, dtype=float),
            "spans": np.array(patches.spans),
            "halves": np.array(patches.halves),
            "boxes": np.array([node[0] for node in nodes]),
            "children": np.array([node[1] for node in nodes]),
            "number": np.array([node[2] for node in nodes]),
            "twists": np.array([node[3] for node in nodes], dtype=float),
            "together": None,
        }
        | changes
    )


def everything(sides, fingers: int) -> list[tuple]:
    """The arcs of box 0."""
    return [(0, len(sides) - 1, float(sides[0][1]), float(sides[-1][2]))] * fingers


def random_tree(rng, sides, fingers: int, loads, splits: int) -> list[tuple]:
    """Boxes that cover all placements, each split of an arc between two sides or within one."""
    nodes = [[everything(sides, fingers), (0, 0), 0, _twist(rng, loads)]]
    for box in range(10**6):
        if box == len(nodes) or splits == 0:
            break
        arcs = nodes[box][0]
        if rng.random() < 0.3 and box:
            continue
        finger = int(rng.integers(fingers))
        alike = [f for f in range(fingers) if arcs[f] == arcs[finger]]
        alike = list(range(alike[0], alike[0] + next(
            (k for k, f in enumerate(alike) if f != alike[0] + k), len(alike))))  # fmt: skip
        left, right = _parts(rng, sides, arcs[alike[0]])
        first = len(nodes)
        for rights in range(len(alike) + 1):
            inside = list(arcs)
            for place, f in enumerate(alike):
                inside[f] = left if place < len(alike) - rights else right
            number = int(rng.integers(len(loads)))
            nodes.append([inside, (0, 0), number, _twist(rng, loads[number : number + 1])])
        nodes[box][1] = first, len(alike) + 1
        splits -= 1
    return nodes


def _twist(rng, loads) -> list[float]:
    """One along which the load does work."""
    while True:
        twist = rng.integers(-4, 5, size=len(loads[0]))
        if np.dot(twist, loads[0]) < 0:
            return [float(x) for x in twist]


def _parts(rng, sides, arc):
    first, last, lo, hi = arc
    if first == last:
        middle = lo + (hi - lo) * float(rng.choice([0.25, 0.5, 0.75]))
        return (first, first, lo, middle), (first, first, middle, hi)
    cut = int(rng.integers(first, last))
    return (first, cut, lo, float(sides[cut][2])), (cut + 1, last, float(sides[cut + 1][1]), hi)


@dataclass(frozen=True)
class Patches:
    """Groups of triangles halved down to single ones, and some of these halved across edges."""

    spans: list
    halves: list

    @classmethod
    def of(cls, count: int, rng, halvings: int = 0) -> "Patches":
        spans, halves = [(0, count)], []
        k = 0
        while k < len(spans):
            first, many = spans[k]
            if many > 1:
                less = int(rng.integers(1, many))
                halves.append([len(spans), len(spans) + 1, -1])
                spans += [(first, less), (first + less, many - less)]
            else:
                halves.append([-1, -1, -1])
            k += 1
        singles = [k for k, (_, many) in enumerate(spans) if many == 1]
        for _ in range(halvings):
            k = singles.pop(int(rng.integers(len(singles))))
            halves[k] = [len(halves), len(halves) + 1, int(rng.integers(3))]
            singles += [len(halves), len(halves) + 1]
            halves += [[-1, -1, -1], [-1, -1, -1]]
        return cls(spans, halves)

    def corners(self, patch: int, corners, normals) -> list[tuple]:
        """(corner, normal) of a patch."""
        at = self._part(patch, corners)
        if at is not None:
            on, triangle = at
            return [(p, normals[on]) for p in triangle]
        first, many = self.spans[patch]
        return [(p, normals[k]) for k in range(first, first + many) for p in corners[k]]

    def _part(self, patch: int, corners):
        if patch < len(self.spans):
            first, many = self.spans[patch]
            return (first, np.array(corners[first], dtype=float)) if many == 1 else None
        for parent, (left, right, edge) in enumerate(self.halves):
            if patch in (left, right) and edge >= 0:
                on, t = self._part(parent, corners)
                a, b, o = t[edge], t[(edge + 1) % 3], t[(edge + 2) % 3]
                return on, np.array([a, (a + b) / 2, o] if patch == left else [(a + b) / 2, b, o])
        raise AssertionError

    def tree(self, rng, fingers: int, loads, splits: int) -> list[list]:
        """Boxes that cover all placements."""
        nodes = [[[0] * fingers, (0, 0), 0, _twist(rng, loads)]]
        for box in range(10**6):
            if box == len(nodes) or splits == 0:
                break
            patches = nodes[box][0]
            patch = patches[int(rng.integers(fingers))]
            if self.halves[patch][0] < 0 or (box and rng.random() < 0.2):
                continue
            alike = [f for f in range(fingers) if patches[f] == patch]
            left, right, _ = self.halves[patch]
            nodes[box][1] = len(nodes), len(alike) + 1
            for rights in range(len(alike) + 1):
                inside = list(patches)
                for place, f in enumerate(alike):
                    inside[f] = left if place < len(alike) - rights else right
                number = int(rng.integers(len(loads)))
                nodes.append([inside, (0, 0), number, _twist(rng, loads[number : number + 1])])
            splits -= 1
        return nodes


def limit(proof, points_of) -> Fraction:
    """The largest bound that all boxes which are not split exclude.

    ``points_of(box, finger)``: (point, normal) of what decides.
    """
    least = None
    pairs = getattr(proof, "pairs", None)
    seconds = {} if pairs is None else {box: k for k, (box, _) in enumerate(pairs.tolist())}
    with localcontext() as context:
        context.prec = 60
        for box, (_, count) in enumerate(np.asarray(proof.children).tolist()):
            number = int(proof.number[box])
            if count or number < 0:
                continue
            told = [(number, proof.twists[box])]
            if box in seconds:
                told.append((pairs[seconds[box]][1], proof.seconds[seconds[box]]))
            twists = [[Decimal(x) for x in y.tolist()] for _, y in told]
            work = -sum(
                Decimal(a) * b
                for (load, _), y in zip(told, twists, strict=True)
                for a, b in zip(proof.loads[load].tolist(), y, strict=True)
            )
            most = [
                max(
                    sum(max(_sigma(proof, y, *place), Decimal(0)) for y in twists)
                    for place in points_of(box, finger)
                )
                for finger in range(proof.fingers)
            ]
            if proof.norm == "sum":
                dual = max(most)
            else:
                dual = sum(most) if proof.norm == "largest" else sum(s * s for s in most).sqrt()
            if dual > 0:
                here = work / dual
                least = here if least is None else min(least, here)
            elif work <= 0:
                least = Decimal(0)
    return Fraction(0 if least is None else least)  # none where any bound is proven


def _sigma(proof, y, point, normal) -> Decimal:
    """The most of v . f over forces of size 1 in the cone; the normal of any length."""
    p, n = ([Decimal(float(x)) for x in values] for values in (point, normal))
    mu = Decimal(proof.friction)
    if len(p) == 2:
        v = [y[0] - y[2] * p[1], y[1] + y[2] * p[0]]
    else:
        v = [
            y[k] + y[3 + (k + 1) % 3] * p[(k + 2) % 3] - y[3 + (k + 2) % 3] * p[(k + 1) % 3] for k in range(3)
        ]
    size = sum(x * x for x in n).sqrt()
    along = sum(a * b for a, b in zip(v, n, strict=True)) / size
    across = max(sum(x * x for x in v) - along * along, Decimal(0)).sqrt()
    if proof.size == "force":
        if along > 0 and across <= mu * along:
            return sum(x * x for x in v).sqrt()
        return (along + mu * across) / (1 + mu * mu).sqrt()
    return along + mu * across


def planar_points(proof):
    """``points_of`` of a polygon: both ends of every side of an arc."""
    vertices = np.asarray(proof.vertices)

    def points(box: int, finger: int):
        (first, last), (lo, hi) = proof.arcs[box][finger], proof.ends[box][finger]
        for j in range(first, last + 1):
            edge, least, most = proof.sides[j]
            p, q = vertices[int(edge)], vertices[(int(edge) + 1) % len(vertices)]
            along = q - p
            for u in (lo if j == first else least, hi if j == last else most):
                at = p + (u - int(edge)) * along - proof.centre_of_mass
                yield at, [-along[1], along[0]]

    return points


def most_work(proof, y, point, normal) -> float:
    """The most that a force of size 1 does, of a thousand in the cone and its edges."""
    n = np.array(normal) / np.hypot(*normal)
    t = np.array([n[1], -n[0]])
    v = np.array([y[0] - y[2] * point[1], y[1] + y[2] * point[0]])
    shares = np.linspace(-proof.friction, proof.friction, 1001)
    forces = n + shares[:, None] * t
    if proof.size == "force":
        forces /= np.hypot(*forces.T)[:, None]
    return max(0.0, float((forces @ v).max()))


SHAPES = (
    [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]],
    [[-2, -1], [3, -1], [0, 5]],
    [[8, 8], [12, 11], [9, 15], [5, 12]],  # sides of 3, 4 and 5
)


def random_planar(rng, size, norm, splits, **changes):
    vertices = SHAPES[int(rng.integers(len(SHAPES)))]
    count = len(vertices)
    chosen = sorted(rng.choice(count, size=int(rng.integers(2, count + 1)), replace=False).tolist())
    sides = [[e, e + float(rng.choice([0, 0.25])), e + float(rng.choice([0.5, 1]))] for e in chosen]
    loads = rng.integers(-3, 4, size=(2, 3)) + np.array([0, 0.5, 0])
    nodes = random_tree(rng, sides, int(rng.integers(1, 4)), loads, splits)
    given = {
        "friction": float(rng.choice([0, 0.25, 1, 3])), "size": size, "norm": norm, "sides": np.array(sides),
        "centre_of_mass": np.array(rng.integers(-2, 9, size=2), dtype=float),
    }  # fmt: skip
    return planar(vertices, loads, nodes, **given | changes)


def tree_changes(proof: Any, parents: Any, last: int) -> list[tuple[str, Any, Any]]:
    """By name, place and amount: what spoils the tree of boxes, its numbers and its twists."""
    return [
        ("children", (parents[0], 1), -1), ("children", (parents[-1], 1), 1),
        ("children", (parents[-1], 0), -1), ("children", parents[0], -proof.children[parents[0]]),
        ("number", last, 2), ("number", last, -1 - proof.number[last]),
        ("number", last, -2 - proof.number[last]), ("twists", last, -2 * proof.twists[last]),
        ("twists", last, -proof.twists[last]),
    ]  # fmt: skip


def said_of_changes(
    proof: Any, changes: list[tuple[str, Any, Any]], said: Callable[[Any], str]
) -> Iterator[str]:
    """What is said of a proof with each change by itself; never nothing."""
    for name, at, add in changes:
        kept = getattr(proof, name)
        other = kept.copy()
        other[at] += add
        setattr(proof, name, other)
        found = said(proof)
        assert found, (name, at)
        setattr(proof, name, kept)
        yield found


def bent(vertices) -> np.ndarray:
    """(n, 4, 2) control points of cubics along the sides of a polygon (n, 2)."""
    p = np.array(vertices, dtype=float)
    q = np.roll(p, -1, axis=0)
    return np.stack([p, (2 * p + q) / 3, (p + 2 * q) / 3, q], axis=1)
