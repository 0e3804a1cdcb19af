"""What is said to a page, from plain data to plain data; the server and the widget share it."""

from collections.abc import Callable
from functools import partial
from typing import Any

from regrasp.errors import InvalidInput, RegraspError, shown
from regrasp.explore.answer import answer
from regrasp.explore.copies import as_python, as_scenario
from regrasp.explore.looks import pair_map, places, tolerated
from regrasp.explore.question import Question, Shape
from regrasp.explore.start import Start

LOOKS: dict[str, Callable[[Question, Shape | None], dict[str, Any]]] = {
    "tolerances": tolerated,
    "answered": partial(tolerated, answered=True),
    "map": pair_map,
    "places": places,
}
"""What is asked for by name, and takes longer than a frame."""


def reply(start: Start, asked: Any) -> dict[str, Any]:
    """The answer to a question, or what to copy of it; what is wrong with it is an answer, too.

    Args:
        start: what the page began with.
        asked: ``{"question": ...}``, with ``"copy": true`` for it as text, and with ``"look"`` for what is
            looked at on request.
    """
    try:
        question = Question.of(asked.get("question") if isinstance(asked, dict) else None)
        if asked.get("copy") is True:
            return {
                "python": as_python(question, start.shape),
                "scenario": as_scenario(question, start.shape),
            }
        look = asked.get("look")
        if look is not None:
            if not isinstance(look, str) or look not in LOOKS:
                raise InvalidInput(f"look must be one of {', '.join(LOOKS)}, got {shown(look)}")
            return LOOKS[look](question, start.shape)
        return answer(question, start.shape)
    except RegraspError as error:
        return {"holds": False, "says": str(error), "milliseconds": 0.0}
