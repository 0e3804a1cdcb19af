"""The map of the house is that of today's imports."""

import re
import sys
from collections import Counter

import pytest

from places import ROOT

sys.path.append(str(ROOT / "docs"))
from architecture import LIST, PICTURE, between, figure, fingerprint, levels, listed, reduced, room_imports

pytestmark = pytest.mark.architecture

AGAIN = "the imports have changed: python docs/architecture.py draws the map anew; look at it and commit both"


def test_the_map_is_of_today() -> None:
    assert LIST.read_text(encoding="utf-8") == listed(room_imports()), AGAIN


def test_the_picture_is_of_the_list() -> None:
    drawn_from = fingerprint(LIST.read_text(encoding="utf-8"))
    assert re.findall(r"<dc:description>(\w+)</dc:description>", PICTURE.read_text("utf-8")) == [
        drawn_from
    ], AGAIN


def test_every_room_is_seen_with_its_floor(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("architecture.permutations", lambda row: [tuple(row)])  # the neatest order takes long
    edges = room_imports()
    drawn = {text.get_text() for text in figure(edges).axes[0].texts}
    assert {room.rpartition(".")[2] for room in edges} <= drawn


def test_arrows_are_imports_and_the_others_follow_from_them() -> None:
    graph = {"a": {"b", "c", "d"}, "b": {"c"}, "c": set(), "d": set()}
    assert reduced(graph) == [("a", "b"), ("a", "d"), ("b", "c")]
    assert levels(graph, list(graph)) == [["a"], ["b"], ["c", "d"]]
    floors = between(room_imports(), None)
    assert all(b in floors[a] for a, b in reduced(floors))
    assert floors["verification"] == {"display", "errors", "mechanics"}


def test_rooms_that_import_each_other_are_in_order_of_how_much() -> None:
    edges = {"f.a": Counter({"f.b": 1}), "f.b": Counter({"f.a": 3, "g": 1}), "g": Counter()}
    assert between(edges, "f") == {"f.a": set(), "f.b": {"f.a"}}
    assert listed(edges) == "f.a: f.b\nf.b: f.a, g\ng:\n"
