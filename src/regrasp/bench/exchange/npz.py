"""Quadratic programs as NumPy archives of plain arrays.

    minimise 1/2 x'Px + q'x   subject to   G x <= h,  A x = b

Each matrix M of P, G and A is three arrays: ``M_row``, ``M_col`` and ``M_value``. Nothing is pickled.
"""

from pathlib import Path

import numpy as np
from scipy import sparse

from regrasp.errors import InvalidInput
from regrasp.programs import Block, Cone, Program
from regrasp.programs.blocks import Array

_MATRICES = ("P", "G", "A")
_VECTORS = ("q", "h", "b")
_KEYS = (*_VECTORS, *(f"{m}_{part}" for m in _MATRICES for part in ("row", "col", "value")))


def split(program: Program) -> tuple[sparse.csc_matrix, Array, sparse.csc_matrix, Array]:
    """G, h, A, b of a program without second-order cones. Raises ``InvalidInput`` of one that has some."""
    if program.has_second_order:
        raise InvalidInput("a quadratic program must have no second-order cones; write it as CBF")
    equal = np.zeros(program.b.size, dtype=bool)
    for block, rows in program.slices:
        equal[rows] = block.cone is Cone.ZERO
    rows = program.A.tocsr()
    return rows[~equal].tocsc(), program.b[~equal], rows[equal].tocsc(), program.b[equal]


def write_npz(program: Program, path: Path) -> None:
    """Write a program without second-order cones. Raises ``InvalidInput`` of one that has some."""
    G, h, A, b = split(program)
    arrays: dict[str, Array] = {"q": program.q, "h": h, "b": b}
    for name, matrix in zip(_MATRICES, (program.P, G, A), strict=True):
        entries = matrix.tocoo()
        arrays[f"{name}_row"], arrays[f"{name}_col"] = entries.row, entries.col
        arrays[f"{name}_value"] = entries.data
    with path.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def read_npz(path: Path) -> Program:
    """The program in an archive, its equations first. Raises ``InvalidInput`` where it is not one."""
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = dict(archive)
    except (OSError, ValueError) as error:
        raise InvalidInput(f"{path}: expected a NumPy archive of plain arrays: {error}") from None
    if arrays.keys() != set(_KEYS):
        raise InvalidInput(f"{path}: expected the arrays {', '.join(_KEYS)}, got {', '.join(arrays)}")
    q, h, b = (arrays[name] for name in _VECTORS)
    matrices = []
    for name, rows in zip(_MATRICES, (q.size, h.size, b.size), strict=True):
        entries = (arrays[f"{name}_row"], arrays[f"{name}_col"])
        try:
            matrices.append(sparse.csc_matrix((arrays[f"{name}_value"], entries), shape=(rows, q.size)))
        except ValueError as error:
            raise InvalidInput(
                f"{path}: {name} does not fit {rows} rows, {q.size} columns: {error}"
            ) from None
    P, G, A = matrices
    blocks = ((Cone.ZERO, b.size), (Cone.NONNEGATIVE, h.size))
    return Program(
        P=P,
        q=q,
        A=sparse.vstack([A, G], format="csc"),
        b=np.concatenate([b, h]),
        blocks=tuple(Block(cone, 1, rows) for cone, rows in blocks if rows),
    )
