"""One ES module, or one style sheet, out of the files in this folder: pages need no second request."""

import re
from functools import cache
from importlib.resources import files

# In the order of their use; modules here import nothing from elsewhere.
_IMPORT = re.compile(r"^import .*;\n", re.MULTILINE)
_EXPORT = re.compile(r"^export (?!default)", re.MULTILINE)


@cache
def module(*names: str) -> str:
    """Modules joined into one, in which only the default export of the last is left.

    Args:
        names: of files without their ending, each after those it imports from.
    """
    sources = [_text(f"{name}.js") for name in names]
    return "\n".join(_EXPORT.sub("", _IMPORT.sub("", source)) for source in sources)


@cache
def style(*, whole: bool = True) -> str:
    """The style sheet of all pages.

    Args:
        whole: for a page of our own; otherwise only what is inside ours, as in a notebook.
    """
    return (_text("page.css") if whole else "") + _text("look.css")


def _text(name: str) -> str:
    return (files(__package__) / name).read_text(encoding="utf-8")
