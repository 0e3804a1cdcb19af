"""Cuts that prove that no regrasp exists at any orientation: made by the planner, judged in rationals."""

import json
from dataclasses import replace

import numpy as np
import pytest

import regrasp as rg
from regrasp.files import read_cut, write_cut
from regrasp.planning.regrasps.cut import cut_of
from scenarios import regrasp

pytestmark = pytest.mark.laws

ELLIPSE, WEIGHT = rg.Outline.ellipse(2, 1), rg.Wrench([0, -3.0])


def grasp(*places, friction=0.5):
    return rg.Grasp(ELLIPSE.contact_at(p * ELLIPSE.length, friction=friction) for p in places)


START, GOAL = grasp(0.02, 0.35, 0.7), grasp(0.2, 0.5, 0.85)


def refused(**options):
    with pytest.raises(rg.Infeasible) as error:
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, **{"friction": 0.5, "candidates": 30} | options)
    return error.value


@pytest.fixture(scope="module")
def cut():
    found = refused(least_margin=0.4637)  # above atan 0.5: no cone is left
    assert str(found).endswith("none at any orientation is proven, by the cut of the certificate")
    return found.certificate.cut


@pytest.mark.parametrize("options", [{"min_distance": 5.0}, {"least_margin": 0.47}, {"least_margin": 1.54}])
def test_refusals_at_any_orientation_are_proven(options):
    proof = refused(**options).certificate.cut
    verdict = rg.verify(proof)
    assert verdict.ok
    assert str(verdict).startswith("no regrasp leads from the start to the goal on these contacts")
    assert "not covered: contacts elsewhere, fingers that slide or roll" in str(verdict)
    asked = (
        f"with angle margins of {options['least_margin']:g} rad"
        if "least_margin" in options
        else "with fingers 5 apart"
    )
    assert str(verdict).count(asked) == 2  # another regrasp may well exist
    assert " pairs may hold" in verdict.components
    assert verdict.components in str(verdict)
    assert verdict.crossing == len(proof.reached) * (len(proof.contacts) - len(proof.reached))


def test_what_is_sampled_or_has_arcs_is_not_proven():
    assert refused(min_distance=5.0, orientations=4).certificate.cut is None
    assert "proven" not in str(refused(min_distance=5.0, orientations=4))


def test_a_cut_is_read_back_and_judged_from_a_file(cut, tmp_path, capsys):
    path = tmp_path / "cut.json"
    write_cut(cut, path)
    assert read_cut(path) == cut
    assert rg.RegraspCut.from_dict(json.loads(json.dumps(cut.to_dict()))) == cut
    status, out, err = regrasp(capsys, "verify", path)
    assert (status, err) == (0, "")
    assert "which no hold crosses at any orientation" in out
    data = json.loads(path.read_text())
    data["least_margin"] = 0.1
    path.write_text(json.dumps(data))
    status, out, err = regrasp(capsys, "verify", path)
    assert status == 1
    assert "of the start may hold" in err
    for spoiled in ({**data, "version": 2}, {**data, "start": [0, 0, 1]}, {**data, "colour": 3}, []):
        path.write_text(json.dumps(spoiled))
        with pytest.raises(rg.InvalidInput, match=r"cut\.json"):
            read_cut(path)


def of_others(cut):
    """The same words about contacts of which some hold."""
    ways = (0.03, 0.97, 0.53, 0.56)
    contacts = tuple(ELLIPSE.contact_at(w * ELLIPSE.length, friction=0.1) for w in ways)
    return replace(cut, contacts=contacts, start=(0, 1, 2), goal=(0, 1, 3), least_margin=0.0)


def test_what_crosses_is_named(cut):
    some = next(k for k in range(len(cut.contacts)) if k not in cut.reached)
    assert rg.verify(replace(cut, reached=(*cut.reached, some))).ok  # it holds with none
    wide = replace(cut, least_margin=0.2)
    words = "; ".join(rg.verify(replace(wide, reached=tuple(range(5)))).violations)
    assert "may hold across the cut" in words
    assert "of the goal may hold and are not both on the other side" in words
    assert "of the start may hold and are not both on its side" in "; ".join(rg.verify(wide).violations)
    assert "the same contacts" in "; ".join(rg.verify(replace(cut, goal=cut.start[::-1])).violations)
    assert not rg.verify(of_others(cut)).ok
    with pytest.raises(rg.InvalidInput, match="verify takes nothing else"):
        rg.verify(cut, friction=0.9)
    with pytest.raises(rg.InvalidInput, match="start must be three different places"):
        replace(cut, start=(0, 1))


def test_the_margin_is_judged_on_both_sides_of_its_limit():
    """Three contacts of one friction: pairs of opposite turns hold up to atan mu, and not beyond."""
    problem = rg.RegraspProblem(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, candidates=5)
    proof = cut_of(replace(problem, least_margin=0.47))
    limit = float(np.arctan(0.5))
    assert rg.verify(replace(proof, least_margin=limit * (1 + 1e-12))).ok
    assert not rg.verify(replace(proof, least_margin=limit * (1 - 1e-12))).ok


def test_a_finger_that_holds_alone_needs_no_cone_beside_it():
    """With ``one_finger`` an idle one may have no cone left: such holds cross, and the planner finds them."""
    low = ELLIPSE.contact_at(0.75 * ELLIPSE.length, friction=0.5)
    contacts = [low, *grasp(0.95, 0.45, 0.05, 0.55, friction=0.1)]
    start, goal = rg.Grasp(contacts[:3]), rg.Grasp([contacts[0], *contacts[3:]])
    options = {"friction": 0.1, "candidates": 10, "least_margin": 0.3}
    plan = rg.plan_regrasp(ELLIPSE, start, goal, WEIGHT, one_finger=True, **options)
    assert rg.verify(plan).ok
    assert plan.margin >= 0.3
    cut = rg.RegraspCut(tuple(contacts), (0, 1, 2), (0, 3, 4), (0, 1, 2), 0.3)
    assert any("may hold" in v for v in rg.verify(cut).violations)
    assert rg.verify(replace(cut, least_margin=0.47)).ok  # beyond the cone of the one that holds


@pytest.mark.parametrize("seed", range(6))
def test_free_turning_is_possible_or_a_cut_proves_that_it_is_not(seed):
    """Without limits two fingers of any grasp that holds can hold at some orientation (docs/facts.md, 7)."""
    rng = np.random.default_rng(seed)
    seen = set()
    for _ in range(12):
        places = rng.uniform(0, 1, (2, 3))
        mu = float(rng.uniform(0.05, 0.6))
        ends = [grasp(*p, friction=mu) for p in places]
        distance = float(rng.choice([0.0, 1.5, 3.0]))
        problem = rg.RegraspProblem(
            ELLIPSE, *ends, WEIGHT, friction=mu, candidates=6, min_distance=distance,
            least_margin=float(rng.choice([0.0, 0.1, 0.3])),
        )  # fmt: skip
        found, proof = problem.turning_sequences(), cut_of(problem)
        assert bool(found) == (proof is None)
        assert proof is None or rg.verify(proof).ok
        seen.add(proof is None)
    assert seen == {True, False}


def test_every_grasp_that_holds_can_be_left_without_limits():
    rng = np.random.default_rng(5)
    tried = 0
    while tried < 15:
        start, goal = (grasp(*p, friction=0.3) for p in rng.uniform(0, 1, (2, 3)))
        try:
            for end in (start, goal):
                rg.choose_state(end, WEIGHT, "force")
        except rg.Infeasible:
            continue
        tried += 1
        problem = rg.RegraspProblem(ELLIPSE, start, goal, WEIGHT, friction=0.3, candidates=4)
        assert problem.turning_sequences()
