"""What is said to a page, from plain data to plain data; the server and the widget share it."""

from typing import Any

from regrasp.errors import RegraspError
from regrasp.explore.answer import answer
from regrasp.explore.copies import as_python, as_scenario
from regrasp.explore.question import Question
from regrasp.explore.start import Start


def reply(start: Start, asked: Any) -> dict[str, Any]:
    """The answer to a question, or what to copy of it; what is wrong with it is an answer, too.

    Args:
        start: what the page began with.
        asked: ``{"question": ...}``, with ``"copy": true`` for it as text.
    """
    try:
        question = Question.of(asked.get("question") if isinstance(asked, dict) else None)
        if asked.get("copy") is True:
            made = start.outline
            return {"python": as_python(question, made), "scenario": as_scenario(question, made)}
        return answer(question, start.outline)
    except RegraspError as error:
        return {"holds": False, "says": str(error), "milliseconds": 0.0}
