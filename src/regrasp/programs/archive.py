"""Programs in files: NumPy archives of plain arrays, nothing pickled.

``P_data``, ``P_indices``, ``P_indptr`` and likewise of A are the matrices in CSC format; ``q``, ``b`` the
vectors; ``cones`` (k, 3) kind, size and count of each block, the kind by its place among zero, non-negative
and second-order; ``size`` as in ``Program``.
"""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from scipy import sparse

from regrasp.errors import InvalidInput, shown

_PARTS = ("data", "indices", "indptr")
_KEYS = {"q", "b", "cones", "size", *(f"{m}_{part}" for m in "PA" for part in _PARTS)}


def file_path(path: object) -> Path:
    """A path as a ``Path``; raises ``InvalidInput`` for what is none."""
    if not isinstance(path, (str, PathLike)):
        raise InvalidInput(f"path must be a file's name, got {shown(path)}")
    return Path(path)


def write_arrays(path: Path, arrays: Mapping[str, Any], matrices: Mapping[str, sparse.csc_matrix]) -> Path:
    """Write vectors and matrices to ``path`` and return that. Raises ``InvalidInput`` where that fails."""
    parts = {f"{name}_{part}": getattr(m, part) for name, m in matrices.items() for part in _PARTS}
    try:
        with path.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, **arrays, **parts)
    except (OSError, ValueError) as error:
        raise InvalidInput(f"{path}: cannot be written: {error}") from None
    return path


def read_arrays(path: Path) -> tuple[dict[str, Any], dict[str, sparse.csc_matrix]]:
    """The vectors and the matrices in a file. Raises ``InvalidInput`` where it holds none."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            arrays = dict(archive)
    except (OSError, ValueError, BadZipFile, EOFError, AttributeError, TypeError) as error:
        raise InvalidInput(f"{path}: expected a NumPy archive of plain arrays: {error}") from None
    if arrays.keys() != _KEYS:
        raise InvalidInput(f"{path}: expected the arrays {', '.join(sorted(_KEYS))}, got {', '.join(arrays)}")
    matrices = {}
    try:
        for name in ("q", "b"):
            arrays[name] = np.array(arrays[name], dtype=float).ravel()
        for name, rows in (("P", arrays["q"].size), ("A", arrays["b"].size)):
            parts = [arrays[f"{name}_{part}"] for part in _PARTS]
            matrices[name] = sparse.csc_matrix(
                (np.array(parts[0], dtype=float), *parts[1:]), shape=(rows, arrays["q"].size)
            )
            matrices[name].check_format(full_check=True)
    except (ValueError, TypeError) as error:
        raise InvalidInput(f"{path}: not the matrices of a program: {error}") from None
    return arrays, matrices
