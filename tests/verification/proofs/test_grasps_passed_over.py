"""Grasps that were passed over: of fingers that the proof is about, and none better than its bound."""

from dataclasses import replace
from math import nan
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.placed.claims.meanings import LARGEST

pytestmark = pytest.mark.contract

SQUARE = rg.Outline([[0, 0], [2, 0], [2, 2], [0, 2]])
BOX = rg.Mesh.box(0.04, 0.03, 0.05)


def said(value) -> str:
    return "; ".join(rg.verify(value).violations)


def passed_over(good, value, **changes):
    return SimpleNamespace(**{"grasp": good.grasp, "places": good.places, "value": value} | changes)


@pytest.mark.parametrize("objective", ["peak", "angle"])
def test_no_grasp_that_was_passed_over_is_better_than_the_bound(objective) -> None:
    given = {"friction": 0.5, "objective": objective, "tolerance": 0.1}
    limit = {} if objective == "peak" else {"max_force": 1.0}
    good = rg.choose_grasp(SQUARE, 2, rg.Wrench([0, -1], 1.2), **given, **limit)
    way = -1 if objective in LARGEST else 1
    for off, fine in ((0.5, True), (0.0, True), (-1e-8, False), (-0.5, False)):
        passed = tuple(passed_over(good, value) for value in (good.value + way, good.bound + way * off))
        found = said(replace(good, others=passed))
        assert (found == "") == fine, off
        assert fine or "a grasp passed over has the value" in found
    assert "passed over" in said(replace(good, others=(passed_over(good, nan),)))


@pytest.mark.parametrize("shape", [SQUARE, BOX])
def test_grasps_that_were_passed_over_are_of_fingers_of_the_proof(shape) -> None:
    load = rg.Wrench([0, -1] if shape is SQUARE else [0, 0, -1])
    good = rg.choose_grasp(
        shape, 2 if shape is SQUARE else 3, load, friction=0.5, objective="peak", tolerance=0.3
    )
    first, *rest = good.grasp
    away, back = (first.position + step * np.abs(first.position).max() for step in (1e-9, -1e-3))
    aside = np.linalg.svd(first.normal[None])[2][1]  # along the boundary, to the middle of the side
    aside *= -np.sign(aside @ first.position)
    beside = replace(
        first, name="beside", position=first.position + 1e-7 * np.abs(first.position).max() * aside
    )
    changes: list[tuple[str, dict[str, object]]] = [
        ("", {}),
        ("not of fingers where", {"grasp": rg.Grasp(rest)}),
        ("not of fingers where", {"grasp": rg.Grasp([replace(first, position=away), *rest])}),
        ("not of fingers where", {"grasp": rg.Grasp([replace(first, position=back), *rest])}),
        ("not of fingers where", {"grasp": rg.Grasp([replace(first, normal=-first.normal), *rest])}),
        ("of another friction", {"grasp": rg.Grasp([replace(first, friction=0.49), *rest])}),
        ("contacts are nearer", {"grasp": rg.Grasp([first, beside, *rest[1:]])}),
        ("off its place", {"places": good.places + 1e-6 * np.abs(good.places).max()}),
        ("needs a place", {"places": good.places[1:]}),
    ]
    for words, change in changes:
        found = said(
            replace(good, others=(passed_over(good, good.value), passed_over(good, good.value, **change)))
        )
        assert (found == "") == (words == ""), (words, found)
        assert found.startswith("grasp 2 of those passed over: ") or not words
        assert words in found
