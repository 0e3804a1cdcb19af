"""What is wrong with a scenario's file, numbers and contacts is said in one message, and leaves no file."""

import re
from pathlib import Path

import pytest

from scenarios import check_refused, edited

pytestmark = pytest.mark.contract


# name -> (scenario, exit status, message); every line of a message starts with the file's name.
P2 = edited().split("\n\n")[5]
SCENARIOS: dict[str, tuple[str, int, list[str | re.Pattern[str]]]] = {
    "not TOML": (
        "[load\nforce = [1, 2]",
        2,
        ["not TOML: Expected ']' at the end of a table declaration (at line 1, column 6)"],
    ),
    "empty": (
        "",
        2,
        ["task: a required key is missing: a table with a kind, as grasp or regrasp"],
    ),
    "key given twice": (
        edited(("torque = 0.0 ", "torque = 0.0\ntorque = 1.0 ")),
        2,
        ["not TOML: Cannot overwrite a value (at line 16, column 13)"],
    ),
    "NaN in the load": (
        edited(("force = [-1.5, -3.5]", "force = [nan, -3.5]")),
        2,
        ["load.force[0]: expected a finite number, got nan"],
    ),
    "infinite torque": (
        edited(("torque = 0.0", "torque = inf")),
        2,
        ["load.torque: expected a finite number, got inf"],
    ),
    "infinite position": (
        edited(("position = [4.0, -5.0]", "position = [4.0, -inf]")),
        2,
        ["contacts[1].position[1]: expected a finite number, got -inf"],
    ),
    "NaN friction": (
        edited(("friction = 0.3", "friction = nan")),
        2,
        ["contacts[0].friction: expected a finite number, got nan"],
    ),
    "negative friction": (
        edited(("friction = 0.3", "friction = -0.3")),
        2,
        ["contacts[0].friction: expected a number of at least 0, got -0.3"],
    ),
    "friction as text": (
        edited(("friction = 0.3", 'friction = "0.3"')),
        2,
        ["contacts[0].friction: expected a number, got '0.3'"],
    ),
    "friction as truth value": (
        edited(("friction = 0.3", "friction = true")),
        2,
        ["contacts[0].friction: expected a number, got True"],
    ),
    "a number no double holds": (
        edited(("friction = 0.3", f"friction = 1{'0' * 400}")),
        2,
        [f"contacts[0].friction: expected a number, got 1{'0' * 56}..."],
    ),
    "zero force limit": (
        edited(("friction = 0.3", "friction = 0.3\nmax_force = 0.0")),
        2,
        ["contacts[0].max_force: expected a number greater than 0, got 0.0"],
    ),
    "zero normal": (
        edited(("normal = [-1.0, 2.0]", "normal = [0.0, 0.0]")),
        2,
        [
            "contacts[1]: contact 'P2': normal must not be zero; "
            "give the direction that points into the object"
        ],
    ),
    "blank name": (
        edited(('name = "P2"', 'name = " "')),
        2,
        ["contacts[1]: a contact's name must be a non-empty string, got ' '"],
    ),
    "empty name": (
        edited(('name = "P2"', 'name = ""')),
        2,
        ["contacts[1].name: expected some text, got ''"],
    ),
    "name that is a number": (
        edited(('name = "P2"', "name = 2")),
        2,
        ["contacts[1].name: expected text, got 2"],
    ),
    "same name twice": (
        edited(('name = "P2"', 'name = "P1"')),
        2,
        ["contacts: contacts of one grasp must have different names, 'P1' came twice"],
    ),
    "coincident contacts": (
        edited(
            ("position = [4.0, -5.0]", "position = [-4.0, -4.0]"),
            ("normal = [-1.0, 2.0]", "normal = [1.0, 1.0]"),
        ),
        2,
        ["contacts: contacts 'P1' and 'P2' coincide at [-4.0, -4.0]; place them at different points"],
    ),
    "contact in space": (
        edited(("position = [4.0, -5.0]", "position = [4.0, -5.0, 0.0]")),
        2,
        ["contacts[1]: contact 'P2': position and normal must have the same dimension, got 3 and 2"],
    ),
    "one coordinate": (
        edited(("position = [4.0, -5.0]", "position = [4.0]")),
        2,
        ["contacts[1].position: expected at least 2 entries, got [4.0]"],
    ),
    "position as a number": (
        edited(("position = [4.0, -5.0]", "position = 4.0")),
        2,
        ["contacts[1].position: expected a list, got 4.0"],
    ),
    "position missing": (
        edited(("position = [4.0, -5.0]", "")),
        2,
        ["contacts[1].position: a required key is missing"],
    ),
    "unknown key of a contact": (
        edited(("friction = 0.3", "friktion = 0.3")),
        2,
        [
            "contacts[0].friction: a required key is missing",
            "contacts[0].friktion: unknown key; known here: "
            "name, position, normal, friction, max_force, torsion, limits, force, end_force",
        ],
    ),
    "contacts as one table": (
        "[contacts]\nname = 'P1'\n[load]\nforce = [0, -1]\n[task]\nkind = 'removal'\ncontact = 'P1'",
        2,
        ["contacts: expected a list, got {'name': 'P1'}"],
    ),
    "one contact only": (
        "[load]\nforce = [0, -1]\n[task]\nkind = 'removal'\ncontact = 'P1'\n"
        "[[contacts]]\nname = 'P1'\nposition = [0, 0]\nnormal = [0, 1]\nfriction = 1",
        2,
        [
            "contacts: expected at least 2 entries, "
            "got [{'name': 'P1', 'position': [0, 0], 'normal': [0, 1], 'fr..."
        ],
    ),
}


@pytest.mark.parametrize("name", SCENARIOS)
def test_bad_scenario(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    check_refused(capsys, *SCENARIOS[name])
