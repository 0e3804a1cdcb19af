import re
from pathlib import Path

import pytest

from documents import examples, executed
from places import ROOT

pytestmark = pytest.mark.documents

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_python_blocks_print_what_the_page_says(page: Path) -> None:
    for code, promised, actual in executed(page):
        assert actual == promised, f"{page.name} prints something else after:\n{code}"


def test_readme_has_examples_to_run() -> None:
    assert len(examples(ROOT / "README.md")) >= 5


def test_first_example_of_the_readme_is_short() -> None:
    code, promised = examples(ROOT / "README.md")[0]
    assert len([line for line in code.splitlines() if line.strip()]) <= 15
    assert promised.strip()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
        if not target.startswith("http"):
            assert (page.parent / target).exists(), f"{page.name} links to {target}, which is not there"
