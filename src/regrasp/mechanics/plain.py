"""Values to and from plain data: what JSON holds, with every number bit for bit."""

from collections.abc import Collection, Mapping
from typing import Any

from regrasp.errors import InvalidInput, shown


def entries(
    data: Any, what: str, required: Collection[str], optional: Collection[str] = ()
) -> dict[str, Any]:
    """The entries of a table with these keys. Raises ``InvalidInput`` for others, and for anything else."""
    if not isinstance(data, Mapping):
        raise InvalidInput(f"{what} must be a dictionary as to_dict makes it, got {shown(data)}")
    known = (*required, *optional)
    for key in data:
        if key not in known:
            raise InvalidInput(f"{what} has an unknown key {shown(key)}; known here: {', '.join(known)}")
    for key in required:
        if key not in data:
            raise InvalidInput(
                f"{what} must have the key {shown(key)}; it has {', '.join(map(str, data)) or 'none'}"
            )
    return dict(data)


def listed(data: Any, what: str) -> list[Any]:
    """A list or tuple, of anything. Raises ``InvalidInput`` for anything else."""
    if not isinstance(data, (list, tuple)):
        raise InvalidInput(f"{what} must be a list, got {shown(data)}")
    return list(data)
