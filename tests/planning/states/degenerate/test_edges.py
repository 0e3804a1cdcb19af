"""Near the edge: held inside, a proof outside, never wrong, and one word for what rounding decides."""

from math import inf, sqrt

import numpy as np
import pytest

import regrasp as rg
from boundary import KINDS, Boundary, boundary
from exact_judge import is_escape, is_held, state_faults

pytestmark = pytest.mark.laws

OBJECTIVES = ("effort", "angle", "peak", "force", "friction_use", "peak_normal")
CASES = [(d, kind) for d in (2, 3) for kind in KINDS if d == 3 or kind != "box turns"]


def grasp_of(at: Boundary) -> rg.Grasp:
    return rg.Grasp(
        rg.Contact(r, n, float(mu), max_force=None if limit == inf else float(limit))
        for r, n, mu, limit in zip(at.positions, at.normals, at.frictions, at.limits, strict=True)
    )


def verdict(grasp: rg.Grasp, load: np.ndarray, objective: str) -> str:
    data = grasp.positions, grasp.normals, grasp.frictions
    try:
        state = rg.choose_state(grasp, rg.Wrench.from_vector(load), objective)
    except rg.Infeasible as reason:
        refused, twist = reason, reason.certificate
    else:
        assert state_faults(*data, grasp.max_forces, load, state.forces) == []
        return "held"
    if twist is None:
        why = str(refused)  # looks for what helps, for longer than all else
        assert "more friction" not in why  # the advice that helps nobody who tips
        return "at its limit" if "at its limit" in why else why
    assert twist.is_proof
    assert is_escape(*data, np.array(twist.limits), load, twist.twist)
    return "proven"


@pytest.mark.parametrize(("dimension", "kind"), CASES)
def test_from_a_hundredth_to_a_millionth(dimension: int, kind: str) -> None:
    """At the very end of the range rounding of the contacts themselves decides once in a hundred times."""
    rng = np.random.default_rng([dimension, KINDS.index(kind)])
    at_limit = 0
    for case in range(12):
        at = boundary(rng, dimension, kind)
        grasp, objective = grasp_of(at), OBJECTIVES[case % 6]
        beyond = 10.0 ** rng.uniform(-5.5, -2)
        assert verdict(grasp, at.load(beyond), objective) == "proven"
        assert verdict(grasp, at.load(-beyond), objective) == "held"
        for side, right in ((1e-6, "proven"), (-1e-6, "held")):
            found = verdict(grasp, at.load(side), objective)
            assert found in (right, "at its limit")
            at_limit += found != right
    assert at_limit <= 2


@pytest.mark.parametrize(("dimension", "kind"), CASES)
def test_nearer_than_a_millionth_nothing_is_wrong(dimension: int, kind: str) -> None:
    rng = np.random.default_rng([7, dimension, KINDS.index(kind)])
    for case in range(6):
        at = boundary(rng, dimension, kind)
        beyond = 10.0 ** rng.uniform(-9, -6.5)
        assert verdict(grasp_of(at), at.load(beyond), OBJECTIVES[case]) in ("proven", "at its limit")
        assert verdict(grasp_of(at), at.load(-beyond), OBJECTIVES[case]) in ("held", "at its limit")


def test_the_construction_is_right_in_the_plane() -> None:
    rng = np.random.default_rng(5)
    for case in range(60):
        at = boundary(rng, 2, ("sliding", "tipping", "box tips")[case % 3])
        for side in (1e-3, -1e-3, 1e-9, -1e-9):
            assert is_held(at.positions, at.normals, at.frictions, at.load(side)) == (side < 0)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("beyond", [1e-2, 1e-4, 1e-6, 1e-8])
def test_a_table_tips_whatever_its_friction(objective: str, beyond: float) -> None:
    table = rg.Grasp([rg.Contact([-1, -1], [0, 1], 0.5), rg.Contact([1, -1], [0, 1], 0.5)])
    with pytest.raises(rg.Infeasible, match=r"turning clockwise about \(1, -1\)") as error:
        rg.choose_state(table, rg.Wrench([0, -1], -(1 + beyond)), objective, method="clarabel")
    twist = error.value.certificate.twist
    assert twist / -twist[2] == pytest.approx([1, 1, -1], abs=1e-6)
    held = rg.choose_state(table, rg.Wrench([0, -1], -(1 - beyond)), objective, method="clarabel")
    assert held.is_balanced()


@pytest.mark.parametrize("beyond", [1e-9, 1e-7, 1e-6, 1e-5])
def test_a_block_on_four_corners(beyond: float) -> None:
    block = rg.Grasp(rg.Contact([x, y, -1], [0, 0, 1], 0.5) for x in (-1, 1) for y in (-1, 1))
    edges = ([0, 1, 0], [1, 0, 0], [0, 0, 0.5 * sqrt(2)])  # tipping both ways, turning about the vertical
    for torque, objective in zip(edges, ("effort", "angle", "friction_use"), strict=True):
        out, inside = (rg.Wrench([0, 0, -1], (1 + s * beyond) * np.array(torque)) for s in (1, -1))
        with pytest.raises(rg.Infeasible) as error:
            rg.choose_state(block, out, objective)
        assert error.value.certificate is not None or "at its limit" in str(error.value)
        if beyond >= 1e-6:
            assert error.value.certificate.is_proof
        if beyond >= 1e-7:
            assert rg.choose_state(block, inside, objective).is_balanced()


@pytest.mark.parametrize("seed", [1855, 5340, 7222, 7322, 9666])  # of ``benchmarks/truth/edges.py``
def test_two_contacts_at_rest_whose_motion_no_double_is(seed: int) -> None:
    """It turns about both while others slide: opposed by 1e-16 when rounded, by nothing when cleared."""
    rng = np.random.default_rng(seed)
    kind = str(rng.choice(KINDS)) if rng.integers(2, 4) == 3 else ""
    at = boundary(rng, 3, kind)
    for beyond in (1e-6, 1e-8):
        assert verdict(grasp_of(at), at.load(beyond), "effort") == "proven"
        assert verdict(grasp_of(at), at.load(-beyond), "effort") == "held"


def test_at_its_limit_is_said_with_the_reserve_that_was_kept() -> None:
    """Friction 0.5 of which a tenth is kept back, and a load at nine tenths of the cones."""
    block = rg.Grasp(
        [rg.Contact([-1, 0], [0, 1], 0.5), rg.Contact([1, 0], [0, 1], 0.5), rg.Contact([0, 0], [0, 1], 0.5)]
    )
    with pytest.raises(rg.Infeasible) as error:
        rg.choose_state(block, rg.Wrench([0.45 + 1e-9, -1]), "effort", reserve=0.1)
    assert "is at its limit for P1, P2, P3 with 0.1 of the friction kept in reserve" in str(error.value)
    assert error.value.certificate is None
    with pytest.raises(
        rg.Infeasible, match="more friction than that leaves, or is at the limit of what they can hold"
    ):
        rg.choose_state(block, rg.Wrench([0.46, -1]), "effort", reserve=0.1)
