"""Boxes on curves excluded by twists that turn with the fingers: by hand, by samples, of a search."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from numba import njit
from scipy.optimize import linprog

import regrasp as rg
from proofs import planar
from regrasp.closed_form.compiled.places.simplex import play
from regrasp.closed_form.compiled.places.turning_bounds import least_above, slowest
from regrasp.closed_form.compiled.places.turning_twists import polynomial_twists, room_to_turn
from regrasp.planning.placement.levels import turning_search
from regrasp.verification.placed.curves.turning import is_excluded_in_turn

pytestmark = pytest.mark.oracle

FLOOR = np.array([[0.0, 0], [1, 0], [2, 0], [3, 0]])
BOWL = np.array([[0.0, 0], [1, 0], [2, 1], [3, 3]])  # (3 t, 3 t^2)
LOADS = [[1.0, -1, -2], [1.0, -1, -2.125]]
NONE = [0.0, 0, 0]
# about the finger in the bowl, wherever it is, one way and the other: it does no work, the loads do 1/8
ABOUT = [[0.0, 0, -3, 0, 3, 0, -1, 0, 0, *NONE], [0.0, 0, 3, 0, -3, 0, 1, 0, 0, *NONE]]


def excluded(motions=ABOUT, loads=LOADS, *, bound=1e6, part=BOWL, friction=0.75) -> bool:
    """By one finger on a part."""
    hulls = [[(Fraction(x), Fraction(y)) for x, y in part.tolist()]]
    return is_excluded_in_turn(list(zip(loads, motions, strict=True)), Fraction(bound), hulls, friction)


def test_turns_about_a_finger_hold_at_any_limit() -> None:
    assert excluded()
    assert not excluded(ABOUT[::-1])
    for which in range(2):
        for term in range(9):
            moved = np.array([ABOUT, ABOUT])
            moved[:, which, term] += [2**-20, -(2**-20)]  # the finger moves, one way along its cone
            assert not all(excluded(wrong.tolist()) for wrong in moved), (which, term)
    for term in range(9, 12):
        wrong = np.array(ABOUT)
        wrong[0, term] -= 2**-60
        assert not excluded(wrong.tolist(), bound=1e-6)


def test_a_bound_is_at_the_edge_of_the_cone() -> None:
    """Velocity (1/2, 1/4) on the floor: (1/4 + 3/4 / 2) / (5/4) = 1/2 along the edge of friction 3/4."""
    for way in (-1, 1):
        for s, good in (0.5, True), (0.5 - 2**-40, False), (0.5 + 2**-40, True):
            moved = [[0.5 * way, 0, 0, 0.25, 0, 0, *NONE, s, s, s]]
            for bound in (0.25, 1.0):
                # the load does 3/4 along it
                assert excluded(moved, [[-1.0 * way, -1, 0]], part=FLOOR, bound=bound) == good
    work = 0.5 + 0.25
    for factor, good in (1 - 2**-40, True), (1, False), (1 + 2**-40, False):
        moved = [[0.5, 0, 0, 0.25, 0, 0, *NONE, 0.5, 0.5, 0.5]]
        assert excluded(moved, [[-1.0, -1, 0]], part=FLOOR, bound=2 * work * factor) == good


def test_along_the_normal_it_is_that_of_the_polygon() -> None:
    for s, good in (1.25 + 2**-40, True), (1.25 - 2**-40, False):
        moved = [[*NONE, 1, 0, 0, *NONE, s, s, s]]
        assert excluded(moved, [[0, -2.0, 0]], part=FLOOR, bound=1) == good


def test_what_doubles_lose_excludes_nothing() -> None:
    """Products too small for doubles, and many loads of which each is lost in the sum of all."""
    for size in (1.0, 1e-60, 1e-170):
        for s, good in (1.25 + 2**-40, True), (1.25 - 2**-40, False), (0.0, False):
            moved = (size * np.array([[*NONE, 1, 0, 0, *NONE, s, s, s]])).tolist()
            load = [[0, -2.0 / size, 0]]
            assert excluded(moved, load, part=size * FLOOR, bound=1 / size) == good, (size, s)
    few = 1200
    loads = [[-1.0, 0, 0], *[[2.0**-54, 0, 0]] * few]  # work 1 - 1200 / 2^54 along the floor
    for work, good in (1 - 0.95 * few / 2**54, False), (1 - few / 2**53, True):
        moved = [[1.0, 0, 0, *NONE, *NONE, *[s] * 3] for s in (work, *[0.0] * few)]
        assert excluded(moved, loads, part=FLOOR, bound=1, friction=0.0) == good


def test_polynomials_count_between_the_ends() -> None:
    """Work t (1 - t) (a - 1) + t^2 + (1 - t)^2 for the load, by terms 1 + (a - 3) t + (3 - a) t^2."""
    for a, good in (1.0, False), (1.5, True), (0.5, False), (0.99, False), (1.01, True):
        moved = [[*NONE, 1, a - 3, 3 - a, *NONE, *NONE]]
        # the finger pushes down onto it from above, and does less than nothing
        assert excluded(moved, [[0, -1.0, 0]], part=FLOOR[::-1], bound=1, friction=0.0) == good


def _sampled(motions, loads, bound, parts, friction, t) -> float:
    """The least of what excludes, at places t (n, k)."""
    k = len(parts)
    terms = [np.ones(len(t)), *t.T, *(t[:, i] * t[:, j] for i in range(k) for j in range(i, k))]
    left = np.zeros(len(t))
    for load, motion in zip(loads, motions, strict=True):
        y = np.reshape(motion[: 3 * len(terms)], (3, -1)) @ np.array(terms)
        left -= load @ y[:3]
        for i, part in enumerate(parts):
            s = t[:, i]
            weights = np.stack([(1 - s) ** 3, 3 * s * (1 - s) ** 2, 3 * s**2 * (1 - s), s**3])
            slopes = np.stack([(1 - s) ** 2, 2 * s * (1 - s), s**2])
            p, along = part.T @ weights, np.diff(part, axis=0).T @ slopes
            along = along / np.hypot(*along)
            u = np.array([y[0] - y[2] * p[1], y[1] + y[2] * p[0]])
            ahead, aside = along[0] * u[1] - along[1] * u[0], (along * u).sum(axis=0)
            edge = (ahead + friction * np.abs(aside)) / np.hypot(1, friction)
            inside = np.abs(aside) <= friction * ahead
            left -= bound * np.where(inside, np.hypot(*u), np.maximum(edge, 0))
    return float(left.min())


@pytest.mark.parametrize("fingers", [1, 2, 3])
def test_what_is_excluded_is_at_every_place(fingers: int) -> None:
    rng = np.random.default_rng(fingers)
    m = (fingers + 1) * (fingers + 2) // 2
    t = rng.uniform(-0.1, 1.1, size=(300, fingers)).clip(0, 1)
    seen = 0
    for _ in range(150):
        parts = [BOWL / 3 + 0.2 * rng.normal(size=(4, 2)) for _ in range(fingers)]
        loads = rng.normal(size=(2, 3))
        twists = 0.1 / fingers * rng.normal(size=(2, 3, m))
        twists[:, :, 0] -= loads
        most = 0.1 / fingers * rng.normal(size=(2, fingers * 3**fingers)) + rng.uniform(1, 3)
        rows = np.hstack([twists.reshape(2, -1), most])
        bound, friction = float(rng.uniform(0.01, 0.5) / fingers), float(rng.uniform(0.1, 1))
        hulls = [[(Fraction(x), Fraction(y)) for x, y in part.tolist()] for part in parts]
        motions = list(zip(loads.tolist(), rows.tolist(), strict=True))
        if is_excluded_in_turn(motions, Fraction(bound), hulls, friction):
            seen += 1
            assert _sampled(rows, loads, bound, parts, friction, t) > 0
    assert seen > 5


@njit
def _lowest(x, y):
    return slowest(x, y)


def lowest(tangents) -> np.ndarray:
    """Coefficients of a polynomial below the length of tangents (3, 2)."""
    return np.array(_lowest(*np.array(tangents).T.copy()))


def test_the_slowest_is_below_and_near_by_the_third_power() -> None:
    s = np.linspace(0, 1, 101)
    slopes = np.stack([(1 - s) ** 2, 2 * s * (1 - s), s**2], axis=1)
    off = []
    for h in (0.4, 0.2, 0.1):
        whole = np.array([[1.0, 0.2], [0.7, 0.9], [-0.3, 0.8]])  # of a part, the blossom from 0 to h
        tangent = np.array(
            [
                whole[0],
                whole[0] + h * (whole[1] - whole[0]),
                [h * h, 2 * h * (1 - h), (1 - h) ** 2][::-1] @ whole,
            ]
        )
        length, q = np.hypot(*(slopes @ tangent).T), slopes @ lowest(tangent)
        assert (q <= length + 1e-15).all()
        off.append((length - q).max())
    assert off[0] > 5 * off[1] > 30 * off[2] > 0
    assert not lowest([[1.0, 0], [0, 0], [-1, 0]]).any()


def test_twists_of_the_search_are_bounds() -> None:
    """On a box of small parts of an ellipse, where forces of 1 N cannot hold the loads."""
    shape = rg.Outline.ellipse(2.0, 1.0)
    control = shape.cubics()[[10, 70, 120]] / 2
    loads = np.array([[0.5, 0, 0.2], [0.5, 0, -0.2], [0, 0.5, 0.2], [0, 0.5, -0.2]])
    rows = np.zeros((4, 3 * 10 + 3 * 27))
    hulls = [[(Fraction(x), Fraction(y)) for x, y in part.tolist()] for part in control]
    for friction in (0.02, 0.2):
        assert polynomial_twists(control, friction, loads, rows, room_to_turn(4, 3))
        few = np.flatnonzero(rows.any(axis=1))

        def judged(given: np.ndarray, friction=friction, hulls=hulls, few=few) -> bool:
            motions = list(zip((-loads[few]).tolist(), given[few].tolist(), strict=True))
            return is_excluded_in_turn(motions, Fraction(1), hulls, friction)

        assert judged(rows)
        for column in range(30, 30 + 81, 4):
            lower = rows.copy()
            lower[:, column] -= 0.01 * np.abs(rows).max()
            assert not judged(lower), column
        assert not judged(rows, 2 * friction)
        assert not judged(rows, hulls=hulls[::-1])
    assert not polynomial_twists(control, 2.0, loads, rows, room_to_turn(4, 3))


@njit
def _raised(speed, edge, basis, s):
    least_above(speed, edge, basis, s)


def test_the_least_above_is_that_of_a_linear_program() -> None:
    rng = np.random.default_rng(5)
    for _ in range(100):
        speed, edge, s = rng.uniform(0, 1, (8, 3)), rng.normal(size=8), np.zeros(3)
        _raised(speed, edge, np.zeros((3, 4)), s)
        assert (s >= 0).all()
        assert (speed @ s >= edge - 1e-12).all()
        assert s.sum() == pytest.approx(linprog(np.ones(3), -speed, -edge).fun, rel=1e-9, abs=1e-12)
    _raised(speed, -np.ones(8), np.zeros((3, 4)), s)
    assert not s.any()


def test_they_are_of_lengths_of_forces() -> None:
    node = ([(0, 0, 0.0, 1.0)], (0, 0), 0, (0.0, 0.0, 0.0))
    given = {"norm": "largest", "control": BOWL[None], "movers": np.array([[0, 0], [0, 1]]), "bound": 1e6}
    given |= {"sides": np.array([[0, 0, 1.0]]), "motions": np.array(ABOUT), "friction": 0.75}

    def said(**changes) -> str:
        proof = planar(BOWL[:1], LOADS, [node], **given | {"size": "force"} | changes)
        return "; ".join(rg.verify(proof).violations)

    assert said() == ""
    assert "for the length of a force" in said(size="normal")
    assert "motions must have shape (2, 12)" in said(motions=np.array(ABOUT)[:, :5])
    assert said(motions=np.array(ABOUT[::-1])) == "proof: the twists of box 0 do not exclude it"
    assert said(movers=np.array([[0, 0], [0, 0]])) == "proof: the twists of box 0 do not exclude it"
    assert said(motions=np.array(ABOUT[::-1]), bound=0.0) == ""


@njit
def _played(gains, least, table, names, shares, corners):
    return play(gains, len(gains), least, table, names, shares, corners)


def test_a_game_is_that_of_a_linear_program() -> None:
    rng = np.random.default_rng(3)
    above = 0
    for _ in range(40):
        n, m = rng.integers(1, 80), rng.integers(1, 28)
        gains = rng.normal(size=(n, m)) * rng.choice([1, 100.0], size=(n, 1)) + rng.uniform(-1, 1)
        gains /= np.abs(gains).max()
        rows = np.column_stack([-gains.T, np.ones(m)])
        sums, limits = np.append(np.ones(n), 0.0)[None], [(0, None)] * n + [(None, None)]
        value = -linprog(np.append(np.zeros(n), -1.0), rows, np.zeros(m), sums, 1.0, limits).fun
        room = np.zeros((n + 1, m + 1)), np.zeros(n + m, int), np.zeros(n), np.zeros(m)
        assert _played(gains, -1.0, *room) == pytest.approx(value, abs=1e-9)
        shares, corners = room[2:]
        assert (shares.sum(), corners.sum()) == pytest.approx((1, 1))
        assert (shares @ gains).min() == pytest.approx((gains @ corners).max(), abs=1e-9)
        above += value > 0
        assert (_played(gains, 0.0, *room) > 0) == (value > 0)
    assert 5 < above < 35


def flower() -> tuple[rg.Outline, rg.LoadSet]:
    """A smooth outline, and twelve loads, of which fixed twists leave two fingers some boxes."""
    angle = np.arange(8) * np.pi / 4
    radius = np.array([1.3, 1.2, 1, 1, 1.2, 0.9, 1, 1.1])[:, None]
    shape = rg.Outline.smooth(radius * np.column_stack([np.cos(angle), np.sin(angle)]))
    loads = rg.LoadSet.hull([
        rg.Wrench([np.cos(a), np.sin(a)], t) for a in np.arange(6) * np.pi / 3 for t in (0.1, -0.1)
    ])  # fmt: skip
    return shape, loads


def test_a_search_is_closed_by_them() -> None:
    shape, loads = flower()
    given = {"friction": 0.6, "objective": "friction_use", "max_force": 4, "most_boxes": 2000}
    chosen = rg.choose_grasp(shape, 2, loads, tolerance=1e-4, **given)
    assert chosen.gap <= 1e-4
    proof = chosen.certificate
    assert proof.motions is not None
    assert proof.movers is not None
    assert len(proof.motions) == len(proof.movers) > 10
    assert rg.verify(rg.ChosenGrasp.from_dict(chosen.to_dict())).ok
    wrong = []
    for column in range(0, proof.motions.shape[1], 7):
        motions = proof.motions.copy()
        motions[:, column] -= 0.1 * np.abs(motions).max(axis=1)
        wrong.append(not rg.verify(replace(proof, motions=motions)).ok)
    assert all(wrong)
    assert not rg.verify(replace(proof, movers=None, motions=None)).ok
    assert not rg.verify(replace(proof, movers=proof.movers[::-1])).ok
    for box in np.unique(proof.movers[:, 0])[:2]:
        less = proof.movers[:, 0] != box
        assert not rg.verify(replace(proof, movers=proof.movers[less], motions=proof.motions[less])).ok
    for friction in (proof.friction * 1.01,):
        assert not rg.verify(replace(proof, friction=friction)).ok


def test_of_a_search_cut_short_what_was_closed_is_left() -> None:
    """One is closed some way from the best, and the next of 2,000 boxes or an interrupt ends."""
    shape, loads = flower()
    bounds: list[float] = []

    def noted(bound: float, value: float) -> None:
        bounds.append(bound)

    def interrupting(bound: float, value: float) -> None:
        if bound == kept:
            raise KeyboardInterrupt

    given = {"friction": 0.6, "objective": "friction_use", "max_force": 4, "tolerance": 1e-6}
    cut = rg.choose_grasp(shape, 2, loads, most_boxes=2000, progress=noted, **given)
    *_, before, kept = sorted(set(bounds) - {0.0})
    assert cut.bound == kept
    assert 1e-6 < cut.gap < 0.6 * (cut.value - before) / cut.value
    ended = rg.choose_grasp(shape, 2, loads, most_boxes=2000, progress=interrupting, **given)
    assert ended.bound == kept
    for chosen in (cut, ended):
        assert chosen.certificate.motions is not None
        assert rg.verify(chosen).ok


def test_twists_take_so_much_memory_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    shape, loads = flower()
    monkeypatch.setattr(turning_search, "_NUMBERS", 2)
    given = {"friction": 0.6, "objective": "friction_use", "max_force": 4, "tolerance": 1e-6}
    cut = rg.choose_grasp(shape, 2, loads, most_boxes=2000, **given)
    motions = cut.certificate.motions
    assert motions is not None
    assert cut.gap > 1e-5
    assert motions.size < 2 * 2000 + 6 * motions.shape[1]
    assert rg.verify(cut).ok
