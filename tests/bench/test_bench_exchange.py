"""The benchmark's problems reach other programs as they are: by file, and as a test set of qpbenchmark."""

import json
import re
from functools import cache
from hashlib import sha256

import numpy as np
import pytest
import qpsolvers
from scipy import sparse

from regrasp.bench.exchange import export, read_cbf, read_npz, write_cbf, write_npz
from regrasp.bench.families import FAMILIES
from regrasp.bench.problems.problem import Verdict
from regrasp.errors import InvalidInput
from regrasp.programs import Block, Cone, Program, Status, solve

pytestmark = pytest.mark.oracle

MOST = 400  # unknowns of what is solved again


@cache
def problems(family):
    """Of a family; test_bench_families.py sees that they are the same whenever they are made."""
    return list(FAMILIES[family].problems())


def every():
    return (p for family in FAMILIES for p in problems(family))


@cache
def small(is_qp):
    """Conic or quadratic problems of a moderate size."""
    return [p for p in every() if p.is_qp == is_qp and p.program.q.size <= MOST]


def solved_again(problem, program):
    """The answer to a program that was read back agrees with what is known."""
    answer = solve(program, "clarabel", throw=False)
    known = problem.known
    if known.verdict is Verdict.INFEASIBLE:
        assert answer.status is Status.INFEASIBLE, problem.name
    else:
        assert answer.status is Status.SOLVED, problem.name
        assert answer.objective == pytest.approx(known.optimum, rel=1e-6, abs=1e-6), problem.name


def test_cbf_is_read_back_to_the_same_optimum(tmp_path):
    assert len({problem.family for problem in small(is_qp=False)}) > 3
    for problem in small(is_qp=False):
        write_cbf(problem.program, tmp_path / "a.cbf", problem.name)
        back = read_cbf(tmp_path / "a.cbf")
        assert back.q.size == problem.program.q.size + (problem.program.P.nnz > 0)
        assert back.P.nnz == 0
        solved_again(problem, back)


def test_a_linear_objective_comes_back_to_the_last_digit(tmp_path):
    linear = [p for p in small(is_qp=False) if p.program.P.nnz == 0]
    assert len(linear) > 20
    for problem in linear:
        write_cbf(problem.program, tmp_path / "a.cbf")
        back = read_cbf(tmp_path / "a.cbf")
        assert (back.A != problem.program.A).nnz == 0
        assert (back.b == problem.program.b).all()
        assert (back.q == problem.program.q).all()


def test_npz_is_read_back_to_the_same_program(tmp_path):
    families = {problem.family for problem in small(is_qp=True)}
    assert len(families) > 5
    for problem in (p for name in families for p in problems(name) if p.is_qp):
        program = problem.program
        write_npz(program, tmp_path / "a.npz")
        back = read_npz(tmp_path / "a.npz")
        assert (back.P != program.P).nnz == 0
        assert (back.q == program.q).all()
        # Rows are the same ones, the equations first.
        equal = np.concatenate([np.full(block.rows, block.cone is Cone.ZERO) for block in program.blocks])
        order = np.argsort(~equal, kind="stable")
        assert (program.A[order] != back.A).nnz == 0
        assert (back.b == program.b[order]).all()


def test_npz_is_solved_to_the_same_optimum(tmp_path):
    for problem in small(is_qp=True)[::7]:
        if problem.family == "scaled":
            continue  # in kilometres and micronewtons the reference solver is unsound
        write_npz(problem.program, tmp_path / "a.npz")
        solved_again(problem, read_npz(tmp_path / "a.npz"))


def test_a_full_quadratic_form_survives_as_an_epigraph(tmp_path):
    rng = np.random.default_rng(0)
    F = rng.normal(size=(2, 4))  # rank 2 in four unknowns
    A = sparse.csc_matrix(np.vstack([np.ones(4), np.eye(4), -np.eye(4)]))
    program = Program(
        sparse.csc_matrix(F.T @ F), rng.normal(size=4), A, np.array([1.0, *np.full(8, 2.0)]),
        (Block(Cone.ZERO, 1), Block(Cone.SECOND_ORDER, 4), Block(Cone.NONNEGATIVE, 1, 4)),
    )  # fmt: skip
    write_cbf(program, tmp_path / "a.cbf")
    back = read_cbf(tmp_path / "a.cbf")
    assert back.blocks[-1] == Block(Cone.SECOND_ORDER, 4)  # t, 1 and two rows of F
    before, after = solve(program), solve(back)
    assert after.objective == pytest.approx(before.objective, rel=1e-7)
    assert after.value[:4] == pytest.approx(before.value, abs=1e-3)


HAND = """VER
1
OBJSENSE
MIN
# minimise u with 2 u v >= w^2, v = 1, w <= -3 and a free one: 4.5
VAR
4 2
QR 3
F 1
CON
4 3
L= 1
L- 1
L+ 2
OBJACOORD
1
0 1.0
ACOORD
4
0 1 1.0
1 2 1
2 3 1
3 3 -1
BCOORD
2
0 -1
1 3e0
"""


def test_a_file_written_by_hand(tmp_path):
    (tmp_path / "hand.cbf").write_text(HAND)
    program = read_cbf(tmp_path / "hand.cbf")
    answer = solve(program)
    assert answer.objective == pytest.approx(4.5, rel=1e-6)
    assert answer.value[[1, 2]] == pytest.approx([1, -3], rel=1e-5)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("VER\n1", "VER\n9", "line 2: expected a version: 1 or 2 or 3 or 4, found '9'"),
        ("VER\n1\n", "", "line 1: expected VER first, found 'OBJSENSE'"),
        ("MIN", "MAX", "line 4: expected the sense: MIN, found 'MAX'"),
        ("QR 3", "EXP 3", "line 8: expected a cone among F, L=, L+, L-, Q, QR, found 'EXP'"),
        ("QR 3", "QR 1", "line 8: expected QR of at least 2 entries, found '1'"),
        ("4 2", "5 2", "line 9: expected cones of 5 entries together, found '4'"),
        ("0 1 1.0", "0 4 1.0", "line 20: expected a place below 4, found '4'"),
        ("1 2 1\n", "0 1 1\n", "line 21: expected each entry once, found '(0, 1) again'"),
        ("2 3 1\n", "2 3 nan\n", "line 22: expected a finite number, found 'nan'"),
        ("2 3 1\n", "2 3 one\n", "line 22: expected a number, found 'one'"),
        ("2 3 1\n", "\n", "line 22: expected 2 place(s) and a value, found 'an empty line'"),
        ("BCOORD\n2", "BCOORD\n3", "line 28: expected 1 place(s) and a value, found 'an empty line'"),
        (
            "BCOORD\n2",
            "BCOORD\n1",
            "line 27: expected one of VER, OBJSENSE, VAR, CON, OBJACOORD, ACOORD, BCOORD",
        ),
        ("BCOORD", "DCOORD", "line 24: expected one of VER, OBJSENSE, VAR, CON, OBJACOORD, ACOORD, BCOORD"),
        ("BCOORD", "ACOORD", "line 24: expected each item once, found 'ACOORD again'"),
        ("OBJSENSE\nMIN\n", "", "expected OBJSENSE in the file, found 'its end'"),
    ],
)
def test_the_reader_is_strict(old, new, said, tmp_path):
    assert HAND.count(old) > 0
    (tmp_path / "hand.cbf").write_text(HAND.replace(old, new, 1))
    with pytest.raises(InvalidInput, match=re.escape(said)):
        read_cbf(tmp_path / "hand.cbf")


def test_what_is_not_a_quadratic_program_is_refused(tmp_path):
    with pytest.raises(InvalidInput, match="write it as CBF"):
        write_npz(small(is_qp=False)[0].program, tmp_path / "a.npz")
    (tmp_path / "b.npz").write_text("no archive")
    with pytest.raises(InvalidInput, match="expected a NumPy archive of plain arrays"):
        read_npz(tmp_path / "b.npz")
    np.savez(tmp_path / "c.npz", q=np.zeros(2))
    with pytest.raises(InvalidInput, match="expected the arrays q, h, b, P_row"):
        read_npz(tmp_path / "c.npz")
    with pytest.raises(InvalidInput, match="cannot be read as text"):
        read_cbf(tmp_path / "none.cbf")


def test_a_manifest_says_what_every_file_is(tmp_path):
    chosen = [FAMILIES[name] for name in ("loci", "regrasps", "infeasible", "warm")]
    where = export(chosen, tmp_path / "set")
    manifest = json.loads(where.read_text(encoding="utf-8"))
    known = {p.name: p for family in chosen for p in problems(family.name)}
    assert [entry["name"] for entry in manifest["problems"]] == list(known)
    assert {path.name for path in where.parent.iterdir()} == {
        where.name, *(entry["file"] for entry in manifest["problems"])
    }  # fmt: skip
    for entry in manifest["problems"]:
        problem, path = known[entry["name"]], where.parent / entry["file"]
        assert entry["sha256"] == sha256(path.read_bytes()).hexdigest()
        assert (entry["unknowns"], entry["rows"], entry["nonzeros"]) == problem.size
        assert entry["density"] == problem.program.A.nnz / np.prod(problem.program.A.shape)
        assert (entry["optimum"], entry["truth"]) == (problem.known.optimum, problem.known.truth.value)
        assert (entry["verdict"], entry["cones"]) == (problem.known.verdict.value, problem.cones)
        assert (entry["follows"], entry["licence"]) == (problem.follows, "MIT")
        assert path.suffix == (".npz" if problem.is_qp else ".cbf")
    assert manifest["families"]["loci"] == {
        "origin": FAMILIES["loci"].origin, "formula": FAMILIES["loci"].formula
    }  # fmt: skip
    again = export(chosen, tmp_path / "again")
    assert again.read_bytes() == where.read_bytes()
    assert export(chosen, tmp_path / "set") == where  # in place of the earlier one


# -- qpbenchmark -----------------------------------------------------------------------------------------


def test_qpbenchmark_runs_the_test_set(tmp_path):
    qpbenchmark = pytest.importorskip("qpbenchmark", reason="qpbenchmark is not installed: regrasp[bench]")
    from qpbenchmark.results import Results
    from qpbenchmark.run import run

    from regrasp.bench.exchange.qpbenchmark_set import QpbenchmarkSet

    chosen = ("loci", "states", "infeasible", "degenerate")
    tests = QpbenchmarkSet(chosen, most=12)
    assert isinstance(tests, qpbenchmark.TestSet)
    wanted = {
        p.name: p
        for p in small(is_qp=True)
        if p.family in chosen and p.known.verdict is Verdict.SOLVABLE and p.program.q.size <= 12
    }
    assert {p.name for p in tests} == wanted.keys()
    results = Results(tmp_path / "results.csv", tests)
    for solver in ("clarabel", "daqp"):  # one takes sparse problems only, one dense ones
        if solver in qpsolvers.available_solvers:
            run(tests, results, only_solver=solver, only_settings="default", verbose=True)
            assert set(results.df["problem"][results.df["solver"] == solver]) == wanted.keys()
    assert results.df["found"].all()
    assert (results.df["primal_residual"] < 1e-5).all()
    for problem in tests:  # in the letters of qpbenchmark it is the same problem
        answer = qpsolvers.solve_problem(problem.to_sparse(), "clarabel")
        optimum = wanted[problem.name].known.optimum
        assert answer.obj == pytest.approx(optimum, rel=1e-6, abs=1e-6)


def test_qpbenchmark_finds_the_class_by_its_file():
    pytest.importorskip("qpbenchmark", reason="qpbenchmark is not installed: regrasp[bench]")
    from qpbenchmark.benchmark import load_test_set

    import regrasp.bench.exchange.qpbenchmark_set as module

    assert load_test_set(module.__file__).count_problems() == sum(
        p.is_qp and p.known.verdict is Verdict.SOLVABLE and p.program.q.size <= 1000 for p in every()
    )


def test_problems_are_exported_from_the_command_line(tmp_path, capsys, monkeypatch):
    from regrasp.cli import main

    for arguments, status in ((["--family", "loci"], 0), (["--family", "none"], 2)):
        monkeypatch.setattr("sys.argv", ["regrasp", "bench", "export", str(tmp_path / "set"), *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        assert (ended.value.code or 0) == status
    out, err = capsys.readouterr()
    assert "manifest.json" in out
    assert "no family 'none'; there are states" in err
