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


def in_lines(document: dict[str, Any], depth: int = 1) -> str:
    """JSON with a line for each value of a table, and of tables within it: long lists are not taken apart.

    ``InvalidInput`` for numbers that are not finite.
    """
    rows = []
    for key, value in document.items():
        if isinstance(value, dict) and value:
            text = in_lines(value, depth + 1)
        else:
            try:
                text = json.dumps(value, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
            except ValueError:
                raise InvalidInput(f"{key}: expected finite numbers") from None
        rows.append(f"{' ' * depth}{json.dumps(key, ensure_ascii=False)}: {text}")
    return "{\n" + ",\n".join(rows) + "\n" + " " * (depth - 1) + "}"


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A table of JSON, whose keys come once: of two values a reader would see either."""
    table = dict(pairs)
    if len(table) < len(pairs):
        keys = [key for key, _ in pairs]
        raise InvalidInput(f"the key {shown(max(keys, key=keys.count))} comes twice in one table")
    return table
