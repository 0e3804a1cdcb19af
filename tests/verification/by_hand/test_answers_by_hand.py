"""What is answered and withstood, claimed by others: each part of the claim and of its proof counts."""

from math import atan, hypot, inf, nan, nextafter
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign.beams import BEAM, held, withstood
from proofs import planar

pytestmark = pytest.mark.contract


def said(claim) -> str:
    return "; ".join(rg.verify(claim).violations)


def passed_over(good, value: float) -> SimpleNamespace:
    return SimpleNamespace(grasp=good.grasp, places=good.places, value=value)


def test_what_is_withstood_is_judged_whoever_says_it() -> None:
    good = withstood()
    verdict = rg.verify(good)
    assert (verdict.ok, verdict.excluded, verdict.bound) == (True, 9, good.bound)
    share = " on the 0.0% of the outline that was asked about"  # 3 / 512 of 12 m
    assert verdict.asked == f" of fingers that answer by equal stiffness{share}, fingers 0.5 apart or more,"
    assert verdict.asked == rg.verify(good.certificate).asked
    first, second, third = good.states
    for off in 5e-9, -5e-9:  # of a load of 5.5 N
        assert "do not hold the load" in said(withstood(value=1.5 * (1 + off)))
    for bound, words in (
        (np.nextafter(good.bound, 2), ""), (good.bound * (1 - 2e-9), "is better than what the proof says"),
        (1.4, "bound 1.4 is below the value 1.5"), (nan, "bound nan is below"), (inf, "must be finite"),
    ):  # fmt: skip
        assert words in said(withstood(bound=bound))
        assert words or not said(withstood(bound=bound))
    for objective in "answered", "force", "wrench_ball", "peak":
        found = said(withstood(objective=objective, length=1.0))
        assert f"the proof is of forces tied by stiffness, not of {objective}" in found
    shifted = held((1.3, 1.4, 1.3), (0, -4, 0))  # balance, of other springs
    answered = held((2, 2, 0.5), (0, -4.5, 1.5))
    for states, words in (
        ((shifted, second, third), "not what fingers of equal stiffness"), ((), "no state shows the value"),
        ((first, second), "do not hold the load"), ((second, first, third), "do not hold the load"),
        ((first, second, answered), "do not hold the load"),
    ):  # fmt: skip
        assert words in said(withstood(states=states))
    for field, value, words in (
        ("max_force", 2 * (1 - 2e-9), "is above the limit"), ("max_force", None, "needs the limit"),
        ("max_force", 2 * (1 + 1e-9), "the proof proves no bound"), ("min_normal", 0.5, ""),
        ("min_normal", 0.5 * (1 + 2e-9), "a finger pushes with less than 0.5"),
        ("others", (passed_over(good, good.bound * (1 + 2e-9)),), "passed over"),
        ("others", (passed_over(good, good.bound),), ""), ("places", np.array([1, 2, 3.1]), "off its"),
        ("deviations", np.array([[0, -1, 0], [0, 0, 1.1]]), "do not hold the load"),
        ("deviations", good.deviations[::-1].copy(), "do not hold the load"),
    ):  # fmt: skip
        found = said(withstood(**{field: value}))
        assert words in found
        assert words or not found


def test_a_limit_that_placements_just_reach_excludes_none() -> None:
    """Two fingers that face each other, friction 3 / 4, lift 6 N by just 5 N each, (4, 3) and (-4, 3).

    What helps them to lift they stand up to 12 N of.
    """
    square, lift = [[-1, -1], [1, -1], [1, 1], [-1, 1]], np.array([[0, 1.0, 0]])
    node = [([(0, 1, 1, 4)] * 2, (0, 0), 0, (0, 1, 0))]
    given = {
        "size": "force",
        "norm": "largest",
        "friction": 0.75,
        "sides": np.array([[1, 1.0, 2], [3, 3, 4]]),
    }
    proof = planar(square, [[0, -6, 0], [0, -5, 0]], node, bound=5.0, **given)
    assert rg.verify(proof).ok
    grasp = rg.Grasp([rg.Contact([1, 0], [-1, 0], 0.75), rg.Contact([-1, 0], [1, 0], 0.75)])
    states = [
        rg.GraspState(grasp, rg.Wrench([0, -w]), [[-4 * w / 6, w / 2], [4 * w / 6, w / 2]])
        for w in (6.0, 5.0)
    ]
    shown = {"objective": "answered", "grasp": grasp, "states": tuple(states), "places": np.array([3.0, 7.0])}
    claim = withstood(**shown, value=1.0, bound=1.0, certificate=proof, max_force=5.0, deviations=lift)
    claim.shape = rg.Outline(square)
    assert said(claim) == "the proof proves no bound"
    claim.max_force = nextafter(5.0, 0)
    assert said(claim) == ""
    claim.max_force, proof.bound = 5.0, nextafter(5.0, inf)
    assert said(claim) == "proof: the twist of box 0 does not exclude it"


def test_what_is_answered_holds_the_load_itself() -> None:
    """Forces of 2 N hold 4 N that are lifted by 2 to 3 N; that the load alone is too much proves no bound."""
    loads, lift = [[0, -4, 0], [0, -2, 0]], np.array([[0, 2.0, 0]])
    node = [([(0, 3, 0, 4)], (0, 0), 0, (0, 1, 0))]
    proof = planar(BEAM, loads, node, size="force", norm="largest", friction=0.0, bound=nextafter(2.0, inf))
    assert rg.verify(proof).ok  # the load alone wants 4 N
    grasp = rg.Grasp([rg.Contact([0, -1], [0, 1], 0.0)])
    state = rg.GraspState(grasp, rg.Wrench([0, -2]), [[0, 2]])
    given = {"grasp": grasp, "places": np.array([2.0]), "certificate": proof, "deviations": lift}
    claim = withstood(objective="answered", states=(state,), value=1.0, bound=1.0, **given)
    assert "do not hold the load, and the deviations" in said(claim)  # though a factor of 1.5 is held, too


def peak(**changes):
    """One finger that lifts 1 N by 1 N, at (0, -1), on a square board."""
    board = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
    node = [([(0, 3, 0, 4)], (0, 0), 0, (0, 1, 0))]
    proof = planar(board, [[0, -1, 0]], node, size="force", norm="largest", friction=0.5, bound=1 - 2.0**-50)
    grasp = rg.Grasp([rg.Contact([0, -1], [0, 1], 0.5, name="F")])
    given = {
        "objective": "peak", "grasp": grasp, "states": (rg.GraspState(grasp, rg.Wrench([0, -1]), [[0, 1]]),),
        "places": np.array([1.0]), "value": 1.0, "bound": proof.bound, "certificate": proof,
        "max_force": None, "shape": rg.Outline(board), "deviations": None,
    }  # fmt: skip
    return withstood(**given | changes)


def of(claim, **changes):
    """With other parts of its proof."""
    claim.certificate = SimpleNamespace(**vars(claim.certificate) | changes)
    return claim


def test_what_a_verdict_tells() -> None:
    good = peak()
    (state,) = good.states
    verdict = rg.verify(good)
    assert (verdict.ok, verdict.excluded, verdict.asked, verdict.worst_residual) == (True, 1, "", 0.0)
    assert (verdict.least_angle, verdict.least_cone_slack) == (pytest.approx(atan(0.5)), 0.25)
    aside = rg.GraspState(good.grasp, rg.Wrench([0, -1]), [[0.25, 1]])  # out of balance by a quarter
    verdict = rg.verify(peak(states=(state, aside, state), value=hypot(0.25, 1)))
    assert verdict.worst_residual > 0.2
    assert verdict.least_angle == pytest.approx(atan(0.5) - atan(0.25))
    assert verdict.least_cone_slack == 1.25 - 1.0625
    assert [v.partition(":")[0] for v in verdict.violations] == ["state 2"]
    other = rg.Grasp([rg.Contact([0, -1], [0, 1], 0.4, name="F")])
    foreign = rg.GraspState(other, rg.Wrench([0, -1]), [[0, 5]])
    found = rg.verify(peak(states=(state, foreign, aside), value=5.0)).violations
    assert found[0] == "state 2 is of other contacts"
    assert [v.partition(":")[0] for v in found[1:]] == ["state 3"]
    nothing = rg.verify(peak(objective="plenty"))
    assert nothing.violations == ("objective 'plenty' has no bound",)
    assert (nothing.worst_residual, nothing.least_angle, nothing.least_cone_slack) == (inf, 0.0, -inf)


def test_a_proof_is_of_the_objective() -> None:
    assert said(peak()) == ""
    for size, norm in ("normal", "largest"), ("force", "sum"), ("force", "squares"):
        assert said(of(peak(), size=size, norm=norm)) == f"the proof is of a {norm} of {size}, not of peak"
    for objective, ok in ("force", True), ("sum_normal", False), ("angle", True):
        found = said(peak(objective=objective, max_force=1.0))
        assert (f"not of {objective}" in found) != ok


def test_contacts_are_fingers_of_the_proof() -> None:
    def placed(position, normal, friction=0.5):
        grasp = rg.Grasp([rg.Contact(position, normal, friction, name="F")])
        state = rg.GraspState(grasp, rg.Wrench([0, -1]), [[0, 1]])
        return said(peak(grasp=grasp, states=(state,), places=np.array([1.0 + position[0]])))

    assert placed([0, -1], [0, 1]) == placed([0, -1], [0, 1], 0.4) == ""
    assert placed([0, -1], [0, 1], nextafter(0.5, 1)) == "contact F has more friction than the proof is about"
    words = "contact F is on none of the sides that the proof is about"
    assert placed([0, -1 + 2e-12], [0, 1]) == placed([0, -1], [1e-9, 1]) == words
    half = of(
        peak(), sides=np.array([[0, 0.5, 1.0]]), ends=np.array([[[0.5, 1.0]]]), arcs=np.zeros((1, 1, 2), int)
    )
    assert said(half) == ""
    assert rg.verify(half).asked == " on the 12.5% of the outline that was asked about"
    half.certificate.sides[0, 1] = half.certificate.ends[0, 0, 0] = 0.5 + 1e-9
    assert said(half) == words
    load = of(peak(), loads=np.array([[0, -1, 0], [0, -1 - 2e-9, 0]]))
    assert said(load) == "a load of the proof has no state"
    ring = peak()
    ring.shape = rg.Outline.ellipse(2, 1)
    assert said(ring) == "the proof is about another kind of outline"
