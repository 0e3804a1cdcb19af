"""Loops that are shared out to threads, and run alone where threads cannot be had.

Threads do not survive a fork. In a process forked from one that had started them, Numba ends the process or
waits for ever; so there the same loop, compiled without threads, does the work.
"""

import multiprocessing
import os
import sys
from collections.abc import Callable
from functools import cached_property
from types import FunctionType
from typing import Any

from numba import get_num_threads

from regrasp.compilation import kept


def _started() -> bool:
    """Whether Numba's threads were started, here or in the process this one was forked from."""
    parallel = sys.modules.get("numba.np.ufunc.parallel")
    return bool(getattr(parallel, "_is_initialized", parallel is not None))


# Imported for the first time in a child whose threads run already: they may be the parent's.
_alone = _started() and multiprocessing.parent_process() is not None


def _forked() -> None:
    global _alone
    _alone = _alone or _started()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)


class Shared:
    """A loop with ``prange``, called from Python: shared out to threads, or alone in a forked process."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        self._function, self._options = function, options
        self.__doc__ = function.__doc__

    def __call__(self, *arguments: Any) -> Any:
        """Run the loop."""
        return (self._by_one if _alone else self._by_all)(*arguments)

    @property
    def signatures(self) -> list[Any]:
        """Of the arguments that the shared loop was compiled for."""
        return list(self._by_all.signatures)

    @cached_property
    def _by_all(self) -> Any:
        return kept(parallel=True, **self._options)(self._function)

    @cached_property
    def _by_one(self) -> Any:
        shared, code = self._function, self._function.__code__
        name = f"{code.co_qualname}_alone"  # under which its machine code is kept
        alone = FunctionType(
            code.replace(co_name=f"{code.co_name}_alone", co_qualname=name),
            shared.__globals__,
            argdefs=shared.__defaults__,
            closure=shared.__closure__,
        )
        return kept(**self._options)(alone)


def shared(**options: Any) -> Callable[[Callable[..., Any]], Shared]:
    """The decorator: options as for ``numba.njit``."""
    return lambda function: Shared(function, options)


def threads() -> int:
    """How many threads share a loop."""
    return 1 if _alone else int(get_num_threads())
