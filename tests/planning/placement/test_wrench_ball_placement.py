"""Grasps chosen for Ferrari and Canny's measure, against the measure of sampled ones."""

import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
from regrasp.verification.placed.whole_sets import makes_ball

pytestmark = pytest.mark.oracle

BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
ELLIPSE = rg.Outline.ellipse(2, 1)
NONE = rg.Wrench([0, 0])


@cache
def chosen(name: str, fingers: int) -> rg.ChosenGrasp:
    shape = {"bracket": BRACKET, "ellipse": ELLIPSE}[name]
    return rg.choose_grasp(
        shape, fingers, NONE, friction=0.4, objective="wrench_ball", max_force=2.0, length=1.5
    )


@pytest.mark.parametrize(
    ("name", "fingers", "count"), [("bracket", 2, 20), ("bracket", 3, 9), ("ellipse", 2, 20)]
)
def test_no_sampled_grasp_has_a_larger_ball(name: str, fingers: int, count: int) -> None:
    found = chosen(name, fingers)
    assert found.gap <= 1e-3
    assert found.value <= found.bound
    contacts = [found.shape.contact_at(s, friction=0.4) for s in found.shape.sample(count)]
    radii = [rg.wrench_ball(few, limit=2.0, length=1.5).radius for few in combinations(contacts, fingers)]
    assert max(radii) <= found.bound
    assert rg.wrench_ball(found.grasp, limit=2.0, length=1.5).radius == pytest.approx(found.value, rel=1e-9)
    verdict = rg.verify(found)
    assert verdict.ok, verdict
    assert rg.ChosenGrasp.from_dict(json.loads(json.dumps(found.to_dict()))) == found


def test_more_force_longer_levers_and_other_units_scale() -> None:
    base = chosen("bracket", 2)
    other = rg.choose_grasp(
        rg.Outline(1e3 * np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])), 2, NONE, friction=0.4,
        objective="wrench_ball", max_force=2e-3, length=1.5e3,
    )  # fmt: skip
    assert other.value * 1e3 == pytest.approx(base.value, rel=2e-3)


def test_a_spoiled_ball_is_noticed() -> None:
    found = chosen("bracket", 3)
    for change in (
        {"value": found.value * (1 + 1e-6), "bound": found.bound * (1 + 1e-6)},
        {"bound": found.value},
        {"length": 1.4},
        {"length": None},
        {"max_force": 1.99},
    ):
        assert not rg.verify(replace(found, **change)).ok, change  # type: ignore[arg-type]


def test_a_ball_is_made_up_to_its_radius_and_no_further() -> None:
    """The check in rationals against the measure, on random grasps, those without closure included."""
    rng = np.random.default_rng(2)
    for _ in range(25):
        k = int(rng.integers(2, 5))
        grasp = rg.Grasp(
            rg.Contact(rng.normal(size=2), rng.normal(size=2), float(rng.choice([0.0, 0.4, 2.0])))
            for _ in range(k)
        )
        radius = rg.wrench_ball(grasp, limit=1.5, length=0.7).radius
        if radius > 1e-9:
            assert makes_ball(grasp, 1.5, 0.7, Fraction(radius * (1 - 1e-9)))
        assert not makes_ball(grasp, 1.5, 0.7, Fraction(max(radius * (1 + 1e-9), 1e-9)))


def test_what_a_ball_does_not_go_with_is_refused() -> None:
    asked = {"friction": 0.4, "objective": "wrench_ball", "max_force": 1.0}
    for given, words in (
        ({"load": rg.Wrench([0, -1])}, "load must be zero"),
        ({"max_force": None}, "needs max_force"),
        ({"length": 0.0}, "length"),
        ({"removable": True}, "removable"),
        ({"objective": "peak", "length": 1.0}, "length is for objective 'wrench_ball'"),
    ):
        call = {"load": NONE, **asked, **given}
        said = refusal(lambda call=call: rg.choose_grasp(BRACKET, 3, **call))  # type: ignore[misc]
        assert words in str(said)
