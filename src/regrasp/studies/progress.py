"""How far a study is: on a terminal, in a notebook, and in the log ``regrasp``."""

import logging
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import import_module
from time import monotonic
from typing import Any

from regrasp.studies.task import ANSWERED

_log = logging.getLogger("regrasp")
_OFTEN, _SELDOM = 0.5, 60.0  # seconds between lines that replace each other, and between those of a log


@dataclass
class Progress:
    """How far a study is.

    total: cases. before: rows that were there. verdicts: of the rows that came since. where: in words.
    seconds: those rows took, all together [s].
    """

    total: int
    before: int
    where: str
    verdicts: Counter[str] = field(default_factory=Counter)
    started: float = field(default_factory=monotonic)
    seconds: float = 0.0

    def count(self, verdict: str, seconds: float) -> None:
        """A row came."""
        self.verdicts[verdict] += 1
        self.seconds += seconds

    @property
    def new(self) -> int:
        """Rows that came."""
        return self.verdicts.total()

    @property
    def done(self) -> int:
        """Rows that are there."""
        return self.before + self.new

    @property
    def rate(self) -> float:
        """Rows a second, of this run."""
        return self.new / max(monotonic() - self.started, 1e-9)

    @property
    def left(self) -> float | None:
        """Seconds that are left at this rate; None before the first row."""
        return (self.total - self.done) / self.rate if self.new else None

    def __str__(self) -> str:
        left = "" if self.left is None else f", {self.rate:.3g}/s, {in_words(self.left)} left"
        others = [f"{word} {n}" for word, n in sorted(self.verdicts.items()) if word != ANSWERED]
        return (
            f"{self.done} of {self.total} rows {self.where}{left}{'; ' if others else ''}{', '.join(others)}"
        )


def in_words(seconds: float) -> str:
    """A time that is left, to two figures or so."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"


class Reporter:
    """Says how far a study is, wherever somebody looks.

    listen: called with the ``Progress`` now and then, in the place of terminal and notebook; None for these.
    quiet: neither.
    """

    def __init__(self, listen: Callable[[Progress], Any] | None, quiet: bool) -> None:
        self._listen, self._show = listen, None if listen or quiet else _display()
        self._shown = self._logged = -_SELDOM

    def tell(self, progress: Progress, *, last: bool = False) -> None:
        """Say it, unless that was done a moment ago."""
        now = monotonic()
        if last or now - self._shown >= _OFTEN:
            self._shown = now
            if self._listen is not None:
                self._listen(progress)
            if self._show is not None:
                self._show(str(progress), last)
        if last or now - self._logged >= _SELDOM:
            self._logged = now
            _log.info("%s", progress)

    def note(self, text: str) -> None:
        """A line that stays."""
        _log.info(text)
        if self._show is not None:
            self._show(text, True)


def _display() -> Callable[[str, bool], None] | None:
    """Shows a line in the place of the one before; None where nobody would see it."""
    if "ipykernel" in sys.modules:
        show: Any = import_module("IPython.display").display

        handles: list[Any] = []

        def in_notebook(text: str, last: bool) -> None:
            if handles:
                handles[0].update({"text/plain": text}, raw=True)
            else:
                handles.append(show({"text/plain": text}, raw=True, display_id=True))
            if last:
                handles.clear()

        return in_notebook
    stream = sys.stderr
    if stream is None or not stream.isatty():
        return None

    def on_terminal(text: str, last: bool) -> None:
        stream.write(f"\r\x1b[K{text}{chr(10) if last else ''}")
        stream.flush()

    return on_terminal
