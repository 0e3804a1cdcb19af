"""Wrong calls of every public name: one line that says what was expected and what came, and nothing else."""

import inspect
import re
import warnings
from collections.abc import Iterator
from types import ModuleType
from typing import Any

import matplotlib.pyplot as plt
import pytest

import regrasp as rg
import regrasp.files
import regrasp.plots
from paper import GRASP, LOAD
from refusals import refusal
from wrong_calls import ROOMS, rows, rows_of
from wrong_calls.row import Case, called_wrongly, cases, long_cases

pytestmark = pytest.mark.contract

# Records of results: they are made by the verbs, and hold what they are given.
RECORDS = {
    "BatchStates", "BatchTolerances", "Bottleneck", "ChosenState", "HeldDirections", "HeldSphere",
    "MarginCurve", "Margins",
    "PyramidLosses", "RegraspCut", "RegraspObstacle", "RegraspPlan", "SampledTransition", "Sensitivity",
    "ContactRegions", "FaceRegions", "OutlineCut", "OutlineRegrasps", "PlacementMap", "SurfaceMap",
    "Closure", "WrenchBall", "Measure", "Quality", "LeastFriction", "LargestLoad",
    "HeldCentres", "Tolerances", "Transition", "TurningTransition", "Verification", "StraightPath",
    "SampledPath", "TurningPath",
}  # fmt: skip


@pytest.fixture(autouse=True)
def _no_figure_is_left() -> Iterator[None]:
    yield
    plt.close("all")


BY_ROOM = pytest.mark.parametrize("room", ROOMS, ids=lambda room: room.__name__.rpartition(".")[2])


@BY_ROOM
def test_wrong_arguments_are_refused_in_one_line(room: ModuleType) -> None:
    for name, row in rows_of(room).items():
        tried = 0
        for case in cases(name, row):
            said = refusal(lambda case=case, row=row: called_wrongly(row, case))
            assert said is not None, f"{case} was taken"
            assert said.strip(), case
            assert "\n" not in said, case
            assert len(said) < 500, case
            tried += 1
        assert tried > 0 or not inspect.signature(row.call).parameters, name


@BY_ROOM
def test_what_is_long_is_not_repeated(room: ModuleType) -> None:
    for name, row in rows_of(room).items():
        for case in long_cases(name, row):
            try:
                called_wrongly(row, case)
            except rg.RegraspError as error:
                said = str(error)
                assert len(said) < 500, (case.parameter, said[:600])
                assert "\n" not in said


@pytest.mark.parametrize(
    "name", ["plan_removal", "plan_addition", "plan_exchange", "verify", "LoadSeries.sampled"]
)
@pytest.mark.parametrize("load", [lambda: LOAD, lambda a, b: LOAD, lambda *, t: LOAD])
def test_functions_of_other_arguments_are_refused(name: str, load: Any) -> None:
    said = refusal(lambda: called_wrongly(rows()[name], Case(name, "load", load)))
    assert said is not None
    assert re.match("load must be (a|the) function of time", said)


@pytest.mark.parametrize("shape", ["RegraspProblem", "RegraspProblem in space"])
def test_filters_of_other_arguments_or_answers_are_refused(shape: str) -> None:
    for keep, words in ((lambda: True, "keep must be a function of first"), (len, "keep must be")):
        said = refusal(lambda keep=keep: called_wrongly(rows()[shape], Case(shape, "keep", keep)))
        assert said is not None
        assert words in said
    with pytest.raises(rg.InvalidInput, match="keep must return which of"):
        called_wrongly(rows()[shape], Case(shape, "keep", lambda a, b, c: [True])).plans()


def test_names_that_are_long_or_many_leave_the_ends_of_a_message() -> None:
    long = rg.Grasp([GRASP["P1"].named("n" * 100_000), GRASP["P2"].named("m" * 100_000)])
    many = rg.Grasp([rg.Contact([k, 0], [0, 1], 0.5, name=f"finger number {k}") for k in range(300)])
    for grasp in (long, many):
        for wrong in ("Q", None):
            said = refusal(lambda grasp=grasp, wrong=wrong: grasp[wrong])
            assert said is not None
            assert len(said) < 500
    with pytest.raises(rg.Infeasible) as caught:
        rg.choose_state(long, rg.Wrench([0, 100]), "effort", max_force=1)
    assert len(str(caught.value)) < 500
    assert str(caught.value).startswith("no forces of nnn")


def test_thousands_are_tried() -> None:
    assert sum(1 for name, row in rows().items() for _ in cases(name, row)) > 5000


def test_every_public_name_has_a_row() -> None:
    errors = {
        n for n in rg.__all__ if isinstance(getattr(rg, n), type) and issubclass(getattr(rg, n), Exception)
    }
    missing = set(rg.__all__) - {name.split(".")[0].split(" ")[0] for name in rows()} - errors - RECORDS
    assert missing == set()
    functions = {n for n in regrasp.files.__all__ if inspect.isfunction(getattr(regrasp.files, n))}
    assert functions - {"scenario_schema"} <= rows().keys()


def test_every_parameter_is_tried_where_it_has_a_right_value_too() -> None:
    """The calls that the wrong ones are made from are right, so that one thing is wrong with each."""
    unanswered = {
        "read_scenario",
        "read_plan",
        "read_cut",
        "read_regions",
        "read_motions",
        "read_ways",
        "Outline.from_file",
        "Mesh.from_file",
        "Mesh.save_stl",
        "write_mcap",
    }
    for name, row in rows().items():
        if name in unanswered or name.startswith("plots."):
            continue
        needed = [
            key
            for key, parameter in inspect.signature(row.call).parameters.items()
            if parameter.default is inspect.Parameter.empty
            and parameter.kind not in (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
        ]
        assert set(needed) <= row.right.keys() | set(row.kinds) - set(row.kinds), (name, needed)
        if name.endswith(".plans"):
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            first = next(iter(inspect.signature(row.call).parameters), None)
            positional = [row.right[first]] if needed and needed[0] == first else []
            row.call(*positional, **{k: v for k, v in row.right.items() if not (positional and k == first)})


def test_what_came_is_shown_shortly() -> None:
    from regrasp.errors import shown

    class Broken:
        def __repr__(self) -> str:
            raise RuntimeError("no words")

    assert shown(Broken()) == "a value of type Broken"
    assert len(shown(list(range(10_000)))) == 120
    assert shown(10**5000) == "a value of type int"
    assert shown("two\nlines") == r"'two\nlines'"
    assert str(rg.InvalidInput("expected this,\n  got that")) == "expected this, got that"


def test_numbers_that_are_numbers_are_taken() -> None:
    """Fractions, decimals, NumPy's kinds and large whole numbers, as before."""
    from decimal import Decimal
    from fractions import Fraction

    import numpy as np

    for position in (
        [Fraction(1, 2), 1],
        (Decimal("0.5"), 1),
        np.array([0.5, 1], dtype=np.float32),
        [2**70, 1],
    ):
        for friction in (np.float64(0.5), np.int64(1), Fraction(1, 2), np.array(0.5), 10**300):
            contact = rg.Contact(position, [0, 1], friction)
            assert contact.friction == float(friction)
            assert contact.position[1] == 1.0
