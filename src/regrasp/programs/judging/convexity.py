"""Whether the matrix of an objective is symmetric and positive semidefinite, each unknown by its own unit.

With D the diagonal of P, S = D^-1/2 P D^-1/2 has ones on its diagonal whatever the units of the unknowns. P
is positive semidefinite exactly when S is, and only where it is zero beside a zero of the diagonal.
"""

import numpy as np
from scipy import sparse

_ROUNDING = 1e-12
"""Entries and eigenvalues of S below this are rounding: P is often a product of matrices, or typed in."""
_DENSE = 400
"""Unknowns up to which a dense factorisation is the faster one."""


def why_not_convex(P: sparse.csc_matrix) -> str:
    """The reason in words; empty where P (n, n) is symmetric and positive semidefinite, to rounding."""
    diagonal = P.diagonal()
    if P.nnz == np.count_nonzero(diagonal) and (diagonal >= 0).all():
        return ""
    if (diagonal < 0).any():
        k = int(diagonal.argmin())
        return f"P is not positive semidefinite: P[{k}, {k}] is {diagonal[k]:g}"
    scale = sparse.diags(np.divide(1.0, np.sqrt(diagonal), out=np.ones_like(diagonal), where=diagonal > 0))
    S = sparse.csc_matrix(scale @ P @ scale)
    for words, M in (("symmetric", S - S.T), ("positive semidefinite", _beyond(S, diagonal))):
        entries = abs(M).tocoo()
        if entries.nnz and entries.data.max() > _ROUNDING:
            k = int(entries.data.argmax())
            i, j = int(entries.row[k]), int(entries.col[k])
            both = f"P[{i}, {j}] is {P[i, j]:g} and P[{j}, {i}] is {P[j, i]:g}"
            if words == "symmetric":
                return f"P is not symmetric: {both}; give both triangles, (P + P.T) / 2"
            return f"P is not positive semidefinite: {both} beside {diagonal[i]:g} and {diagonal[j]:g}"
    off = np.asarray(abs(S).sum(axis=1)).ravel() - S.diagonal()
    if (off <= S.diagonal() + _ROUNDING).all():  # Gershgorin's discs lie on the right
        return ""
    return "" if _is_positive(S) else "P is not positive semidefinite: it has a negative eigenvalue"


def _beyond(S: sparse.csc_matrix, diagonal: np.ndarray) -> sparse.csc_matrix:
    """What entries of S exceed the root of the product of their diagonal ones by; infinite beside a zero."""
    entries = S.tocoo()
    some = (diagonal > 0)[entries.row] & (diagonal > 0)[entries.col]
    beside_zero = np.where(entries.data == 0, 0.0, np.inf)
    excess = np.where(some, np.maximum(abs(entries.data) - 1.0, 0.0), beside_zero)
    return sparse.csc_matrix((excess, (entries.row, entries.col)), S.shape)


def _is_positive(S: sparse.csc_matrix) -> bool:
    """Whether S, a little of the identity added, has a Cholesky factor."""
    n = S.shape[0]
    shifted = S + _ROUNDING * n * sparse.identity(n, format="csc")
    if n <= _DENSE:
        try:
            np.linalg.cholesky(shifted.toarray())
        except np.linalg.LinAlgError:
            return False
        return True
    from scipy.sparse.linalg import splu  # a third of the time that the first choice of forces takes

    try:
        # Without pivots for size the factors are those of L D L', and D has the signs of the eigenvalues.
        factors = splu(
            shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError:  # singular
        return False
    return bool((factors.perm_r == factors.perm_c).all() and (factors.U.diagonal() > 0).all())
