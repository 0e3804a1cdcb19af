"""Other people's test programs through every installed back end: right, or plainly refused."""

from dataclasses import replace

import pytest

from peer_problems import peers
from peers import (
    NOT_TAKEN,
    PAGE,
    REFUSED,
    RIGHT,
    WRONG,
    backends,
    documented,
    is_right,
    outcome,
)
from regrasp.programs import Status, solve
from regrasp.programs.facts import BACKENDS

pytestmark = pytest.mark.oracle

PROBLEMS = peers()


@pytest.mark.parametrize("backend", backends())
def test_every_back_end_is_right_or_refuses(backend):
    found = {name: outcome(peer, backend) for name, peer in PROBLEMS.items()}
    assert [name for name, what in found.items() if what == WRONG] == []
    takes_cones = backend == "auto" or BACKENDS[backend.partition(":")[0]].second_order
    cones = {name for name, peer in PROBLEMS.items() if peer.program.has_second_order}
    assert {name for name, what in found.items() if what == NOT_TAKEN} == (set() if takes_cones else cones)
    right = sum(what == RIGHT for what in found.values())
    before = documented(PAGE.read_text(encoding="utf-8")).get(backend, 0)
    assert right >= before, [name for name, what in found.items() if what == REFUSED]


def test_auto_answers_them_all():
    assert len(PROBLEMS) >= 40
    assert documented(PAGE.read_text(encoding="utf-8"))["auto"] == len(PROBLEMS)


def test_every_kind_is_there():
    optima = [peer.optimum for peer in PROBLEMS.values()]
    assert {float("inf"), -float("inf")} <= set(optima)
    assert any(not peer.program.b.size for peer in PROBLEMS.values())
    assert sum(name.startswith("Maros-Meszaros") for name in PROBLEMS) == 12


@pytest.mark.parametrize("name", [name for name, peer in PROBLEMS.items() if peer.optimum is None])
def test_where_nobody_prints_an_optimum_a_spoiled_answer_is_not_right(name):
    peer = PROBLEMS[name]
    answer = solve(peer.program)
    assert answer.status is Status.SOLVED
    assert is_right(peer, answer)
    assert not is_right(peer, replace(answer, value=answer.value * (1 + 1e-2)))
    assert not is_right(peer, replace(answer, duals=-answer.duals))
