"""The measures of ``audit`` once more, number by number."""

from math import inf, sqrt

import numpy as np

from regrasp.programs.judging.audit import MOST
from regrasp.programs.judging.terms import ROUNDING
from regrasp.programs.judging.units import OWN, PASSES


def _products(indptr, indices, data, x, sizes, rows):
    """A x, |A| sizes."""
    result, terms = np.zeros(rows), np.zeros(rows)
    for j in range(x.size):
        for k in range(indptr[j], indptr[j + 1]):
            result[indices[k]] += data[k] * x[j]
            terms[indices[k]] += abs(data[k]) * sizes[j]
    return result, terms


def _length(values, start, stop):
    squares = 0.0
    for i in range(start, stop):
        squares += values[i] * values[i]
    return sqrt(squares)


def _inverse(values):
    inverse = np.zeros(values.size)
    for i in range(values.size):
        if values[i] != 0:
            inverse[i] = 1 / values[i]
    return inverse


def _of_cones(codes, values, together):
    """The values of rows, of each second-order cone the length of its own, or the largest."""
    row = 0
    for kind, size, count in codes:
        for _ in range(count):
            if kind == 2:
                whole = _length(values, row, row + size)
                if not together:
                    whole = 0.0
                    for i in range(row, row + size):
                        whole = max(whole, values[i])
                values[row : row + size] = whole
            row += size
    return values


def _passed_on(ap, ai, ad, noise, codes, rows, columns, of_rows):
    """Inverse units of columns, or of rows, passed on through rows, or columns, that have none: ``units``."""
    fixed = rows > 0 if of_rows else columns > 0
    for number in range(PASSES):
        if number > 0:  # what has a unit keeps it
            had_rows, had_columns = rows > 0, columns > 0
        else:
            had_rows, had_columns = np.zeros(rows.size, np.bool_), np.zeros(columns.size, np.bool_)
        if of_rows:
            rows[:] = np.where(fixed, rows, 0.0)
        else:
            columns[:] = np.where(fixed, columns, 0.0)
        for j in range(ap.size - 1):  # where none is fixed, the largest that comes back
            for k in range(ap[j], ap[j + 1]):
                i, entry = ai[k], abs(ad[k])
                if entry > noise[i]:
                    if of_rows and not fixed[i]:
                        rows[i] = max(rows[i], columns[j] / entry)
                    elif not of_rows and not fixed[j]:
                        columns[j] = max(columns[j], rows[i] / entry)
        if of_rows:
            _of_cones(codes, rows, False)
        changed = False
        for j in range(ap.size - 1):
            for k in range(ap[j], ap[j + 1]):
                i, entry = ai[k], abs(ad[k])
                if of_rows and not had_columns[j] and columns[j] < entry * rows[i]:
                    columns[j], changed = entry * rows[i], True
                elif not of_rows and not had_rows[i] and rows[i] < entry * columns[j]:
                    rows[i], changed = entry * columns[j], True
        if not of_rows:
            _of_cones(codes, rows, False)
        if not changed:
            break


def _inverse_units(pp, pi, pd, q, ap, ai, ad, noise, b, codes):
    rows, columns = _inverse(_of_cones(codes, np.abs(b), True)), np.zeros(q.size)
    for j in range(q.size):
        for k in range(pp[j], pp[j + 1]):
            if q[pi[k]] != 0 and (pi[k] == j or q[j] == 0):
                columns[j] = max(columns[j], abs(pd[k]) / abs(q[pi[k]]))
        for k in range(ap[j], ap[j + 1]):
            columns[j] = max(columns[j], abs(ad[k]) * rows[ai[k]])
    _passed_on(ap, ai, ad, noise, codes, rows, columns, True)
    return columns


def _inverse_units_of_duals(ap, ai, ad, noise, pulls, codes, m):
    rows, columns = np.zeros(m), _inverse(pulls)
    for j in range(pulls.size):
        for k in range(ap[j], ap[j + 1]):
            rows[ai[k]] = max(rows[ai[k]], abs(ad[k]) * columns[j])
    _of_cones(codes, rows, False)
    _passed_on(ap, ai, ad, noise, codes, rows, columns, False)
    return rows


def _ratio(amount, unit):
    if amount == 0:
        return 0.0
    return amount / unit if unit != 0 else inf


def _worse(worst, value):
    """The larger one, and NaN once there is one."""
    return worst if worst != worst or value <= worst else value


def _into_dual(codes, z):
    inside, row = z.copy(), 0
    for kind, size, count in codes:
        if kind == 1:
            for i in range(row, row + size * count):
                if -inf < z[i] < 0:
                    inside[i] = 0.0
            row += size * count
        elif kind == 2:
            for _ in range(count):
                length = _length(z, row + 1, row + size)
                if length > z[row]:
                    along = max((z[row] + length) / 2, 0.0)
                    share = along / length if length > 0 else 0.0
                    inside[row] = along
                    for i in range(row + 1, row + size):
                        inside[i] = z[i] * share
                row += size
        else:
            row += size * count
    return inside


def _counted(weight, terms, unit):
    """What counts of terms beside a unit: the less, the more of them cancels."""
    return _lessened(weight * terms, unit) if weight < 1 else terms


def _lessened(counted, unit):
    if unit > 0 and counted > MOST * unit:
        return (MOST * unit) ** 2 / counted
    return counted


def measures(pp, pi, pd, q, ap, ai, ad, b, codes, size_of_x, x, z):
    """The fields of ``Audit``."""
    n, m = q.size, b.size
    noise = np.zeros(m)
    for k in range(ad.size):
        noise[ai[k]] = max(noise[ai[k]], ROUNDING * abs(ad[k]))
    _of_cones(codes, noise, False)
    if size_of_x > 0:
        unknowns = np.full(n, 1 / size_of_x)
    else:
        unknowns = _inverse_units(pp, pi, pd, q, ap, ai, ad, noise, b, codes)
    weight = 1.0 if size_of_x > 0 else OWN
    least = _inverse(unknowns)
    sizes = np.maximum(np.abs(x), least)
    px, abs_px = _products(pp, pi, pd, x, np.abs(x), n)
    _, of_sizes = _products(pp, pi, pd, x, sizes, n)
    _, pulls = _products(pp, pi, pd, x, least, n)
    pulls += np.abs(q)
    ax, of_rows = _products(ap, ai, ad, x, np.abs(x), m)
    own_rows = of_rows.copy()
    inside = _into_dual(codes, z)
    largest, duals = 0.0, np.zeros(m)
    if size_of_x > 0:
        for j in range(n):
            largest = max(largest, pulls[j])
    else:
        duals = _inverse_units_of_duals(ap, ai, ad, noise, pulls, codes, m)
    s = b - ax
    dual = stationarity = quadratic = linear = value = of_gap = moved = 0.0
    per_dual, floor = np.zeros(m), np.zeros(m)
    for j in range(n):
        gradient, own, alone = px[j] + q[j], abs_px[j], 0.0
        for k in range(ap[j], ap[j + 1]):
            i, entry = ai[k], abs(ad[k])
            gradient += ad[k] * inside[i]
            own += entry * abs(inside[i])
            if size_of_x > 0:
                floor[i] = max(floor[i], entry * size_of_x)
            elif entry > noise[i]:
                alone = max(alone, duals[i] / entry)
                floor[i] = max(floor[i], unknowns[j] / entry)
        unit = pulls[j] + largest
        if alone != 0:
            unit += 1 / alone
        whole = unit + own
        if whole != 0:
            for k in range(ap[j], ap[j + 1]):
                per_dual[ai[k]] = max(per_dual[ai[k]], abs(ad[k]) / whole)
        dual = _worse(dual, _ratio(abs(gradient), unit + _counted(weight, own, unit)))
        stationarity = _worse(stationarity, abs(gradient))
        quadratic += x[j] * px[j]
        linear += q[j] * x[j]
        of_gap += sizes[j] * (of_sizes[j] + abs(q[j]))
    units = np.abs(b) + (floor if size_of_x > 0 else _inverse(floor))
    for i in range(m):
        of_rows[i] = units[i] + _counted(weight, own_rows[i], units[i])
    own_rows += units
    for i in range(m):
        value += b[i] * inside[i]
        of_gap += abs(b[i] * inside[i])
        moved = _worse(moved, abs(z[i] - inside[i]))
    primal = both = violation = 0.0
    row = 0
    for kind, size, count in codes:
        for _ in range(count):
            if kind == 2:
                unit, per = _length(of_rows, row, row + size), _length(per_dual, row, row + size)
                excess, product = _length(s, row + 1, row + size) - s[row], 0.0
                for i in range(row, row + size):
                    product += s[i] * inside[i]
                excess = excess if excess > 0 or excess != excess else 0.0
                primal = _worse(primal, _ratio(excess, unit))
                both = _worse(both, _ratio(abs(product) * per, _length(own_rows, row, row + size)))
                violation = _worse(violation, excess)
            else:
                for i in range(row, row + size):
                    excess = abs(s[i]) if kind == 0 else -s[i]
                    excess = excess if excess > 0 or excess != excess else 0.0
                    primal = _worse(primal, _ratio(excess, of_rows[i]))
                    both = _worse(both, _ratio(abs(s[i] * inside[i]) * per_dual[i], own_rows[i]))
                    violation = _worse(violation, excess)
            row += size
    gap = abs(quadratic + linear + value)
    if size_of_x == 0:
        unit = 0.0
        for j in range(n):
            unit += least[j] * pulls[j]
        of_gap = unit + _lessened(of_gap, unit)
    relative = gap / of_gap if gap != 0 else 0.0
    return primal, dual, both, relative, quadratic / 2 + linear, violation, moved, stationarity, gap
