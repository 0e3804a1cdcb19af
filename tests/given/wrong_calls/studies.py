"""Studies, on a folder of one that is done."""

import tempfile
from functools import cache

import regrasp as rg
from wrong_calls.row import Row


@cache
def _study() -> str:
    """The folder of a study that is done."""
    folder = tempfile.mkdtemp()
    rg.sweep("study_cases:product", {"a": [1, 2]}, out=folder, workers=0, progress=False)
    return folder


def rows() -> dict[str, Row]:
    return {
        "sweep": Row(
            rg.sweep,
            {"function": "study_cases:product", "grid": {"a": [1, 2]}, "out": _study(), "workers": 0},
            {
                "function": "function name",
                "grid": "grid",
                "out": "path",
                "keep": "contact names",
                "zipped": "flag",
                "plans": "flag",
                "extend": "flag",
                "workers": "workers",
                "client": "client",
                "time_limit": "time limit",
                "memory_limit": "time limit",
                "part_seconds": "not negative",
                "shared": "shared",
                "progress": "listener",
            },
        ),
        "read_study": Row(rg.read_study, {"folder": _study()}, {"folder": "path", "form": "word"}),
    }
