"""What a call says when it refuses its arguments."""

import re
from collections.abc import Callable
from typing import Any

import pytest

import regrasp as rg


def refusal(call: Callable[[], Any]) -> str | None:
    """The message of ``InvalidInput``; None where the call went well. Every other error passes through."""
    try:
        call()
    except rg.InvalidInput as error:
        return str(error)
    return None


def check_error(call: Callable[[], object], error: type[Exception], message: str | re.Pattern[str]) -> None:
    """A call raises this very class, with this text."""
    pattern = message.pattern if isinstance(message, re.Pattern) else re.escape(message)
    with pytest.raises(error) as raised:
        call()
    assert type(raised.value) is error
    assert re.fullmatch(pattern, str(raised.value), re.DOTALL), str(raised.value)


def refused(call: Callable[..., Any], *args: Any, **options: Any) -> str:
    """The one line with which a call refuses its arguments."""
    with pytest.raises(rg.InvalidInput) as caught:
        call(*args, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)
