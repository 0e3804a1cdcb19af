"""The values of one key of a study: a list, a range, or numbers drawn from a distribution.

[0.2, 0.4]                                      these
{"from": 0.2, "to": 0.8, "count": 7}            evenly spaced, both ends included; "spacing": "log"
{"uniform": [0, 1], "count": 100, "seed": 1}    drawn; also "log_uniform", "normal" [mean, deviation]
                                                and "integers" [least, most], both included

A distribution draws the same numbers wherever it is.
"""

from collections.abc import Iterable, Mapping
from math import isfinite
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import number, whole

Plain = bool | int | float | str | list[Any] | None
"""What a case may hold."""
MOST = 10**9
_DRAWN = ("uniform", "log_uniform", "normal", "integers")
_FORMS = "a list, {from, to, count}, or {uniform | log_uniform | normal | integers, count, seed}"


def plain(value: Any, what: str) -> Plain:
    """A number, text, truth value, None, or lists of these; NumPy's are taken as Python's."""
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, int) and abs(value) < 2**63:
        return value
    if isinstance(value, float) and isfinite(value):
        return value
    if isinstance(value, (list, tuple)):
        return [plain(entry, what) for entry in value]
    raise InvalidInput(
        f"{what} must be finite numbers, text, truth values or lists of these, got {shown(value)}"
    )


def values_of(key: str, given: Any) -> list[Plain]:
    """The values of a key. Raises ``InvalidInput`` for what is none of the forms, or empty."""
    if isinstance(given, Mapping):
        values = _listed(key, given)
    elif isinstance(given, Iterable) and not isinstance(given, (str, bytes)):
        values = [plain(value, f"values of {key}") for value in given]
    else:
        raise InvalidInput(f"{key}: expected {_FORMS}, got {shown(given)}")
    if not values:
        raise InvalidInput(f"{key}: expected at least one value, got none")
    return values


def _listed(key: str, given: Mapping[str, Any]) -> list[Plain]:
    drawn = [kind for kind in _DRAWN if kind in given]
    known = {*drawn, "count", "seed"} if drawn else {"from", "to", "count", "spacing"}
    needed = known - {"spacing"}
    if len(drawn) > 1 or not needed <= set(given) or not set(given) <= known:
        raise InvalidInput(f"{key}: expected {_FORMS}, got {shown(dict(given))}")
    count = whole(given["count"], f"{key}: count", least=1, most=MOST)
    if drawn:
        return _draws(key, drawn[0], given[drawn[0]], count, given["seed"])
    first, last = number(given["from"], f"{key}: from"), number(given["to"], f"{key}: to")
    if given.get("spacing", "even") == "even":
        return [float(x) for x in np.linspace(first, last, count)]
    if given["spacing"] != "log" or min(first, last) <= 0:
        raise InvalidInput(
            f"{key}: spacing must be 'even', or 'log' between positive ends, got {shown(dict(given))}"
        )
    return [float(x) for x in np.geomspace(first, last, count)]


def _draws(key: str, kind: str, of: Any, count: int, seed: Any) -> list[Plain]:
    if not isinstance(of, (list, tuple)) or len(of) != 2:
        raise InvalidInput(f"{key}: {kind} needs two numbers, got {shown(of)}")
    rng = np.random.default_rng(whole(seed, f"{key}: seed", least=0))
    if kind == "integers":
        least, most = whole(of[0], f"{key}: least", least=-MOST), whole(of[1], f"{key}: most", least=of[0])
        return [int(x) for x in rng.integers(least, most, count, endpoint=True)]
    a, b = number(of[0], f"{key}: {kind}"), number(of[1], f"{key}: {kind}")
    if kind == "normal":
        return [float(x) for x in rng.normal(a, number(b, f"{key}: deviation", least=0.0), count)]
    if a > b or (kind == "log_uniform" and a <= 0):
        raise InvalidInput(f"{key}: {kind} needs its least and its largest number, got {shown(of)}")
    if kind == "uniform":
        return [float(x) for x in rng.uniform(a, b, count)]
    return [float(x) for x in np.exp(rng.uniform(np.log(a), np.log(b), count))]
