"""What public docstrings say of parameters, and how the types of arrays print beside them."""

import inspect
import pydoc
import re
from enum import Enum

import numpy as np
import pytest

import regrasp as rg
from docstrings import Documented, args_of, attributes_of, public, section
from regrasp.mechanics.checks import Array, array
from regrasp.planning.states.options import StateOptions, described

pytestmark = pytest.mark.architecture

PUBLIC = list(public())


def complaint(entry: Documented) -> str | None:
    """What is wrong with the section Args of a docstring."""
    wanted, found = entry.parameters, entry.documented
    missing = [name for name in wanted if name not in found]
    strange = [name for name in found if name not in wanted]
    twice = sorted({name for name in found if found.count(name) > 1})
    said = [
        f"{w} {', '.join(names)}" for w, names in (("missing", missing), ("no parameter", strange)) if names
    ]
    said += [f"twice {', '.join(twice)}"] if twice else []
    return f"{entry.module}: Args of {entry.name}: {'; '.join(said)}" if said else None


def test_every_parameter_of_a_public_name_is_described_once() -> None:
    assert len(PUBLIC) > 200
    assert {"choose_state", "Transition.forces", "solve", "write_plan", "plot_state", "verify"} <= {
        entry.name for entry in PUBLIC
    }
    assert [words for entry in PUBLIC if (words := complaint(entry))] == []


def test_every_public_name_says_what_it_is() -> None:
    assert [entry.name for entry in PUBLIC if not (entry.value.__doc__ or "").strip()] == []


def test_sections_come_last_and_have_words() -> None:
    for entry in PUBLIC:
        doc = inspect.getdoc(entry.value) or ""
        titles = re.findall(r"^(Args|Returns|Raises|Yields):$", doc, re.MULTILINE)
        assert titles == [t for t in ("Args", "Returns", "Raises") if t in titles], entry.name
        for title in titles:
            assert section(doc, title), f"{entry.name}: an empty section {title}"
        after = doc.partition("\nArgs:\n")[2]
        assert not re.search(r"^(?!Returns:|Raises:)\S", after, re.MULTILINE), (
            f"{entry.name}: words after Args"
        )


# -- the rules above catch what they are for ------------------------------------------------------------


def right(position, *, load=None):
    """Something.

    Args:
        position: (d,) [m], which is: a place.
        load: [N].
    """


def missing(position, load):
    """Something.

    Args:
        position: (d,) [m].
    """


def strange(position):
    """Something.

    Args:
        position: (d,) [m].
        load: [N].
    """


def twice(position):
    """Something.

    Args:
        position: (d,) [m].
        position: [m].
    """


def typed(position):
    """Something.

    Args:
        position (Array): (d,) [m].
    """


def bare(position):
    """Something of a position: (d,)."""


def starred(*places, **options):
    """Something.

    Args:
        *places: (d,) [m].
        **options: more.
    """


class Fields:
    """Something.

    Args:
        position: (d,) [m].
    """

    load: float
    """[N]."""
    value: float
    """No parameter, and may be described all the same."""

    def __init__(self, position: float, load: float) -> None: ...


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (right, None),
        (starred, None),
        (missing, "missing load"),
        (strange, "no parameter load"),
        (twice, "twice position"),
        (typed, "missing position"),
        (bare, "missing position"),
    ],
    ids=lambda x: getattr(x, "__name__", ""),
)
def test_what_is_not_one_entry_a_parameter_is_said(value: object, said: str | None) -> None:
    found = complaint(Documented(value.__name__, "here", value))
    assert found == (None if said is None else f"here: Args of {value.__name__}: {said}")


def test_args_are_read_with_their_indentation_and_end_with_their_section() -> None:
    assert args_of(
        "X.\n\nArgs:\n    a: one.\n        b: in the words of a.\n    c: two.\n\nRaises:\n    D: so."
    ) == [
        "a",
        "c",
    ]
    assert args_of("X.\n\nRaises:\n    D: so.") == []


def test_enumerations_and_plain_classes_take_nothing() -> None:
    class Colour(Enum):
        RED = 1

    assert Documented("Colour", "here", Colour).parameters == []
    assert "criteria" not in attributes_of(rg.ChosenState)
    assert "method" in attributes_of(rg.ChosenState)


# -- how they print ---------------------------------------------------------------------------------------


def test_arrays_print_short_and_stay_arrays() -> None:
    assert str(inspect.signature(rg.Grasp.wrenches)) == "(self, forces: Array) -> Array"
    assert Array.__name__ == "Array"
    assert isinstance(array([1.0], "x", (1,)), np.ndarray)
    long = [e.name for e in PUBLIC if "numpy.float64" in _signature(e) or "_typing" in _signature(e)]
    assert long == []


def _signature(entry: Documented) -> str:
    return str(inspect.signature(entry.value)) if entry.parameters else ""


def test_help_on_a_verb_reads_well() -> None:
    text = pydoc.plain(pydoc.render_doc(rg.choose_state))
    assert max(map(len, text[text.index("The best forces") :].splitlines())) <= 110  # below the signature
    for name, (_, option) in described(StateOptions).items():
        assert f"        {name}: {option.words[:20]}" in text
    assert text.index("    Args:") < text.index("    Returns:") < text.index("    Raises:")
