"""Programs in the Conic Benchmark Format (H. A. Friberg, CBLIB 2014, Math. Program. Comput. 8, 2016).

    minimise c'y   subject to   E y + e in K

A quadratic objective is written as its epigraph: y = (x, t), c = (q, 1), and with P = F'F

    1/2 x'Px <= t   <=>   (t, 1, F x) in the rotated cone {(u, v, w): 2 u v >= |w|^2, u, v >= 0}

so the least value is that of the program.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy import sparse

from regrasp.bench.exchange.cbf_items import Items
from regrasp.programs import Block, Cone, Program

_WORDS = {Cone.ZERO: "L=", Cone.NONNEGATIVE: "L+", Cone.SECOND_ORDER: "Q"}
# All that is written is in version 1, which every later reader accepts.
_VERSION = 1


def write_cbf(program: Program, path: Path, comment: str = "") -> None:
    """Write the program; each line of ``comment`` stands on top as a comment.

    Numbers are written so that they read back as they are.
    """
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(f"# {line}\n" for line in comment.splitlines())
        file.writelines(f"{line}\n" for line in _lines(program))


def read_cbf(path: Path) -> Program:
    """The program in a file; P is zero, as the format has linear objectives only.

    Takes minimisation over free, linear, quadratic and rotated cones, in variables and constraints, and
    refuses everything else, repeated entries and wrong counts included. Rotated cones come as second-order
    ones: 2 u v >= |w|^2  <=>  |(u - v, sqrt 2 w)| <= u + v. Raises ``InvalidInput`` with the line.
    """
    items = Items.read(path)
    variables, constraints = sum(n for _, n in items.variables), sum(n for _, n in items.constraints)
    E = sparse.coo_matrix((items.a[2], items.a[:2]), shape=(constraints, variables))
    E = sparse.vstack([sparse.identity(variables), E], format="csr")
    e = np.concatenate([np.zeros(variables), items.b])
    parts, rights, blocks, start = [], [], [], 0
    for word, size in (*items.variables, *items.constraints):
        rows = slice(start, start + size)
        start += size
        if word == "F":
            continue
        turn, cone = _into_standard(word, size)
        parts.append(-turn @ E[rows])  # A y + s = b with s = E y + e
        rights.append(turn @ e[rows])
        blocks.append(Block(cone, size) if cone is Cone.SECOND_ORDER else Block(cone, 1, size))
    A = sparse.vstack(parts, format="csc") if parts else sparse.csc_matrix((0, variables))
    return Program(
        P=sparse.csc_matrix((variables, variables)),
        q=items.c,
        A=A,
        b=np.concatenate([np.zeros(0), *rights]),
        blocks=tuple(blocks),
    )


def _into_standard(word: str, size: int) -> tuple[sparse.csr_matrix, Cone]:
    """The matrix that takes a cone of the format into one of ours, and that one."""
    if word == "QR":
        turn = sparse.lil_matrix((size, size))
        turn.setdiag(np.sqrt(2))
        turn[:2, :2] = [[1, 1], [1, -1]]
        return turn.tocsr(), Cone.SECOND_ORDER
    sign = -1.0 if word == "L-" else 1.0
    cone = {"L=": Cone.ZERO, "Q": Cone.SECOND_ORDER}.get(word, Cone.NONNEGATIVE)
    return sign * sparse.identity(size, format="csr"), cone


def _lines(program: Program) -> Iterator[str]:
    n, m = program.q.size, program.b.size
    root = _root(program.P)  # F
    quadratic = root.shape[0] > 0
    c, E, e = program.q, -program.A, program.b
    domains = [(_WORDS[block.cone], block) for block in program.blocks]
    sizes = [
        (word, size)
        for word, block in domains
        for size in ([block.size] * block.count if block.cone is Cone.SECOND_ORDER else [block.rows])
    ]
    if quadratic:
        rank = root.shape[0]
        c = np.append(c, 1.0)
        t = sparse.coo_matrix(([1.0], ([0], [n])), shape=(2, n + 1))
        E = sparse.vstack([sparse.hstack([E, sparse.coo_matrix((m, 1))]), t,
                           sparse.hstack([root, sparse.coo_matrix((rank, 1))])])  # fmt: skip
        e = np.concatenate([e, [0.0, 1.0], np.zeros(rank)])
        sizes.append(("QR", rank + 2))
    E = sparse.csr_matrix(E)
    E.eliminate_zeros()
    E.sort_indices()
    E = E.tocoo()
    yield from ("VER", f"{_VERSION}", "", "OBJSENSE", "MIN", "")
    yield from ("VAR", f"{c.size} 1", f"F {c.size}", "")
    yield from ("CON", f"{e.size} {len(sizes)}", *(f"{word} {size}" for word, size in sizes), "")
    yield from ("OBJACOORD", f"{np.count_nonzero(c)}")
    yield from (f"{j} {float(c[j])!r}" for j in np.flatnonzero(c))
    yield from ("", "ACOORD", f"{E.nnz}")
    for i, j, value in zip(E.row, E.col, E.data, strict=True):
        yield f"{i} {j} {float(value)!r}"
    yield from ("", "BCOORD", f"{np.count_nonzero(e)}")
    yield from (f"{i} {float(e[i])!r}" for i in np.flatnonzero(e))


def _root(P: sparse.csc_matrix) -> sparse.csr_matrix:
    """(rank, n) F with F'F = P; of a diagonal P the square roots, else by its eigenvectors."""
    diagonal = P.diagonal()
    if (P - sparse.diags(diagonal)).count_nonzero() == 0:
        used = np.flatnonzero(diagonal)
        F = sparse.diags(np.sqrt(diagonal), format="csr")
        return F[used]
    values, vectors = np.linalg.eigh(P.toarray())
    used = np.flatnonzero(values > values[-1] * values.size * np.finfo(float).eps)
    return sparse.csr_matrix(np.sqrt(values[used])[:, None] * vectors[:, used].T)
