"""What only POSIX systems have is used behind a question whether this is one: read from the sources."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import regrasp
from regrasp.errors import InvalidInput
from regrasp.programs.backends import solve
from regrasp.programs.program import Program

pytestmark = pytest.mark.architecture

SOURCES = Path(regrasp.__file__).parent
MODULES = {
    "curses",
    "fcntl",
    "grp",
    "posix",
    "pty",
    "pwd",
    "readline",
    "resource",
    "syslog",
    "termios",
    "tty",
}
OF_OS = {"fork", "forkpty", "getpgid", "getuid", "geteuid", "killpg", "mkfifo", "nice", "register_at_fork"}
OF_OS |= {"sched_getaffinity", "sched_setaffinity", "setpgid", "setsid", "wait3", "wait4"}
OF_SIGNAL = {"SIGALRM", "SIGHUP", "SIGKILL", "SIGUSR1", "SIGUSR2", "alarm", "pause", "setitimer"}
ARGUMENTS = {"pass_fds", "preexec_fn"}
QUESTIONS = (
    "os.name",
    "sys.platform",
    "except ImportError",
    "except AttributeError",
    "hasattr(os",
    "can_limit_memory",
)


def posix_only(tree: ast.AST) -> set[str]:
    """Names that other systems lack, anywhere in a source."""
    found = set()
    for node in ast.walk(tree):
        match node:
            case ast.Import(names=names):
                found |= {name.name for name in names} & MODULES
            case ast.ImportFrom(module=module):
                found |= {module or ""} & MODULES
            case ast.Attribute(value=ast.Name(id="os"), attr=attr) if attr in OF_OS:
                found.add(f"os.{attr}")
            case ast.Attribute(value=ast.Name(id="signal"), attr=attr) if attr in OF_SIGNAL:
                found.add(f"signal.{attr}")
            case ast.keyword(arg=arg) if arg in ARGUMENTS:
                found.add(arg)
    return found


def when_imported(tree: ast.Module) -> Iterator[ast.stmt]:
    """Statements that run when a module is imported, those after `try` left out."""
    for statement in tree.body:
        if not isinstance(statement, ast.Try | ast.FunctionDef | ast.ClassDef):
            yield statement


@cache
def parsed() -> list[tuple[str, str, ast.Module]]:
    found = []
    for path in sorted(SOURCES.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        found.append((path.relative_to(SOURCES).as_posix(), text, ast.parse(text)))
    return found


def test_every_module_can_be_imported_elsewhere() -> None:
    assert [
        (name, found)
        for name, _, tree in parsed()
        for statement in when_imported(tree)
        if (found := posix_only(statement))
    ] == []


def test_whatever_is_only_here_is_asked_for_in_the_same_file() -> None:
    assert [
        (name, found)
        for name, text, tree in parsed()
        if (found := posix_only(tree)) and not any(question in text for question in QUESTIONS)
    ] == []


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("import fcntl", {"fcntl"}),
        ("from resource import getrlimit", {"resource"}),
        ("os.killpg(1, signal.SIGKILL)", {"os.killpg", "signal.SIGKILL"}),
        ("Popen(x, pass_fds=[1])", {"pass_fds"}),
        ("os.getpid(); signal.SIGTERM", set()),
    ],
)
def test_what_is_only_here_is_seen(source: str, found: set[str]) -> None:
    assert posix_only(ast.parse(source)) == found


def test_no_path_of_one_system_is_written_down() -> None:
    assert [
        (name, node.value)
        for name, _, tree in parsed()
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and node.value.startswith(("/tmp", "/home", "/usr", "/dev/", "~/"))
    ] == []


def test_a_process_of_its_own_is_refused_in_a_line(monkeypatch: pytest.MonkeyPatch, small: Program) -> None:
    monkeypatch.setattr("regrasp.programs.child.os.name", "nt")
    with pytest.raises(InvalidInput, match="as POSIX systems do; leave isolated and time_limit out"):
        solve(small, "clarabel", isolated=True)


@pytest.fixture
def small() -> Program:
    """The first program of the benchmark."""
    from regrasp.bench.families import FAMILIES

    return next(FAMILIES["states"].problems()).program
