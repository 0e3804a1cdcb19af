"""To which bound twists that turn exclude, against polynomials through their values; doubles as rationals."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest

from regrasp.verification.placed.curves import turning
from regrasp.verification.placed.curves.turning import is_excluded_in_turn, numbers_of

pytestmark = pytest.mark.oracle

HIGH, LOW = 7, 2  # degrees in a finger's own place, and in those of others


def bernstein(degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes, and what makes values there coefficients."""
    t = 0.5 - 0.5 * np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    k = np.arange(degree + 1)
    weights = np.array([comb(degree, j) for j in k])
    return t, np.linalg.inv(weights * t[:, None] ** k * (1 - t[:, None]) ** (degree - k))


def curve(part, legs, t):
    """Points and tangents, of a cubic, a third of the derivative."""
    t = t[..., None]
    point = sum(comb(3, k) * t**k * (1 - t) ** (3 - k) * part[k] for k in range(4))
    return point, sum(comb(2, k) * t**k * (1 - t) ** (2 - k) * legs[k] for k in range(3))


class Case:
    """Loads, motions and parts by chance, and what their polynomials say."""

    def __init__(self, seed: int, k: int, friction: float, *, bend: float = 0.2) -> None:
        rng = np.random.default_rng(seed)
        self.k, self.friction = k, friction
        self.parts = [np.array([[0, 0], [1, 0], [2, 0.5], [3, 1.5]]) + rng.normal(size=2) for _ in range(k)]
        self.parts = [part + bend * rng.normal(size=(4, 2)) for part in self.parts]
        self.loads = rng.normal(size=(2, 3))
        terms = (k + 1) * (k + 2) // 2
        self.twists = 0.1 * rng.normal(size=(2, 3, terms))
        self.twists[:, :, 0] -= 3 * self.loads
        self.most = rng.uniform(1, 3, size=(2, k) + (3,) * k)

    def motions(self, most=None):
        most = self.most if most is None else most
        rows = np.hstack([self.twists.reshape(2, -1), most.reshape(2, -1)])
        assert rows.shape[1] == numbers_of(self.k)
        return list(zip(self.loads.tolist(), rows.tolist(), strict=True))

    def excluded(self, bound=1e-9, most=None) -> bool:
        hulls = [[(Fraction(x), Fraction(y)) for x, y in part.tolist()] for part in self.parts]
        return is_excluded_in_turn(self.motions(most), Fraction(bound), hulls, self.friction)

    def coefficients(self, own: int | None, values):
        """Of what ``values`` gives at places (..., k); the degree is high in the place of ``own``."""
        each = [bernstein(HIGH if i == own else LOW) for i in range(self.k)]
        found = values(np.stack(np.meshgrid(*(t for t, _ in each), indexing="ij"), axis=-1))
        for i, (_, inverse) in enumerate(each):
            found = np.moveaxis(np.tensordot(inverse, np.moveaxis(found, i, 0), axes=1), 0, i)
        return found

    def twist(self, load: int, t, of=np.asarray):
        terms = [np.ones(t.shape[:-1]), *np.moveaxis(t, -1, 0)]
        terms += [t[..., i] * t[..., j] for i in range(self.k) for j in range(i, self.k)]
        return np.tensordot(of(self.twists[load]), np.array(terms), axes=1)

    def done(self, load: int, finger: int, t):
        found = self.most[load, finger]
        for i in reversed(range(self.k)):
            s = t[..., i]
            weights = np.stack([(1 - s) ** 2, 2 * s * (1 - s), s * s], axis=-1)
            if i == self.k - 1:
                found = np.tensordot(weights, found, axes=(-1, -1))
                found = np.moveaxis(found, -1, 0) if self.k > 1 else found
            else:
                found = (np.moveaxis(found, 0, -1) * weights).sum(axis=-1)
        return found

    def limit(self, lost: float = 0.0) -> float:
        """Up to which bound the work suffices, where so much of each load's is lost."""

        def work(t, of=np.asarray, sign=-1.0):
            return sum(sign * (of(w) @ self.flat(d, t, of)) for d, w in enumerate(self.loads))

        def most(t):
            return sum(self.done(d, i, t) for d in (0, 1) for i in range(self.k))

        size = self.coefficients(None, lambda t: work(t, np.abs, 1.0))
        left = self.coefficients(None, work) - 2 * lost * size
        return float((left / (self.coefficients(None, most) * (1 + 2 * lost))).min())

    def flat(self, load: int, t, of):
        y = self.twist(load, t, of)
        return np.moveaxis(y, 0, -2) if self.k > 1 else y

    def ways(self, load: int, finger: int, sign: float = -1.0, of=np.asarray):
        """Coefficients of u . N and u . T; with sign 1 all terms add up, of the sizes of numbers."""
        part, legs = of(self.parts[finger]), of(np.diff(self.parts[finger], axis=0))

        def velocity(t):
            y, (p, tangent) = self.twist(load, t, of), curve(part, legs, t[..., finger])
            u = np.stack([y[0] + sign * y[2] * p[..., 1], y[1] + y[2] * p[..., 0]], axis=-1)
            ahead = tangent[..., 0] * u[..., 1] + sign * tangent[..., 1] * u[..., 0]
            return ahead, (tangent * u).sum(axis=-1)

        return [self.coefficients(finger, lambda t, i=i: velocity(t)[i]) for i in (0, 1)]

    def share(self, load: int, finger: int, lost: float = 0.0) -> float:
        """The part of what a finger is said to do at most that would do, by coefficients; so much is lost."""
        slant = np.hypot(1, self.friction)
        ahead, aside = self.ways(load, finger)
        far, wide = self.ways(load, finger, 1.0, np.abs)
        a, b, c = np.diff(self.parts[finger], axis=0)
        first, last = np.hypot(*a), np.hypot(*c)
        square = 2 * b @ b + a @ c - first * last
        if min(a @ b, b @ c, square) <= 0:
            return np.inf
        middle = min(a @ b / first, b @ c / last, np.sqrt(square / 2))

        def length(t):
            s = t[..., finger]
            return first * (1 - s) ** 2 + 2 * middle * s * (1 - s) + last * s * s

        there = self.coefficients(finger, lambda t: self.done(load, finger, t) * length(t))
        edge = np.maximum(ahead + self.friction * np.abs(aside), slant**2 * ahead)
        doubt = lost * (slant**2 * far + self.friction * wide)
        return float(((edge + doubt) / (slant * there * (1 - lost))).max())


CASES = [(1, 0.5, 0.2), (1, 0.0, 0.3), (1, 3.0, 0.2), (2, 0.25, 0.2), (2, 2.0, 0.2)]


@pytest.mark.parametrize("doubles", [True, False])
@pytest.mark.parametrize(("k", "friction", "bend"), CASES)
def test_what_is_excluded_is_that_to_ten_digits(k, friction, bend, doubles, monkeypatch) -> None:
    told = [False]

    def clear(*given) -> bool:
        told.append(doubles and kept(*given))
        return told[-1]

    kept = turning._is_clear
    monkeypatch.setattr(turning, "_is_clear", clear)
    seen = 0
    for seed in range(8):
        case = Case(seed, k, friction, bend=bend)
        shares = np.array([[case.share(d, i) for i in range(k)] for d in (0, 1)])
        if not (shares > 0).all() or np.isinf(shares).any():
            continue
        seen += 1
        case.most *= shares[(...,) + (None,) * k] * (1 + 1e-10)  # just enough, of every load and finger
        assert case.excluded()
        assert told[-1] == doubles
        for d in 0, 1:
            for i in range(k):
                less = case.most.copy()
                less[d, i] *= 1 - 2e-10
                assert not case.excluded(most=less), (seed, d, i)
        limit = case.limit()
        assert limit > 0
        assert case.excluded(limit * (1 - 1e-10))
        assert told[-1] == doubles
        assert not case.excluded(limit * (1 + 1e-10))
    assert seen > 1


def threshold(good) -> float:
    """Of factors near 1 the least that is good, to thirteen digits."""
    lo, hi = 1 - 1e-6, 1 + 1e-6
    while hi - lo > 1e-13:
        middle = 0.5 * (lo + hi)
        lo, hi = (lo, middle) if good(middle) else (middle, hi)
    return hi


@pytest.mark.parametrize("friction", [0.0, 0.5, 30.0])
def test_doubles_doubt_what_they_lose(friction, monkeypatch) -> None:
    """Far away fingers turn about a place beside them, and the velocities that are left have lost digits."""
    kept, far = turning._is_clear, 1e7
    monkeypatch.setattr(turning, "_is_clear", lambda *_: False)
    for seed in range(4):
        case = Case(seed, 1, friction, bend=0.1)
        rng = np.random.default_rng(seed)
        at = far * rng.normal(size=2)
        case.parts[0] += at
        case.twists[:] = 0.1 * rng.normal(size=(2, 3, 3))
        case.twists[:, 2, 0] = rng.normal(size=2)
        for axis, lever in (0, at[1]), (1, -at[0]):
            case.twists[:, axis] += lever * case.twists[:, 2]
        case.loads = -case.twists[:, :, 0] / np.abs(case.twists[:, :, 0]).max()
        shares = np.array([[case.share(d, 0)] for d in (0, 1)])
        if not (shares > 0).all() or np.isinf(shares).any():
            continue
        most = case.most * shares[..., None]
        least = threshold(lambda m, case=case, most=most: case.excluded(most=m * most))
        hulls = [[(Fraction(x), Fraction(y)) for x, y in case.parts[0].tolist()]]
        for factor, good in (0.9, False), (least - 1e-12, False), (least + 2e-12 * far, True):
            assert kept(case.motions(factor * most), 1e-9, hulls, friction) == good, (seed, factor)


def test_work_of_which_little_is_left() -> None:
    rng = np.random.default_rng(1)
    hulls = [[(Fraction(k), Fraction(0)) for k in range(4)]]
    for size in 1.0, 1e8:
        for _ in range(20):
            x, y, turn = rng.normal(size=3)
            load = [-size / x, size / y, -1 / turn]  # the work of the first two is nothing but for rounding
            most = 1e3
            motion = [x, 0, 0, y, 0, 0, turn, 0, 0, most, most, most]
            work = -sum(Fraction(a) * Fraction(b) for a, b in zip(load, (x, y, turn), strict=True))
            assert abs(work - 1) < 1e-15 * size + 1e-15
            for off, good in (1e-15, False), (-1e-13 * (2 * size + 2), True):
                bound = float((work + Fraction(off)) / Fraction(most))
                assert turning._is_clear([(load, motion)], bound, hulls, 0.5) == good, (size, off)


def test_lengths_of_tangents_are_bounded_by_less_in_doubles() -> None:
    """Where tangents are at right angles, or beside a place where a curve stops, digits are lost."""
    rng, sure = np.random.default_rng(2), 0
    for k in range(100):
        a, b, c = np.array([[1.0, 0], [1, 0.3], [0.8, 0.6]]) + 0.3 * rng.normal(size=(3, 2))
        if k % 4 == 1:
            b = np.array([-a[1], a[0]]) + 10.0 ** -rng.integers(6, 17) * a
        if k % 4 == 2:
            b = np.array([c[1], -c[0]]) + 10.0 ** -rng.integers(6, 17) * c
        if k % 4 == 3:  # 2 b.b + a.c is nearly the product of the lengths of a and c
            angle = rng.uniform(0.4, 1.4)
            c = np.array([np.cos(angle), np.sin(angle)]) * np.hypot(*a)
            a = np.array([np.hypot(*a), 0])
            b = (
                (a + c)
                / np.hypot(*(a + c))
                * np.sqrt(0.5 * (a @ a - a @ c) * (1 + 10.0 ** -rng.integers(6, 17)))
            )
        tangent = np.array([a, b, c])
        unit = 2**200
        exactly = turning._slowest([tuple(int(Fraction(x) * unit) for x in t) for t in tangent.tolist()])
        found = turning._slowest_clear(tangent)
        if found.any():
            sure += 1
            assert all(Fraction(q) * unit < p for q, p in zip(found.tolist(), exactly, strict=True)), k
            ends = [p / unit for p in exactly]
            assert found[[0, 2]] == pytest.approx([ends[0], ends[2]], rel=1e-12)
            assert k % 4 != 0 or found[1] == pytest.approx(ends[1], rel=1e-10)
        else:
            assert exactly[1] <= 1e-6 * exactly[0], k
    assert 50 < sure < 100


LOST = 1e-3


@pytest.mark.parametrize(("k", "friction", "bend"), CASES)
def test_doubt_is_a_part_of_all_terms(k, friction, bend, monkeypatch) -> None:
    def slowest(tangent):
        first, last = np.hypot(*tangent[0]), np.hypot(*tangent[2])
        a, b, c = tangent
        square = 2 * b @ b + a @ c - first * last
        return np.array([first, min(a @ b / first, b @ c / last, np.sqrt(square / 2)), last])

    monkeypatch.setattr(turning, "_ROUNDING", LOST)
    monkeypatch.setattr(turning, "_slowest_clear", slowest)
    seen = 0
    for seed in range(8):
        case = Case(seed, k, friction, bend=bend)
        shares = np.array([[case.share(d, i, LOST) for i in range(k)] for d in (0, 1)])
        if not (shares > 0).all() or np.isinf(shares).any():
            continue
        seen += 1
        case.most *= shares[(...,) + (None,) * k] * (1 + 1e-9)
        hulls = [[(Fraction(x), Fraction(y)) for x, y in part.tolist()] for part in case.parts]

        def clear(bound, most, case=case, hulls=hulls) -> bool:
            return turning._is_clear(case.motions(most), bound, hulls, friction)

        limit = case.limit(LOST)
        assert clear(limit * (1 - 1e-9), case.most)
        assert not clear(limit * (1 + 1e-9), case.most)
        for d in 0, 1:
            for i in range(k):
                less = case.most.copy()
                less[d, i] *= 1 - 2e-9
                assert not clear(limit * 0.9, less), (seed, d, i)
    assert seen > 1


def test_doubt_of_lengths_is_a_part_of_all_terms(monkeypatch) -> None:
    monkeypatch.setattr(turning, "_ROUNDING", LOST)
    least = set()
    for a, b, c in (
        ((3, 4), (5, 0.5), (6, -1)), ((3, 0), (1, 2), (2, 3)), ((2, 3), (1, 2), (3, 0)),
        ((2, 1), (1.2, 0), (2, -1)), ((5, 0), (5, 1), (5, 2)),
    ):  # fmt: skip
        tangent = np.array([a, b, c], dtype=float)
        first, middle, last = np.hypot(*tangent.T)
        ways = [
            (tangent[0] @ tangent[1] - LOST * first * middle) / first,
            (tangent[1] @ tangent[2] - LOST * middle * last) / last,
            0.5
            * (2 * middle**2 + tangent[0] @ tangent[2] - first * last - LOST * (middle**2 + first * last)),
        ]
        ways[2] = max(ways[2], 0.0) ** 0.5
        least.add(int(np.argmin(ways)))
        expected = np.array([first, min(ways), last]) * (1 - LOST)
        assert turning._slowest_clear(tangent) == pytest.approx(expected, rel=1e-12)
    assert least == {0, 1, 2}
    for none in ((1, 0), (-1, 3), (0, 1)), ((0, 1), (-1, 3), (1, 0)), ((1, 0), (0.5, 0.5), (-1, 0.1)):
        assert not turning._slowest_clear(np.array(none, dtype=float)).any()
        assert turning._slowest([(int(10 * x), int(10 * y)) for x, y in none]) == [0, 0, 0]


FLOOR = [(Fraction(k), Fraction(0)) for k in range(4)]


@pytest.mark.parametrize("doubles", [True, False])
def test_fingers_that_need_not_push_do_nothing_at_least(doubles, monkeypatch) -> None:
    """Down along (0, -1) they do less than nothing where they push, and what is said to be done is not."""
    if not doubles:
        monkeypatch.setattr(turning, "_is_clear", lambda *_: False)
    down = [0.0, 0, 0, -1, 0, 0, 0, 0, 0]
    motions = [([0.0, -1, 0], [*down, -0.79, -0.79, -0.79]), ([0.0, 0, 0], [0.0] * 12)]
    for bound in 2.0, 100.0:
        assert not is_excluded_in_turn(motions, Fraction(bound), [FLOOR], 0.75)
    motions[0] = ([0.0, 1, 0], [*down, 0.0, 0.0, 0.0])  # a load upward is held by none
    assert is_excluded_in_turn(motions, Fraction(2), [FLOOR], 0.75)


@pytest.mark.parametrize("number", [1e-41, 1e41])
def test_numbers_that_doubles_may_lose_are_left_to_rationals(number) -> None:
    motions = [([0.0, 1, 0], [0.0, 0, 0, -1, 0, 0, 0, 0, 0, 1.0, 1, 1]), ([0.0, 0, 0], [0.0] * 12)]
    few = Fraction(number)

    def clear(bound=1e-3, hull=FLOOR, friction=0.75, load=0.0, term=0.0) -> bool:
        motions[1] = [load, 0.0, 0.0], [0.0] * 8 + [term, 1.0, 1, 1]
        return turning._is_clear(motions, bound, [hull], friction)

    assert clear(load=1.0)
    assert clear(term=1e-30)
    assert not clear(load=number)
    assert not clear(term=number)
    assert number > 1 or not clear(bound=number)
    assert not clear(hull=[*FLOOR[:3], (Fraction(3), few)])
    assert number > 1 or not clear(hull=[*FLOOR[:2], (1 + few, Fraction(0)), (1 + 2 * few, Fraction(0))])
    assert not clear(friction=number)
