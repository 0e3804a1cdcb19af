"""Values that were pickled or copied are the equal value, read-only, in any process."""

import copy
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays as any_arrays

import regrasp as rg
from paper import GRASP
from values import VALUES, escape

pytestmark = pytest.mark.contract

WAYS: dict[str, Callable[[Any], Any]] = {
    "pickled": lambda value: pickle.loads(pickle.dumps(value)),
    "pickled, oldest protocol": lambda value: pickle.loads(pickle.dumps(value, protocol=2)),
    "copied": copy.copy,
    "deep-copied": copy.deepcopy,
}


def arrays(value: Any) -> Iterator[np.ndarray]:
    """Every array that a value keeps."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, (tuple, list)):
        for entry in value:
            yield from arrays(entry)
    elif is_dataclass(value):
        for field in fields(value):
            yield from arrays(getattr(value, field.name))


@pytest.mark.parametrize("name", VALUES)
@pytest.mark.parametrize("way", WAYS)
def test_a_copy_is_the_equal_value(name: str, way: str) -> None:
    value = VALUES[name]()
    again = WAYS[way](value)
    assert type(again) is type(value)
    assert again == value
    assert hash(again) == hash(value)
    assert repr(again) == repr(value)
    for array in arrays(again):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


def test_every_public_value_is_tried() -> None:
    known = {type(make()).__name__ for make in VALUES.values()}
    public = {
        name
        for name in rg.__all__
        if isinstance(getattr(rg, name), type) and not issubclass(getattr(rg, name), Exception)
    }
    # An obstacle says what could not be planned, and sets
    # of loads are of classes of their own.
    assert public - known <= {"RegraspObstacle", "LoadSet"}


@pytest.mark.parametrize("name", ["Grasp", "GraspState", "straight Transition", "Outline, smooth"])
def test_what_was_computed_from_a_value_stays_at_home(name: str) -> None:
    """A hash of text differs from process to process, and margins are computed in no time."""
    value = VALUES[name]()
    hash(value)
    str(value)
    computed = {
        key
        for of in type(value).__mro__
        for key, what in vars(of).items()
        if isinstance(what, cached_property)
    }
    again = pickle.loads(pickle.dumps(value))
    assert not computed & vars(again).keys()


def test_another_process_finds_the_equal_value() -> None:
    code = (
        "import pickle, sys\n"
        "for value in pickle.load(sys.stdin.buffer): hash(value); again = value\n"
        "names = {value[name]: name for value in [again] for name in value.names}\n"
        "assert set(names.values()) == {'P1', 'P2', 'P3'} and names[again['P2']] == 'P2'\n"
    )
    hash(GRASP)
    environment = os.environ | {"PYTHONHASHSEED": "7"}
    subprocess.run([sys.executable, "-c", code], input=pickle.dumps([GRASP]), check=True, env=environment)


def test_an_error_keeps_its_proof() -> None:
    reason = pickle.loads(pickle.dumps(rg.Infeasible("it escapes", escape())))
    assert str(reason) == "it escapes"
    assert reason.certificate == escape()
    refused = pickle.loads(pickle.dumps(rg.InvalidInput("two\nlines")))
    assert str(refused) == "two lines"


@given(any_arrays(float, (2, 3), elements=st.floats(-1e6, 1e6)))
def test_any_forces_survive(forces: np.ndarray) -> None:
    state = rg.GraspState(
        rg.Grasp([rg.Contact([0, 0, 0], [1, 0, 0], 0.5), rg.Contact([1, 0, 0], [-1, 0, 0], 0.5)]),
        rg.Wrench([0, 0, 0]),
        forces,
    )
    again = pickle.loads(pickle.dumps(state))
    assert again == state
    assert (again.forces == forces).all()


@given(st.lists(st.floats(allow_nan=True, allow_infinity=True), min_size=3, max_size=3))
def test_margins_that_mean_nothing_are_equal(values: list[float]) -> None:
    margins = rg.Margins(*(np.array([value]) for value in values))
    assert pickle.loads(pickle.dumps(margins)) == margins
