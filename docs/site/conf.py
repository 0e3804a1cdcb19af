"""Settings of the documentation site: `make docs`. Sources are the repository's own pages, where they lie."""

import sys
import warnings
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import regrasp  # noqa: E402

# myst-nb stores a value that Sphinx cannot; of no effect on pages
warnings.filterwarnings("ignore", category=DeprecationWarning)

project = "regrasp"
author = "The regrasp developers"
copyright = author  # noqa: A001
version = release = regrasp.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "mathml",
    "public_names",
    "reader_links",
]
root_doc = "docs/index"
include_patterns = [
    "docs/**",
    "notebooks/*.ipynb",
    "benchmarks/README.md",
    "benchmarks/solvers/report.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
]
exclude_patterns = [".*", "**/.ipynb_checkpoints", "src", "tests", "docs/site", "docs/images"]

# Nothing is executed here: notebooks keep their outputs, and the tests run them and the pages' examples.
nb_execution_mode = "off"
nb_merge_streams = True
myst_enable_extensions = ["amsmath", "colon_fence", "dollarmath"]
myst_heading_anchors = 4
suppress_warnings = ["mystnb.unknown_mime_type"]

nitpicky = True
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
autodoc_member_order = "bysource"
python_use_unqualified_type_names = True
default_role = "code"
napoleon_numpy_docstring = False
napoleon_use_rtype = False
toc_object_entries_show_parents = "hide"

html_theme = "furo"
html_title = f"regrasp {release}"
html_static_path: list[str] = []
html_extra_path = ["front"]
html_show_sourcelink = False
html_copy_source = False
html_show_copyright = False
