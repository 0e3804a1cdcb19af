"""Names of a room that are imported when they are asked for."""

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from sys import modules


def later(
    room: str, where: Mapping[str, str], made: Callable[[object], object] | None = None
) -> tuple[Callable[[str], object], Callable[[], Sequence[str]]]:
    """``__getattr__`` and ``__dir__`` of a room.

    Args:
        room: its ``__name__``.
        where: the module of each name, from the room on.
        made: what becomes of each value before the room has it.
    """

    def found(name: str) -> object:
        if name not in where:
            raise AttributeError(f"module {room!r} has no attribute {name!r}")
        value: object = getattr(import_module(f"{room}.{where[name]}"), name)
        value = value if made is None else made(value)
        setattr(modules[room], name, value)
        return value

    return found, lambda: sorted({*vars(modules[room]), *where})
