"""Forces tied by equal stiffness: what duals of a box bound, worked out by hand, and what of them counts."""

from fractions import Fraction
from itertools import product
from math import inf, nextafter
from types import SimpleNamespace

import numpy as np
import pytest

from foreign.beams import EIGHTH, ROW, beam
from proofs import planar, said_of_changes
from regrasp.verification.placed.placements import check_proof
from regrasp.verification.placed.whole_sets import ties_of, works

pytestmark = pytest.mark.oracle


def below(limit: Fraction) -> float:
    """The largest double that is no more."""
    number = float(limit)
    return number if Fraction(number) <= limit else nextafter(number, -inf)


def verdicts(proof, limit: Fraction) -> None:
    """It is a proof of the largest double that is no more than a limit, and of none above."""
    for bound, words in (below(limit), []), (limit / 2, []), (0.0, []), (-1.0, []):
        proof.bound = float(bound)
        assert check_proof(proof) == words, bound
    for bound in nextafter(below(limit), inf), 2 * float(limit):
        proof.bound = float(bound)
        assert all("the duals of box" in words for words in check_proof(proof)), bound
        assert check_proof(proof) != []
    proof.bound = below(limit)


def lifted(x0, x1, x2):
    """What the fingers take up at most, together, of forces of size 1."""
    away = x1 - x2, x2 - x0, x0 - x1
    lifts = [1 + d for d in away] + [2 - 3 * x - d for x, d in zip((x0, x1, x2), away, strict=True)]
    return sum(max(u, 0) for u in lifts)


def limit_of_beam(width=EIGHTH, more=Fraction(3, 2)) -> Fraction:
    corners = product(*((x - width, x + width) for x in (-1, 0, 1)))
    return ((4 + more) + (8 + 3 * more)) / max(lifted(*x) for x in corners)


def test_three_fingers_below_a_beam() -> None:
    assert lifted(-1, 0, 1) == 9  # of which the limit is 2
    for width in EIGHTH, Fraction(1, 1024):
        verdicts(beam(width), limit_of_beam(width))
    assert 2 > limit_of_beam(Fraction(1, 1024)) > 1.99 > limit_of_beam() > 1.6
    for unit in 1e-30, 1e30:
        verdicts(beam(tied=unit * np.array([ROW])), limit_of_beam())


def test_every_number_of_duals_counts() -> None:
    """More of it or less excludes nothing at the limit; what moves fingers along the beam does no harm."""
    proof, limit = beam(), limit_of_beam()
    proof.bound = below(limit)
    idle = {0, 3, 6, 9, 10, 11, 12, 14, 15, 16, 17, 18, 20}  # along the beam
    for k in range(len(ROW)):
        said = []
        for off in 0.01, -0.01:
            changed = np.array([ROW], dtype=float)
            changed[0, k] += off
            proof.tied = changed
            said.append(check_proof(proof))
        assert all(words == ["proof: the duals of box 6 do not exclude it"] for words in said if words)
        assert any(said) == (k not in idle), k


def test_duals_that_do_no_work_exclude_nothing() -> None:
    still = np.zeros((1, len(ROW)))
    for tied in still, -np.array([ROW], dtype=float):
        proof = beam(tied=tied, bound=0.0)
        assert check_proof(proof) == []  # forces are 0 or more
        proof.bound = 5e-324
        assert check_proof(proof) == ["proof: the duals of box 6 do not exclude it"]
    lift, fall = still.copy(), still.copy()
    lift[0, 1], fall[0, 1] = 1, -1
    proof = beam(tied=lift)  # three fingers hold 4 N
    verdicts(proof, Fraction(4, 3))
    proof.tied, proof.bound = fall, 1e300
    assert check_proof(proof) == ["proof: the duals of box 6 do not exclude it"]
    proof.loads[:, 1] *= -1  # upward, which no finger below holds
    assert check_proof(proof) == []


def test_what_is_tied_is_formed() -> None:
    proof = beam()
    proof.bound = below(limit_of_beam())
    assert check_proof(proof) == []
    changes = [
        ("ends", (6, 0, 1), 2.0**-50), ("ends", (6, 2, 0), -(2.0**-50)), ("number", 6, 1), ("number", 6, 2),
        ("number", 6, -1), ("number", 5, -1), ("children", (3, 1), -1), ("sides", (0, 1), -0.01),
        ("loads", (1, 1), 0.01), ("loads", (2, 1), 0.01), ("loads", (2, 2), -0.01), ("arcs", (6, 0, 1), 1),
    ]  # fmt: skip
    for words in said_of_changes(proof, changes, lambda p: "; ".join(check_proof(p))):
        assert words.startswith("proof: ")
    for field, value, words in (
        ("tied", None, "box 6 has no load"), ("tied", np.zeros((0, 21)), "box 6 has no load"),
        ("tied", proof.tied[:, :-1], r"tied must have shape (1, 21)"),
        ("tied", proof.tied[0], "tied must have shape"),
        ("tied", np.full((1, 21), np.nan), "finite"),
        ("size", "normal", "for a largest force alone"), ("norm", "sum", "for a largest force alone"),
    ):  # fmt: skip
        other = SimpleNamespace(**vars(proof) | {field: value})
        assert any(words in said for said in check_proof(other)), field
    rows = np.array([ROW, np.zeros(len(ROW))])
    proof.tied = rows
    assert check_proof(proof) == []
    proof.number[6] = -3
    assert check_proof(proof) == ["proof: the duals of box 6 do not exclude it"]
    proof.tied = rows[::-1].copy()
    assert check_proof(proof) == []
    proof.number[6] = -4
    assert check_proof(proof) == ["proof: box 6 has no load"]


def test_fingers_on_several_sides_at_once() -> None:
    """Box 3: one finger near -1, the others each near 0 or 1."""
    proof = beam()
    proof.number[3], proof.children[3] = -2, 0
    keep = np.array([0, 1, 2, 3, 4, 8, 9, 10, 11])
    for name in "arcs", "ends", "number", "twists", "children":
        setattr(proof, name, getattr(proof, name)[keep])
    proof.children[4] = 5, 4
    ends = [[x + side * EIGHTH for x in on for side in (-1, 1)] for on in ((-1,), (0, 1), (0, 1))]
    most = max(lifted(*x) for x in product(*ends))
    limit = ((4 + Fraction(3, 2)) + (8 + Fraction(9, 2))) / most
    assert limit < limit_of_beam()
    verdicts(proof, limit)
    proof.bound = below(limit)
    for changes in ("ends", (3, 1, 1), 2.0**-50), ("ends", (3, 0, 0), -(2.0**-50)), ("arcs", (3, 1, 1), -1):
        (words,) = said_of_changes(proof, [changes], lambda p: "; ".join(check_proof(p)))
        assert words.startswith("proof: ")


# Two fingers face each other at (1, a) and (-1, b), friction 3 / 4, of 13 N at most. They hold 10 N between
# them. s N more weight want a squeeze of 2 / 3 (10 + s), and s N from the side add s / 2 to the right finger,
# which is on the arc of its limit at (12, 5): 2 / 3 (10 + s) + s / 2 <= 12, s <= 32 / 7.
#
# Duals: y = 0, (0, 8, 0), (-6, 5 / 2, 5 / 2) and c = 3, -3, so fingers are moved by c (2, a - b), to and fro,
#
#     (6, 8 + 3 (a - b)), (-6, 8 - 3 (a - b))   and   (-12 - 5 a / 2, 5 - 3 (a - b)), (-5 b / 2, 3 (a - b)).
PAIR = [0, 0, 0, 0, 8, 0, -6, 2.5, 2.5, 3, -3]


def facing(width=EIGHTH, more=Fraction(32, 7), row=PAIR):
    lo, hi = float((1 - width) / 2), float((1 + width) / 2)
    right, left = (0, 0, 1 + lo, 1 + hi), (1, 1, 3 + lo, 3 + hi)
    nodes = [
        ([(0, 1, 1 + lo, 3 + hi)] * 2, (1, 3), 0, (0, 0, 0)),
        ([right, right], (0, 0), 0, (1, 4 / 3, 0)), ([right, left], (0, 0), -2, (0, 0, 0)),
        ([left, left], (0, 0), 0, (-1, 4 / 3, 0)),
    ]  # fmt: skip
    more = float(more)
    loads = [[0, -10, 0], [0, -10 - more, 0], [more, -10, 0]]
    given = {
        "size": "force", "norm": "largest", "friction": 0.75, "tied": np.array([row], dtype=float),
        "sides": np.array([[1, *right[2:]], [3, *left[2:]]]),
    }  # fmt: skip
    return planar([[-1, -1], [1, -1], [1, 1], [-1, 1]], loads, nodes, **given)


def most(x, y):
    """Of forces (x', y') of size 1 with |y'| <= 3 / 4 x'."""
    if abs(4 * y) <= 3 * x:
        return Fraction((x * x + y * y) ** 0.5)
    return max(Fraction(0), Fraction(4, 5) * x + Fraction(3, 5) * abs(y))


def test_two_fingers_that_face_each_other() -> None:
    for e in Fraction(1, 2**40), EIGHTH:
        dual = Fraction(0)
        for a, b in product((-e, e), repeat=2):
            d = a - b
            moved = [(-6, 8 + 3 * d), (-6, 8 - 3 * d)]  # into the object, of the right and of the left finger
            moved += [(12 + Fraction(5, 2) * a, 5 - 3 * d), (-Fraction(5, 2) * b, 3 * d)]
            dual = max(dual, sum(most(*u) for u in moved))
        proof = facing(e)
        more = Fraction(proof.loads[2, 0])
        limit = (8 * (10 + more) + 6 * more + 25) / dual
        for factor, good in (1 - 2.0**-50, True), (1 + 2.0**-50, False):
            proof.bound = float(limit) * factor
            assert check_proof(proof) == ([] if good else ["proof: the duals of box 2 do not exclude it"])
        assert (12.999999 < float(limit) < 13) == (e < EIGHTH)
        for k in 4, 6, 7, 8, 9, 10:
            said = []
            for off in 0.25, -0.25:
                row = list(PAIR)
                row[k] += off
                other = facing(e, more, row)
                other.bound = float(limit) * (1 - 1e-9)
                said += check_proof(other)
            assert said, k


def test_fingers_are_moved_by_twists_and_by_ties() -> None:
    """Each tie moves the fingers of its deviation, and back under the load itself."""
    places = [(Fraction(x), Fraction(y)) for x, y in ((2, 1), (-1, 3), (0, -4), (5, 7))]
    rng = np.random.default_rng(1)
    for fingers, ties in (1, 0), (2, 1), (3, 6), (4, 18):
        assert ties_of(fingers) == ties
        here = np.array([[float(c) for c in p] for p in places[:fingers]])
        loads = rng.integers(-5, 6, size=(3, 3)).astype(float)
        twists = rng.integers(-5, 6, size=(3, 3)).astype(float)
        factors = rng.integers(-5, 6, size=(2, ties)).astype(float)
        told: list[tuple[int, tuple[float, float]]] = []

        def heard(i, u, told=told):
            told.append((i, (float(u[0]), float(u[1]))))
            return (i + 1) * (u[0] + 10 * u[1])

        row = [*twists.ravel(), *factors.ravel()]
        work, done = works(row, loads.tolist(), [[p] for p in places[:fingers]], heard)
        assert work == -(loads * twists).sum()
        moved = np.array([[w[:2] + w[2] * np.array([-p[1], p[0]]) for w in twists] for p in here])
        for d in (1, 2):
            z = balanced(here, factors[d - 1])
            assert z.sum(axis=0) == pytest.approx(0, abs=1e-12)
            assert (here[:, 0] * z[:, 1] - here[:, 1] * z[:, 0]).sum() == pytest.approx(0, abs=1e-12)
            moved[:, d] += z
            moved[:, 0] -= z
        assert [(i, tuple(u)) for i, each in enumerate(moved.tolist()) for u in each] == told
        assert done == sum((i + 1) * (x + 10 * y) for i, (x, y) in told)


def balanced(places, factors):
    """Forces of pairs along their line, and of triples."""
    left, z = list(factors), np.zeros_like(places)
    count = len(places)
    for i in range(count):
        for j in range(i + 1, count):
            along = left.pop(0) * (places[i] - places[j])
            z[i] += along
            z[j] -= along
    for i in range(count):
        for j in range(i + 1, count):
            for k in range(j + 1, count):
                a, b, c = left.pop(0), left.pop(0), left.pop(0)
                for f, g, h in (i, j, k), (j, k, i), (k, i, j):
                    x, y = places[g] - places[h]
                    z[f] += np.array([[a, c], [c, b]]) @ [-y, x]
    return z


def test_the_worst_corner_counts() -> None:
    """The largest of a convex function is at a corner, of each finger's hull by itself."""
    hulls = [[(Fraction(x), Fraction(0)) for x in (-1, 3)], [(Fraction(0), Fraction(y)) for y in (-2, 5)]]
    for way in product((1, -1), repeat=2):
        work, done = works([0, 0, 1], [[0, 0, -7]], hulls, lambda i, u, way=way: way[i] * (u[0] + u[1]))
        assert work == 7
        # turned about the origin they move by x upward, and by y to the left
        assert done == max(way[0] * x for x in (-1, 3)) + max(-way[1] * y for y in (-2, 5))
