"""The cases of a study: forms of a grid, and keys."""

from math import inf, nan
from typing import Any

import numpy as np
import pandas as pd
import pytest

import regrasp as rg
from regrasp.studies.axes import values_of
from regrasp.studies.cases import cases_of, key_of

pytestmark = pytest.mark.contract


def test_ranges_have_both_ends() -> None:
    assert values_of("a", {"from": 0.2, "to": 0.8, "count": 4}) == pytest.approx([0.2, 0.4, 0.6, 0.8])
    logarithmic = {"from": 1, "to": 100, "count": 3, "spacing": "log"}
    assert values_of("a", logarithmic) == pytest.approx([1, 10, 100])
    assert values_of("a", {"from": 3, "to": 9, "count": 1}) == [3]


@pytest.mark.parametrize(
    ("form", "low", "high"),
    [({"uniform": [2, 3]}, 2, 3), ({"log_uniform": [0.1, 10]}, 0.1, 10), ({"integers": [0, 3]}, 0, 3)],
)
def test_distributions_draw_within_and_the_same_again(form: dict[str, Any], low: float, high: float) -> None:
    drawn = values_of("a", {**form, "count": 500, "seed": 3})
    assert drawn == values_of("a", {**form, "count": 500, "seed": 3})
    assert drawn != values_of("a", {**form, "count": 500, "seed": 4})
    assert low <= min(drawn) < low + 0.1 * (high - low)
    assert high - 0.1 * (high - low) < max(drawn) <= high


def test_a_normal_distribution_has_its_moments() -> None:
    drawn = np.array(values_of("a", {"normal": [5, 2], "count": 4000, "seed": 1}))
    assert drawn.mean() == pytest.approx(5, abs=0.15)
    assert drawn.std() == pytest.approx(2, abs=0.1)


def test_a_product_has_every_combination_once_and_the_last_key_turns_fastest() -> None:
    cases = cases_of({"a": [1, 2], "b": ["x", "y", "z"]})
    assert len(cases) == 6
    assert list(cases)[:4] == [{"a": 1, "b": "x"}, {"a": 1, "b": "y"}, {"a": 1, "b": "z"}, {"a": 2, "b": "x"}]
    assert len({key_of(case) for case in cases}) == 6


def test_zipped_values_and_tables_stand_side_by_side() -> None:
    wanted = [{"a": 1, "b": "x"}, {"a": 2, "b": "y"}]
    assert list(cases_of({"a": [1, 2], "b": ["x", "y"]}, zipped=True)) == wanted
    assert list(cases_of(wanted)) == wanted
    assert list(cases_of(pd.DataFrame(wanted))) == wanted


def test_a_key_is_of_the_values_alone() -> None:
    assert key_of({"a": 1, "b": [2, 3]}) == key_of({"b": [2.0, 3.0], "a": 1.0})
    assert key_of({"a": np.nextafter(0.1, 1)}) != key_of({"a": 0.1})
    assert len({key_of({"a": value}) for value in (1, True, "1", None, [1], [[1]])}) == 6
    assert key_of({"a": 0.5, "b": "x"}) == "4f06c0984588618f76a588f0", "keys of written rows would change"


def test_numpy_values_are_plain() -> None:
    (case,) = cases_of({"a": np.array([0.5]), "b": [np.arange(2)]})
    assert case == {"a": 0.5, "b": [0, 1]}
    assert type(case["a"]) is float


@pytest.mark.parametrize(
    ("grid", "words"),
    [
        ({"a": 3}, "a: expected a list"),
        ({"a": "abc"}, "a: expected a list"),
        ({"a": []}, "at least one value"),
        ({"a": [nan]}, "finite"),
        ({"a": [inf]}, "finite"),
        ({"a": [{}]}, "finite"),
        ({"a": [0.5, 1, 1.0]}, "cases must differ"),
        ({"a": {"from": 1, "to": 2}}, "a: expected a list"),
        ({"a": {"from": 1, "to": 2, "count": 3, "steps": 3}}, "a: expected a list"),
        ({"a": {"from": -1, "to": 2, "count": 3, "spacing": "log"}}, "positive ends"),
        ({"a": {"uniform": [1, 0], "count": 3, "seed": 1}}, "least and its largest"),
        ({"a": {"uniform": [0, 1], "count": 3}}, "a: expected a list"),
        ({"a": {"uniform": [0, 1], "normal": [0, 1], "count": 3, "seed": 1}}, "a: expected a list"),
        ({"a": {"normal": [0, -1], "count": 3, "seed": 1}}, "deviation must be at least 0"),
        ({"a": {"integers": [0, 1], "count": 3, "seed": -1}}, "seed"),
        ({"a": {"integers": [3, 1], "count": 3, "seed": 1}}, "most"),
        ({}, "grid must be a mapping"),
        ([], "a table must have cases"),
        ([{"a": 1}, {"b": 1}], "all with the same keys"),
        ([{"a": 1}, {"a": 1}], "cases must differ"),
        ({"verdict": [1]}, "must not be called 'verdict'"),
    ],
)
def test_what_is_no_grid_is_refused(grid: Any, words: str, tmp_path: Any) -> None:
    with pytest.raises(rg.InvalidInput, match=words):
        rg.sweep(dict, grid, out=tmp_path / "out", workers=0, progress=False)
    assert not (tmp_path / "out").exists()


def test_zipped_keys_have_equally_many_values() -> None:
    with pytest.raises(rg.InvalidInput, match="equally many"):
        cases_of({"a": [1, 2], "b": [1]}, zipped=True)
