"""The explorer in a notebook: messages from the page are answered, and what is seen can be gone on with."""

import sys
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from regrasp.errors import InvalidInput
from regrasp.explore import explorer

pytestmark = pytest.mark.contract

GRASP = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])


def test_a_question_from_the_page_is_answered_and_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    widget = explorer(GRASP, rg.Wrench([0, -1.0]))
    sent: list[Any] = []
    monkeypatch.setattr(widget, "send", sent.append)
    asked = widget.begin["question"] | {"load": [0.0, -2.0, 0.0]}
    widget._handle_custom_msg({"id": "7", "asked": {"question": asked}}, [])
    assert sent[0]["id"] == "7"
    assert sent[0]["answer"]["holds"]
    np.testing.assert_array_equal(widget.load.force, [0, -2])
    np.testing.assert_array_equal(widget.grasp.positions, GRASP.positions)


def test_what_is_wrong_is_answered_and_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    widget = explorer(rg.Outline.ellipse(2, 1))
    sent: list[Any] = []
    monkeypatch.setattr(widget, "send", sent.append)
    for message in ({"asked": 3}, {"asked": {"question": {"load": None}}}, "nothing"):
        widget._handle_custom_msg(message, [])
    assert [s["answer"]["holds"] for s in sent] == [False, False]
    assert widget.load == rg.Wrench([0, -1.0])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((GRASP,), "needs its load, a Wrench; got None"),
        ((None, rg.Wrench([0, 1])), "load and outline go with a Grasp"),
        ((3,), "a Grasp, an Outline, a Mesh or a name, got 3"),
    ],
)
def test_wrong_calls(arguments: Any, words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        explorer(*arguments)


def test_without_anywidget_one_line_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "regrasp.explore.widget", raising=False)
    from regrasp import explore

    monkeypatch.delattr(explore, "widget", raising=False)
    with pytest.raises(ImportError, match=r"pip install 'regrasp\[widget\]'"):
        _ = explore.explorer
