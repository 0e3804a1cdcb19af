"""What is wrong with a scenario's forces and task is said in one message, and leaves no file."""

import re
from pathlib import Path

import pytest

from regrasp.programs import available_backends
from scenarios import check_refused, edited

pytestmark = pytest.mark.contract

METHODS = ", ".join(("auto", "closed-form", *available_backends()))

# name -> (scenario, exit status, message); every line of a message starts with the file's name.
P2 = edited().split("\n\n")[5]
NO_EQUILIBRIUM = (
    "start: the forces are no equilibrium inside the friction cones and limits; the nearest one differs "
    "by {}, more than 0.001 of the largest force {}; correct them, or allow more by balance_tolerance"
)
NO_FORCES = (
    ("force = [3.7897, 3.0034]", ""),
    ("force = [-3.0096, 4.4156]", ""),
    ("force = [0.7199, -3.9190]", ""),
)


def loaded_at(*times: float) -> str:
    """The example with its load given at times."""
    text = edited()
    head, rest = text.split("[load]", 1)
    _, contacts = rest.split("\n\n", 1)
    entries = "\n".join(f"[[load]]\ntime = {t}\nforce = [-1.5, -3.5]\n" for t in times)
    return f"{head}{entries}\n{contacts}"


SCENARIOS: dict[str, tuple[str, int, list[str | re.Pattern[str]]]] = {
    "force of one contact missing": (
        edited(("force = [-3.0096, 4.4156]", "")),
        2,
        ["contacts[1].force: a required key is missing; others have it, so give it to all or none"],
    ),
    "end force of one contact missing": (
        edited(("force = [-3.0096, 4.4156]", "force = [-3.0096, 4.4156]\nend_force = [-0.3557, 1.0445]")),
        2,
        ["contacts[0].end_force: a required key is missing; others have it, so give it to all or none"],
    ),
    "end force of the finger that leaves": (
        edited(("force = [0.7199, -3.9190]", "end_force = [0.0, 0.0]")),
        2,
        [
            "contacts[2].force: a required key is missing; others have it, so give it to all or none",
            "contacts[2].end_force: P3 leaves, so it ends without force; leave it out",
        ],
    ),
    "starting force of the finger that arrives": (
        edited(('kind = "removal"', 'kind = "addition"')),
        2,
        ["contacts[2].force: P3 arrives, so it starts without force; leave it out"],
    ),
    "forces far from equilibrium": (
        edited(("force = [3.7897, 3.0034]", "force = [3.9, 3.0034]")),
        2,
        [NO_EQUILIBRIUM.format("0.0506", "5.344")],
    ),
    "starting force outside its cone": (
        edited(("force = [0.7199, -3.9190]", "force = [0.7199, 3.9190]")),
        2,
        [NO_EQUILIBRIUM.format("4.61", "5.344")],
    ),
    "task missing": (
        edited().split("[task]")[0],
        2,
        ["task: a required key is missing"],
    ),
    "kind missing": (
        edited(('kind = "removal"', "")),
        2,
        [
            "task.kind: expected 'removal' or 'addition' or 'exchange' or 'hold' or 'rotation' or 'regrasp', "
            "found no such key"
        ],
    ),
    "kind not planned yet": (
        edited(('kind = "removal"', 'kind = "juggling"')),
        2,
        [
            "task.kind: expected 'removal' or 'addition' or 'exchange' or 'hold' or 'rotation' or 'regrasp', "
            "got 'juggling'"
        ],
    ),
    "unknown contact": (
        edited(('contact = "P3"', 'contact = "P4"')),
        2,
        ["task.contact: expected one of P1, P2, P3, got 'P4'"],
    ),
    "unknown objective": (
        edited(('objective = "angle"', 'objective = "safest"')),
        2,
        [
            "task.objective: expected 'angle', 'force', 'effort', 'peak', 'peak_normal', 'friction_use', "
            "'sum_normal' or 'wrench', got 'safest'"
        ],
    ),
    "unknown method": (
        edited(('objective = "angle"', 'method = "magic"')),
        2,
        [f"task.method: method must be one of {METHODS}; got 'magic'"],
    ),
    "unknown key of the task": (
        edited(("duration = 1.0", "time = 1.0")),
        2,
        [
            "task.time: unknown key; known here: objective, method, facets, duration, rate, scaling, "
            "control, max_force, peak_ratio, reserve, balance_tolerance, min_normal, stiffness, rate_limit, "
            "path_objective, instants, contact, early_loss, whole_objective, idle_time, kind"
        ],
    ),
    "no duration": (
        edited(("duration = 1.0", "duration = 0.0")),
        2,
        ["task.duration: expected a number greater than 0, got 0.0"],
    ),
    "negative rate": (
        edited(("rate = 1000.0", "rate = -1000.0")),
        2,
        ["task.rate: expected a number greater than 0, got -1000.0"],
    ),
    "more set-points than anybody wants": (
        edited(("rate = 1000.0", "rate = 1e12")),
        2,
        ["rate 1e+12 for 1 s makes 1e+12 set-points; at most 1e+08 are made"],
    ),
    "load at times that do not start at zero": (
        loaded_at(0.1, 1.0),
        2,
        ["load: times of a load must rise from 0, two or more; got [0.1, 1.0]"],
    ),
    "load at one time": (
        loaded_at(0.0),
        2,
        ["load: expected at least 2 entries, got [{'time': 0.0, 'force': [-1.5, -3.5]}]"],
    ),
    "load at times and another duration": (
        loaded_at(0.0, 2.0),
        2,
        ["task.duration: expected 2, the last time of the load, or nothing; got 1"],
    ),
    "rates too slow for any path": (
        edited(("duration = 1.0", "duration = 1.0\nrate_limit = 1.0")),
        3,
        [
            re.compile(
                r"the forces would have to change at 4\.\d+ times the rate limits: allow faster changes, "
                r"a longer duration or other ends; with rate limits 4\.\d+ times as high, it would do"
            )
        ],
    ),
    "a finger idle after the end": (
        edited(("duration = 1.0", "duration = 1.0\nidle_time = 1.5")),
        2,
        ["the finger's idle time must lie inside (0, 1) s, got 1.5"],
    ),
    "control values that rise": (
        edited(("control = [1.0, 1.0, 0.5, 0.0, 0.0]", "control = [1.0, 0.5, 0.6, 0.0]")),
        2,
        ["task.control: control values must fall from 1 to 0, got (1.0, 0.5, 0.6, 0.0)"],
    ),
    "control values of no spline": (
        edited(('scaling = "spline"', 'scaling = "linear"')),
        2,
        ["task: control belongs to scaling 'spline', got scaling 'linear'"],
    ),
    "peak ratio below 1": (
        edited(("duration = 1.0", "peak_ratio = 0.9")),
        2,
        ["task.peak_ratio: expected a number of at least 1, got 0.9"],
    ),
    "the whole friction in reserve": (
        edited(("duration = 1.0", "reserve = 1.0")),
        2,
        ["task.reserve: expected a number less than 1, got 1.0"],
    ),
    "zero load": (
        edited(
            ("force = [-1.5, -3.5]", "force = [0, 0]"),
            *NO_FORCES,
        ),
        2,
        [
            "objective 'angle' under a zero load needs max_force: any squeeze holds it, so no force follows "
            "from the load"
        ],
    ),
    "everything at once": (
        edited(
            ("torque = 0.0", "torque = '0'"),
            ("normal = [1.0, 1.0]", "normal = [1.0, nan]"),
            ("friction = 0.3", "friction = -1"),
            ('kind = "removal"', 'kind = "addition"\nkin = 1'),
            ("rate = 1000.0", "rate = 0"),
        ),
        2,
        [
            "load.torque: expected a number, got '0'",
            "contacts[0].normal[1]: expected a finite number, got nan",
            "contacts[0].friction: expected a number of at least 0, got -1",
            "task.rate: expected a number greater than 0, got 0",
            "task.kin: unknown key; known here: objective, method, facets, duration, rate, scaling, "
            "control, max_force, peak_ratio, reserve, balance_tolerance, min_normal, stiffness, rate_limit, "
            "path_objective, instants, contact, early_loss, whole_objective, idle_time, kind",
        ],
    ),
    "infeasible removal": (
        edited(('contact = "P3"', 'contact = "P1"')),
        3,
        [
            "no forces of P2, P3 inside their friction cones balance Wrench(force=(-1.5, -3.5), torque=0): "
            "the object escapes by turning counter-clockwise about (4.13793, -5.7931); with a friction of at "
            "least 0.308 at every contact, it would do"
        ],
    ),
    "force limit too low": (
        edited(("duration = 1.0", "max_force = 1.0"), *NO_FORCES),
        3,
        [
            re.compile(
                r"no forces of P1, P2 inside their friction cones and force limits \(P1 1, P2 1\) balance "
                r"Wrench\(force=\(-1\.5, -3\.5\), torque=0\): the object escapes by turning "
                r"counter-clockwise about \(42\.6\d*, -30\.4\d*\); the cones alone would hold it with "
                r"larger forces; with force limits of at least \d\.?\d*, it would do"
            )
        ],
    ),
    "reserve too large": (
        edited(("duration = 1.0", "reserve = 0.9")),
        3,
        [
            "no forces of P1, P2 that balance Wrench(force=(-1.5, -3.5), torque=0) were found with 0.9 of "
            "the friction kept in reserve, and no motion proves that there are none without it: the load "
            "needs more friction than that leaves, or is at the limit of what they can hold; choose a "
            "smaller reserve; with a friction of at least 1.83 at every contact, or with a reserve at most "
            "0.433 times as large, it would do"
        ],
    ),
    "infeasible start of an addition": (
        edited(('kind = "removal"', 'kind = "addition"'), ('contact = "P3"', 'contact = "P2"'), *NO_FORCES),
        3,
        [
            "no forces of P1, P3 inside their friction cones balance Wrench(force=(-1.5, -3.5), torque=0): "
            "the object escapes by turning clockwise about (-4, -4); with a friction of at least 0.412 at "
            "every contact, it would do"
        ],
    ),
    "two fingers, one leaves": (
        edited((P2, ""), NO_FORCES[0], NO_FORCES[2]),
        3,
        [
            "no forces of P1 balance Wrench(force=(-1.5, -3.5), torque=0): none resists turning about P1, "
            "about which the load has a torque; the object escapes by turning clockwise about (-4, -4); "
            "no friction helps"
        ],
    ),
}


@pytest.mark.parametrize("name", SCENARIOS)
def test_bad_task(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    check_refused(capsys, *SCENARIOS[name])
