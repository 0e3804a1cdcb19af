"""Two records of answers are told apart: to the last bit, by amount, by outcome and by words."""

from math import inf, nan

import numpy as np
import pytest

import regrasp as rg
from answer_plans import PLANS
from answer_states import STATES
from answers import Answer, Told, Value, document, load, save, told_by
from paper import GRASP, STATE
from same_answers import ALLOWED, differences, main

pytestmark = pytest.mark.contract

FORCES = np.array([[3.0, -4.0], [0.1, 0.0], [nan, inf]])


def told(forces=FORCES, outcome="removal", words="a plan"):
    return Told(outcome, {"forces": Value.of(forces), "moves": Value.of([])}, words)


def changed(by):
    forces = FORCES.copy()
    forces[0, 0] += by
    return forces


def compared(tmp_path, before, after):
    """The exit status of ``compare`` for records of one task of each kind: one that is equal, and one."""
    paths = [tmp_path / "before.npz", tmp_path / "after.npz"]
    for path, other in zip(paths, (before, after), strict=True):
        answers = [Answer("alike", "1", told())]
        answers += [] if other is None else [Answer("other", "2", other)]
        save(path, {"regrasp": "1"}, answers)
    return main(["compare", *map(str, paths)])


def row(text, kind):
    """tasks, equal to the bit, largest difference, outcomes, words."""
    return numbers(text, kind)[:5]


def numbers(text, kind):
    line = next(line for line in text.splitlines() if line.startswith(kind))
    return [float(number) for number in line[28:].split()]


def test_a_record_keeps_every_bit(tmp_path):
    forces = np.array([[0.1 + 0.2, -0.0], [nan, inf], [5e-324, -inf]])
    answers = [Answer("a", "1", told(forces)), Answer("b", "1", Told("Infeasible: why \u00e9", {}))]
    save(tmp_path / "record.npz", {"numpy": "2"}, answers)
    versions, again = load(tmp_path / "record.npz")
    assert versions == {"numpy": "2"}
    assert [a[:2] for a in again] == [a[:2] for a in answers]
    for (*_, x), (*_, y) in zip(answers, again, strict=True):
        assert (x.outcome, x.words) == (y.outcome, y.words)
        assert list(x.values) == list(y.values)
        for name, value in x.values.items():
            assert value.scale == y.values[name].scale
            assert value.numbers.shape == y.values[name].numbers.shape
            assert value.numbers.tobytes() == y.values[name].numbers.tobytes()
    assert not [d for d in differences(answers, again) if not d.equal]


def test_equal_records(tmp_path, capsys):
    assert compared(tmp_path, told(), told()) == 0
    text = capsys.readouterr().out
    assert row(text, "other") == [1, 1, 0, 0, 0]
    assert row(text, "all") == [2, 2, 0, 0, 0]
    assert len(text.splitlines()) == 4


def test_a_single_bit_is_counted_and_allowed(tmp_path, capsys):
    forces = FORCES.copy()
    forces[1, 0] = np.nextafter(forces[1, 0], 1)
    assert compared(tmp_path, told(), told(forces)) == 0
    text = capsys.readouterr().out
    tasks, equal, largest, *rest = row(text, "other")
    assert (tasks, equal, rest) == (1, 0, [0, 0])
    assert largest == pytest.approx(2.0**-56 / 4, rel=1e-2)  # one bit of 0.1, beside the largest force, 4
    assert row(text, "alike") == [1, 1, 0, 0, 0]
    assert text.endswith("other bits: 1\n  other: 2\n    forces: 3.47e-18\n")
    zero = [told(np.array(z)) for z in (0.0, -0.0)]
    (d,) = differences(*([Answer("a", "1", z)] for z in zero))
    assert (d.equal, d.amount, d.matters) == (False, 0.0, False)


@pytest.mark.parametrize(("by", "status"), [(0.99, 0), (-0.99, 0), (1.01, 1), (-1.01, 1)])
def test_what_is_allowed_is_relative_to_the_largest_force(tmp_path, capsys, by, status):
    assert compared(tmp_path, told(), told(changed(by * 4.0 * ALLOWED))) == status
    assert f"other bits: 1\n  other: 2\n    forces: {abs(by)}e-09".replace("0.99e-09", "9.9e-10") in (
        capsys.readouterr().out
    )


@pytest.mark.parametrize("place", [(0, 0), (2, 0), (2, 1)])
@pytest.mark.parametrize("number", [nan, inf, -inf, 1.0])
def test_what_is_not_finite_is_equal_only_to_itself(place, number):
    forces = FORCES.copy()
    forces[place] = number
    same = np.array_equal(forces, FORCES, equal_nan=True)
    for before, after in ((FORCES, forces), (forces, FORCES)):
        (d,) = differences([Answer("a", "1", told(before))], [Answer("a", "1", told(after))])
        assert d.equal == same
        assert d.matters == (not same)


@pytest.mark.parametrize(
    ("other", "shown"),
    [
        (told(outcome="Infeasible: no forces"), ["- removal", "+ Infeasible: no forces"]),
        (told(FORCES[:2]), ["- forces (3, 2), moves (0,)", "+ forces (2, 2), moves (0,)"]),
        (Told("removal", {}, "a plan"), ["- forces (3, 2), moves (0,)", "+ "]),
        (None, ["- removal", "+ no such task"]),
    ],
)
def test_another_outcome_is_listed(tmp_path, capsys, other, shown):
    assert compared(tmp_path, told(), other) == 1
    text = capsys.readouterr().out
    assert row(text, "other ") == [1, 0, 0, 1, 0]
    assert text.splitlines()[-4:] == ["other outcome: 1", "  other: 2", *(f"    {line}" for line in shown)]
    assert compared(tmp_path, other, told()) == 1


def test_optima_are_told_apart_from_forces(tmp_path, capsys):
    """Where many forces are as good, they may be others."""
    states = [Told("a state", {"forces": Value.of([4.0, x]), "end value": Value.of(v, 2.0)}) for x, v in
              ((1.0, 2.0), (2.0, 2.001))]  # fmt: skip
    assert compared(tmp_path, *states) == 1
    assert numbers(capsys.readouterr().out, "other")[2::3] == [0.25, 0.0005]


def test_words_are_counted_apart(tmp_path, capsys):
    assert compared(tmp_path, told(), told(words="a plan\nof mine")) == 0
    text = capsys.readouterr().out
    assert row(text, "other ") == [1, 1, 0, 0, 1]
    assert text.splitlines()[-4:] == ["other words: 1", "  other: 2", "    - ", "    + of mine"]


def test_so_many_of_each_kind_are_listed(tmp_path, capsys):
    for name, words in (("a", "x"), ("b", "y")):
        answers = [Answer(kind, str(k), told(words=words)) for kind in ("one", "two") for k in range(5)]
        save(tmp_path / name, {}, answers)
    for most in (1, 3, 5):
        assert main(["compare", str(tmp_path / "a"), str(tmp_path / "b"), "--most", str(most)]) == 0
        text = capsys.readouterr().out
        assert text.count("    + y") == 2 * most
        assert text.count(f": and {5 - most} more") == (2 if most < 5 else 0)


def test_a_plan_is_told_by_its_forces_and_not_its_class():
    straight = told_by(lambda: rg.plan_removal(STATE, "P3"))
    bent = told_by(lambda: rg.plan_removal(STATE, "P3", path_objective="change", instants=11))
    assert (
        straight.outcome
        == "removal with P1, P2, P3, end for angle by closed-form, path by closed-form; verified"
    )
    assert bent.outcome == straight.outcome.replace("path by closed-form", "path by clarabel")
    assert straight.values["forces"].numbers.shape == (7, 3, 2)
    assert straight.values.keys() == bent.values.keys()
    for one in (straight, bent):
        assert "Transition" not in one.outcome + one.words
    ends = [one.values["forces"].numbers[[0, -1]] for one in (straight, bent)]
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)
    turned = told_by(lambda: rg.plan_rotation(GRASP, 0.3, load=STATE.load))
    assert turned.values["angles"].numbers[-1] == pytest.approx(0.3)


def test_an_error_is_told_with_its_twist():
    refused = told_by(lambda: rg.plan_removal(STATE, "P1"))
    assert refused.outcome.startswith("Infeasible: no forces of P2, P3")
    assert refused.values["twist"].numbers.shape == (3,)
    assert told_by(lambda: 1 / 0).outcome == "ZeroDivisionError: division by zero"


def test_a_document_is_compared_as_data():
    data = {"kind": "removal", "start": [[1.0, 2.0]], "record": {"balancing": 0.5, "limits": [None, 3.0]}}
    found = document(data, "printed")
    again = document(dict(reversed(data.items())), "printed")
    (d,) = differences([Answer("a", "1", found)], [Answer("a", "1", again)])
    assert d.equal
    assert d.outcome is None
    assert found.values.keys() == {"/start", "/record/balancing", "/record/limits/1"}
    assert found.values["/record/balancing"].scale == 2.0
    assert found.outcome != document(data | {"kind": "addition"}, "printed").outcome
    assert found.outcome != document(data | {"start": None}, "printed").outcome


def test_every_kind_has_tasks_of_their_own_keys():
    for kind, tasks in (STATES | PLANS).items():
        keys = [key for key, _ in tasks()]
        assert len(keys) == len(set(keys)) > 0, kind
