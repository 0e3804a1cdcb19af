"""The sets of Section III: wrench loops, and the loci that close them."""

from math import hypot, inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from cones import in_cone, wrench
from regrasp.mechanics.wrench_space import WrenchCone, WrenchLoop
from strategies import Pair, frictions, held_pairs, held_triples, points

pytestmark = pytest.mark.laws

PAPER = rg.Grasp(
    [
        rg.Contact([-4, -4], [1, 1], 0.3, name="P1"),
        rg.Contact([4, -5], [-1, 2], 0.3, name="P2"),
        rg.Contact([0, 8], [0, -1], 0.3, name="P3"),
    ]
)
LOAD = rg.Wrench([-1.5, -3.5])
STATE = rg.GraspState(PAPER, LOAD, [[3.7897, 3.0034], [-3.0096, 4.4156], [0.7199, -3.9190]]).balanced()
shares = st.floats(-0.99, 0.99)


def test_the_loop_closes_in_equilibrium() -> None:
    loop = WrenchLoop(STATE)
    assert loop.order == ("P1", "P2", "P3")
    assert loop.vertices.shape == (5, 3)
    np.testing.assert_array_equal(loop.vertices[0], 0)
    np.testing.assert_array_equal(loop.vertices[1], LOAD.vector)
    np.testing.assert_allclose(np.diff(loop.vertices[1:], axis=0), STATE.wrenches, rtol=0, atol=1e-14)
    np.testing.assert_allclose(loop.gap, 0, atol=1e-14)


@given(held_pairs(), points, points)
def test_the_gap_is_what_is_missing(pair: Pair, f1: tuple[float, float], f2: tuple[float, float]) -> None:
    state = rg.GraspState(pair.grasp, pair.load, [f1, f2])
    loop = WrenchLoop(state)
    np.testing.assert_allclose(loop.gap, state.imbalance, rtol=0, atol=1e-13 * 100)
    assert np.linalg.norm(loop.gap) == pytest.approx(state.residual, abs=1e-11)


def test_the_loop_in_another_order() -> None:
    loop = WrenchLoop(STATE, ("P3", "P1", "P2"))
    np.testing.assert_allclose(loop.vertices[2] - loop.vertices[1], STATE.wrenches[2], atol=1e-14)
    np.testing.assert_allclose(loop.gap, 0, atol=1e-14)
    assert loop != WrenchLoop(STATE)


@pytest.mark.parametrize("order", [("P1", "P2", "P3"), ("P1", "P3", "P2"), ("P3", "P2", "P1")])
def test_cones_of_the_loop_hold_its_vertices(order: tuple[str, ...]) -> None:
    """Each cone stands where its wrench starts, so holds where it ends; the last is inverted."""
    loop = WrenchLoop(STATE, order)
    cones = loop.cones()
    assert [cone.contact.name for cone in cones] == list(order)
    assert [cone.sign for cone in cones] == [1, 1, -1]
    for i, cone in enumerate(cones[:-1]):
        np.testing.assert_array_equal(cone.apex, loop.vertices[i + 1])
        assert cone.contains(loop.vertices[i + 2])
        assert not cone.contains(loop.vertices[i])
    np.testing.assert_array_equal(cones[-1].apex, 0)
    assert cones[-1].contains(loop.vertices[-2])


def on_both(first: WrenchCone, second: WrenchCone, ends: np.ndarray) -> None:
    """The segment lies on both cones, and a hundredth of it beyond either end on only one or neither."""
    for share in np.linspace(0, 1, 11):
        point = (1 - share) * ends[0] + share * ends[1]
        assert first.contains(point)
        assert second.contains(point)
    for share in (-0.01, 1.01):
        beyond = (1 - share) * ends[0] + share * ends[1]
        assert not (first.contains(beyond) and second.contains(beyond))


def test_the_locus_of_the_paper_lies_on_both_cones() -> None:
    """LS_B = S Pi_1, standing at the head of the load, cut with S Pi_2^-1, at the origin (Fig. 5)."""
    locus = rg.EquilibriumLocus(PAPER.without("P3"), LOAD)
    heads = LOAD.vector + locus.segment()
    on_both(WrenchCone(PAPER["P1"], LOAD.vector), WrenchCone(PAPER["P2"]).inverse(), heads)


@given(held_pairs(frictions.filter(lambda mu: mu > 1e-3)))
def test_any_locus_lies_on_both_cones(pair: Pair) -> None:
    if min(hypot(*pair.r1), hypot(*pair.r2)) < 0.1:
        return  # at the centre of mass a cone has no torque, so rounding of the load's puts points off it
    locus = rg.EquilibriumLocus(pair.grasp, pair.load)
    lo, hi = locus.interval
    first, second = pair.grasp
    cone1, cone2 = WrenchCone(first, pair.load.vector), WrenchCone(second, sign=-1)
    reach = 10 * (1 + abs(pair.load.vector).max())
    heads = pair.load.vector + locus.segment(reach)
    for share in (0, 0.3, 1):
        point = (1 - share) * heads[0] + share * heads[1]
        for cone in (cone1, cone2):  # where a finger is idle the point is the apex, to the load's rounding
            assert cone.contains(point, 1e-7) or np.linalg.norm(point - cone.apex) < 1e-12 * reach
    along = np.append(locus.direction, locus.wrenches(1.0)[0, 2] - locus.wrenches(0.0)[0, 2])
    for end, head, side in ((lo, heads[0], -1), (hi, heads[1], 1)):
        if abs(end) < inf:
            beyond = head + side * 0.1 * reach * along
            assert not (cone1.contains(beyond) and cone2.contains(beyond))


def test_the_locus_of_three_contacts_for_a_given_first_force() -> None:
    """LS_A = S Pi_3, standing at the head of w_1, cut with S Pi_2^-1, at the origin (Fig. 6)."""
    f1 = STATE.force("P1")
    head = LOAD.vector + wrench(PAPER["P1"], f1)
    locus = rg.EquilibriumLocus.given(PAPER, LOAD, "P1", f1)
    assert locus.grasp.names == ("P2", "P3")
    lo, hi = locus.interval
    assert lo < hi < inf
    w3 = locus.wrenches(np.array([lo, hi]))[:, 1]
    on_both(WrenchCone(PAPER["P3"], head), WrenchCone(PAPER["P2"], sign=-1), head + w3)
    # Of it the state's own forces are one point.
    own = locus.squeeze(STATE.without("P1"))
    assert lo < own < hi
    np.testing.assert_allclose(locus.forces(own), STATE.forces[1:], atol=1e-13)


@given(held_triples(frictions.filter(lambda mu: mu > 1e-3)), st.data())
def test_given_forces_and_the_locus_of_the_others_balance(triple: tuple, data: st.DataObject) -> None:
    grasp, load = triple
    fixed = data.draw(st.sampled_from(grasp.names))
    force = in_cone(grasp[fixed], data.draw(shares), data.draw(st.floats(0, 5)))
    locus = rg.EquilibriumLocus.given(grasp, load, fixed, force)
    assert fixed not in locus.grasp.names
    x = data.draw(st.floats(-5, 5))
    forces = np.insert(locus.forces(x), grasp.index(fixed), force, axis=0)
    state = rg.GraspState(grasp, load, forces)
    scale = abs(forces).max() + abs(load.vector).max()
    assert state.residual <= 1e-13 * scale * (1 + grasp.size) ** 2
    if fixed == "C" and not force.any():
        assert locus.interval == rg.EquilibriumLocus(grasp.without("C"), load).interval


def test_segments_without_end_or_without_points() -> None:
    opposed = rg.Grasp([rg.Contact([0, 0], [1, 0], 1.0), rg.Contact([2, 0], [-1, 0], 1.0)])
    locus = rg.EquilibriumLocus(opposed, rg.Wrench([0, -2], -2.0))
    assert locus.interval == (1.0, inf)
    np.testing.assert_allclose(locus.segment(4.0), [[1, 1, 0], [5, 1, 0]], atol=1e-15)
    with pytest.raises(rg.InvalidInput) as refused:
        locus.segment()
    assert str(refused.value) == "this locus has no end on one side; give reach, how far [N] to show it"
    empty = rg.EquilibriumLocus(
        rg.Grasp([rg.Contact([0, 0], [0, 1], 0.5), rg.Contact([2, 0], [0, 1], 0.5)]), rg.Wrench([0, 2])
    )
    with pytest.raises(rg.Infeasible) as none:
        empty.segment()
    assert str(none.value) == "the equilibrium locus of P1, P2 is empty"
