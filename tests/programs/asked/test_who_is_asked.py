"""Who is asked what, in which order, and what is made of it: by solvers that answer as they are told."""

import logging
import types

import numpy as np
import pytest

from regrasp.errors import SolverFailed, SolverUnavailable
from regrasp.programs import Program, Rows, Solution, Status, available_backends, child, facts, solve
from regrasp.programs import backends as table
from regrasp.programs.calls import deadline
from regrasp.programs.facts import BACKENDS, is_available
from regrasp.programs.solution import failed

pytestmark = pytest.mark.contract


def bounded(*bounds: float, q: float = -1.0, size: float = 0.0) -> Program:
    """min q x over 0 <= x <= each of the bounds."""
    rows = Rows(1)
    rows.at_least_zero([[1.0]])
    for bound in bounds:
        rows.at_least_zero([[-1.0]], bound)
    return rows.program([q], size=size)


def empty() -> Program:
    """x >= 1 and x <= 0."""
    rows = Rows(1)
    rows.at_least_zero([[1.0], [-1.0]], [-1.0, 0.0])
    return rows.program([0.0])


def told(program, status, x=None, z=None) -> Solution:
    x = np.full(program.q.size, np.nan) if x is None else np.array(x, dtype=float)
    z = np.full(program.b.size, np.nan) if z is None else np.array(z, dtype=float)
    return Solution(program, "told", status, x, z, None, 0.0, 0.0, "so")


class Asked(list):
    """Programs in the order in which they were asked, and by which back end."""

    def __init__(self, monkeypatch, answer) -> None:
        self.names: list[str] = []

        def solver(program, name, **_):
            self.append(program)
            self.names.append(name)
            return answer(program)

        monkeypatch.setattr(table, "import_module", lambda _: types.SimpleNamespace(solve=solver))


def honest(program) -> Solution:
    from regrasp.programs import clarabel_backend

    return clarabel_backend.solve(program, "clarabel")


# -- one back end ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("status", [Status.STOPPED, Status.INFEASIBLE, Status.NOT_FOUND])
def test_what_stopped_or_proved_nothing_is_asked_for_the_room_that_is_missing(monkeypatch, status) -> None:
    program = empty()
    asked = Asked(monkeypatch, lambda p: told(p, status) if p is program else honest(p))
    answer = solve(program, "clarabel")
    assert answer.status is Status.INFEASIBLE
    assert answer.said.endswith("but infeasible with room for all")
    assert [p.q.size for p in asked] == [1, 2]


@pytest.mark.parametrize("claim", [Status.SOLVED, Status.FAILED])
def test_others_are_not(monkeypatch, claim) -> None:
    """A solver that calls a wrong point its answer is asked no more, nor one that failed."""
    asked = Asked(monkeypatch, lambda p: told(p, claim, [0.5], [0.0, 0.0]))
    answer = solve(empty(), "clarabel", throw=False)
    assert answer.status is (Status.UNSOUND if claim is Status.SOLVED else claim)
    assert len(asked) == 1


def test_room_that_is_there_proves_nothing(monkeypatch) -> None:
    program = bounded(1.0)
    asked = Asked(monkeypatch, lambda p: told(p, Status.STOPPED) if p is program else honest(p))
    answer = solve(program, "clarabel", throw=False)
    assert (answer.status, answer.said) == (Status.STOPPED, "so")
    assert len(asked) == 2


@pytest.mark.parametrize("backend", ["clarabel", "auto"])
@pytest.mark.parametrize("solved", [True, False])
def test_who_fails_is_asked_in_own_units(monkeypatch, backend, solved) -> None:
    """x at its bound of 2^-30, in units of which it is one; what fails there, too, is what failed first."""
    program = bounded(2.0**-30, q=-1.0)

    def answer(p):
        return told(p, Status.STOPPED) if p is program or not solved else honest(p)

    asked = Asked(monkeypatch, answer)
    found = solve(program, backend, throw=False)
    assert asked[2].b.tolist() == [0.0, 1.0]
    assert found.program is program
    if solved:
        assert (found.status, found.said) == (Status.SOLVED, "Solved, in own units")
        assert found.value[0] == pytest.approx(2.0**-30)
        assert (asked.names, [p.q.size for p in asked]) == (["clarabel"] * 3, [1, 2, 1])
    else:
        assert (found.status, found.said) == (Status.STOPPED, "so")


@pytest.mark.parametrize(("scale", "far"), [(1.0, False), (2.0**-30, False), (1.0, True)])
@pytest.mark.parametrize(("off", "is_one"), [(0.999e-8, True), (1.001e-8, False)])
def test_where_a_solver_stopped_is_a_solution_as_certificates_are_proofs(
    monkeypatch, scale, far, off, is_one
) -> None:
    """x <= 1 and x >= 1 + d, stopped between; also in own units, and without a far bound."""

    def halfway(p, d):
        return told(p, Status.STOPPED, [-p.b[0] * (1 - d / 2)], np.zeros(p.b.size))

    def program(d):
        rows = Rows(1)
        rows.at_least_zero([[1.0], [-1.0]], [-scale * (1 + d), scale])
        if far:
            rows.at_least_zero([[-1.0]], 1e9)
        return rows.program([0.0])

    d = off * 1e-3 / halfway(program(1e-3), 1e-3).residual
    p = program(d)
    asked = Asked(
        monkeypatch,
        lambda p: failed(p, "told", "no") if p.q.size == 2 or p.b.size == 3 else halfway(p, d),
    )
    answer = solve(p, "auto" if far else "clarabel", throw=False)
    assert (answer.status is Status.SOLVED) is is_one
    assert answer.status in (Status.SOLVED, Status.STOPPED, Status.FAILED)
    assert [q.b.size for q in asked if q.q.size == 1][-1] == 2


def test_who_takes_second_order_cones_is_named() -> None:
    rows = Rows(1)
    rows.second_order([[1.0], [0.0]])
    takers = ", ".join(name for name in ("clarabel", "cvxpy") if is_available(name))
    with pytest.raises(table.InvalidInput, match=f"or one of {takers}$"):
        solve(rows.program([1.0]), "daqp")


def test_only_cvxpy_has_solvers_within() -> None:
    for name in ("clarabel:CLARABEL", "daqp:", "cvxpyx", "nobody"):
        assert not is_available(name)
        with pytest.raises(SolverUnavailable, match=f"no back end '{name}'"):
            solve(bounded(1.0), name)
    assert is_available("cvxpy:CLARABEL") == is_available("cvxpy") == ("cvxpy" in available_backends())


def test_what_a_back_end_needs_is_imported_before_its_time_runs(monkeypatch) -> None:
    names: list[str] = []
    monkeypatch.setattr(table, "import_module", names.append)
    table.warm("clarabel")
    table.warm("daqp")
    place = "regrasp.programs."
    assert names[:2] == [place + "clarabel_backend"] * 2
    assert names[2:] == [place + "qp_backend", place + "calls.daqp_call"]


@pytest.mark.parametrize(
    ("backend", "isolated", "asked"),
    [
        ("piqp", False, ("apart", 50.0, {"speed": 2})),
        ("piqp", True, ("apart", 50.0, {"speed": 2})),
        ("daqp", False, ("here", None, {"speed": 2, "time_limit": 50.0})),
        ("daqp", True, ("apart", None, {"speed": 2, "time_limit": 50.0})),
    ],
)
def test_who_keeps_time_is_told_and_who_does_not_is_ended(monkeypatch, backend, isolated, asked) -> None:
    calls = []

    def here(program, name, options):
        calls.append(("here", None, options))
        return honest(program)

    def apart(program, name, limit, options):
        calls.append(("apart", limit, options))
        return honest(program)

    monkeypatch.setattr(deadline, "monotonic", lambda: 1.0)
    monkeypatch.setattr(table, "asked", here)
    monkeypatch.setattr(child, "solved_apart", apart)
    solve(bounded(1.0), backend, time_limit=50.0, isolated=isolated, speed=2)
    assert calls == [asked]


@pytest.mark.parametrize(("backend", "who"), [("auto", "clarabel"), ("daqp", "daqp")])
def test_who_is_asked_for_a_quick_word(monkeypatch, backend, who) -> None:
    asked = Asked(monkeypatch, honest)
    assert table.least_room(bounded(1.0), backend) == pytest.approx(-0.5)
    assert table.solved_at_once(bounded(1.0), backend).value == pytest.approx([1.0])
    assert asked.names == [who, who]


def test_what_is_sound_at_once_is_sound_to_the_tolerance(monkeypatch) -> None:
    program = bounded(1.0)
    off = told(program, Status.STOPPED, [1 + 1e-6], [0.0, 1.0])
    Asked(monkeypatch, lambda _: off)
    for tolerance, is_sound in ((off.residual, True), (np.nextafter(off.residual, 0), False)):
        monkeypatch.setitem(BACKENDS, "told", BACKENDS["daqp"]._replace(tolerance=tolerance))
        answer = table.solved_at_once(program, "told")
        assert (answer is not None) is is_sound
        if is_sound:
            assert answer.status is Status.SOLVED


# -- a kept solver -----------------------------------------------------------------------------------------


def test_entries_that_are_given_stand_for_those_of_the_rows() -> None:
    """The most of x over a x <= 1 is 1 / a."""
    rows = Rows(1)
    rows.at_least_zero([[-1.0]], 1.0)
    program = rows.program([-1.0], size=1.0)
    for entries, best in ((None, 1.0), (np.array([4.0]), 0.25), (None, 1.0)):
        x, z = table.answered_quickly(program, entries)
        assert x == pytest.approx([best], rel=1e-6)
        assert z == pytest.approx([best], rel=1e-6)


def test_only_what_is_quick_is_asked() -> None:
    assert table.answered_quickly(bounded(1.0, size=1.0)) is not None
    assert table.answered_quickly(bounded(1.0)) is None
    assert table.solved_quickly(bounded(1.0)) is None


def test_how_sound_a_quick_answer_must_be(monkeypatch) -> None:
    """Constraints to 5e-10 of their unit, all else to 1e-8; here both units are 4, of |q| + the bound's."""
    given = []
    monkeypatch.setattr(table, "surely_sound", lambda *args: given.append(args[3:]))
    assert table.solved_quickly(bounded(1.0, size=1.0)) is None
    assert given == [(5e-10, 1e-8)]


# -- whoever answers ---------------------------------------------------------------------------------------


def test_who_is_not_installed_is_passed_over_in_silence(monkeypatch, caplog) -> None:
    has = facts._has
    monkeypatch.setattr(facts, "_has", lambda package: package != "clarabel" and has(package))
    with caplog.at_level(logging.WARNING, logger="regrasp.programs"):
        assert solve(bounded(1.0)).backend == "daqp"
    assert not caplog.records
    monkeypatch.setattr(facts, "_has", lambda package: False)
    assert not is_available("daqp")
    with pytest.raises(SolverUnavailable, match="none of clarabel, daqp, osqp, cvxpy is installed"):
        solve(bounded(1.0, 1e9))


def test_second_order_cones_are_for_those_who_take_them(monkeypatch) -> None:
    rows = Rows(1)
    rows.second_order([[1.0], [0.0]])
    asked = Asked(monkeypatch, lambda p: failed(p, "told", "no"))
    with pytest.raises(SolverFailed, match="no back end gave a sound answer"):
        solve(rows.program([1.0]))
    assert asked.names == ["clarabel", "cvxpy"]


def test_one_is_asked_however_short_the_time(monkeypatch) -> None:
    """A limit that the clock does not resolve is over where it begins."""
    monkeypatch.setattr(deadline, "monotonic", lambda: 1.0)
    asked = Asked(monkeypatch, honest)
    assert solve(bounded(1.0), time_limit=1e-300).status is Status.SOLVED
    assert asked.names == ["clarabel"]


def test_without_far_rows_nothing_is_thrown_either(monkeypatch) -> None:
    asked = Asked(monkeypatch, lambda p: failed(p, "told", "no"))
    assert solve(bounded(1.0, 1e9), throw=False).status is Status.FAILED
    count = sum(map(is_available, table._AUTO))
    assert [p.b.size for p in asked] == [3] * count + [2] * count


@pytest.mark.parametrize(("off", "is_close"), [(0.9999e-7, True), (1.0003e-7, False)])
def test_how_well_an_answer_must_keep_far_rows(monkeypatch, off, is_close) -> None:
    """A point off by a share of its unit, 2, of the objective's and the bound's: beyond, it is polished."""
    x = 1 + 2 * off
    asked = Asked(
        monkeypatch,
        lambda p: failed(p, "told", "no") if p.b.size == 3 else told(p, Status.SOLVED, [x], [0.0, 1.0]),
    )
    answer = solve(bounded(1.0, 1e9))
    assert answer.status is Status.SOLVED
    assert answer.said == "so, without loose rows" + ("" if is_close else ", polished")
    assert asked[-1].b.size == 2


def falling(*, with_point: int):
    """min -y over x = 1, y >= 0 beside a far bound of x: asked for a point, it is told so many times."""
    rows = Rows(2)
    rows.at_least_zero([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]], [-1.0, 1.0, 0.0, 1e9])
    left = [with_point]

    def answer(p):
        if p.q.any():
            return failed(p, "told", "no") if p.b.size == 4 else told(p, Status.UNBOUNDED, [0.0, 1.0])
        left[0] -= 1
        return (
            told(p, Status.SOLVED, [1.0, 0.0], np.zeros(p.b.size))
            if left[0] >= 0
            else failed(p, "told", "no")
        )

    return rows.program([0.0, -1.0]), answer


def test_a_direction_that_keeps_far_rows_wants_a_point_that_does(monkeypatch) -> None:
    program, answer = falling(with_point=2)
    asked = Asked(monkeypatch, answer)
    assert solve(program).status is Status.UNBOUNDED
    assert [(p.b.size, bool(p.q.any())) for p in asked] == [(4, True)] * sum(
        map(is_available, table._AUTO)
    ) + [
        (3, True),
        (3, False),
        (4, False),
    ]
    program, answer = falling(with_point=1)
    Asked(monkeypatch, answer)
    assert solve(program, throw=False).status is Status.FAILED


def test_a_program_without_an_answer_is_asked_in_its_own_units(monkeypatch) -> None:
    """1024 x <= 1024 for the least of -x; not where no time is left."""
    rows = Rows(1)
    rows.at_least_zero([[-1024.0]], 1024.0)
    p = rows.program([-1.0])
    asked = Asked(monkeypatch, lambda p: honest(p) if abs(p.A.data[0]) == 1 else failed(p, "told", "no"))
    found = solve(p)
    assert (found.status, found.value) == (Status.SOLVED, pytest.approx([1.0]))
    assert found.said.endswith("in own units")
    assert found.program is p
    assert asked.names == ["clarabel", "clarabel"]
    monkeypatch.setattr(deadline.Deadline, "is_over", True)
    assert solve(p, throw=False).status is Status.FAILED
    assert asked.names[2:] == ["clarabel"]
    monkeypatch.undo()
    once = Asked(monkeypatch, honest)
    assert solve(p).status is Status.SOLVED
    assert once.names == ["clarabel"]
