"""Random edits of plain data, as a slip, a broken tool or a forger makes them. Knows nothing of plans.

Numbers nudged at every scale, given another sign, another type or none; entries swapped, dropped, doubled,
put into another order; keys removed, added and exchanged; names taken from elsewhere in the document. A
forger changes a number wherever it stands.
"""

import copy
from math import inf, nan, nextafter
from random import Random
from typing import Any

WORDS = ("removal", "addition", "exchange", "rotation", "hold", "start", "end", "angle", "peak", "normal")
ODD = (None, True, "", "x\ny", "\ud7ff", [], {}, [[]], 0, 1e308, -1e308, 5e-324, 10**400, nan, inf, "1.0")


def edited(data: Any, rng: Random, kept: tuple[str, ...] = ()) -> tuple[Any, str]:
    """A copy with one to three edits, and what they were; top-level keys that are ``kept`` stay."""
    data, said = copy.deepcopy(data), []
    for _ in range(rng.choice((1, 1, 1, 1, 1, 2, 3))):
        place = _place(data, rng, kept)
        if place:
            said.append(f"{'.'.join(map(str, place))} {_edit(data, place, rng)}")
    return data, "; ".join(said)


def _place(data: Any, rng: Random, kept: tuple[str, ...]) -> tuple[Any, ...]:
    """The keys that lead to a value; tables and lists are chosen now and then, too."""
    place: tuple[Any, ...] = ()
    while isinstance(data, (dict, list)) and data:
        if place and rng.random() < 0.12:
            break
        keys = [k for k in data if place or k not in kept] if isinstance(data, dict) else range(len(data))
        key = rng.choice(list(keys))
        place, data = (*place, key), data[key]
    return place


def _edit(data: Any, place: tuple[Any, ...], rng: Random) -> str:
    table = data
    for key in place[:-1]:
        table = table[key]
    key, old = place[-1], table[place[-1]]
    if rng.random() < 0.04:
        table[key] = copy.deepcopy(rng.choice(ODD))
        return f"is {str(table[key])[:20]!r}"
    if isinstance(old, (int, float)) and not isinstance(old, bool):
        new = _number(old, rng)
        if rng.random() < 0.2:
            return f"{old!r} -> {new!r} at {_everywhere(data, old, new)} places"
        table[key] = new
        return f"{old!r} -> {new!r}"
    if isinstance(old, str):
        new = rng.choice((*WORDS, *_strings(data)[:40]))
        if rng.random() < 0.4:
            return f"{old!r} -> {new!r} at {_everywhere(data, old, new)} places"
        table[key] = new
        return f"{old!r} -> {new!r}"
    if isinstance(old, list) and old and rng.random() < 0.9:
        return _order(old, rng)
    if isinstance(old, dict) and old and rng.random() < 0.6:
        one, other = rng.choice(list(old)), rng.choice(list(old))
        old[one], old[other] = old[other], old[one]
        return f"{one} and {other} exchanged"
    if isinstance(table, dict):
        if rng.random() < 0.5:
            del table[key]
            return "gone"
        table[rng.choice((f"{key}x", *table))] = copy.deepcopy(old)
        return "copied to another key"
    table[key] = copy.deepcopy(rng.choice((None, True, *table)))
    return "of another place"


def _number(old: float, rng: Random) -> float:
    how = rng.random()
    if isinstance(old, int) and abs(old) > 10**300:
        return rng.choice((0, -old))
    if how < 0.45:
        new = old * (1 + rng.choice((-1, 1)) * 10.0 ** rng.randint(-17, 0))
    elif how < 0.6:
        new = old + rng.choice((-1, 1)) * 10.0 ** rng.randint(-16, 3)
    elif how < 0.7:
        new = nextafter(old, rng.choice((-inf, inf)))
    elif how < 0.8:
        new = -old
    elif how < 0.9:
        new = old * 10.0 ** rng.randint(-12, 12)
    else:
        new = rng.choice((0.0, 1.0, -1.0, 2.0, float(rng.randint(-9, 9))))
    if isinstance(old, int):
        return int(new) if abs(new) < 1e9 and new != old and rng.random() < 0.8 else old + rng.choice((-1, 1))
    return new


def _order(rows: list[Any], rng: Random) -> str:
    k, j = rng.randrange(len(rows)), rng.randrange(len(rows))
    how = rng.choice(("dropped", "doubled", "swapped", "turned round", "moved on", "emptied", "copied over"))
    if how == "dropped":
        del rows[k]
    elif how == "doubled":
        rows.insert(k, copy.deepcopy(rows[k]))
    elif how == "swapped":
        rows[k], rows[j] = rows[j], rows[k]
    elif how == "turned round":
        rows.reverse()
    elif how == "moved on":
        rows.append(rows.pop(0))
    elif how == "emptied":
        rows.clear()
    else:
        rows[k] = copy.deepcopy(rows[j])
    return f"{k} {how}"


def _everywhere(data: Any, old: Any, new: Any) -> int:
    """Put ``new`` in the place of every equal value of the same type, of ``-new`` where ``-old`` stands."""
    count = 0
    for key, value in list(data.items() if isinstance(data, dict) else enumerate(data)):
        if isinstance(value, (dict, list)):
            count += _everywhere(value, old, new)
        elif type(value) is type(old) and value == old:
            data[key] = new
            count += 1
        elif isinstance(old, float) and isinstance(value, float) and value == -old:
            data[key] = -new
            count += 1
    return count


def _strings(data: Any) -> list[str]:
    if isinstance(data, str):
        return [data]
    inside = data.values() if isinstance(data, dict) else data if isinstance(data, list) else ()
    return [word for value in inside for word in _strings(value)]
