# mypy: allow-untyped-calls
"""The elimination of ``face_newton`` in loops, in the place of NumPy's where all is compiled."""


def eliminated(K, unknowns, v):  # type: ignore[no-untyped-def]
    """``v`` becomes K^-1 v by L D L': K is quasi-definite, so that no order of its rows is better."""
    size = v.size
    for j in range(size):
        for k in range(j):
            K[j, j] -= K[j, k] * K[j, k] * K[k, k]
        for i in range(j + 1, size):
            for k in range(j):
                K[i, j] -= K[i, k] * K[j, k] * K[k, k]
            K[i, j] /= K[j, j]
    for i in range(size):
        for k in range(i):
            v[i] -= K[i, k] * v[k]
    for i in range(size):
        v[i] /= K[i, i]
    for back in range(size):
        i = size - 1 - back
        for k in range(i + 1, size):
            v[i] -= K[k, i] * v[k]
