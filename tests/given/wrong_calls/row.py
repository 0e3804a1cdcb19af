"""A row of the table, and the wrong calls that it makes."""

import inspect
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from wrong_calls.wrong import KINDS, LONG, NAMES


class Row(NamedTuple):
    """A call that is right; kinds of parameters that their names do not tell; parameters of no kind."""

    call: Callable[..., Any]
    right: dict[str, Any]
    kinds: dict[str, str] = {}  # noqa: RUF012 - never changed
    free: tuple[str, ...] = ()


class Case(NamedTuple):
    """One wrong call."""

    name: str
    parameter: str
    wrong: Any


def cases(row_name: str, row: Row) -> Iterator[Case]:
    """Every wrong value for every parameter of a row."""
    for name, parameter in inspect.signature(row.call).parameters.items():
        if name in row.free:
            continue
        kind = row.kinds.get(name, NAMES.get(name))
        assert kind is not None, f"{row_name}: no kind of wrong values for its parameter {name!r}"
        for wrong in KINDS[kind]:
            if not (wrong is None and parameter.default is None):
                yield Case(row_name, name, wrong)
    for name in set(row.right) - inspect.signature(row.call).parameters.keys():  # options of a verb
        for wrong in KINDS[NAMES[name]]:
            yield Case(row_name, name, wrong)


def long_cases(row_name: str, row: Row) -> Iterator[Case]:
    """Every parameter of a row with text and lists that are long; some may be right."""
    parameters = inspect.signature(row.call).parameters
    names = (parameters.keys() | row.right.keys()) - {*row.free, "options"}
    needed = {
        name
        for name in parameters.keys() - {"options"}
        if parameters[name].default is inspect.Parameter.empty
    }
    for name in sorted(names):
        if row.kinds.get(name, NAMES.get(name)) not in ("name", "own word") and needed <= row.right.keys() | {
            name
        }:
            yield from (Case(row_name, name, wrong) for wrong in LONG)


def called_wrongly(row: Row, case: Case) -> Any:
    """The call with the one wrong argument."""
    given = row.right | {case.parameter: case.wrong}
    positional = [
        given.pop(name)
        for name, parameter in inspect.signature(row.call).parameters.items()
        if parameter.kind is inspect.Parameter.POSITIONAL_ONLY and name in given
    ]
    return row.call(*positional, **given)
