"""What a file in the Conic Benchmark Format says, line by line and strictly."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.programs.blocks import Array

_VERSIONS = ("1", "2", "3", "4")
_CONES = ("F", "L=", "L+", "L-", "Q", "QR")
# The least sizes of the cones that have one.
_LEAST = {"Q": 1, "QR": 2}
_KNOWN = ("VER", "OBJSENSE", "VAR", "CON", "OBJACOORD", "ACOORD", "BCOORD")

Cones = list[tuple[str, int]]
Places = NDArray[np.intp]


@dataclass
class Items:
    """minimise c'y subject to a y + b in the cones of ``constraints`` and y in those of ``variables``.

    variables, constraints: words and sizes, in order. c: (variables,). b: (constraints,). a: rows, columns
    and values.
    """

    variables: Cones = field(default_factory=list)
    constraints: Cones = field(default_factory=list)
    c: Array = field(default_factory=lambda: np.zeros(0))
    b: Array = field(default_factory=lambda: np.zeros(0))
    a: tuple[Places, Places, Array] = field(
        default_factory=lambda: (np.zeros(0, np.intp), np.zeros(0, np.intp), np.zeros(0))
    )

    @classmethod
    def read(cls, path: Path) -> "Items":
        """The items of a file. Raises ``InvalidInput`` with the line where it is not what is taken."""
        return _Reader(path).items()


class _Reader:
    def __init__(self, path: Path) -> None:
        self.path, self.number = path, 0
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InvalidInput(f"{path}: cannot be read as text: {error}") from None
        self.rest = iter(list(enumerate(text.splitlines(), 1)))

    def items(self) -> Items:
        items, seen = Items(), set[str]()
        for keyword in self._keywords():
            if keyword not in _KNOWN:
                self._refuse(f"one of {', '.join(_KNOWN)}", keyword)
            if keyword in seen:
                self._refuse("each item once", f"{keyword} again")
            if not seen and keyword != "VER":
                self._refuse("VER first", keyword)
            seen.add(keyword)
            if keyword == "VER":
                self._word("a version", _VERSIONS)
            elif keyword == "OBJSENSE":
                self._word("the sense", ("MIN",))
            elif keyword == "VAR":
                items.variables = self._cones()
            elif keyword == "CON":
                items.constraints = self._cones()
            else:
                self._data(keyword, items)
        missing = [word for word in ("VER", "OBJSENSE", "VAR") if word not in seen]
        if missing:
            self._refuse(f"{', '.join(missing)} in the file", "its end")
        n, m = sum(s for _, s in items.variables), sum(s for _, s in items.constraints)
        items.c = items.c if items.c.size else np.zeros(n)
        items.b = items.b if items.b.size else np.zeros(m)
        return items

    def _data(self, keyword: str, items: Items) -> None:
        n, m = sum(s for _, s in items.variables), sum(s for _, s in items.constraints)
        if keyword == "OBJACOORD":
            items.c = self._vector(n)
        elif keyword == "BCOORD":
            items.b = self._vector(m)
        else:
            found = self._entries((m, n))
            rows, columns = (np.array([place[k] for place in found], dtype=np.intp) for k in (0, 1))
            items.a = (rows, columns, np.array(list(found.values()), dtype=np.float64))

    def _vector(self, size: int) -> Array:
        result = np.zeros(size)
        for (place,), value in self._entries((size,)).items():
            result[place] = value
        return result

    def _keywords(self) -> Iterator[str]:
        for number, line in self.rest:
            self.number = number
            if line.strip() and not line.startswith("#"):
                yield line.strip()

    def _line(self, words: int, what: str) -> list[str]:
        """The next line's words; inside an item every line counts."""
        self.number, line = next(self.rest, (self.number + 1, ""))
        found = line.split()
        if len(found) != words:
            self._refuse(what, line or "an empty line")
        return found

    def _word(self, what: str, allowed: tuple[str, ...]) -> None:
        (word,) = self._line(1, what)
        if word not in allowed:
            self._refuse(f"{what}: {' or '.join(allowed)}", word)

    def _whole(self, word: str, what: str, below: int | None = None) -> int:
        if not word.isascii() or not word.isdigit() or (below is not None and int(word) >= below):
            self._refuse(what if below is None else f"{what} below {below}", word)
        return int(word)

    def _cones(self) -> Cones:
        total, count = (
            self._whole(word, "a count") for word in self._line(2, "how many entries, in how many cones")
        )
        cones = []
        for _ in range(count):
            word, text = self._line(2, "a cone and its size")
            size = self._whole(text, "a size")
            if word not in _CONES:
                self._refuse(f"a cone among {', '.join(_CONES)}", word)
            if size < _LEAST.get(word, 0):
                self._refuse(f"{word} of at least {_LEAST[word]} entries", text)
            cones.append((word, size))
        if sum(size for _, size in cones) != total:
            self._refuse(f"cones of {total} entries together", f"{sum(size for _, size in cones)}")
        return cones

    def _entries(self, shape: tuple[int, ...]) -> dict[tuple[int, ...], float]:
        (text,) = self._line(1, "how many entries")
        found: dict[tuple[int, ...], float] = {}
        for _ in range(self._whole(text, "a count")):
            *places, word = self._line(len(shape) + 1, f"{len(shape)} place(s) and a value")
            place = tuple(
                self._whole(where, "a place", below) for where, below in zip(places, shape, strict=True)
            )
            try:
                value = float(word)
            except ValueError:
                self._refuse("a number", word)
            if not isfinite(value):
                self._refuse("a finite number", word)
            if place in found:
                self._refuse("each entry once", f"{place} again")
            found[place] = value
        return found

    def _refuse(self, expected: str, found: str) -> NoReturn:
        raise InvalidInput(f"{self.path}, line {self.number}: expected {expected}, found {shown(found)}")
