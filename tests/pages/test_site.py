"""The site has every page and every public name, and its check finds what is wrong."""

import re
import sys
from pathlib import Path

import pytest

import regrasp
from places import ROOT

sys.path.append(str(ROOT / "docs" / "site"))
from check import faults
from public_names import listed, names_in

pytestmark = pytest.mark.documents

DOCS = ROOT / "docs"
OUTSIDE = [
    *(ROOT / "notebooks").glob("*.ipynb"),
    ROOT / "CHANGELOG.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "benchmarks" / "README.md",
    ROOT / "benchmarks" / "solvers" / "report.md",
]


def in_tables_of_contents() -> list[Path]:
    """Every page that a `toctree` of a page names, patterns filled in."""
    found = []
    for page in DOCS.rglob("*.md"):
        for block in re.findall(r"^```\{toctree\}\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S):
            for line in block.splitlines():
                if line and not line.startswith(":"):
                    folder, _, name = line.rpartition("/")
                    found += (page.parent / folder).resolve().glob(f"{name}.*")
    return found


def test_every_page_is_in_a_table_of_contents() -> None:
    pages = {*DOCS.rglob("*.md"), *OUTSIDE} - {DOCS / "index.md"}
    assert sorted(pages - set(in_tables_of_contents())) == []


def test_no_page_is_in_two() -> None:
    found = [page for page in in_tables_of_contents() if page.suffix in (".md", ".ipynb")]
    assert sorted(found) == sorted(set(found))


def test_every_public_name_is_in_the_reference_once() -> None:
    found = [path for line in listed() for path in names_in(line)]
    assert sorted(path for path in found if path.count(".") == 1) == sorted(
        f"regrasp.{name}" for name in regrasp.__all__
    )
    assert len(found) == len(set(found))


def test_no_room_of_the_reference_is_empty() -> None:
    catches_the_rest = "regrasp"
    assert [line for line in listed() if line != catches_the_rest and not names_in(line)] == []


@pytest.mark.parametrize(
    ("page", "said"),
    [
        ('<a href="gone.html">', "index.html links to gone.html, which is not there"),
        ('<a href="#gone">', "index.html links to #gone, a place that is not on that page"),
        ('<script src="https://cdn.example/x.js">', "index.html fetches https://cdn.example/x.js"),
        ('<link href="//cdn.example/x.css">', "index.html fetches //cdn.example/x.css"),
    ],
)
def test_faults_of_a_site_are_found(tmp_path: Path, page: str, said: str) -> None:
    (tmp_path / "index.html").write_text(f'<p id="here"><a href="#here"><a href="index.html#here">{page}')
    assert faults(tmp_path) == [said]


def test_fonts_of_style_sheets_are_found(tmp_path: Path) -> None:
    (tmp_path / "x.css").write_text(
        "@font-face { src: url('https://fonts.example/x.woff') } a { b: url(x.png) }"
    )
    assert faults(tmp_path) == ["x.css fetches https://fonts.example/x.woff'"]
