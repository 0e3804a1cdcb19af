"""Compiled loops over many items, shared out to threads.

A loop over a part of the items is compiled to run without Python's lock, and threads run it side by side,
each on one part after the other. Numba's own ``prange`` takes seconds more to compile, and threads that it
has started do not survive a fork; these live for one call only.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

from regrasp.compilation import at_hand, kept
from regrasp.threads import threads

_PARTS = 4  # for each thread, since parts differ in work


class Shared:
    """A compiled loop ``function(first, last, *arguments)``, called as ``(items, *arguments)``."""

    def __init__(self, function: Callable[..., Any], words: str, options: dict[str, Any]) -> None:
        self._loop = kept(words, nogil=True, **options)(function)
        self.__doc__ = function.__doc__

    def __call__(self, items: int, *arguments: Any) -> list[Any]:
        """What the loop returns for each part."""
        parts = min(items, _PARTS * threads())
        if threads() == 1 or parts < 2:
            return [self._loop(0, items, *arguments)]
        ends = pairwise(items * k // parts for k in range(parts + 1))
        with ThreadPoolExecutor(threads()) as pool:
            return list(pool.map(lambda part: self._loop(*part, *arguments), ends))

    @property
    def is_at_hand(self) -> bool:
        """Whether it need not be compiled."""
        return at_hand(self._loop)

    @property
    def plain(self) -> Callable[..., Any]:
        """The loop as it was written, which is not compiled."""
        function: Callable[..., Any] = getattr(self._loop, "py_func", self._loop)
        return function

    @property
    def signatures(self) -> list[Any]:
        """Of the arguments that the loop was compiled for."""
        return list(self._loop.signatures)


def shared(words: str, **options: Any) -> Callable[[Callable[..., Any]], Shared]:
    """The decorator: words as for ``kept``, options as for ``numba.njit``."""
    return lambda function: Shared(function, words, options)
