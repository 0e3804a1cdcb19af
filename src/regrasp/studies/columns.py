"""Types of columns, which only ever widen: so that all parts of a study can be of one schema.

    none -> bool, whole, number, numbers, text        whole -> number        anything else -> text

Widening two types is commutative and associative, so the columns do not depend on the order of the rows.
"""

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from regrasp.studies.axes import Plain

if TYPE_CHECKING:
    import pyarrow

NONE, BOOL, WHOLE, NUMBER, NUMBERS, TEXT = "none", "bool", "whole", "number", "numbers", "text"
FIXED = {
    "verdict": TEXT, "error": TEXT, "certificate": TEXT, "seconds": NUMBER, "machine": TEXT, "versions": TEXT,
}  # fmt: skip
"""Columns of every row, after its key, its inputs and its outputs."""

Columns = dict[str, str]


def type_of(value: Plain) -> str:
    """The narrowest type that holds a value."""
    if value is None:
        return NONE
    if isinstance(value, bool):
        return BOOL
    if isinstance(value, int):
        return WHOLE
    if isinstance(value, float):
        return NUMBER
    if isinstance(value, list) and all(type(entry) in (int, float) for entry in value):
        return NUMBERS
    return TEXT


def wider(one: str, other: str) -> str:
    """The narrowest type that holds what both hold."""
    if one == other or other == NONE:
        return one
    if one == NONE:
        return other
    return NUMBER if {one, other} == {WHOLE, NUMBER} else TEXT


def widened(columns: Columns, row: Mapping[str, Plain]) -> Columns:
    """The columns that hold a row besides; the same object where they do already."""
    new = {}
    for name, value in row.items():
        before = columns.get(name)
        now = type_of(value) if before is None else wider(before, type_of(value))
        if now != before:
            new[name] = now
    return {**columns, **new} if new else columns


def held(value: Plain, kind: str) -> Any:
    """A value as a column of a type holds it."""
    if value is None:
        return None
    if kind == NUMBER:
        return float(value)  # type: ignore[arg-type] # a whole number
    if kind == NUMBERS:
        return [float(entry) for entry in value]  # type: ignore[union-attr]
    if kind == TEXT and not isinstance(value, str):
        return json.dumps(_floats(value))
    return value


def _floats(value: Any) -> Any:
    """Whole numbers as floats, so that a number is the same text whichever column it was in before."""
    if isinstance(value, list):
        return [_floats(entry) for entry in value]
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


def schema_of(columns: Columns) -> "pyarrow.Schema":
    """The Arrow schema of a study's columns; one that no row has filled yet holds numbers."""
    import pyarrow as pa

    kinds = {
        NONE: pa.float64(), BOOL: pa.bool_(), WHOLE: pa.int64(), NUMBER: pa.float64(), TEXT: pa.string(),
        NUMBERS: pa.list_(pa.float64()),
    }  # fmt: skip
    return pa.schema([pa.field(name, kinds[kind]) for name, kind in columns.items()])
