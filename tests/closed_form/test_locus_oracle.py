"""The interval of squeezes against exact rational arithmetic (``oracle.py``).

Ends are computed from a (the torque about a contact per length), phi and the slope of a cone edge. Rounding
moves the first two by a few eps of their largest term and the slope by a few eps of 1 / sine, the sine of
the angle between edge and line of contacts. So an end may be off by

    K eps (|end| + |F| + (|tau| + |r| |F|) / |P_1 P_2|) / sine,        K = 4, eps = 2^-52

and no more: 1e-9 relative for every edge steeper than 1e-6 rad under a load that does not cancel.
"""

from collections import Counter
from dataclasses import replace
from math import atan, atan2, cos, inf, isfinite, isnan, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from oracle import ExactLocus, locus, sines
from regrasp.closed_form.locus import squeeze_interval
from strategies import POWERS, Pair, lattice_pair, pairs, random_pair

pytestmark = pytest.mark.oracle

EPS = 2.0**-52
K = 4


def verdict(lo: float, hi: float) -> str:
    assert not isnan(lo)
    assert not isnan(hi)
    if lo > hi:
        assert (lo, hi) == (inf, -inf)
        return "empty"
    return {(True, True): "bounded", (True, False): "above", (False, True): "below"}.get(
        (isfinite(lo), isfinite(hi)), "unbounded"
    )


def allowed(exact: ExactLocus, end: float, sine: float) -> float:
    """What rounding may move an end by."""
    return K * EPS * (abs(end) + exact.terms) / sine


def check(pair: Pair, exact: ExactLocus, force_unit: float = 1.0) -> None:
    """The float interval of ``pair`` in ``force_unit`` agrees with ``exact``."""
    lo, hi = squeeze_interval(*pair.plain)
    found = verdict(lo, hi)
    if found != exact.verdict and 0 < exact.miss <= 16 * EPS * exact.terms:
        open_again = exact.lo is None or exact.hi is None or exact.lo.value <= exact.hi.value
        exact = replace(exact, miss=0.0, empty=not open_again)
    if found != exact.verdict:
        assert exact.lo is not None, (pair, found, exact)
        assert exact.hi is not None, (pair, found, exact)
        ends = float(exact.lo.value) * exact.length, float(exact.hi.value) * exact.length
        slack = allowed(exact, ends[0], exact.lo.sine) + allowed(exact, ends[1], exact.hi.sine)
        assert abs(exact.width) <= slack, f"{pair}: {found}, exactly {exact.verdict} by {exact.width}"
        return
    if found == "empty":
        return
    for end, want, bound in zip((lo, hi), exact.ends(), (exact.lo, exact.hi), strict=True):
        if bound is not None:
            assert abs(end / force_unit - want) <= allowed(exact, want, bound.sine), (pair, end, want)


def units(rng: np.random.Generator) -> dict[str, object]:
    length, force, normal1, normal2 = (10.0 ** rng.uniform(-6, 6, 4)).tolist()
    return {"length": length, "force": force, "normals": (normal1, normal2)}


@pytest.mark.parametrize("seed", range(4))
def test_random_contacts_at_every_scale(seed: int) -> None:
    rng = np.random.default_rng(seed)
    seen: Counter[str] = Counter()
    for _ in range(1000):
        pair = random_pair(rng).scaled(**units(rng))
        exact = locus(*pair.arguments)
        assert verdict(*squeeze_interval(*pair.plain)) == exact.verdict, pair  # no exception among these
        check(pair, exact)
        seen[exact.verdict] += 1
    assert min(seen[kind] for kind in ("empty", "bounded", "above", "below")) > 15, seen


@pytest.mark.parametrize("seed", range(2))
def test_contacts_a_million_distances_from_the_origin(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    for _ in range(700):
        pair = random_pair(rng, far=6).scaled(**units(rng))
        check(pair, locus(*pair.arguments))


@pytest.mark.parametrize("seed", range(2))
def test_lattice_geometry_is_decided_without_exception(seed: int) -> None:
    """Parallel edges, loads through contacts, points and zero loads, exact in doubles: all are right."""
    rng = np.random.default_rng(200 + seed)
    seen: Counter[tuple[str, bool]] = Counter()
    for _ in range(1500):
        pair = lattice_pair(rng)
        exact = locus(*pair.arguments)
        assert verdict(*squeeze_interval(*pair.plain)) == exact.verdict, pair
        check(pair, exact)
        seen[exact.verdict, exact.width == 0] += 1
    assert seen["bounded", True] > 50  # points among them


@pytest.mark.parametrize("powers_of", [2.0, 10.0])
def test_lattice_verdicts_survive_a_change_of_units(powers_of: float) -> None:
    """In decimal units the same geometry is rounded: edges no longer exactly parallel, torques not zero."""
    rng = np.random.default_rng(300)
    for _ in range(1500):
        pair = lattice_pair(rng)
        exact = locus(*pair.arguments)
        length, force, normal1, normal2 = (powers_of ** rng.integers(-6, 7, 4).astype(float)).tolist()
        scaled = pair.scaled(length, force, (normal1, normal2))
        assert verdict(*squeeze_interval(*scaled.plain)) == exact.verdict, (pair, scaled)
        check(scaled, exact, force)


def test_lattice_verdicts_survive_an_origin_far_away() -> None:
    """Rounding of far coordinates tilts edges off the line of contacts; they count as parallel still."""
    rng = np.random.default_rng(350)
    for _ in range(1500):
        pair = lattice_pair(rng)
        exact = locus(*pair.arguments)
        length, x, y = (
            10.0 ** rng.uniform(-6, 6),
            *(10.0 ** rng.uniform(0, 6) * rng.normal(size=2)).tolist(),
        )
        near = pair.scaled(length)
        moved = replace(
            near,
            r1=(near.r1[0] + length * x, near.r1[1] + length * y),
            r2=(near.r2[0] + length * x, near.r2[1] + length * y),
            torque=length * (pair.torque + x * pair.force[1] - y * pair.force[0]),
        )
        if exact.width != 0:
            assert verdict(*squeeze_interval(*moved.plain)) == exact.verdict, (pair, moved)


@given(pairs(st.sampled_from([0.0, 1e-8, 0.1, 0.25, 0.3, 0.5, 1.0, 2.0, 5.0])), POWERS, POWERS)
@settings(max_examples=400)
def test_any_contacts(pair: Pair, length: float, force: float) -> None:
    scaled = pair.scaled(length, force)
    check(scaled, locus(*scaled.arguments))


@pytest.mark.parametrize("seed", range(2))
def test_no_locus_begins_at_1e12_times_the_load(seed: int) -> None:
    """An edge within 1e-12 rad of the line of contacts is parallel to it, wherever the contacts are."""
    rng = np.random.default_rng(400 + seed)
    seen: Counter[str] = Counter()
    for _ in range(1500):
        pair = near_parallel(rng)
        lo, hi = squeeze_interval(*pair.plain)
        exact = locus(*pair.arguments)
        for end in (lo, hi):
            if isfinite(end):
                assert abs(end) < 1e12 * exact.terms
        # Rounding of the coordinates widens what is parallel by a few eps of |r| / |P_1 P_2|.
        reach = sum(map(abs, (*pair.r1, *pair.r2))) / exact.length
        nearest = min(sines(*pair.arguments[:6]))
        if nearest < 0.999e-12 or nearest > 1.001e-12 + 4 * EPS * reach:
            check(pair, exact)
            seen["parallel" if nearest < 1e-12 else "not"] += 1
    assert min(seen.values()) > 200, seen


def near_parallel(rng: np.random.Generator) -> Pair:
    """One edge of the first or the second cone 1e-17 to 1e-9 rad from the line of contacts."""
    pair = random_pair(rng, far=rng.choice([0, 3]))
    line = atan2(pair.r2[1] - pair.r1[1], pair.r2[0] - pair.r1[0])
    miss = float(rng.choice([0, 1, -1, 1, -1])) * 10.0 ** rng.uniform(-17, -9)
    angle = line + rng.choice([0, np.pi]) + rng.choice([-1, 1]) * atan(pair.mu1) + miss
    tilted = Pair(
        pair.r1,
        (cos(angle), sin(angle)),
        pair.mu1,
        pair.r2,
        (-cos(line), -sin(line)),
        0.5,
        pair.force,
        pair.torque,
    )
    return tilted if rng.random() < 0.5 else tilted.swapped()


def test_near_parallel_edges_are_told_from_parallel_ones_at_1e_12() -> None:
    """Directly: f_1 in a cone whose upper edge rises by delta above the line, load asking for a > 0."""
    for delta, bounded in ((0.0, False), (1e-13, False), (0.99e-12, False), (1.01e-12, True), (1e-10, True)):
        angle = delta - atan(0.5)
        n1 = (cos(angle), sin(angle))
        lo, hi = squeeze_interval(0, 0, *n1, 0.5, 1, 0, -1, 0, 0.5, 0, -1, -0.6)  # a = 0.4, b = 0.6
        assert (lo < inf) == bounded, (delta, lo, hi)
        if bounded:
            assert lo == pytest.approx(0.4 / delta, rel=1e-3)


CASES = [
    # contacts at (0, 0) and (2, 0): n1, mu1, n2, mu2, force, torque, (lo, hi)
    ("zero load, opposed", (1, 0), 0.5, (-1, 0), 0.5, (0, 0), 0.0, (0, inf)),
    ("zero load inside a ring", (-1, 0), 0.5, (1, 0), 0.5, (0, 0), 0.0, (-inf, 0)),
    ("zero load, only zero force", (0, 1), 0.5, (0, 1), 0.5, (0, 0), 0.0, (0, 0)),
    ("frictionless and opposed, pushed along", (1, 0), 0, (-1, 0), 0, (1, 0), 0.0, (0, inf)),
    ("frictionless and opposed, pushed across", (1, 0), 0, (-1, 0), 0, (0, -1), -1.0, (inf, -inf)),
    ("frictionless shelf", (0, 1), 0, (0, 1), 0, (0, -1), -1.0, (0, 0)),
    ("frictionless V-groove", (1, 1), 0, (-1, 1), 0, (0, -2), -2.0, (1, 1)),
    ("pure torque across, held", (1, 0), 1, (-1, 0), 1, (0, 0), -2.0, (1, inf)),
    ("pure torque, both push one way", (0, 1), 0.5, (0, 1), 0.5, (0, 0), 1.0, (inf, -inf)),
    ("load through the second contact", (0, 1), 0.5, (0, 1), 0.5, (0, -1), -2.0, (0, 0)),
    ("load through the first contact", (1, 0), 1, (-1, 0), 1, (0, -1), 0.0, (1, inf)),
    ("both edges along the line", (1, 1), 1, (-1, 1), 1, (0, -2), -2.0, (0, inf)),
    ("both edges along the line, wrong side", (1, 1), 1, (-1, 1), 1, (0, 2), 2.0, (inf, -inf)),
    ("a point between two supports", (0, 1), 0.5, (0, 1), 0, (0.5, -2), -2.0, (-0.5, -0.5)),
    ("one above, shifted by the load", (1, 0), 0.5, (-1, 0), 0.5, (3, 0), 0.0, (0, inf)),
    ("both carry, bounded", (0, 1), 0.5, (0, 1), 0.5, (0, -2), -2.0, (-0.5, 0.5)),
]


@pytest.mark.parametrize("case", CASES, ids=[case[0] for case in CASES])
def test_by_hand(case: tuple) -> None:
    _, n1, mu1, n2, mu2, force, torque, want = case
    pair = Pair((0.0, 0.0), n1, mu1, (2.0, 0.0), n2, mu2, force, torque)
    assert squeeze_interval(*pair.plain) == pytest.approx(want, abs=1e-15)
    assert locus(*pair.arguments).ends() == pytest.approx(want, abs=1e-15)  # the oracle by hand, too
    assert rg.EquilibriumLocus(pair.grasp, pair.load).interval == pytest.approx(want, abs=1e-15)


@given(pairs(), st.floats(-3, 3))
@settings(max_examples=100)
def test_forces_of_the_locus_balance_for_any_squeeze(pair: Pair, squeeze: float) -> None:
    found = rg.EquilibriumLocus(pair.grasp, pair.load)
    state = rg.GraspState(pair.grasp, pair.load, found.forces(squeeze))
    scale = abs(state.forces).max() + abs(pair.load.vector).max()
    assert state.residual <= 1e-14 * scale * (1 + pair.grasp.size)
    assert found.squeeze(state) == pytest.approx(squeeze, abs=1e-14 * scale)
    assert (found.wrenches(squeeze) == state.wrenches).all()
