"""Compiling functions with Numba, and keeping the machine code between runs wherever that is possible.

Numba keeps it beside the source or in the user's cache. Where it can do neither it raises, and a file that
was cut short or spoiled fails every later run. Here, a file that is not what was written is no file, and
where nothing can be kept, functions are compiled in memory: slower at the start of every run, and said once.

What compiles for more than a second says so: as ``INFO`` of the log ``regrasp`` and, where nobody listens to
that, on a terminal and in notebooks. ``regrasp warm-up`` compiles all there is.
"""

import logging
import os
import pickle
import sys
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from threading import Timer
from time import perf_counter
from typing import Any

from numba import njit
from numba.core import event
from numba.core.caching import FunctionCache, IndexDataCacheFile

_DIGEST = 32

_LONG = 1.0  # [s] of compiling that somebody who waits wants to know of

_log = logging.getLogger("regrasp")
_said: set[str] = set()
_words: dict[Any, str] = {}  # of functions that are called from outside


def kept(words: str = "", **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """``numba.njit`` with these options, whose machine code is kept for the next run where it can be.

    words: what it computes, for the message that it compiles; the first line of its docstring if not given.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        dispatcher = njit(**options)(function)
        _words[function] = words or (function.__doc__ or function.__name__).partition("\n")[0].rstrip(".")
        if not hasattr(dispatcher, "enable_caching"):  # NUMBA_DISABLE_JIT leaves functions as they are
            return dispatcher
        try:
            dispatcher._cache = _Cache(function)
        except (OSError, RuntimeError) as error:  # no folder can be written to
            _say_once(error)
        return dispatcher

    return compiled


def at_hand(dispatcher: Any) -> bool:
    """Whether a function that is ``kept`` was compiled in this process, or in one before."""
    files = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    return bool(getattr(dispatcher, "signatures", True)) or (files is not None and bool(files._load_index()))


class _Saying(event.Listener):
    """Says what compiles for long: that it does while it does, and then how long it took.

    Numba compiles one function at a time, with those that it calls inside of it.
    """

    def __init__(self) -> None:
        self._depth, self._started = 0, 0.0
        self._timer: Timer | None = None

    def on_start(self, started: Any) -> None:
        """A function, or one that it calls, begins to compile."""
        self._depth += 1
        words = _words.get(started.data["dispatcher"].py_func)
        if self._depth == 1 and words is not None:
            self._started = perf_counter()
            text = f"compiling {words}: some seconds, once; `regrasp warm-up` does it beforehand"
            self._timer = Timer(_LONG, _tell, [text])
            self._timer.daemon = True
            self._timer.start()

    def on_end(self, ended: Any) -> None:
        """It is compiled."""
        self._depth -= 1
        if self._depth == 0 and self._timer is not None:
            self._timer.cancel()
            self._timer, took = None, perf_counter() - self._started
            if took > _LONG:
                _tell(f"compiled {_words[ended.data['dispatcher'].py_func]} in {took:.1f} s")


event.register("numba:compile", _Saying())


def _tell(text: str) -> None:
    _log.info(text)
    stream = sys.stderr
    if stream is not None and not _log.hasHandlers() and (stream.isatty() or "ipykernel" in sys.modules):
        print(f"regrasp: {text}", file=stream, flush=True)


class _Cache(FunctionCache):
    """Numba's cache of a function; what cannot be read is compiled again, what cannot be written is not."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        impl = self._impl
        self._cache_file = _Files(self.cache_path, impl.filename_base, impl.locator.get_source_stamp())

    def load_overload(self, signature: Any, target: Any) -> Any:
        """The machine code of a signature; None where none is kept."""
        try:
            return super().load_overload(signature, target)
        except OSError:
            return None

    def save_overload(self, signature: Any, code: Any) -> None:
        """Keep the machine code of a signature, if the disk lets us."""
        try:
            super().save_overload(signature, code)
        except OSError as error:
            _say_once(error)


class _Files(IndexDataCacheFile):
    """Numba's files, each behind the digest of what was written; the code names what it is the code of."""

    def save(self, key: Any, data: Any) -> None:
        """Write the code of a key, and the key."""
        super().save(key, (key, data))

    def load(self, key: Any) -> Any:
        """None where another process wrote other code under the name that was given to ours."""
        found = super().load(key)
        return found[1] if found is not None and found[0] == key else None

    def _save_index(self, overloads: dict[Any, str]) -> None:
        with self._open_for_write(self._index_path) as file:
            file.write(self._dump((self._version, self._source_stamp, overloads)))

    def _load_index(self) -> dict[Any, str]:
        kept = _read(self._index_path)
        if kept is None or kept[:2] != (self._version, self._source_stamp):
            return {}
        overloads: dict[Any, str] = kept[2]
        return overloads

    def _load_data(self, name: str) -> Any:
        return _read(self._data_path(name))

    def _dump(self, value: Any) -> bytes:
        data: bytes = super()._dump(value)
        return sha256(data).digest() + data


def _read(path: str) -> Any:
    """What was dumped to a file; None where there is none, or not all of it, or something else."""
    try:
        content = Path(path).read_bytes()
    except OSError:
        return None
    digest, data = content[:_DIGEST], content[_DIGEST:]
    return pickle.loads(data) if sha256(data).digest() == digest else None


def _say_once(error: Exception) -> None:
    """One line for a process: each of its functions meets the same disk."""
    if "memory" not in _said:
        _said.add("memory")
        reason = os.strerror(error.errno) if isinstance(error, OSError) and error.errno else "no folder"
        _log.warning(
            "compiled code cannot be kept (%s), so every run compiles anew; "
            "set NUMBA_CACHE_DIR to a folder that can be written to",
            reason,
        )
