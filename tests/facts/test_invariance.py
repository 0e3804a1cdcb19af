"""Results do not depend on the units of length and force, on the frame, or on the order of the contacts."""

from collections.abc import Sequence
from itertools import permutations
from math import isfinite

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from invariance import Frame, frames, numbered
from models import OBJECTIVES
from strategies import comfortable_pair, held_pairs, held_triples, pairs, random_pair

pytestmark = pytest.mark.laws


@given(pairs(), frames)
@settings(max_examples=150)
def test_verdict_and_ends_of_a_locus(pair, frame: Frame) -> None:
    """Of a locus with an inside; one of no length may open or close by rounding."""
    here = rg.EquilibriumLocus(pair.grasp, pair.load).interval
    there = rg.EquilibriumLocus(frame.grasp(pair.grasp), frame.load(pair.load)).interval
    swapped = rg.EquilibriumLocus(frame.grasp(pair.grasp, (1, 0)), frame.load(pair.load)).interval
    scale = 1 + max((abs(x) for x in here if isfinite(x)), default=0)
    if here[0] > here[1] or here[1] - here[0] <= 1e-9 * scale:
        return  # empty ones: test_an_escape_is_the_same_motion
    for other in (there, swapped):
        assert [isfinite(x) for x in other] == [isfinite(x) for x in here]
    locus = rg.EquilibriumLocus(pair.grasp, pair.load)
    phi = -float(locus.forces(0.0)[1] @ locus.direction)  # f_2 . u = -(x + phi); u turns about when they swap
    for x, x_there, x_swapped in zip(here, there, swapped, strict=True):
        if isfinite(x):
            assert x_there / frame.force == pytest.approx(x, abs=1e-7 * scale)
            assert x_swapped / frame.force == pytest.approx(x + phi, abs=1e-7 * (scale + abs(phi)))


@given(held_pairs(), frames, st.sampled_from(OBJECTIVES))
@settings(max_examples=150)
def test_the_best_value(pair, frame: Frame, objective: str) -> None:
    here = rg.choose_state(pair.grasp, pair.load, objective)
    near = 1e-7
    if objective == "friction_use":  # |f_t| / (mu f_n), of an f_t that is rounded to eps |f|
        frictions = pair.grasp.frictions
        near += 10 * np.finfo(float).eps / frictions[frictions > 0].min(initial=1.0)
    for order in ((0, 1), (1, 0)):
        there = rg.choose_state(frame.grasp(pair.grasp, order), frame.load(pair.load), objective)
        size = frame.value(1.0, objective) * (
            1 if objective in ("angle", "friction_use") else here.magnitudes.max()
        )
        assert there.value == pytest.approx(frame.value(here.value, objective), rel=1e-7, abs=near * size)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_best_forces_and_their_margins(objective: str) -> None:
    """For grasps with one best state."""
    rng = np.random.default_rng(OBJECTIVES.index(objective))
    for _ in range(60):
        grasp, load = comfortable_pair(rng)
        frame = numbered(rng)
        here = rg.choose_state(grasp, load, objective)
        for order in ((0, 1), (1, 0)):
            there = rg.choose_state(frame.grasp(grasp, order), frame.load(load), objective)
            expected = frame.force * (here.forces @ frame.rotation.T)[list(order)]
            assert there.forces == pytest.approx(expected, abs=1e-8 * abs(expected).max())
            assert there.margins.angle == pytest.approx(here.margins.angle[list(order)], abs=1e-7)
            assert there.force_limits == pytest.approx(
                [frame.force * here.force_limits[i] for i in order], rel=1e-9
            )


@given(
    held_triples(st.sampled_from([0.1, 0.3, 0.5, 1.0])), frames, st.sampled_from(list(permutations(range(3))))
)
@settings(max_examples=25)
def test_a_removal_as_a_whole(held, frame: Frame, order: Sequence[int]) -> None:
    """Effort has one least state, so that forces compare; they are chosen by formula and by Clarabel."""
    grasp, load = held
    options = {"objective": "effort", "whole_objective": "effort"}
    here = rg.plan_removal(grasp, "C", load=load, **options)
    there = rg.plan_removal(frame.grasp(grasp, order), "C", load=frame.load(load), **options)
    t = np.linspace(0, 1, 9)
    expected = frame.force * (here.forces(t) @ frame.rotation.T)[:, list(order)]
    largest = abs(expected).max()
    assert there.forces(t) == pytest.approx(expected, abs=1e-5 * largest)
    assert there.margins(t).force == pytest.approx(
        frame.force * here.margins(t).force[:, list(order)], abs=1e-5 * largest
    )
    turned = frame.force * here.wrenches(t)[..., 2] * frame.length
    assert there.wrenches(t)[..., 2] == pytest.approx(
        turned[:, list(order)], abs=1e-5 * largest * frame.length * grasp.size
    )


def test_an_escape_is_the_same_motion() -> None:
    rng = np.random.default_rng(9)
    seen = proven = 0
    while seen < 60:
        pair = random_pair(rng)
        if not rg.EquilibriumLocus(pair.grasp, pair.load).is_empty:
            continue
        seen += 1
        frame = numbered(rng)
        with pytest.raises(rg.Infeasible) as here:
            rg.choose_state(pair.grasp, pair.load)
        twist = here.value.certificate
        for order in ((0, 1), (1, 0)):
            with pytest.raises(rg.Infeasible) as there:
                rg.choose_state(frame.grasp(pair.grasp, order), frame.load(pair.load))
            other = there.value.certificate
            assert (other is None) == (twist is None)
            if twist is None:
                continue
            proven += 1
            assert other.is_proof
            velocity, spin = frame.length * frame.rotation @ twist.twist[:2], twist.twist[2]
            v, w = other.twist[:2], other.twist[2]
            reach = frame.length * pair.grasp.size
            expected = np.array([*velocity, spin * reach]) / np.linalg.norm([*velocity, spin * reach])
            found = np.array([*v, w * reach]) / np.linalg.norm([*v, w * reach])
            assert found == pytest.approx(expected, abs=1e-6)
            assert str(other).split("(")[0] == str(twist).split("(")[0]  # turning which way, or sliding
    assert proven > 100


@given(held_triples(), frames)
@settings(max_examples=60)
def test_margins_of_given_forces(held, frame: Frame) -> None:
    grasp, load = held
    forces = np.array([[0.3, 1.1], [-0.2, 0.4], [0.1, -2.0]])
    here = rg.GraspState(grasp, load, forces)
    there = rg.GraspState(frame.grasp(grasp), frame.load(load), frame.force * forces @ frame.rotation.T)
    assert there.margins.angle == pytest.approx(here.margins.angle, abs=1e-12)
    assert there.margins.force == pytest.approx(
        frame.force * here.margins.force, rel=1e-9, abs=1e-12 * frame.force
    )
    assert there.wrenches[:, 2] == pytest.approx(
        here.wrenches[:, 2] * frame.force * frame.length, abs=1e-12 * frame.force * frame.length
    )
