"""``regrasp verify``: names forge no line, any numbers end in words, and statuses are as documented."""

import json
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

import regrasp as rg
from regrasp.files import write_plan, write_setpoints
from scenarios import edited, regrasp

pytestmark = pytest.mark.contract

FORGED = "x\nverified in exact arithmetic\neach of 9999 set-points verified too\r\x1b[2J\u2028y"
GRASP = rg.Grasp(
    rg.Contact(r, n, 0.3, name=name)
    for name, r, n in (("P1", [-4, -4], [1, 1]), ("P2", [4, -5], [-1, 2]), ("P3", [0, 8], [0, -1]))
)
PLAN = rg.plan_removal(GRASP, "P3", load=rg.Wrench([-1.5, -3.5]))
TURN = rg.plan_rotation(GRASP.without("P3"), 0.2, load=rg.Wrench([-1.5, -3.5]))
BENT = rg.plan_removal(GRASP, "P3", load=PLAN.start.load, rate_limit=10.0, duration=1.0, instants=5)


def stored(folder: Path, plan=PLAN, rate: float = 10.0) -> Path:
    write_plan(plan, folder / "plan.json")
    write_setpoints(plan, folder / "setpoints.csv", rate)
    return folder


def changed(folder: Path, change) -> None:
    file = folder / "plan.json"
    data = json.loads(file.read_text(encoding="utf-8"))
    change(data)
    file.write_text(json.dumps(data), encoding="utf-8")


def renamed(plan=PLAN) -> rg.Transition:
    grasp = rg.Grasp([plan.grasp[0].named(FORGED), *plan.grasp.contacts[1:]])
    return rg.plan_removal(grasp, "P3", load=plan.start.load)


def forged(text: str) -> list[str]:
    """Lines that only a name could have made."""
    return [line for line in text.splitlines() if line.startswith(("y", "each of 9999"))]


def test_a_name_forges_no_line_of_a_verdict(tmp_path: Path, capsys) -> None:
    stored(tmp_path, renamed())
    status, out, err = regrasp(capsys, "verify", tmp_path)
    assert (status, err) == (0, "")
    assert out.count("\nverified in exact arithmetic") == 1
    assert forged(out) == []
    assert r"x\nverified in exact arithmetic\neach of 9999 set-points verified too\r\x1b[2J\u2028y" in out
    assert all(character.isprintable() or character == "\n" for character in out)


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data["start"][0].__setitem__(0, -9.0),
        lambda data: data["record"].update(least_normals=[99.0, 0.0, 0.0]),
        lambda data: data["contacts"][0].update(max_force=1e-3),
        lambda data: data.update(contact=FORGED),
        lambda data: data["record"]["choices"][0]["force_limits"].__setitem__(0, 1e-3),
    ],
)
def test_a_name_forges_no_line_of_what_is_wrong(change, tmp_path: Path, capsys) -> None:
    stored(tmp_path, renamed())
    changed(tmp_path, change)
    status, out, err = regrasp(capsys, "verify", tmp_path)
    assert status == 1
    assert "verified in exact arithmetic" not in [line.strip() for line in (out + err).splitlines()]
    assert forged(out + err) == []


def test_a_name_forges_no_line_of_an_error(tmp_path: Path, capsys) -> None:
    stored(tmp_path, renamed())
    changed(tmp_path, lambda data: data.update(contact="P9"))
    status, out, err = regrasp(capsys, "verify", tmp_path)
    assert (status, out) == (2, "")
    assert len(err.splitlines()) == 1
    stored(tmp_path, renamed())
    table = (tmp_path / "setpoints.csv").read_text(encoding="utf-8")
    (tmp_path / "setpoints.csv").write_text(table.replace("_fx", "_x"), encoding="utf-8", newline="")
    status, out, err = regrasp(capsys, "verify", tmp_path)
    assert status == 2
    assert len(err.splitlines()) == 1


def test_a_name_or_a_title_forges_no_line_of_a_plan(tmp_path: Path, capsys) -> None:
    scenario = tmp_path / "scenario.toml"
    title = ('title = "', r'title = "all\nverified in exact ')
    text = edited(('name = "P1"', f"name = {json.dumps(FORGED)}"), title)
    scenario.write_text(text, encoding="utf-8")
    status, out, _ = regrasp(capsys, "plan", scenario, "-o", tmp_path / "out", "--no-figures")
    assert status == 0
    assert out.startswith(r"all\nverified in exact ")
    assert forged(out) == []
    assert out.count("\nverified in exact arithmetic") == 1
    assert regrasp(capsys, "verify", tmp_path / "out")[0] == 0


def test_half_a_character_is_bad_input(tmp_path: Path, capsys) -> None:
    stored(tmp_path)
    for change in (
        lambda data: data["contacts"][0].update(name="\ud800"),
        lambda data: data.update(contact="\udfff"),
        lambda data: data["record"]["choices"][0].update(objective="\ud800"),
        lambda data: data.update({"\ud800": 1}),
    ):
        stored(tmp_path)
        changed(tmp_path, change)
        status, out, err = regrasp(capsys, "verify", tmp_path)
        assert (status, out) == (2, "")
        assert len(err.splitlines()) == 1


def test_statuses_are_as_documented(tmp_path: Path, capsys) -> None:
    stored(tmp_path)
    assert regrasp(capsys, "verify", tmp_path)[0] == 0
    assert regrasp(capsys, "verify", tmp_path, "--rate", "10")[0] == 0
    status, _, err = regrasp(capsys, "verify", tmp_path, "--rate", "20")
    assert (status, err.count("rows must come every 0.05 s")) == (2, 1)
    table = tmp_path / "setpoints.csv"
    rows = table.read_text().splitlines()
    table.write_text(
        "\n".join([*rows[:5], ",".join([rows[5].split(",")[0], *rows[4].split(",")[1:]]), *rows[6:]])
    )
    status, out, err = regrasp(capsys, "verify", tmp_path)
    assert status == 1
    assert "set-point 4: force of P1 is not the plan's at t = 0.4 s" in err
    assert "set-points in" not in out
    table.write_text("\n".join(rows[:-1]))
    assert regrasp(capsys, "verify", tmp_path)[0] == 2
    table.unlink()
    assert regrasp(capsys, "verify", tmp_path)[0] == 0
    (tmp_path / "plan.json").write_text("{}")
    assert regrasp(capsys, "verify", tmp_path)[0] == 2


@pytest.mark.parametrize("plan", [PLAN, TURN, BENT], ids=["straight", "turn", "bent"])
def test_any_number_anywhere_ends_in_words(plan, tmp_path: Path, capsys) -> None:
    """Every number of a plan in turn is something that no plan has: words, no traceback or warning."""
    write_plan(plan, tmp_path / "plan.json")
    text = (tmp_path / "plan.json").read_text(encoding="utf-8")
    places = list(numbers(json.loads(text), ()))
    odd = [1e308, -1e308, 1e200, 1e-200, 5e-324, 0.0, -1.0, 10**400, True, None, "x", [], {}, [[]]]
    rng = random.Random(0)
    seen = set()
    for place in places:
        for value in rng.sample(odd, 2):
            data = json.loads(text)
            at = data
            for key in place[:-1]:
                at = at[key]
            at[place[-1]] = value
            (tmp_path / "plan.json").write_text(json.dumps(data), encoding="utf-8")
            status, _, err = regrasp(capsys, "verify", tmp_path)
            assert status in (0, 1, 2), (place, value)
            assert "Traceback" not in err
            assert (err == "") == (status == 0)
            seen.add(status)
    assert seen == {0, 1, 2}


def numbers(data, place):
    """Keys of every number."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield from numbers(value, (*place, key))
    elif isinstance(data, list):
        for k, value in enumerate(data):
            yield from numbers(value, (*place, k))
    elif isinstance(data, (int, float)):
        yield place


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device here")
def test_output_to_a_full_device_is_a_message(tmp_path: Path) -> None:
    stored(tmp_path)
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "regrasp", "verify", str(tmp_path)],
            stdout=full, stderr=subprocess.PIPE, text=True, env=os.environ, check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr == "Error: output cannot be written: No space left on device\n"


def test_letters_that_a_terminal_does_not_know_are_escaped(tmp_path: Path) -> None:
    grasp = rg.Grasp([GRASP[0].named("β"), *GRASP.contacts[1:]])
    stored(tmp_path, rg.plan_removal(grasp, "P3", load=PLAN.start.load))
    done = subprocess.run(
        [sys.executable, "-m", "regrasp", "verify", str(tmp_path)],
        capture_output=True, text=True, env=os.environ | {"PYTHONIOENCODING": "latin-1"}, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert r"\u03b2" in done.stdout
