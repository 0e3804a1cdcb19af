"""``face_newton`` compiled by Numba. Imported when needed."""

from typing import Any

from regrasp.closed_form.compiled.compiling import compiled, digest
from regrasp.closed_form.least import elimination, face_newton, faces
from regrasp.compilation import kept

_MODULES = faces, face_newton, elimination  # the last names count
_refined = compiled(_MODULES, inline=False)["refined"]


def _loop(sources: str) -> Any:
    @kept("least forces", error_model="numpy")
    def refined(  # type: ignore[no-untyped-def]
        forces, unit, matrix, load, normals, frictions, negligible, limits, squares, linear, kind
    ):
        _ = sources
        return _refined(
            forces, unit, matrix, load, normals, frictions, negligible, limits, squares, linear, kind
        )

    return refined


refined = _loop(digest(_MODULES))
"""``face_newton.refined``."""
