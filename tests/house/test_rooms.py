"""Rooms and files stay small, names stay in their rooms, and every name is imported from where it is made."""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

import imports
import regrasp
from places import TESTS

pytestmark = pytest.mark.architecture

ROOT = Path(regrasp.__file__).parent
HELPERS = [TESTS, TESTS.parent / "benchmarks"]
LINES = 350
"""Of a file, besides the sections Args, Returns and Raises of docstrings."""
FILES = 15
"""Files of a room, besides its ``__init__``."""


def sources() -> dict[str, str]:
    return imports.sources(ROOT)


def private(module: str, source: str) -> Iterator[str]:
    """Private names that a module takes from another room."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("regrasp"):
            away = str(node.module).rpartition(".")[0] != module.rpartition(".")[0]
            yield from (
                a.name for a in node.names if away and a.name.startswith("_") and not a.name.startswith("__")
            )


def read(source: str) -> str:
    """A source without the lists of its docstrings, which are looked up."""
    return re.sub(r"^( +)(?:Args|Returns|Raises):\n(?:\1 +.*\n)+", "", source, flags=re.MULTILINE)


def made(source: str) -> set[str]:
    """Names that a module makes itself, anywhere at its top level."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
    return names


def handed_on(modules: dict[str, str]) -> Iterator[str]:
    """Imports of a name from a module that has it from another; packages hand on what is public."""
    packages = {name.rpartition(".")[0] for name in modules}
    own = {name: made(source) for name, source in modules.items()}
    for module, source in modules.items():
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.ImportFrom) and node.module in modules and node.module not in packages:
                for alias in node.names:
                    if alias.name not in own[node.module] and not alias.name.startswith("__"):
                        yield f"{module} imports {alias.name} from {node.module}"


def test_files_read_in_one_sitting() -> None:
    assert {m: n for m, text in sources().items() if (n := len(read(text).splitlines())) > LINES} == {}


def test_lists_of_parameters_are_looked_up_and_all_else_is_read() -> None:
    text = (
        'def f(a):\n    """Words.\n\n    Args:\n        a: one,\n            more.\n\n    Words.\n    """\n'
    )
    assert read(text) == 'def f(a):\n    """Words.\n\n\n    Words.\n    """\n'


def test_tests_and_benchmarks_read_in_one_sitting() -> None:
    files = {path: path.read_text(encoding="utf-8") for root in HELPERS for path in root.rglob("*.py")}
    assert {path.name: n for path, text in files.items() if (n := len(text.splitlines())) > LINES} == {}


@pytest.mark.parametrize("root", [ROOT, *HELPERS], ids=lambda root: root.name)
def test_rooms_are_not_crowded(root: Path) -> None:
    rooms = Counter(path.parent for path in root.rglob("*.py") if path.name != "__init__.py")
    assert {str(room.relative_to(root)): n for room, n in rooms.items() if n > FILES} == {}


def test_every_folder_says_what_it_is_for() -> None:
    folders = {path.parent for path in ROOT.rglob("*.py")}
    assert [f for f in folders if not ast.get_docstring(ast.parse((f / "__init__.py").read_text()))] == []


def test_no_private_name_leaves_its_room() -> None:
    assert {m: names for m, text in sources().items() if (names := list(private(m, text)))} == {}
    assert list(private("regrasp.plots.look.style", "from regrasp.programs.assembly import _Rows")) == [
        "_Rows"
    ]


def test_every_name_is_imported_from_where_it_is_made() -> None:
    assert list(handed_on(sources())) == []


def test_a_name_handed_on_is_caught() -> None:
    modules = {
        "regrasp.a.one": "from regrasp.a.two import f",
        "regrasp.a.two": "from regrasp.a.three import f",
        "regrasp.a.three": "def f(): pass",
    }
    assert list(handed_on(modules)) == ["regrasp.a.one imports f from regrasp.a.two"]
