"""Scenarios, plan files, set-points and the staging of output."""

import tomllib
from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from places import EXAMPLES, SCENARIOS
from regrasp.files import (
    parse_scenario,
    plan_scenario,
    read_plan,
    read_scenario,
    scenario_schema,
    write_plan,
)
from regrasp.plans.record import Choice, Record
from scenarios import PAPER, edited, planned

pytestmark = pytest.mark.contract

PLAN = planned()

# -- scenarios ------------------------------------------------------------------------------------------


def test_example_and_demo_are_the_same_text() -> None:
    assert (EXAMPLES / "paper.toml").read_text(encoding="utf-8") == PAPER


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_examples_plan_and_verify(path: Path) -> None:
    assert rg.verify(plan_scenario(read_scenario(path))).ok


def test_scenario_plans_what_the_same_calls_plan() -> None:
    grasp = rg.Grasp(
        [
            rg.Contact([-4, -4], [1, 1], 0.3, name="P1"),
            rg.Contact([4, -5], [-1, 2], 0.3, name="P2"),
            rg.Contact([0, 8], [0, -1], 0.3, name="P3"),
        ]
    )
    forces = [[3.7897, 3.0034], [-3.0096, 4.4156], [0.7199, -3.9190]]
    state = rg.GraspState(grasp, rg.Wrench([-1.5, -3.5]), forces)
    assert rg.plan_removal(state, "P3") == PLAN


TASK = "duration = 1.0"


def without_forces(text: str) -> str:
    """The scenario with no starting force; the load, in brackets of its own, keeps its force."""
    head, *contacts = text.split("[[contacts]]")
    return "[[contacts]]".join(
        [head, *("\n".join(x for x in c.splitlines() if not x.startswith("force")) + "\n" for c in contacts)]
    )


@pytest.mark.parametrize(
    ("line", "seen", "expected"),
    [
        ('whole_objective = "peak"', lambda p: p.record.choices[1].objective, "peak"),
        ('method = "clarabel"', lambda p: p.record.choices[0].method, "clarabel"),
        ("max_force = 7.5", lambda p: p.grasp.max_forces.tolist(), [7.5] * 3),
        ("reserve = 0.25", lambda p: p.record.reserve, 0.25),
        ("duration = 2.5", lambda p: p.duration, 2.5),
    ],
)
def test_option_reaches_the_plan(line: str, seen: Callable[[rg.Transition], Any], expected: Any) -> None:
    changed = plan_scenario(parse_scenario(without_forces(edited((TASK, line)))))
    assert seen(changed) == expected
    assert rg.verify(changed).ok


def test_objective_and_peak_ratio_reach_the_plan() -> None:
    plan = planned(('objective = "angle"', 'objective = "force"\npeak_ratio = 1.5'))
    least = planned(('objective = "angle"', 'objective = "peak"')).end.magnitudes.max()
    (choice,) = plan.record.choices
    assert choice.objective == "force"
    assert choice.force_limits == pytest.approx([1.5 * least] * 2, rel=1e-8)


def test_balance_tolerance_reaches_the_planner() -> None:
    off = ("force = [3.7897, 3.0034]", "force = [3.9, 3.0034]")
    with pytest.raises(rg.InvalidInput, match="no equilibrium"):
        planned(off)
    plan = planned(off, (TASK, "balance_tolerance = 0.02"))
    assert 0.001 < plan.record.balancing < 0.02 * 5.4
    assert rg.verify(plan).ok


@pytest.mark.parametrize(
    ("lines", "scaling"),
    [
        ('scaling = "minimum_jerk"', rg.TimeScaling.minimum_jerk(1.0)),
        ('scaling = "linear"', rg.TimeScaling.linear(1.0)),
        ('scaling = "spline"', rg.TimeScaling.spline(1.0)),
        ("control = [1.0, 1.0, 0.2, 0.1, 0.0, 0.0]", rg.TimeScaling.spline(1.0, (1, 1, 0.2, 0.1, 0, 0))),
    ],
)
def test_scaling_and_control_reach_the_plan(lines: str, scaling: rg.TimeScaling) -> None:
    text = "".join(
        line for line in PAPER.splitlines(keepends=True) if not line.startswith(("scaling", "control"))
    )
    assert plan_scenario(parse_scenario(f"{text}\n{lines}\n")).scaling == scaling


def test_rate_limit_sets_the_duration() -> None:
    plan = planned((TASK, "rate_limit = 10.0"))
    fastest = np.linalg.norm(plan.rates(np.linspace(0, plan.duration, 2001)), axis=-1).max()
    assert fastest == pytest.approx(10.0, rel=1e-6)
    assert plan == PLAN.fastest(10.0)


def test_given_end_is_used() -> None:
    plan = planned(
        ("force = [3.7897, 3.0034]", "force = [3.7897, 3.0034]\nend_force = [1.8557, 2.4555]"),
        ("force = [-3.0096, 4.4156]", "force = [-3.0096, 4.4156]\nend_force = [-0.3557, 1.0445]"),
    )
    assert plan.record.choices == ()
    assert plan.end.forces[:2] == pytest.approx(np.array([[1.8557, 2.4555], [-0.3557, 1.0445]]), abs=1e-4)
    assert rg.verify(plan).ok


def test_addition_with_both_ends_given_is_the_removal_run_backwards() -> None:
    text = edited(
        ('kind = "removal"', 'kind = "addition"'),
        ("force = [3.7897, 3.0034]", "end_force = [3.7897, 3.0034]\nforce = [1.8557, 2.4555]"),
        ("force = [-3.0096, 4.4156]", "end_force = [-3.0096, 4.4156]\nforce = [-0.3557, 1.0445]"),
        ("force = [0.7199, -3.9190]", "end_force = [0.7199, -3.9190]"),
    )
    plan = plan_scenario(parse_scenario(text))
    assert plan.kind == "addition"
    assert plan.grasp.names == ("P1", "P2", "P3")
    assert plan.end == PLAN.start
    assert not plan.start.force("P3").any()


def test_arriving_finger_may_stand_first_in_the_file() -> None:
    text = without_forces(edited(('kind = "removal"', 'kind = "addition"')))
    head, *contacts = text.split("[[contacts]]")
    last, task = contacts[2].split("[task]")
    text = "[[contacts]]".join([head, last, contacts[0], contacts[1]]) + "[task]" + task
    plan = plan_scenario(parse_scenario(text))
    assert plan.grasp.names == ("P1", "P2", "P3")
    assert plan.contact == "P3"
    assert rg.verify(plan).ok


@pytest.mark.parametrize("change", [lambda b: b"\xef\xbb\xbf" + b, lambda b: b.replace(b"\n", b"\r\n")])
def test_windows_text_is_read(change: Callable[[bytes], bytes], tmp_path: Path) -> None:
    path = tmp_path / "paper.toml"
    path.write_bytes(change(PAPER.encode()))
    assert read_scenario(path) == parse_scenario(PAPER)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: None, "expected a scenario in TOML, found no such file"),
        (lambda path: path.mkdir(), "expected a scenario in TOML, found a folder"),
        (
            lambda path: path.write_bytes(b"# \xff"),
            "expected a scenario in TOML, found no UTF-8 text (at byte 2)",
        ),
        (
            lambda path: path.write_text("a = " + "[" * 100_000),
            "not a scenario: lists within lists, hundreds deep",
        ),
    ],
)
def test_file_that_is_no_scenario(make: Callable[[Path], object], message: str, tmp_path: Path) -> None:
    path = tmp_path / "scenario.toml"
    make(path)
    with pytest.raises(rg.InvalidInput) as raised:
        read_scenario(path)
    assert str(raised.value).startswith(f"{path}: {message}")


def test_json_schema_accepts_the_examples_and_refuses_what_we_refuse() -> None:
    import jsonschema  # takes seconds

    schema = scenario_schema()
    reader = jsonschema.validators.validator_for(schema)
    reader.check_schema(schema)
    for path in SCENARIOS:
        reader(schema).validate(tomllib.loads(path.read_text(encoding="utf-8")))
    for change in (
        ('kind = "removal"', 'kind = "rotation"'),
        ('kind = "removal"', 'kind = "regrasp"'),
        ("friction = 0.3", "friction = -0.3"),
        ("friction = 0.3", "friktion = 0.3"),
        ("position = [4.0, -5.0]", "position = [4.0, -5.0, 0.0, 0.0]"),
        ('objective = "angle"', 'objective = "safest"'),
    ):
        with pytest.raises(jsonschema.ValidationError):
            reader(schema).validate(tomllib.loads(edited(change)))


# -- plan files -----------------------------------------------------------------------------------------

finite = st.floats(-1e200, 1e200)  # rates of larger ones have no number
positive = st.floats(min_value=0, exclude_min=True, allow_infinity=False, allow_nan=False)
frictions = st.floats(min_value=0, allow_infinity=False, allow_nan=False)


@st.composite
def normals(draw: st.DrawFn, d: int) -> list[float]:
    n = draw(st.lists(finite, min_size=d, max_size=d).filter(any))
    unit = draw(st.booleans())
    return rg.Contact([0.0] * d, n, 0.0).normal.tolist() if unit else n


@st.composite
def transitions(draw: st.DrawFn) -> rg.Transition:
    """Any transition that can be made, balanced or not: a file must keep its every bit."""
    d, n = draw(st.sampled_from([2, 3])), draw(st.integers(1, 4))
    points = draw(st.lists(st.integers(-9, 9), min_size=n, max_size=n, unique=True))
    scale = draw(st.floats(1e-100, 1e100))
    grasp = rg.Grasp(
        rg.Contact(
            [k * scale, *draw(st.lists(st.just(scale) | st.just(-0.0), min_size=d - 1, max_size=d - 1))],
            draw(normals(d)),
            draw(frictions),
            max_force=draw(st.none() | positive),
            name=draw(st.none() | st.just(f"Finger {i}, “left”")),
        )
        for i, k in enumerate(points)
    )
    load = rg.Wrench.from_vector(draw(st.lists(finite, min_size=3 * (d - 1), max_size=3 * (d - 1))))
    rows = st.lists(st.lists(finite, min_size=d, max_size=d), min_size=n, max_size=n)
    start, end = (rg.GraspState(grasp, load, draw(rows)) for _ in range(2))
    fall = sorted(draw(st.lists(st.floats(0, 1), max_size=5)), reverse=True)
    scaling = rg.TimeScaling.spline(draw(st.floats(1e-100, 1e100)), (1, *fall, 0))
    limits = tuple(draw(st.lists(positive | st.just(inf), min_size=n, max_size=n)))
    record = Record(
        draw(st.floats(0, 0.99)), (Choice("end", "angle", "closed-form", limits),), draw(frictions)
    )
    moving = {draw(st.sampled_from(["leaving", "arriving"])): grasp.names[: draw(st.integers(1, n))]}
    return rg.Transition(start, end, scaling, record, **moving)


@given(plan=transitions())
def test_plan_is_read_back_bit_for_bit(plan: rg.Transition, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.getbasetemp() / "any-plan.json"
    write_plan(plan, path)
    back = read_plan(path)
    assert back == plan
    for ours, theirs in ((plan.start, back.start), (plan.end, back.end)):
        assert ours.forces.tobytes() == theirs.forces.tobytes()
        assert ours.load.vector.tobytes() == theirs.load.vector.tobytes()
        assert ours.grasp.normals.tobytes() == theirs.grasp.normals.tobytes()
        assert ours.grasp.positions.tobytes() == theirs.grasp.positions.tobytes()
    text = path.read_text(encoding="utf-8")
    write_plan(back, path)
    assert path.read_text(encoding="utf-8") == text


@pytest.mark.parametrize("d", [2, 3])
def test_normalising_twice_changes_no_bit(d: int) -> None:
    rng = np.random.default_rng(d)
    for normal in rng.normal(size=(5000, d)) * 10.0 ** rng.uniform(-300, 300, size=(5000, 1)):
        once = rg.Contact(np.zeros(d), normal, 0.3).normal
        assert once.tobytes() == rg.Contact(np.zeros(d), once, 0.3).normal.tobytes()
        assert abs(np.linalg.norm(once) - 1) < 1e-15


def test_plan_read_back_gets_the_same_verdict(tmp_path: Path) -> None:
    write_plan(PLAN, tmp_path / "plan.json")
    assert rg.verify(read_plan(tmp_path / "plan.json")) == rg.verify(PLAN)
