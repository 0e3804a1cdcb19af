"""Sets of loads: support, members and scaling against samples, programs and each other."""

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

import regrasp as rg

pytestmark = pytest.mark.laws

KINDS = ("hull", "ball", "ellipsoid", "tilted", "turned")


def random_set(kind: str, dimension: int, rng: np.random.Generator) -> rg.LoadSet:
    size = 3 if dimension == 2 else 6
    center = rg.Wrench.from_vector(rng.normal(size=size))
    if kind == "hull":
        return rg.LoadSet.hull(
            rg.Wrench.from_vector(rng.normal(size=size)) for _ in range(rng.integers(1, 12))
        )
    if kind == "ball":
        return rg.LoadSet.ball(center, force=rng.uniform(0.1, 2), torque=rng.uniform(0.1, 2))
    if kind == "ellipsoid":
        return rg.LoadSet.ellipsoid(center, rng.normal(size=(size, size)))
    return rg.LoadSet.tilted(center, rng.uniform(0.1, 3)) if kind == "tilted" else rg.LoadSet.turned(center)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_extremes_are_members_at_the_support(kind: str, dimension: int) -> None:
    """Every extreme load is in the set, does the work that ``support`` says, and a hair more is outside."""
    rng = np.random.default_rng(dimension)
    for _ in range(40):
        loads = random_set(kind, dimension, rng).scaled(rng.choice([0.3, 1.0, 4.0]))
        y = rng.normal(size=loads.center.vector.size)
        far = loads.extreme(y)
        assert far.vector @ y == pytest.approx(float(loads.support(y)), rel=1e-9, abs=1e-9)
        assert loads.contains(far)
        beyond = rg.Wrench.from_vector(far.vector + 1e-4 * y / np.linalg.norm(y))
        assert not loads.contains(beyond)
        other = loads.extreme(rng.normal(size=y.size))
        assert other.vector @ y <= float(loads.support(y)) + 1e-9
        assert loads.contains(0.4 * far + 0.6 * other)  # convex
    twists = rng.normal(size=(5, 2, y.size))
    assert loads.support(twists).shape == (5, 2)


def test_a_hull_holds_what_a_program_says() -> None:
    rng = np.random.default_rng(5)
    verdicts = []
    for _ in range(60):
        points = rng.normal(size=(rng.integers(2, 9), 3))
        target = 0.35 * rng.normal(size=3)
        answer = linprog(
            np.zeros(len(points)), A_eq=np.vstack([points.T, np.ones(len(points))]), b_eq=[*target, 1]
        )
        loads = rg.LoadSet.hull(rg.Wrench.from_vector(p) for p in points)
        assert loads.contains(rg.Wrench.from_vector(target)) == (answer.status == 0)
        verdicts.append(answer.status == 0)
    assert len(set(verdicts)) == 2


def test_a_tilted_load_is_the_hull_of_its_turns() -> None:
    load = rg.Wrench([0.6, -2.0], 0.7)
    cap = rg.LoadSet.tilted(load, 1.1)
    turns = [rg.Wrench(load.rotated(a).force, 0.7) for a in np.linspace(-1.1, 1.1, 2001)]
    hull = rg.LoadSet.hull(turns, center=load)
    for a in np.arange(0, 2 * pi, 0.1):
        y = [cos(a), sin(a), 0.3]
        assert float(cap.support(y)) == pytest.approx(float(hull.support(y)), rel=1e-5)
    assert cap.contains(turns[0])
    assert cap.contains(turns[-1])
    assert not cap.contains(rg.Wrench(load.rotated(1.11).force, 0.7))
    assert not cap.contains(rg.Wrench([0, 0], 0.7))
    assert rg.LoadSet.turned(load).contains(rg.Wrench([0, 0], 0.7))
    assert not rg.LoadSet.turned(load).contains(rg.Wrench([0, 0], 0.71))


@given(st.integers(0, 2**32 - 1), st.sampled_from(KINDS), st.floats(0, 5), st.sampled_from([1e-6, 1.0, 1e6]))
@settings(max_examples=40, deadline=None)
def test_scaling_is_about_the_center_and_in_any_unit(
    seed: int, kind: str, factor: float, unit: float
) -> None:
    rng = np.random.default_rng(seed)
    loads = random_set(kind, 2, rng)
    y = rng.normal(size=3)
    middle = float(y @ loads.center.vector)
    grown = loads.scaled(factor)
    assert float(grown.support(y)) == pytest.approx(
        middle + factor * (float(loads.support(y)) - middle), abs=1e-9
    )
    assert grown.contains(loads.center)
    if kind == "hull":
        same = rg.LoadSet.hull(rg.Wrench.from_vector(unit * p) for p in loads.vertices)
        for share in (0.9, 1.2):
            probe = loads.center + share * (loads.extreme(y) - loads.center)
            assert same.contains(unit * probe) == loads.contains(probe)


def test_degenerate_sets() -> None:
    """One load, no deviation, no force: the set is a point and holds itself."""
    load = rg.Wrench([1, -2], 0.5)
    for loads in (
        rg.LoadSet.hull([load]),
        rg.LoadSet.ball(load, force=0, torque=0),
        rg.LoadSet.tilted(load, 0),
        rg.LoadSet.turned(load).scaled(0),
        rg.LoadSet.turned(rg.Wrench([0, 0], 0.5)),
    ):
        middle = loads.center
        assert loads.contains(middle)
        assert not loads.contains(middle + rg.Wrench([1e-3, 0]))
        assert not loads.contains(middle + rg.Wrench([0, 0], 1e-3))
        assert float(loads.support([1, 2, 3])) == pytest.approx(float(middle.vector @ [1, 2, 3]))
    flat = rg.LoadSet.ball(load, force=0.5, torque=0)
    assert flat.contains(rg.Wrench([1.4, -2], 0.5))
    assert not flat.contains(rg.Wrench([1, -2], 0.51))
    segment = rg.LoadSet.hull([rg.Wrench([1, 0]), rg.Wrench([3, 0])])
    assert segment.contains(rg.Wrench([2.9, 0]))
    assert not segment.contains(rg.Wrench([2.9, 1e-3]))


def test_bad_input() -> None:
    load = rg.Wrench([0, -1])
    for build, message in (
        (lambda: rg.LoadSet.hull([]), "needs one Wrench or more"),
        (lambda: rg.LoadSet.hull([load, rg.Wrench([0, 0, 1])]), "must all be planar or all in space"),
        (lambda: rg.LoadSet.ball(load, force=-1, torque=0), "force must be at least 0"),
        (lambda: rg.LoadSet.tilted(load, 4), "at most pi"),
        (lambda: rg.LoadSet.tilted([0, -1], 1), "load must be a Wrench"),
        (lambda: rg.LoadSet.ellipsoid(load, [[1, 0]]), "axes must have shape"),
        (lambda: rg.LoadSet.turned(load).scaled(-1), "factor must be at least 0"),
        (lambda: rg.LoadSet.turned(load).support([1, 2]), "twist must have 3 finite numbers"),
        (lambda: rg.LoadSet.turned(load).contains(rg.Wrench([0, 0, 1])), "cannot be compared"),
    ):
        with pytest.raises(rg.InvalidInput, match=message):
            build()


def test_they_say_what_they_are() -> None:
    load = rg.Wrench([0, -1])
    assert str(rg.LoadSet.tilted(load, pi / 6)) == f"{load!r}, its force tilted by up to 30 deg"
    assert (
        str(rg.LoadSet.turned(load).scaled(2))
        == f"{load!r}, its force in every direction, deviations times 2"
    )
    assert "hull of 2 loads around" in repr(rg.LoadSet.hull([load, load]))
    assert "reaching (2, 2, 3)" in str(rg.LoadSet.ball(load, force=2, torque=3))
    assert rg.LoadSet.turned(load) == rg.LoadSet.turned(load)
    assert rg.LoadSet.turned(load) != rg.LoadSet.tilted(load, 1)
