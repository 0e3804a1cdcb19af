"""What is said of the package in several places is the same, and the source archive stays small."""

import json
import os
import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest

import regrasp
from places import ROOT

pytestmark = pytest.mark.contract

SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = SETTINGS["project"]
OTHER_NAMES = {"cvxpy": "cvxpy-base", "matplotlib": "matplotlib-base"}  # without what the core does not use


def bounds(lines: list[str]) -> dict[str, str]:
    """Lower bound by package."""
    pairs = [line.replace(" ", "").split(">=") for line in lines]
    return {pair[0]: pair[1] for pair in pairs}


def test_the_recipe_asks_for_what_the_package_asks_for() -> None:
    recipe = (ROOT / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    run = re.findall(r"    - (.+)", recipe.partition("  run:\n")[2].partition("\n\n")[0])
    asked = bounds(PROJECT["dependencies"]) | {"python": PROJECT["requires-python"].removeprefix(">=")}
    assert bounds(run) == {OTHER_NAMES.get(name, name): bound for name, bound in asked.items()}


def test_versions_agree() -> None:
    recipe = (ROOT / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.findall(r'  version: "(.+)"', recipe) == [regrasp.__version__]
    assert re.findall(r"^version: (.+)$", citation, re.M) == [regrasp.__version__]


def test_the_citation_has_what_archives_ask_for() -> None:
    keys = set(re.findall(r"^([\w-]+):", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.M))
    assert {"title", "abstract", "type", "authors", "version", "date-released", "license", "keywords"} <= keys


def test_only_lower_bounds() -> None:
    lines = list(PROJECT["dependencies"])
    for extra in PROJECT["optional-dependencies"].values():
        lines += [line for line in extra if not line.startswith("regrasp[")]
    assert [line for line in lines if re.search(r"==|<|~=|!=", line)] == []


def test_dev_has_every_extra() -> None:
    extras = PROJECT["optional-dependencies"]
    named = extras["dev"][0].removeprefix("regrasp[").removesuffix("]").split(",")
    assert named == sorted(extras.keys() - {"dev"})


def test_the_source_archive_is_about_a_megabyte_and_builds(tmp_path: Path) -> None:
    command = (sys.executable, "-m", "hatchling", "build", "-d", tmp_path)
    subprocess.run((*command, "-t", "sdist"), cwd=ROOT, check=True, capture_output=True)
    (packed,) = tmp_path.glob("*.tar.gz")
    assert 200e3 < packed.stat().st_size < 1.1e6
    with tarfile.open(packed) as archive:
        archive.extractall(tmp_path, filter="data")
    source = next(tmp_path.glob("regrasp-*/"))
    beside = {"README.md", "LICENSE", "CITATION.cff"}
    assert {path.name for path in source.iterdir()} >= beside
    subprocess.run((*command, "-t", "wheel"), cwd=source, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as built:
        modules = {name for name in built.namelist() if name.startswith("regrasp/")}
    sources = {path.relative_to(ROOT / "src") for path in (ROOT / "src").rglob("*.*") if path.is_file()}
    assert modules == {str(path) for path in sources if "__pycache__" not in path.parts}


def metadata(address: str) -> dict[str, Any]:
    """What a build says of the package, with an address of the repository or none."""
    command = (sys.executable, "-m", "hatchling", "metadata")
    environment = {**os.environ, "REGRASP_URL": address}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ValueError(done.stderr.splitlines()[-1])
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def test_a_build_leads_to_the_repository_that_it_is_told() -> None:
    said, given = metadata(""), (ROOT / "README.md").read_text(encoding="utf-8")
    assert "urls" not in said
    assert str(said["readme"]["text"]) == given
    address = "https://example.org/hands/regrasp"
    said = metadata(address + "/")
    assert {url.startswith(address) for url in said["urls"].values()} == {True}
    assert said["urls"].keys() == {"Homepage", "Documentation", "Changelog", "Issues"}
    targets, were = (re.findall(r"\]\(([^)]*)\)", text) for text in (said["readme"]["text"], given))
    assert [t.replace("/raw/", "/blob/").removeprefix(f"{address}/blob/main/") for t in targets] == were
    assert {t.rpartition(".")[2] for t in targets if "/raw/" in t} == {"png"}
    with pytest.raises(ValueError, match="REGRASP_URL must be the https address of a repository, got 'here'"):
        metadata("here")
