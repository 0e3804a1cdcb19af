"""Whether a verb is only asked if it has an answer: then a refusal needs no reason, which takes longest."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_ONLY: ContextVar[bool] = ContextVar("only whether", default=False)


@contextmanager
def asking_only() -> Iterator[None]:
    """No proofs, and no second attempts at the very edge, of what is refused inside."""
    before = _ONLY.set(True)
    try:
        yield
    finally:
        _ONLY.reset(before)


def is_asked_only() -> bool:
    """Whether no reasons are wanted."""
    return _ONLY.get()
