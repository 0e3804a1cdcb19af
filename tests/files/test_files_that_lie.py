"""Plan files and set-points that say what is not so, or what nothing can be: refused, in one message."""

import json
from collections.abc import Callable
from math import inf
from pathlib import Path

import numpy as np
import pytest

import regrasp as rg
from regrasp.files import read_plan, write_plan, write_setpoints
from regrasp.files.plans.setpoints import checked, read_setpoints
from spoiling import put

pytestmark = pytest.mark.contract

GRASP = rg.Grasp(
    rg.Contact(r, n, 0.3, name=name)
    for name, r, n in (("P1", [-4, -4], [1, 1]), ("P2", [4, -5], [-1, 2]), ("P3", [0, 8], [0, -1]))
)
LOAD = rg.Wrench([-1.5, -3.5])
STRAIGHT = rg.plan_removal(GRASP, "P3", load=LOAD)
BENT = rg.plan_removal(GRASP, "P3", load=LOAD, rate_limit=10.0, min_normal=0.5, duration=1.0, instants=11)
TURN = rg.plan_rotation(GRASP.without("P3"), 0.2, load=LOAD)
ELLIPSE = rg.Outline.ellipse(2, 1)


def fingers(*places: float) -> rg.Grasp:
    return rg.Grasp(ELLIPSE.contact_at(s * ELLIPSE.length, friction=0.5) for s in places)


WHOLE = rg.plan_regrasp(
    ELLIPSE, fingers(0.02, 0.35, 0.7), fingers(0.2, 0.5, 0.85), rg.Wrench([0, -3.0]), friction=0.5,
    orientations=1, candidates=60,
)  # fmt: skip


@pytest.mark.parametrize(
    ("plan", "change", "words"),
    [
        (STRAIGHT, put(-1.0, "record", "reserve"), "reserve: expected a number of at least 0, got -1.0"),
        (STRAIGHT, put(1.0, "record", "reserve"), "record.reserve: expected a number less than 1, got 1.0"),
        (STRAIGHT, put(1e300, "record", "reserve"), "reserve: expected a number less than 1, got 1e+300"),
        (STRAIGHT, put(-1.0, "record", "balancing"), "record.balancing: expected a number of at least 0"),
        (STRAIGHT, put(-1.0, "record", "choices", 0, "force_limits", 0), "force_limits[0]: expected a num"),
        (STRAIGHT, put(0.0, "record", "choices", 0, "force_limits", 0), "force_limits[0]: expected a num"),
        (STRAIGHT, put("x", "record", "choices", 0, "objective"), "objective: expected angle, force"),
        (STRAIGHT, put("", "record", "choices", 0, "method"), "record.choices[0].method: expected some text"),
        (STRAIGHT, put("", "record", "path"), "record.path: expected some text"),
        (BENT, put("x", "record", "path_objective"), "path_objective: expected change, effort, force"),
        (BENT, put(0.0, "record", "rate_limits", 0), "rate_limits[0]: expected a number greater than 0"),
        (BENT, put(-1.0, "record", "least_normals", 0), "least_normals[0]: expected a number of at least"),
        (BENT, put([1.0] * 2, "record", "rate_limits"), "rate_limits: expected 3 numbers or none, got 2"),
        (BENT, put([1.0] * 4, "record", "least_normals"), "least_normals: expected 3 numbers or none, got 4"),
        (STRAIGHT, put(True, "version"), "version: expected 1, got True"),
        (STRAIGHT, put(1.0, "version"), "version: expected 1, got 1.0"),
        (STRAIGHT, put("1", "version"), "version: expected 1, got '1'"),
        (STRAIGHT, put(True, "load", 0), "load[0]: expected a number, got True"),
        (STRAIGHT, put(10**400, "load", 0), "load[0]: "),
        (STRAIGHT, put(True, "scaling", "degree"), "scaling.degree: "),
        (STRAIGHT, put("\ud800", "contacts", 0, "name"), "a contact's name must be Unicode text"),
        (STRAIGHT, put(" ", "contacts", 0, "name"), "a contact's name must be a non-empty string"),
        (STRAIGHT, put("rotation", "kind"), "a rotation names the wrong fingers"),
        (WHOLE, put([], "steps"), "steps: expected at least 1 entries"),
        (WHOLE, lambda data: data["orientations"].pop(), "orientations: expected"),
        (WHOLE, put([[[1.0] * 3] * 3], "rotations"), "rotations: leave them out in the plane"),
    ],
)  # fmt: skip
def test_a_plan_file_of_impossible_values(plan, change, words, tmp_path: Path) -> None:
    write_plan(plan, tmp_path / "plan.json")
    data = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    change(data)
    (tmp_path / "plan.json").write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(rg.InvalidInput) as raised:
        read_plan(tmp_path / "plan.json")
    (line,) = str(raised.value).splitlines()
    assert line.startswith(f"{tmp_path / 'plan.json'}: ")
    assert words in line


@pytest.mark.parametrize("objective", ["angle", "force", "effort", "peak", "peak_normal", "friction_use"])
def test_every_objective_of_planning_is_read_back(objective, tmp_path: Path) -> None:
    plan = rg.plan_removal(GRASP, "P3", load=LOAD, objective=objective)
    write_plan(plan, tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json") == plan


@pytest.mark.parametrize("key", ["version", "kind", "start", "reserve", "duration", "friction"])
def test_a_key_that_comes_twice(key, tmp_path: Path) -> None:
    """A second value would take the place of the first, which a person reads."""
    file = tmp_path / "plan.json"
    write_plan(STRAIGHT, file)
    text = file.read_text(encoding="utf-8")
    at = text.index(f'"{key}"')
    end = text.index(",", at) if key != "start" else text.index('"end"', at) - 1
    entry = text[at:end].rstrip().rstrip(",")
    file.write_text(f"{text[:at]}{entry}, {text[at:]}", encoding="utf-8")
    assert json.loads(file.read_text(encoding="utf-8")) == json.loads(text)
    with pytest.raises(rg.InvalidInput, match=f"plan.json: the key '{key}' comes twice in one table"):
        read_plan(file)


def test_durations_that_no_force_can_follow_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "plan.json"
    write_plan(STRAIGHT, file)
    data = json.loads(file.read_text(encoding="utf-8"))
    for duration, good in (5e-324, False), (1e-308, False), (1e-300, True), (1e300, True):
        data["scaling"]["duration"] = duration
        file.write_text(json.dumps(data), encoding="utf-8")
        if good:
            assert rg.verify(read_plan(file)).ok
        else:
            with pytest.raises(rg.InvalidInput, match="falls faster than any number"):
                read_plan(file)


# -- set-points -----------------------------------------------------------------------------------------

PLANS = {"straight": STRAIGHT, "bent": BENT, "turn": TURN, "regrasp": WHOLE}


def verdict(file: Path, plan, rate=None) -> str:
    """``verified``, or what is wrong: on reading, or in a row."""
    try:
        steps = read_setpoints(file, plan, rate)
    except rg.InvalidInput as error:
        (line,) = str(error).splitlines()
        return line
    broken = [v for rows in steps for v in checked(plan, rows).violations]
    return "; ".join(broken) or "verified"


@pytest.fixture(params=PLANS)
def plan(request):
    return PLANS[request.param]


@pytest.fixture
def file(plan, tmp_path: Path) -> Path:
    write_setpoints(plan, tmp_path / "setpoints.csv", 20.0)
    return tmp_path / "setpoints.csv"


def rewritten(file: Path, change: Callable[[list[str]], list[str]]) -> None:
    header, *rows = file.read_text(encoding="utf-8").splitlines()
    file.write_text("\n".join([header, *change(rows)]) + "\n", encoding="utf-8")


def test_a_table_as_written_verifies_at_its_rate(plan, file: Path) -> None:
    assert verdict(file, plan) == "verified"
    assert verdict(file, plan, 20.0) == "verified"
    for rate in (19.0, 21.0, 40.0):
        assert "rows must come every" in verdict(file, plan, rate)
    for rate in (0.0, -1.0, inf):
        assert "rate must be" in verdict(file, plan, rate)


@pytest.mark.parametrize("rate", [0.3, 1.0, 3.0, 7.0, 33.3, 1000 / 3, 999.99])
def test_a_table_of_any_rate_verifies(plan, rate, tmp_path: Path) -> None:
    write_setpoints(plan, tmp_path / "setpoints.csv", rate)
    assert verdict(tmp_path / "setpoints.csv", plan) == "verified"
    assert verdict(tmp_path / "setpoints.csv", plan, rate) == "verified"


def test_rows_left_out(plan, file: Path) -> None:
    """Every other row is a table of half the rate; one row out of twenty is a hole."""
    count = 21
    for gone in (0, 1, 7, count - 2, count - 1):
        write_setpoints(plan, file, 20.0)
        rewritten(file, lambda rows, gone=gone: rows[:gone] + rows[gone + 1 :])
        assert verdict(file, plan) != "verified", gone
    write_setpoints(plan, file, 20.0)
    rewritten(file, lambda rows: [row for k, row in enumerate(rows) if k % count % 2 == 0])
    assert verdict(file, plan) == "verified"
    assert "rows must come every 0.05 s" in verdict(file, plan, 20.0)
    rewritten(file, lambda rows: rows[: len(rows) // 2])  # cut short
    assert verdict(file, plan) != "verified"


def test_rows_that_come_twice_or_in_another_order(plan, file: Path) -> None:
    for change in (
        lambda rows: [*rows[:5], rows[4], *rows[5:]],
        lambda rows: rows[::-1],
        lambda rows: [*rows[:5], rows[6], rows[5], *rows[7:]],
        lambda rows: rows + rows[-1:],
        lambda rows: [],
        lambda rows: rows[:1],
    ):
        write_setpoints(plan, file, 20.0)
        rewritten(file, change)
        assert verdict(file, plan) != "verified"


def test_columns_are_all_there_and_no_others(plan, file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    rows = [line.split(",") for line in text.splitlines()]
    for change in (
        [row[:-1] for row in rows],
        [row[1:] for row in rows],
        [[*row, "0"] for row in rows],
        [[*row[:-2], row[-1], row[-2]] for row in rows],
        [["time", *rows[0][1:]], *rows[1:]],
    ):
        file.write_text("\n".join(map(",".join, change)), encoding="utf-8")
        assert "expected the columns t," in verdict(file, plan)
    file.write_text("\n".join(map(",".join, [*rows[:3], rows[3][:-1], *rows[4:]])), encoding="utf-8")
    assert "expected rows of" in verdict(file, plan)


def test_forces_of_the_first_row_throughout(plan, file: Path) -> None:
    """In equilibrium, of a plan without load changes, and not the plan's."""

    def frozen(rows: list[str]) -> list[str]:
        table = [row.split(",") for row in rows]
        first = 1 if plan is not WHOLE and plan.turn is None else 2
        if plan is WHOLE:  # the second step
            here = [row for row in table if row[2] == "2"]
            for row in here:
                row[3:] = here[0][3:]
        else:
            for row in table:
                row[first:] = table[0][first:]
        return [",".join(row) for row in table]

    rewritten(file, frozen)
    words = "not in equilibrium" if plan is TURN else "is not the plan's at t = "
    assert words in verdict(file, plan)


def test_every_number_of_some_rows_changed(plan, file: Path) -> None:
    """By a millionth of the largest of its kind: time, angle, step, place or force."""
    header, *rows = file.read_text(encoding="utf-8").splitlines()
    table = [[float(x) for x in row.split(",")] for row in rows]
    for k in (0, 3, 20, len(table) - 1):
        for column in range(len(table[0])):
            for sign in (1, -1):
                changed = [list(row) for row in table]
                size = max(abs(row[column]) for row in table) or 1.0
                changed[k][column] += sign * 1e-6 * size
                lines = [",".join(map(repr, row)) for row in changed]
                file.write_text("\n".join([header, *lines]), encoding="utf-8")
                assert verdict(file, plan) != "verified", (k, header.split(",")[column])


def test_times_even_to_a_millionth_of_their_spacing(tmp_path: Path) -> None:
    """A finger at rest: forces are the same at every time, so that times alone are judged."""
    state = STRAIGHT.end.without("P3")
    plan = rg.Transition(state, state, STRAIGHT.scaling, STRAIGHT.record)
    file = tmp_path / "setpoints.csv"
    for off, good in (0.9e-6, True), (1.1e-6, False):
        for k in range(1, 20):
            for sign in (1, -1):
                write_setpoints(plan, file, 20.0)

                def moved(rows: list[str], k=k, by=sign * off * 0.05) -> list[str]:
                    t, rest = rows[k].split(",", 1)
                    rows[k] = f"{float(t) + by!r},{rest}"
                    return rows

                rewritten(file, moved)
                if k == 19:
                    continue  # by which the spacing is measured
                assert (verdict(file, plan) == "verified") == good, (off, k)


def test_angles_are_the_plans_to_a_billionth(tmp_path: Path) -> None:
    file = tmp_path / "setpoints.csv"
    for off, words in (0.9e-9, "not in equilibrium"), (1.1e-9, "angles must be the plan's"):
        for k in (0, 10, 20):
            write_setpoints(TURN, file, 20.0)

            def turned(rows: list[str], k=k, off=off) -> list[str]:
                t, angle, rest = rows[k].split(",", 2)
                rows[k] = f"{t},{float(angle) + off!r},{rest}"
                return rows

            rewritten(file, turned)
            assert words in verdict(file, TURN)


def test_a_short_step_late_in_a_long_regrasp(tmp_path: Path) -> None:
    """Times of a step of a millisecond after 1e6 s round by 1e-10 s; the rows are the plan's all the same."""
    first, *rest = WHOLE.steps
    slow = first.retimed(first.scaling.lasting(1e6))
    quick = [step.retimed(step.scaling.lasting(1e-3)) for step in rest]
    plan = rg.RegraspPlan((slow, *quick), WHOLE.orientations, WHOLE.margin)
    assert rg.verify(plan).ok
    file = tmp_path / "setpoints.csv"
    write_setpoints(plan, file, 0.01)
    assert verdict(file, plan) == "verified"


@pytest.mark.parametrize(
    "names",
    [("a,b", 'c"d', "e"), ("line\nbreak", "tab\t", "P"), ("ä“β”", "a\u2028b", "'"), ("a\r\nb", "#", "0")],
)
def test_names_of_any_letters_are_read_back(names, tmp_path: Path) -> None:
    grasp = rg.Grasp(c.named(name) for c, name in zip(GRASP, names, strict=True))
    plan = rg.plan_removal(grasp, names[2], load=LOAD)
    write_plan(plan, tmp_path / "plan.json")
    write_setpoints(plan, tmp_path / "setpoints.csv", 10.0)
    again = read_plan(tmp_path / "plan.json")
    assert again == plan
    assert verdict(tmp_path / "setpoints.csv", again) == "verified"
    rewritten_names = (tmp_path / "setpoints.csv").read_text(encoding="utf-8").replace("_fx", "_gx")
    (tmp_path / "setpoints.csv").write_text(rewritten_names, encoding="utf-8", newline="")
    assert "expected the columns t," in verdict(tmp_path / "setpoints.csv", again)


@pytest.mark.parametrize("text", ["", "\n", "t", "\x00", "t,P1_fx\n1", '"', "t," * 100_000, "\n" * 1000])
def test_text_that_is_no_table(text, tmp_path: Path) -> None:
    (tmp_path / "setpoints.csv").write_text(text, encoding="utf-8")
    assert "setpoints.csv: expected" in verdict(tmp_path / "setpoints.csv", STRAIGHT)


@pytest.mark.parametrize("text", ["nan", "inf", "1e999", "", " ", "0x1", "1;2"])
def test_entries_that_are_no_numbers(plan, file: Path, text) -> None:
    rewritten(file, lambda rows: [rows[0], ",".join([*rows[1].split(",")[:-1], text]), *rows[2:]])
    assert "expected rows of" in verdict(file, plan)
    assert np.isfinite(plan.duration)
