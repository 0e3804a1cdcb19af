"""How holds are numbered: pairs of contacts in the plane, triples in space; see ``hold_paths``."""

from numba.extending import overload

from regrasp.closed_form.compiled.hold_paths import PLAIN_OTHERS, Moves, cheapest, others_of, widest
from regrasp.compilation import kept


@kept("the holds of a stance", error_model="numpy")
def pair_others(holds, hold, third):  # type: ignore[no-untyped-def]
    """The two other holds of the three points of a pair and a third.

    holds: (ids, slots, first, second), the number of a hold by its slot and its two points, -1 where it is
    not allowed; of each hold its slot and points.
    """
    ids, slots, first, second = holds
    u, v = first[hold], second[hold]
    if slots[hold] == 0:
        return ids[1, u, third], ids[2, v, third]
    if slots[hold] == 1:
        return ids[0, u, third], ids[2, third, v]
    return ids[0, third, u], ids[1, third, v]


@kept("the holds of a stance in space", error_model="numpy")
def triple_others(holds, hold, fourth):  # type: ignore[no-untyped-def]
    """The three other holds of the four points of a triple and a fourth.

    holds: (numbers, corners), the number of a triple by its place among all, i < j < k by i, then j, then
    k, -1 where it is not allowed, and last the count of points; the points (H, 3) of each hold.
    """
    numbers, corners = holds
    i, j, k, p = corners[hold, 0], corners[hold, 1], corners[hold, 2], fourth
    if p in (i, j, k):
        return -1, -1, -1
    count = numbers[-1]
    if p < i:
        a, b, c, d = p, i, j, k
    elif p < j:
        a, b, c, d = i, p, j, k
    elif p < k:
        a, b, c, d = i, j, p, k
    else:
        a, b, c, d = i, j, k, p
    whole = (
        numbers[_place(count, a, b, c)],
        numbers[_place(count, a, b, d)],
        numbers[_place(count, a, c, d)],
        numbers[_place(count, b, c, d)],
    )
    if whole[0] == hold:
        return whole[1], whole[2], whole[3]
    if whole[1] == hold:
        return whole[0], whole[2], whole[3]
    if whole[2] == hold:
        return whole[0], whole[1], whole[3]
    return whole[0], whole[1], whole[2]


@kept("the numbers of triples", error_model="numpy")
def _place(n, i, j, k):  # type: ignore[no-untyped-def]
    """Of i < j < k among all triples of n points."""
    m, rest = n - i, n - j
    before = (n * (n - 1) * (n - 2) - m * (m - 1) * (m - 2)) // 6
    return before + ((m - 1) * (m - 2) - rest * (rest - 1)) // 2 + k - j - 1


PLAIN_OTHERS.update({4: pair_others, 2: triple_others})


@overload(others_of)
def _others_of(holds, hold, point):  # type: ignore[no-untyped-def]
    if len(holds) == 4:
        return lambda holds, hold, point: pair_others(holds, hold, point)
    return lambda holds, hold, point: triple_others(holds, hold, point)


PAIRS = Moves(pair_others, widest, cheapest)
TRIPLES = Moves(triple_others, widest, cheapest)
