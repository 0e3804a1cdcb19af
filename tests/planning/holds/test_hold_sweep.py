"""Holds by the million against the formula of one grasp, pair by pair and load by load."""

from collections.abc import Callable
from itertools import combinations
from math import atan, atan2, inf, isnan, pi

import numba
import numpy as np
import pytest

import oracle
import regrasp as rg
from regrasp.closed_form import load_cone
from regrasp.closed_form.choice import ANGLE, best_squeeze
from regrasp.closed_form.compiled.holds import STRETCH, hold_margins, pairs_of, widest_margins
from regrasp.closed_form.locus import squeeze_interval
from regrasp.closed_form.turning_margin import NO_HOLD, arc_tangent, turning_margin

pytestmark = pytest.mark.oracle

Candidates = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, float]
"""Points, unit normals, frictions, force limits and the peak ratio."""


def table(candidates: Candidates, loads: np.ndarray) -> np.ndarray:
    """(O, P) by the sweep."""
    first, second = pairs_of(len(candidates[0]))
    result = np.full((len(loads), first.size), np.nan, dtype=np.float32)
    hold_margins(first, second, loads, candidates, result)
    return result


def one_by_one(candidates: Candidates, loads: np.ndarray) -> np.ndarray:
    """(O, P) by the formula of one grasp, the margin from the angles themselves."""
    points, normals, mu, limits, ratio = (np.asarray(each).tolist() for each in candidates)
    result = []
    for load in loads.tolist():
        for i, j in combinations(range(len(points)), 2):
            _, f, _ = best_squeeze(
                *points[i], *normals[i], mu[i], *points[j], *normals[j], mu[j], *load, 0.0, ANGLE,
                limits[i], limits[j], ratio,
            )  # fmt: skip
            least = min(side(normals[i], mu[i], f[:2]), side(normals[j], mu[j], f[2:]))
            result.append(NO_HOLD if isnan(f[0]) else max(least, 0.0))
    return np.array(result).reshape(len(loads), -1)


def side(n: list[float], mu: float, f: tuple[float, ...]) -> float:
    """The angle margin of one contact; that of a contact without force does not count."""
    if f[0] == f[1] == 0.0:
        return atan(mu)
    return atan(mu) - atan2(abs(n[0] * f[1] - n[1] * f[0]), n[0] * f[0] + n[1] * f[1])


def assert_alike(candidates: Candidates, loads: np.ndarray) -> np.ndarray:
    found, expected = table(candidates, loads), one_by_one(candidates, loads)
    differ = np.argwhere((found >= 0) != (expected >= 0))
    assert len(differ) == 0, (differ[:5], found[tuple(differ[0])], expected[tuple(differ[0])])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)
    return found


def on_a_blob(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points in no order around a smooth shape whose normals are not quite its own."""
    angles = rng.uniform(0, 2 * pi, count)
    radii = rng.uniform(0.5, 1.5, count)
    points = radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    turned = angles + pi + rng.normal(0, 0.5, count)
    return points, np.stack([np.cos(turned), np.sin(turned)], axis=1)


def on_a_lattice(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Different points of a grid with normals along its axes and diagonals: edges and lines fall together."""
    places = rng.choice(49, count, replace=False)
    points = np.stack([places // 7 - 3.0, places % 7 - 3.0], axis=1)
    normals = np.array([(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (0.6, 0.8), (-0.8, 0.6)], float)
    normals /= np.hypot(*normals.T)[:, None]
    return points, normals[rng.integers(0, len(normals), count)]


def around(count: int, start: float = 0.0) -> np.ndarray:
    """Unit loads evenly around; from 0 in steps of 45 degrees, some go through points of the lattice."""
    angles = start + np.arange(count) * 2 * pi / count
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


FRICTIONS: dict[str, Callable[[np.random.Generator, int], np.ndarray]] = {
    "one": lambda rng, n: np.full(n, 0.5),
    "mixed": lambda rng, n: rng.choice([0.05, 0.3, 0.5, 1.0, 3.0], n),
    "some without": lambda rng, n: rng.choice([0.0, 0.5, 1.0], n),
    "small": lambda rng, n: 10 ** rng.uniform(-12, -1, n),
}
LIMITS: dict[str, Callable[[np.random.Generator, int], np.ndarray]] = {
    "none": lambda rng, n: np.full(n, inf),
    "some": lambda rng, n: rng.choice([0.5, 1.0, 2.0, inf], n),
    "each": lambda rng, n: 10 ** rng.uniform(-0.5, 0.7, n),
}


# -- the same answers ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("ratio", [1.0, 1.05, 3.0, 100.0])
@pytest.mark.parametrize("limits", LIMITS)
@pytest.mark.parametrize("frictions", FRICTIONS)
@pytest.mark.parametrize("place", [on_a_blob, on_a_lattice])
def test_margins_are_those_of_one_grasp(place: Callable, frictions: str, limits: str, ratio: float) -> None:
    held = 0
    for seed in range(3):
        rng = np.random.default_rng(seed)
        points, normals = place(rng, 14)
        loads = around(16) * 10 ** rng.uniform(-0.3, 0.3, 16)[:, None]
        candidates = points, normals, FRICTIONS[frictions](rng, 14), LIMITS[limits](rng, 14), ratio
        held += (assert_alike(candidates, loads) >= 0).sum()
    assert held > (0 if frictions == "small" else 50)


@pytest.mark.parametrize("exponent", [-6, -3, 3, 6])
@pytest.mark.parametrize("place", [on_a_blob, on_a_lattice])
def test_in_other_units(place: Callable, exponent: int) -> None:
    """Margins are angles: the same table, and the same as of one grasp in those units.

    No load goes through a contact or is a limit: whether one finger may carry it is then rounding.
    """
    rng = np.random.default_rng(4)
    points, normals = place(rng, 14)
    mu, limits = FRICTIONS["mixed"](rng, 14), 1.07 * LIMITS["some"](rng, 14)
    loads = around(24, 0.1)
    here = table((points, normals, mu, limits, 3.0), loads)
    for length, force in ((10.0**exponent, 1.0), (1.0, 10.0**exponent), (10.0**exponent, 10.0**-exponent)):
        there = assert_alike((length * points, normals, mu, force * limits, 3.0), force * loads)
        np.testing.assert_allclose(here, there, rtol=0, atol=1e-6)


@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-8])
def test_points_close_together_far_from_the_load(gap: float) -> None:
    rng = np.random.default_rng(2)
    points, normals = on_a_blob(rng, 12)
    points[6:] = points[:6] + gap * rng.normal(size=(6, 2))
    candidates = points, normals, np.full(12, 0.8), np.full(12, inf), 3.0
    assert (assert_alike(candidates, around(36)) >= 0).any()


def test_edges_nearly_along_the_line_of_contacts() -> None:
    """From no angle at all between them through every decade."""
    for k, tilt in enumerate([0.0, *(10.0 ** np.arange(-16, -1, 1.0))]):
        mu = np.array([0.5, 0.7])
        turned = np.arctan(mu) + tilt
        normals = np.array([(np.cos(turned[0]), np.sin(turned[0])), (-np.cos(turned[1]), np.sin(turned[1]))])
        for sign in (1.0, -1.0):
            points = np.array([(-1.0, 0.1 * (k % 3)), (1.0, 0.1 * (k % 3))])
            n = normals * np.array([1.0, sign])
            assert_alike((points, n, mu, np.array([inf, inf]), 3.0), around(48))


def test_loads_through_a_contact() -> None:
    """Exactly, and by all decades of almost: a finger may then carry everything, or nothing."""
    points = np.array([(0.0, 1.0), (0.8, -0.7), (-0.3, -1.0), (0.0, -1.5)])
    normals = np.array([(0.0, -1.0), (-0.6, 0.8), (0.0, 1.0), (0.0, 1.0)])
    loads = np.array([(x, y) for x in [0.0, *(10.0 ** np.arange(-18, 0, 1.0))] for y in (1.0, -1.0)])
    candidates = points, normals, np.full(4, 0.6), np.full(4, inf), 3.0
    assert (assert_alike(candidates, loads) >= 0).any()


def test_limits_that_just_suffice() -> None:
    """At the least peak that holds, within every decade of it."""
    points, normals = np.array([(-1.0, 0.3), (1.0, -0.2)]), np.array([(0.8, 0.6), (-0.8, 0.6)])
    mu, load = np.array([0.6, 0.4]), np.array([(0.1, -1.0)])
    least = max(
        np.hypot(*f)
        for _, forces, _ in [
            best_squeeze(
                *points[0], *normals[0], 0.6, *points[1], *normals[1], 0.4, 0.1, -1.0, 0.0, 3, inf, inf, 3.0
            )
        ]
        for f in (forces[:2], forces[2:])
    )
    verdicts = set()
    for off in [0.0, *(10.0 ** np.arange(-16, -1, 1.0)), *(-(10.0 ** np.arange(-16, -1, 1.0)))]:
        limits = np.full(2, least * (1 + off))
        verdicts.add(bool(assert_alike((points, normals, mu, limits, 3.0), load)[0, 0] >= 0))
    assert verdicts == {True, False}


def test_verdicts_are_exact() -> None:
    """Against rational arithmetic, wherever the locus is wider or its gap larger than rounding."""
    seen = {True: 0, False: 0}
    for seed, place in enumerate((on_a_blob, on_a_lattice)):
        rng = np.random.default_rng(seed)
        points, normals = place(rng, 20)
        mu = FRICTIONS["mixed"](rng, 20)
        loads = np.array([(0.0, -1.0), (1.0, 2.0), (-0.5, 0.25)])
        found = table((points, normals, mu, np.full(20, inf), 3.0), loads)
        for o, load in enumerate(loads):
            for p, (i, j) in enumerate(combinations(range(20), 2)):
                exact = oracle.locus(points[i], normals[i], mu[i], points[j], normals[j], mu[j], load, 0.0)
                if abs(exact.width) > 1e-9 and not 0 < exact.miss < 1e-9:
                    assert (found[o, p] >= 0) == (not exact.empty), (o, i, j)
                    seen[not exact.empty] += 1
    assert min(seen.values()) > 100, seen


# -- the formulas -------------------------------------------------------------------------------------------


def random_contacts(rng: np.random.Generator) -> tuple[list[float], list[float], float, float]:
    points, normals = on_a_blob(rng, 2)
    first, second = np.hstack([points, normals]).tolist()
    return first, second, *rng.uniform(0.05, 2.0, 2).tolist()


def test_the_loads_of_a_pair_are_those_with_a_squeeze() -> None:
    rng = np.random.default_rng(11)
    planes: dict[int, int] = {}
    for _ in range(400):
        first, second, mu1, mu2 = random_contacts(rng)
        turned, along1, along2, _ = load_cone.pair_for_turning(*first, *second)
        x, y = [0.0] * 7, [0.0] * 7
        edges = load_cone.cone_edges(turned, (*along1, mu1), (*along2, mu2))
        count = load_cone.half_planes(edges, x, y)
        planes[count] = planes.get(count, 0) + 1
        for fx, fy in around(15).tolist():
            lo, hi = squeeze_interval(*first, mu1, *second, mu2, fx, fy, 0.0)
            inside = count == 0 or all(a * fx + b * fy >= 0 for a, b in zip(x[:4], y[:4], strict=True))
            assert inside == (lo <= hi)
    assert set(planes) == {0, 3, 4}, planes


def test_the_margin_without_branches_is_that_of_the_best_state() -> None:
    """The same lines that are compiled, called as they are."""
    rng = np.random.default_rng(12)
    held = 0
    for _ in range(600):
        first, second, mu1, mu2 = random_contacts(rng)
        turned, along1, along2, far = load_cone.pair_for_turning(*first, *second)
        one, two = (*along1, mu1), (*along2, mu2)
        fx, fy = rng.normal(size=2).tolist()
        _, f, _ = best_squeeze(*first, mu1, *second, mu2, fx, fy, 0.0, ANGLE, inf, inf, 2.0)
        if isnan(f[0]):
            continue
        held += 1
        found = turning_margin(
            fx, fy, turned, one, two, load_cone.own_reach(one), load_cone.own_reach(two),
            False, inf, inf, 2.0, load_cone.idle_below(far),
        )  # fmt: skip
        least = min(side(first[2:], mu1, f[:2]), side(second[2:], mu2, f[2:]))
        assert found == pytest.approx(max(least, 0.0), abs=2e-8)
    assert held > 100


def test_the_arc_tangent_is_as_exact_as_it_says() -> None:
    for t in np.r_[0.0, 10.0 ** np.linspace(-9, 9, 2001)].tolist():
        assert abs(arc_tangent(t, 1.0) - atan(t)) <= 6e-9
        assert arc_tangent(3.0 * t, 3.0) == pytest.approx(arc_tangent(t, 1.0), abs=1e-15)


# -- many ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("orientations", [1, 2, 7, 8, 9, 31])
@pytest.mark.parametrize("points", [2, 3, 7, 30, 100])
def test_sizes_around_blocks_and_vectors(points: int, orientations: int) -> None:
    """Every entry is written, and the widest of each pair are the maxima of the table."""
    rng = np.random.default_rng(points)
    candidates = *on_a_blob(rng, points), FRICTIONS["mixed"](rng, points), LIMITS["some"](rng, points), 3.0
    loads = around(orientations) * rng.uniform(0.5, 2.0)
    found = table(candidates, loads)
    assert not np.isnan(found).any()
    assert ((found == NO_HOLD) | (found >= 0)).all()
    if points <= 7:
        assert_alike(candidates, loads)
    first, second = pairs_of(points)
    for allowed in (rng.random(first.size) < 0.7, rng.random(found.shape) < 0.7):
        expected = np.where(allowed, found, np.float32(NO_HOLD))
        best, where = np.full(first.size, NO_HOLD, np.float32), np.zeros(first.size, np.int32)
        counts = np.zeros((-(-first.size // STRETCH), orientations), np.int64)
        widest_margins(first, second, loads, candidates, allowed, 5, best, where, counts)
        np.testing.assert_array_equal(best, expected.max(axis=0))
        holds = best >= 0
        np.testing.assert_array_equal(where[holds], 5 + expected.argmax(axis=0)[holds])
        np.testing.assert_array_equal(counts.sum(axis=0), (expected >= 0).sum(axis=1))


def test_the_number_of_threads_does_not_matter() -> None:
    rng = np.random.default_rng(8)
    candidates = *on_a_blob(rng, 60), FRICTIONS["mixed"](rng, 60), LIMITS["some"](rng, 60), 3.0
    threads = numba.get_num_threads()
    try:
        numba.set_num_threads(1)
        alone = table(candidates, around(20))
    finally:
        numba.set_num_threads(threads)
    np.testing.assert_array_equal(alone, table(candidates, around(20)))


def test_symmetric_samples_of_outlines() -> None:
    """Sides that face each other and loads along them: many edges are parallel to a line of contacts."""
    for outline in (rg.Outline([[-2, -1], [2, -1], [2, 1], [-2, 1]]), rg.Outline.ellipse(2.0, 1.0)):
        contacts = [outline.contact_at(s, friction=0.5) for s in outline.sample(24).tolist()]
        points, normals = np.array([c.position for c in contacts]), np.array([c.normal for c in contacts])
        candidates = points, normals, np.full(len(points), 0.5), np.full(len(points), inf), 3.0
        assert (assert_alike(candidates, around(24)) >= 0).sum() > 300
