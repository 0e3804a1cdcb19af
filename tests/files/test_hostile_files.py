"""Endless, huge, deep and strange files and devices: one error in bounded time and memory."""

import json
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from refusals import refusal
from regrasp.files import (
    parse_scenario,
    plan_scenario,
    read_plan,
    read_regions,
    read_scenario,
    write_plan,
    write_setpoints,
)
from regrasp.files.plans.setpoints import read_setpoints
from regrasp.files.scenarios.templates import NAMES, template
from scenarios import PAPER, edited
from values import removal

pytestmark = pytest.mark.contract

READERS: dict[str, Callable[[Path], object]] = {
    "scenario": read_scenario,
    "plan": read_plan,
    "regions": read_regions,
    "set-points": lambda path: read_setpoints(path, removal()),
}
DEVICES = [path for path in ("/dev/zero", "/dev/urandom", "/dev/null", "/dev/full") if Path(path).exists()]


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("device", DEVICES)
def test_device_is_refused_soon(reader: str, device: str) -> None:
    started = time.monotonic()
    said = refusal(lambda: READERS[reader](Path(device)))
    assert said is not None
    assert device in said
    assert time.monotonic() - started < 10


@pytest.mark.parametrize("reader", READERS)
def test_memory_is_bounded(reader: str) -> None:
    """A process that reads a device to its limit grows by less than 1 GiB."""
    if not DEVICES:
        pytest.skip("no devices")
    code = (
        "import resource, regrasp as rg\n"
        "from pathlib import Path\n"
        "from regrasp.files import read_plan, read_scenario\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        f"read = {{'scenario': read_scenario}}.get({reader!r}, read_plan)\n"
        "try: read(Path('/dev/zero'))\n"
        "except rg.InvalidInput: pass\n"
        "else: raise SystemExit('taken')\n"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 2**20  # KiB


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
@pytest.mark.parametrize("reader", READERS)
def test_pipe_that_nobody_writes_to(reader: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("regrasp.files.source._PATIENCE", 0.3)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    held = os.open(pipe, os.O_RDWR)  # somebody has it open, and says nothing
    try:
        said = refusal(lambda: READERS[reader](pipe))
    finally:
        os.close(held)
    assert said is not None
    assert said.startswith(f"{pipe}: expected ")
    assert said.endswith("nothing came within 0.3 s")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_pipe_that_brings_a_scenario_is_read(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    writer = threading.Thread(target=pipe.write_text, args=(PAPER,))
    writer.start()
    try:
        assert read_scenario(pipe) == parse_scenario(PAPER, pipe)
    finally:
        writer.join()


@pytest.mark.parametrize("reader", READERS)
def test_file_with_a_hole_of_a_terabyte(reader: str, tmp_path: Path) -> None:
    path = tmp_path / "sparse"
    with path.open("wb") as file:
        file.truncate(2**40)
    said = refusal(lambda: READERS[reader](path))
    assert said is not None
    assert "found more than" in said


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize(
    "content",
    [
        b"", b"\0", b"\xff\xfe", b"\xef\xbb\xbf", b"[" * 100_000, b'{"a":' * 100_000,
        b"a." * 50_000 + b"b = 1", b"[" + b"a ." * 50_000 + b"b]", b"x = {a." + b"b." * 500 + b"c = 1}",
        b"x = " + b"9" * 5000, b"x = " + b"[" * 5000 + b"]" * 5000, b"9" * 5000, b'"' + b"x" * 10**6 + b'"',
        b"t," * 10**6, b"\n" * 10**6, b"x = 1e999", b"NaN", b"null", b"[]", b"0", b"true", b'"text"',
        b'{"format": "regrasp plan", "version": 1}', b"a = 1\na = 2", b"x = 0001-01-01", b"\r\r\r",
    ],
)  # fmt: skip
def test_strange_content_is_one_error(reader: str, content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "strange"
    path.write_bytes(content)
    started = time.monotonic()
    said = refusal(lambda: READERS[reader](path))
    assert said is not None
    assert all(line.startswith(str(path)) and len(line) < 1000 for line in said.splitlines())
    assert time.monotonic() - started < 10


# -- numbers in scenarios -------------------------------------------------------------------------------

HUGE = [
    "1e308",
    "-1e308",
    "1e200",
    "1e-308",
    "5e-324",
    "1e999",
    "inf",
    "nan",
    "9" * 400,
    "0",
    "-1",
    "1e12",
    "1000000000000",
]


def numbers_of(text: str) -> Iterator[tuple[int, int]]:
    """Where the numbers of a scenario stand, comments left out."""
    at = 0
    for line in text.splitlines(keepends=True):
        code = line.split("#")[0]
        if "=" in code:
            for found in re.finditer(r"(?<![\w.\"-])-?\d+(\.\d+)?(?![\w.\"])", code):
                yield at + found.start(), at + found.end()
        at += len(line)


@pytest.mark.filterwarnings("ignore:the (point|contact) :UserWarning")  # some are between two walls, or far
@pytest.mark.parametrize("name", NAMES)
def test_any_number_may_be_huge(name: str) -> None:
    """Each number of a scenario in turn is replaced; reading ends in time, well or in words."""
    text = template(name)
    places = list(numbers_of(text))
    assert len(places) > 5
    for first, last in places:
        for wrong in HUGE:
            started = time.monotonic()
            said = refusal(lambda: parse_scenario(text[:first] + wrong + text[last:]))  # noqa: B023
            assert time.monotonic() - started < 10
            if said is not None:
                assert all(len(line) < 1000 for line in said.splitlines())


COUNTS = ["rate", "instants", "facets", "candidates", "orientations", "seed"]


def worked(text: str) -> None:
    """From a scenario to its set-points."""
    scenario = parse_scenario(text)
    write_setpoints(plan_scenario(scenario), os.devnull, scenario.task.rate)


@pytest.mark.parametrize("name", ["removal", "space-removal", "regrasp", "space-regrasp"])
@pytest.mark.parametrize("key", COUNTS)
@pytest.mark.parametrize("count", ["1000000000000", "9" * 400, "1e15"])
def test_huge_counts_end_before_the_work(name: str, key: str, count: str) -> None:
    text = template(name)
    lines = [line for line in text.splitlines() if not line.lstrip("# ").startswith(f"{key} =")]
    started = time.monotonic()
    said = refusal(lambda: worked("\n".join([*lines, f"{key} = {count}"])))
    assert said is not None or (key == "seed" and name == "space-regrasp")  # any whole number is a seed
    assert time.monotonic() - started < 30


# -- any name -------------------------------------------------------------------------------------------

NAMES_OF_FINGERS = st.text(st.characters(codec="utf-8"), min_size=1, max_size=12).filter(str.strip)


@settings(max_examples=60)
@given(st.lists(NAMES_OF_FINGERS, min_size=3, max_size=3, unique=True))
def test_set_points_of_any_names_read_back(
    tmp_path_factory: pytest.TempPathFactory, names: list[str]
) -> None:
    plan = removal()
    grasp = rg.Grasp(c.named(name) for c, name in zip(plan.grasp, names, strict=True))
    start, end = (rg.GraspState(grasp, s.load, s.forces) for s in (plan.start, plan.end))
    data = plan.to_dict()
    for contact, name in zip(data["contacts"], names, strict=True):
        contact["name"] = name
    named = rg.Transition.from_dict(data | {"contact": names[2]})
    assert (named.start, named.end) == (start, end)
    folder = tmp_path_factory.mktemp("names")
    write_plan(named, folder / "plan.json")
    write_setpoints(named, folder / "setpoints.csv", 20.0)
    assert read_plan(folder / "plan.json") == named
    (rows,) = read_setpoints(folder / "setpoints.csv", named)
    assert rows.forces.shape == (21, 3, 2)
    assert (rows.forces == named.forces(rows.times)).all()


@pytest.mark.parametrize("name", ["a,b", 'say "hi"', "two\nlines", "b\r", "'", ",", '"', "a\r\nb", " x "])
def test_listed_names(name: str, tmp_path: Path) -> None:
    scenario = parse_scenario(edited(('name = "P1"', f"name = {json.dumps(name)}")))
    plan = plan_scenario(scenario)
    write_setpoints(plan, tmp_path / "setpoints.csv", 10.0)
    assert read_setpoints(tmp_path / "setpoints.csv", plan)[0].times.size == 11


# -- one for each finger --------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["removal", "addition"])
@pytest.mark.parametrize("arriving", [0, 1, 2])
def test_rate_limits_are_of_the_contacts_as_listed(kind: str, arriving: int) -> None:
    """The same three fingers in any order: each keeps its own limit, and one of them is reached."""
    names = ["left", "right"]
    text = template(kind)
    head, *blocks = text.split("[[contacts]]")
    last, task = blocks[2].split("[task]")
    blocks = [blocks[0], blocks[1]]
    blocks.insert(arriving, last.split("# No contact")[0])
    names.insert(arriving, "below")
    limits = {"left": 8.0, "right": 9.0, "below": 3.0}
    whole = head + "".join(f"[[contacts]]{block}" for block in blocks) + "[task]" + task
    whole = whole.replace("duration = 1.0", f"rate_limit = {[limits[name] for name in names]}")
    plan = plan_scenario(parse_scenario(whole))
    assert isinstance(plan, rg.Transition)
    use = [plan.steepest[i] / limits[name] for i, name in enumerate(plan.grasp.names)]
    assert max(use) == pytest.approx(1.0)
    assert rg.verify(plan).ok


def test_list_of_another_length_is_refused() -> None:
    text = edited(("rate = 1000.0", "rate_limit = [1.0, 2.0]"))
    assert refusal(lambda: parse_scenario(text)) == (
        "scenario: task.rate_limit: expected a number, or 3 numbers, one for each contact; got 2"
    )


@pytest.mark.parametrize(
    "wrong", ["[]", "[1.0, -1.0, 2.0]", "[1.0, 'x', 2.0]", "'x'", "0.0", "[[1.0], [2.0], [3.0]]", "true"]
)
def test_wrong_limits_are_refused_by_key(wrong: str) -> None:
    said = refusal(lambda: parse_scenario(edited(("rate = 1000.0", f"rate_limit = {wrong}"))))
    assert said is not None
    assert said.startswith("scenario: task.rate_limit")
