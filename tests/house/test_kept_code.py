"""Machine code is kept between runs, but nothing depends on it: no folder, a full disk or a spoiled file."""

import importlib.util
import logging
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from types import ModuleType

import pytest

import regrasp
from regrasp import compilation

pytestmark = pytest.mark.contract

SOURCE = """
from regrasp.compilation import kept

@kept(error_model="numpy")
def tripled(x):
    return 3 * x

@kept(error_model="numpy")
def moved(x):
    return tripled(x) + 1
"""


@pytest.fixture
def module(tmp_path: Path) -> Iterator[Callable[[], ModuleType]]:
    """Imports the same file again and again, as runs one after the other do."""
    path = tmp_path / "formulas.py"
    path.write_text(SOURCE)

    def fresh() -> ModuleType:
        spec = importlib.util.spec_from_file_location("formulas", path)
        assert spec is not None
        assert spec.loader is not None
        found = importlib.util.module_from_spec(spec)
        sys.modules["formulas"] = found
        spec.loader.exec_module(found)
        return found

    yield fresh
    sys.modules.pop("formulas", None)


def files(folder: Path) -> list[Path]:
    return sorted((folder / "__pycache__").glob("*.nb?"))


def compiled_anew(function: object) -> bool:
    return sum(function.stats.cache_misses.values()) > 0  # type: ignore[attr-defined]


def test_second_run_compiles_nothing(module: Callable[[], ModuleType], tmp_path: Path) -> None:
    first = module()
    assert first.moved(2.0) == 7.0
    assert compiled_anew(first.moved)
    assert len(files(tmp_path)) == 4  # two functions, an index and the code of one kind of argument each
    second = module()
    assert second.moved(5.0) == 16.0
    assert not compiled_anew(second.moved)
    assert second.moved(5) == 16  # arguments of another kind are compiled and kept beside
    assert not compiled_anew(module().moved)
    third = module()
    assert (third.moved(5), third.moved(5.0)) == (16, 16.0)
    assert not compiled_anew(third.moved)


DAMAGES: dict[str, Callable[[bytes, Random], bytes]] = {
    "empty": lambda content, random: b"",
    "cut short": lambda content, random: content[: random.randrange(len(content))],
    "longer": lambda content, random: content + b"\0",
    "one bit": lambda content, random: flipped(content, random),
    "noise": lambda content, random: random.randbytes(len(content)),
    "zeros": lambda content, random: bytes(len(content)),
    "text": lambda content, random: b"<html>404</html>",
    "a pickle of something else": lambda content, random: b"\x80\x04K\x01.",
}


def flipped(content: bytes, random: Random) -> bytes:
    changed = bytearray(content)
    changed[random.randrange(len(changed))] ^= 1 << random.randrange(8)
    return bytes(changed)


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
def test_spoiled_file_is_no_file(
    damage: str, suffix: str, module: Callable[[], ModuleType], tmp_path: Path
) -> None:
    assert module().moved(2.0) == 7.0
    random = Random(f"{damage} {suffix}")
    for path in files(tmp_path):
        if path.suffix == f".{suffix}":
            path.write_bytes(DAMAGES[damage](path.read_bytes(), random))
    again = module()
    assert again.moved(2.0) == 7.0
    assert compiled_anew(again.moved)
    mended = module()
    assert mended.moved(2.0) == 7.0
    assert not compiled_anew(mended.moved)


def test_code_under_another_name_is_not_run(module: Callable[[], ModuleType], tmp_path: Path) -> None:
    """Two processes may give one name to the code of different arguments; the index tells of one of them."""
    first = module()
    assert (first.moved(2.0), first.moved(2)) == (7.0, 7)
    one, two = (tmp_path / "__pycache__").glob("formulas.moved*.nbc")
    a, b = one.read_bytes(), two.read_bytes()
    one.write_bytes(b)
    two.write_bytes(a)
    again = module()
    assert (again.moved(2.0), again.moved(2)) == (7.0, 7)
    assert isinstance(again.moved(2.0), float)


def test_full_disk_is_said_once(
    module: Callable[[], ModuleType], caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(compilation._Files, "_save_index", full)
    monkeypatch.setattr(compilation, "_said", set())
    with caplog.at_level(logging.WARNING, "regrasp"):
        found = module()
        assert (found.moved(2.0), found.moved(3)) == (7.0, 10)
    (record,) = caplog.records
    assert record.getMessage() == (
        "compiled code cannot be kept (No space left on device), so every run compiles anew; "
        "set NUMBA_CACHE_DIR to a folder that can be written to"
    )


def test_without_any_folder_to_write_to(tmp_path: Path) -> None:
    """Read-only source folders and no home, for any user: where folders should be there are files."""
    package = tmp_path / "regrasp"
    shutil.copytree(
        Path(regrasp.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__", "bench", "plots")
    )
    for folder in [package, *(path for path in package.rglob("*") if path.is_dir())]:
        (folder / "__pycache__").write_text("")
    home = tmp_path / "home"
    home.write_text("")
    code = (
        "import numpy as np, regrasp\n"
        "place = np.zeros((2000, 2)) + [1, 0]\n"
        "pairs = -place, place, 0.5, place, -place, 0.5\n"
        "best = regrasp.best_squeezes(*pairs, [0.0, -1.0], 0.0, objective='effort')\n"
        "print(len(best), regrasp.__file__)\n"
    )
    environment = os.environ | {
        "PYTHONPATH": str(tmp_path),
        "HOME": str(home),
        "XDG_CACHE_HOME": str(home),
        "LOCALAPPDATA": str(home),
    }
    environment.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert done.stdout == f"2000 {package / '__init__.py'}\n"
    assert done.stderr == (
        "compiled code cannot be kept (no folder), so every run compiles anew; "
        "set NUMBA_CACHE_DIR to a folder that can be written to\n"
    )
