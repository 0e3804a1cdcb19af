"""Positive combinations of vectors that vanish, decided in exact arithmetic on whole numbers.

Either there are weights of at least 1 with W weights = 0, or there is a y with y . w_j >= 0 for every column
and y . w_j > 0 for one (Stiemke's alternative). Phase one of the simplex method finds which, with Bland's
rule, so that it ends, and with fractions left undivided (Edmonds), so that every number is whole.
"""

from collections.abc import Sequence
from fractions import Fraction
from math import gcd, lcm

Vector = list[Fraction]
Whole = list[int]


def whole(columns: Sequence[Vector]) -> list[Whole]:
    """The columns as whole numbers, all multiplied by one number."""
    common = lcm(*(value.denominator for column in columns for value in column))
    numbers = [[value.numerator * (common // value.denominator) for value in column] for column in columns]
    divisor = gcd(*(value for column in numbers for value in column)) or 1
    return [[value // divisor for value in column] for column in numbers]


def vanishing(columns: Sequence[Vector]) -> tuple[Vector | None, Vector | None]:
    """(weights of 1 or more with sum weights_j w_j = 0, None), or (None, y) of Stiemke's alternative."""
    m, n = len(columns[0]), len(columns)
    rows = list(map(list, zip(*whole(columns), strict=True)))
    # W mu = b with mu = weights - 1 and b = -W 1 made non-negative; then the artificial columns; then b
    right = [-sum(row) for row in rows]
    signs = [-1 if value < 0 else 1 for value in right]
    table = [
        [sign * value for value in row] + [int(i == k) for k in range(m)] + [sign * value_b]
        for i, (row, sign, value_b) in enumerate(zip(rows, signs, right, strict=True))
    ]
    costs = [-sum(table[i][j] for i in range(m)) for j in range(n)] + [0] * m
    costs.append(-sum(row[-1] for row in table))
    table.append(costs)
    basis, unit = [n + i for i in range(m)], 1
    while (entering := next((j for j in range(n) if table[m][j] < 0), None)) is not None:
        leaving = min(
            (i for i in range(m) if table[i][entering] > 0),
            key=lambda i: (Fraction(table[i][-1], table[i][entering]), basis[i]),
        )
        unit = _pivot(table, leaving, entering, unit)
        basis[leaving] = entering
    if table[m][-1] != 0:
        # the reduced cost of an artificial column is 1 - sign y', y' the duals; -y' has y . w >= 0
        return None, [sign * (Fraction(table[m][n + i], unit) - 1) for i, sign in enumerate(signs)]
    weights = [Fraction(1)] * n
    for i, j in enumerate(basis):
        if j < n:
            weights[j] += Fraction(table[i][-1], unit)
    return weights, None


def neutral(columns: Sequence[Vector]) -> Vector | None:
    """A y, not zero, with y . w_j = 0 for every column; None where the columns span the space."""
    m = len(columns[0])
    table = whole(columns)
    pivots: list[int] = []
    unit = 1
    for j in range(m):
        row = next((i for i in range(len(pivots), len(table)) if table[i][j]), None)
        if row is None:
            continue
        place = len(pivots)
        table[place], table[row] = table[row], table[place]
        if table[place][j] < 0:
            table[place] = [-value for value in table[place]]
        unit = _pivot(table, place, j, unit)
        pivots.append(j)
    free = next((j for j in range(m) if j not in pivots), None)
    if free is None:
        return None
    y = [Fraction(0)] * m
    y[free] = Fraction(1)
    for place, j in enumerate(pivots):
        y[j] = Fraction(-table[place][free], unit)
    return y


def _pivot(table: list[Whole], row: int, column: int, unit: int) -> int:
    """One exchange without division but for the last pivot, which divides exactly; the new pivot."""
    pivot, chosen = table[row][column], table[row]
    for i, other in enumerate(table):
        if i != row:
            factor = other[column]
            table[i] = [(a * pivot - factor * b) // unit for a, b in zip(other, chosen, strict=True)]
    return pivot
