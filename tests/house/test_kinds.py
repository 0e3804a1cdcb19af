"""Every test file says what kind of evidence it is, in one mark that ``pytest -m`` selects by."""

import ast
import re
import tomllib
from pathlib import Path
from typing import ClassVar

import pytest

from places import ROOT, TESTS
from slowness import ALLOWED, mark, relisted, slow

pytestmark = pytest.mark.architecture

MARKERS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["pytest"][
    "ini_options"
]["markers"]
KINDS = [name for marker in MARKERS if (name := marker.partition(":")[0]) != "slow"]


def kinds_in(source: str) -> list[str]:
    """The kinds that a test file gives to all of its tests, by ``pytestmark`` at its top level."""
    marks = [
        node.value
        for node in ast.parse(source).body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "pytestmark"
    ]
    found = [n.attr for mark in marks for n in ast.walk(mark) if isinstance(n, ast.Attribute)]
    return [name for name in found if name in KINDS]


def complaint(path: str, source: str) -> str | None:
    found = kinds_in(source)
    if len(found) == 1:
        return None
    has = f"{len(found)} kinds of evidence, {' and '.join(found)}" if found else "no kind of evidence"
    return (
        f"{path} has {has}: after its imports, say one of "
        + ", ".join(f"pytestmark = pytest.mark.{kind}" for kind in KINDS)
        + "; CONTRIBUTING.md tells them apart"
    )


def test_every_test_file_has_one_kind() -> None:
    files = sorted(TESTS.rglob("test_*.py"))
    assert len(files) > 60
    assert [words for path in files if (words := _judged(path))] == []


def _judged(path: Path) -> str | None:
    return complaint(str(path.relative_to(ROOT)), path.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("import pytest\n", "no kind of evidence: after its imports, say one of pytestmark = pytest.mark."),
        ("pytestmark = pytest.mark.slow", "no kind of evidence"),
        ("def f():\n    pytestmark = pytest.mark.laws", "no kind of evidence"),
        ("pytestmark = [pytest.mark.laws, pytest.mark.oracle]", "2 kinds of evidence, laws and oracle"),
        ("pytestmark = pytest.mark.laws\npytestmark = pytest.mark.oracle", "2 kinds of evidence"),
    ],
)
def test_what_is_not_one_kind_is_said(source: str, said: str) -> None:
    assert f"test_new.py has {said}" in str(complaint("test_new.py", source))


def test_one_kind_passes_beside_other_marks() -> None:
    assert complaint("test_new.py", "pytestmark = pytest.mark.laws") is None
    assert complaint("test_new.py", "pytestmark = [pytest.mark.slow, pytest.mark.laws]") is None


def test_contributing_explains_every_kind() -> None:
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert [kind for kind in [*KINDS, "slow"] if f"`{kind}`" not in page] == []


# -- the slow ones ----------------------------------------------------------------------------------------


def test_every_slow_test_is_there() -> None:
    gone = []
    for name in slow():
        path, _, function = name.partition("::")
        source = (ROOT / path).read_text(encoding="utf-8") if (ROOT / path).exists() else ""
        if f"def {function.rpartition('::')[2]}(" not in source:
            gone.append(name)
    assert gone == [], "tests/slow.txt names tests that are gone: take the lines out, or give the new names"


def test_the_list_of_slow_tests_is_made_anew_by_what_ran() -> None:
    known = ["a::gone_quick", "a::slow", "b::not_run"]
    measured = {"a::gone_quick": ALLOWED, "a::slow": 2 * ALLOWED, "a::new": 1.01 * ALLOWED}
    assert relisted(known, measured) == ["a::new", "a::slow", "b::not_run"]


def test_slow_tests_are_left_out_by_the_mark() -> None:
    class Item:
        nodeid = f"{slow()[0]}[some-parameter]"
        marks: ClassVar[list[str]] = []

        def add_marker(self, marker: pytest.MarkDecorator) -> None:
            self.marks.append(marker.name)

    mark([Item()])
    assert Item.marks == ["slow"]


def test_contributing_names_files_that_are_there() -> None:
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = {name for name in re.findall(r"`([\w/.]+\.(?:py|txt))`", page) if not name.startswith("_")}
    assert len(named) > 20
    roots = (ROOT / "src" / "regrasp", ROOT)
    near = [path.name for path in (ROOT / "src").rglob("*.py")]
    gone = [n for n in named if not any((root / n).exists() for root in roots) and n not in near]
    assert gone == []
