"""JSON in a file: whole, with no key twice."""

import json
from pathlib import Path
from typing import Any

from regrasp.errors import InvalidInput, shown
from regrasp.files.source import text_of


def data_of(path: Path, what: str) -> Any:
    """What a file of JSON holds. Raises ``InvalidInput``, which begins with the path.

    what: what it should be, as "a plan".
    """
    text = text_of(path, f"{what} in JSON")
    try:
        return json.loads(text, object_pairs_hook=_unique)
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from None
    except RecursionError:
        raise InvalidInput(f"{path}: not {what}: lists within lists, many hundreds deep") from None
    except ValueError as error:
        raise InvalidInput(f"{path}: not JSON, or cut short: {error}") from None


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A table of JSON, whose keys come once: of two values a reader would see either."""
    table = dict(pairs)
    if len(table) < len(pairs):
        keys = [key for key, _ in pairs]
        raise InvalidInput(f"the key {shown(max(keys, key=keys.count))} comes twice in one table")
    return table
