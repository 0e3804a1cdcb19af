"""The cases of a study, made when they are asked for, each with a key that says what it is."""

import json
from collections.abc import Iterator, Mapping, Sequence
from hashlib import blake2b
from math import prod
from typing import Any

from regrasp.errors import InvalidInput, shown
from regrasp.studies.axes import Plain, plain, values_of

Case = dict[str, Plain]
_BYTES = 12  # of a key: two of 10^8 cases share one with a chance of 6e-14


def key_of(case: Mapping[str, Plain]) -> str:
    """The key of a case: the same for the same values, whatever their order, and for 1 and 1.0."""
    text = json.dumps(_canonical(dict(case)), sort_keys=True, separators=(",", ":"))
    return blake2b(text.encode(), digest_size=_BYTES).hexdigest()


def _canonical(value: Any) -> Any:
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if isinstance(value, dict):
        return {key: _canonical(entry) for key, entry in value.items()}
    return [_canonical(entry) for entry in value] if isinstance(value, list) else value


class Cases(Sequence[Case]):
    """Cases by number: all combinations of the values of each key, or those that stand side by side."""

    def __init__(self, axes: Mapping[str, Sequence[Plain]], *, zipped: bool) -> None:
        self.axes, self.zipped = dict(axes), zipped
        sizes = {key: len(values) for key, values in self.axes.items()}
        if zipped and len(set(sizes.values())) > 1:
            raise InvalidInput(
                f"zipped keys must have equally many values, got {shown(sizes)}; leave zipped out for all "
                "combinations"
            )
        self._count = next(iter(sizes.values())) if zipped else prod(sizes.values())
        self._refuse_doubles()

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, number: Any) -> Any:
        if isinstance(number, slice):
            return [self[k] for k in range(*number.indices(len(self)))]
        if not 0 <= number < len(self):
            raise IndexError(number)
        if self.zipped:
            return {key: values[number] for key, values in self.axes.items()}
        case = {}
        for key, values in reversed(self.axes.items()):  # the last key turns fastest
            number, place = divmod(number, len(values))
            case[key] = values[place]
        return {key: case[key] for key in self.axes}

    def __iter__(self) -> Iterator[Case]:
        return (self[number] for number in range(len(self)))

    @property
    def definition(self) -> dict[str, Any]:
        """What makes these cases, as plain data, with a digest in the place of long lists."""
        return {
            "zipped": self.zipped,
            "cases": len(self),
            "axes": {key: self._axis(values) for key, values in self.axes.items()},
        }

    def _axis(self, values: Sequence[Plain]) -> Any:
        if not self.zipped:
            return list(values)
        return {"count": len(values), "digest": key_of({"values": list(values)})}

    def _refuse_doubles(self) -> None:
        """Every case is there once. Of a product it is enough that no key has a value twice."""
        groups = [self] if self.zipped else [[{k: v} for v in values] for k, values in self.axes.items()]
        for group in groups:
            seen: dict[str, int] = {}
            for number, case in enumerate(group):
                before = seen.setdefault(key_of(case), number)
                if before != number:
                    raise InvalidInput(
                        f"cases must differ, got {shown(case)} at {before} and at {number}; take one out, or "
                        "add a key such as `seed` that tells them apart"
                    )


def cases_of(grid: Any, *, zipped: bool = False) -> Cases:
    """The cases of a grid: a mapping of keys to values, or a table: a list of cases, or a data frame.

    Raises ``InvalidInput`` for anything else, and where two cases are the same.
    """
    if hasattr(grid, "to_dict") and hasattr(grid, "columns"):
        grid = grid.to_dict("records")
    if isinstance(grid, (list, tuple)):
        return _tabled(grid)
    if not isinstance(grid, Mapping) or not grid:
        raise InvalidInput(
            f"grid must be a mapping of keys to values, a list of cases or a data frame, got {shown(grid)}"
        )
    return Cases({name(key): values_of(key, given) for key, given in grid.items()}, zipped=zipped)


def _tabled(rows: Sequence[Any]) -> Cases:
    if not rows or not all(isinstance(row, Mapping) and row and row.keys() == rows[0].keys() for row in rows):
        raise InvalidInput(f"a table must have cases, all with the same keys, got {shown(rows)}")
    axes = {name(key): [plain(row[key], f"values of {key}") for row in rows] for key in rows[0]}
    return Cases(axes, zipped=True)


def name(key: Any) -> str:
    """A key, which names a column."""
    if not isinstance(key, str) or not key.strip() or not key.isprintable():
        raise InvalidInput(f"keys of a grid must be text, got {shown(key)}")
    return key
