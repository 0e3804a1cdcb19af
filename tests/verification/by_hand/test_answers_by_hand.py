"""What is answered and withstood, claimed by others: each part of the claim and of its proof counts."""

from math import inf, nan, nextafter
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign.beams import BEAM, held, withstood
from proofs import planar

pytestmark = pytest.mark.contract


def said(claim) -> str:
    return "; ".join(rg.verify(claim).violations)


def test_what_is_withstood_is_judged_whoever_says_it() -> None:
    good = withstood()
    verdict = rg.verify(good)
    assert (verdict.ok, verdict.excluded, verdict.bound) == (True, 9, good.bound)
    share = " on the 0.0% of the outline that was asked about"  # 3 / 512 of 12 m
    assert verdict.asked == f" of fingers that answer by equal stiffness{share}"
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
        ("others", (SimpleNamespace(value=good.bound * (1 + 2e-9)),), "passed over"),
        ("others", (SimpleNamespace(value=good.bound),), ""), ("places", np.array([1, 2, 3.1]), "off its"),
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
