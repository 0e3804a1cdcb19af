"""The best state on a locus is not beaten by brute force on a grid of it."""

from collections import Counter
from math import inf, isfinite, sqrt

import numpy as np
import pytest

import regrasp as rg
from models import LARGER_IS_BETTER, LIMITED, OBJECTIVES, objective_values
from regrasp.closed_form import best
from regrasp.mechanics import margins
from strategies import Pair, comfortable_pair, lattice_pair, random_pair

pytestmark = pytest.mark.oracle


def values(pair: Pair, forces: np.ndarray, objective: str) -> np.ndarray:
    return objective_values(forces, np.array([pair.n1, pair.n2]), np.array([pair.mu1, pair.mu2]), objective)


def limited(locus: rg.EquilibriumLocus, limits: list[float]) -> tuple[float, float]:
    """Squeezes with |f_i| <= limit_i: a circle cuts a chord from each contact's line of forces."""
    (lo, hi), u = locus.interval, locus.direction
    first, second = locus.forces(0.0)
    for force, sense, limit in ((first, 1.0, limits[0]), (second, -1.0, limits[1])):
        if limit < inf:
            along, across = float(force @ u), float(u[0] * force[1] - u[1] * force[0])
            if limit < abs(across):
                return inf, -inf
            middle, reach = -sense * along, sqrt(limit**2 - across**2)
            lo, hi = max(lo, middle - reach), min(hi, middle + reach)
    return lo, hi


def grid(locus: rg.EquilibriumLocus, lo: float, hi: float) -> np.ndarray:
    """1,500 squeezes of [lo, hi], ends and those where a contact may carry nothing included."""
    first, second = locus.forces(0.0)
    width = 5 * max(abs(first).max(), abs(second).max(), *(abs(x) for x in (lo, hi) if isfinite(x)), 0.1)
    lo = lo if isfinite(lo) else min(hi, 0) - width
    hi = hi if isfinite(hi) else max(lo, 0) + width
    special = np.array([0.0, float(second @ locus.direction), lo, hi])
    return np.concatenate([np.linspace(lo, hi, 1500), special[(lo <= special) & (special <= hi)]])


def compare_with_grid(
    pair: Pair,
    objective: str,
    limits: tuple[float | None, float | None],
    max_force: float | None,
    ratio: float,
) -> str:
    """Plan with no reserve, so that the grid of the whole locus is what there is to beat."""
    contacts = ((pair.r1, pair.n1, pair.mu1, limits[0]), (pair.r2, pair.n2, pair.mu2, limits[1]))
    grasp = rg.Grasp(rg.Contact(r, n, mu, max_force=limit) for r, n, mu, limit in contacts)
    locus = rg.EquilibriumLocus(grasp, pair.load)
    bounds = [min(inf if x is None else x for x in (limit, max_force)) for limit in limits]
    lo, hi = locus.interval if locus.is_empty else limited(locus, bounds)
    try:
        state = rg.choose_state(
            grasp, pair.load, objective, max_force=max_force, peak_ratio=ratio, reserve=0.0
        )
    except rg.Infeasible:
        assert lo > hi - 1e-12 * (abs(lo) + abs(hi)), (pair, objective, limits, max_force)
        return "infeasible"
    except rg.InvalidInput:
        assert objective in LIMITED
        assert not pair.load.vector.any()
        assert inf in bounds
        return "zero load"
    assert lo <= hi
    if objective in LIMITED and inf in bounds:
        peaks = -values(pair, locus.forces(grid(locus, lo, hi)), "peak")
        least = -float(values(pair, rg.choose_state(
            grasp, pair.load, "peak", max_force=max_force, reserve=0.0).forces[None], "peak")[0])  # fmt: skip
        assert least <= peaks.min() * (1 + 1e-12)
        bounds = [min(bound, ratio * least) for bound in bounds]
        lo, hi = limited(locus, bounds)
    assert state.force_limits == pytest.approx(bounds, rel=1e-12)
    forces = locus.forces(grid(locus, lo, hi))
    largest = float(np.abs(forces).max())
    assert lo - 1e-12 * largest <= locus.squeeze(state) <= hi + 1e-12 * largest
    on_grid, mine = values(pair, forces, objective), values(pair, state.forces[None], objective)[0]
    scale = {
        "angle": 1.0,
        "friction_use": 1 + 0.01 / min(m for m in (pair.mu1, pair.mu2, 1.0) if m),
        "effort": largest**2,
    }.get(objective, largest)
    nothing = {"angle": 0.0, "friction_use": -1.0}.get(objective, -inf)
    if not pair.load.vector.any() and on_grid.max() <= nothing:
        return "best"  # an edge along the line of contacts and no load: nothing to choose between
    assert on_grid.max() <= mine + 1e-12 * scale, (pair, objective, limits, max_force, ratio)
    own = mine if objective in LARGER_IS_BETTER else -mine
    if objective == "friction_use" and own == 0 and np.isnan(state.value):
        return "best"  # rays only: no friction to use
    assert state.value == pytest.approx(own, rel=1e-11, abs=1e-14 * scale)
    return "best"


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_not_beaten_on_a_grid(objective: str) -> None:
    rng = np.random.default_rng(OBJECTIVES.index(objective))
    seen: Counter[str] = Counter()
    for case in range(800):
        pair = random_pair(rng) if case % 2 else lattice_pair(rng)
        if case % 5 == 0:
            pair = pair.loaded_through((pair.r1, pair.r2)[rng.integers(2)], pair.force)
        limits = [float(10 ** rng.uniform(-0.3, 1)) if rng.random() < 0.4 else None for _ in "12"]
        max_force = float(10 ** rng.uniform(-0.5, 1)) if rng.random() < 0.4 else None
        ratio = float(rng.choice([1.5, 3, 10]))
        seen[compare_with_grid(pair, objective, (limits[0], limits[1]), max_force, ratio)] += 1
    assert seen["best"] > 130, seen
    assert seen["infeasible"] > 100, seen


DEGENERATE = {
    "zero load": (Pair((0, 0), (2, 1), 1.0, (2, 0), (-1, 0), 0.5, (0, 0), 0.0), 4.0),
    "zero load in a ring": (Pair((0, 0), (-2, 1), 1.0, (2, 0), (1, 0), 0.5, (0, 0), 0.0), 4.0),
    "through the first, held by it alone": (
        Pair((0, 0), (0, 1), 0.5, (2, 0), (0, 1), 0.5, (0.25, -1), 0.0), None
    ),
    "through the second": (Pair((0, 0), (1, 0.2), 0.5, (2, 0), (-1, 1), 0.5, (1, -1), -2.0), None),
    "along the line": (Pair((0, 0), (1, 0.1), 0.5, (2, 0), (-1, 0.2), 0.5, (1, 0), 0.0), None),
    "equal contacts, symmetrical": (Pair((0, 0), (1, 1), 0.5, (2, 0), (-1, 1), 0.5, (0, -2), -2.0), None),
    "squeeze from both sides": (Pair((0, 0), (1, 0), 0.5, (2, 0), (-1, 0), 0.5, (0, -2), -2.0), None),
    "fingers pushing apart in a ring": (Pair((0, 0), (-1, 0), 0.5, (2, 0), (1, 0), 0.3, (0, -2), -1.8), None),
    "one shelf, bounded": (Pair((0, 0), (0, 1), 0.5, (2, 0), (0, 1), 0.3, (0.1, -2), -1.5), None),
    "frictionless and frictional": (Pair((0, 0), (0, 1), 0.0, (2, 0), (0, 1), 0.3, (0.1, -2), -1.5), None),
    "frictionless groove": (Pair((0, 0), (1, 1), 0.0, (2, 0), (-1, 1), 0.0, (0, -2), -2.0), None),
    "nearly no torque about the second": (
        Pair((0, 0), (1, 0.2), 0.5, (2, 0), (-1, 1), 0.5, (1, -1), -2.0 - 1e-13), None
    ),
}  # fmt: skip


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("name", DEGENERATE)
def test_not_beaten_where_geometry_degenerates(name: str, objective: str) -> None:
    pair, max_force = DEGENERATE[name]
    for each in (pair, pair.swapped()):
        assert compare_with_grid(each, objective, (None, None), max_force, 3.0) == "best"


def test_an_idle_finger_has_no_angle() -> None:
    """Load straight through P2 along its normal: P1, whose normal is askew, is best left out."""
    grasp = rg.Grasp([rg.Contact([0, 0], [1, 0.4], 0.5), rg.Contact([2, 0], [-1, 1], 0.5)])
    state = rg.choose_state(grasp, rg.Wrench([1, -1], -2.0), "angle")
    assert state.in_use == ("P2",)
    assert state.value == pytest.approx(np.arctan(0.5), rel=1e-12)


@pytest.mark.parametrize("objective", LIMITED)
def test_a_peak_ratio_of_one_is_the_least_peak(objective: str) -> None:
    rng = np.random.default_rng(5)
    for _ in range(100):
        grasp, load = comfortable_pair(rng)
        state = rg.choose_state(grasp, load, objective, peak_ratio=1.0)
        least = rg.choose_state(grasp, load, "peak")
        assert state.magnitudes.max() <= least.value * (1 + 1e-14)


def test_idle_means_the_same_to_formulas_and_margins() -> None:
    assert best.IDLE == margins.IDLE == 2.0**-40  # type: ignore[attr-defined]


def test_a_finger_that_rounding_would_make_pull_is_idle() -> None:
    """The load passes through P1; P2 can push nothing and its force across is 7e-16 on the wrong side."""
    outline = rg.Outline.ellipse(2, 1)
    grasp = rg.Grasp(outline.contact_at(s * outline.length, friction=0.5) for s in (0.5, 0.85))
    for load in (rg.Wrench([-3, 0]), rg.Wrench([0, -3.0]).rotated(-np.pi / 2)):
        state = rg.choose_state(grasp, load)
        assert state.in_use == ("P1",)
        assert not state.forces[1].any()
        assert state.is_balanced()
