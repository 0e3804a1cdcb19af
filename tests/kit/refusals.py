"""What a call says when it refuses its arguments."""

from collections.abc import Callable
from typing import Any

import regrasp as rg


def refusal(call: Callable[[], Any]) -> str | None:
    """The message of ``InvalidInput``; None where the call went well. Every other error passes through."""
    try:
        call()
    except rg.InvalidInput as error:
        return str(error)
    return None
