"""What ``verify`` needs to know of a plan, whoever made it, and refuses to judge without."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.robust.stiffness import Stiffness
from regrasp.mechanics.state import GraspState

NEEDED = ("leaving", "arriving", "start", "end", "scaling", "course", "turn", "record")
"""What a transition has, whoever made it."""


class Scaling(Protocol):
    """T(t) as ``verify`` sees it: a B-spline by its control values."""

    @property
    def duration(self) -> float:
        """[s]."""

    @property
    def control(self) -> tuple[float, ...]:
        """Control values, first to last."""


class Course(Protocol):
    """Forces and loads at instants, linear between them."""

    @property
    def times(self) -> Array:
        """(K,) [s]."""

    @property
    def forces(self) -> Array:
        """(K, n, d) [N]."""

    @property
    def loads(self) -> Array:
        """(K, 3) or (K, 6) [N, N m]."""


class Turn(Protocol):
    """Forces at angles of the object; between them the combination of fact 3."""

    @property
    def angles(self) -> Array:
        """(K,) [rad]."""

    @property
    def forces(self) -> Array:
        """(K, n, d) [N], object frame."""

    @property
    def axis(self) -> Array | None:
        """(3,) unit axis in space; None in the plane."""

    @property
    def middles(self) -> Array | None:
        """(K - 1, n, d) [N] between the angles, where a part of the load does not turn; None elsewhere."""


class Choice(Protocol):
    """How an end was chosen."""

    @property
    def end(self) -> str:
        """``start`` or ``end``."""

    @property
    def force_limits(self) -> tuple[float, ...]:
        """[N], infinite for none."""


class Withstood(Protocol):
    """What a plan says that it withstands at every instant."""

    @property
    def disturbance(self) -> LoadSet | None:
        """Deviations of the load; None for none."""

    @property
    def stiffness(self) -> Stiffness:
        """Of the fingers, one number or rows by contact [N/m]."""

    @property
    def early_loss(self) -> bool:
        """Whether a finger that leaves or arrives may lose contact early."""


class Record(Protocol):
    """What a plan says it keeps to; ``withstands``, a ``Withstood`` or None, besides if it says that."""

    @property
    def reserve(self) -> float:
        """The fraction of every friction coefficient kept back."""

    @property
    def balancing(self) -> float:
        """The largest change of a given force [N]."""

    @property
    def choices(self) -> tuple[Choice, ...]:
        """The ends that were not given."""

    @property
    def rate_limits(self) -> tuple[float, ...]:
        """(n,) [N/s], or empty."""

    @property
    def least_normals(self) -> tuple[float, ...]:
        """(n,) [N], or empty."""


class Plan(Protocol):
    """What ``verify`` needs to know of a transition."""

    @property
    def leaving(self) -> tuple[str, ...]:
        """Names of the fingers that leave: they carry no force at the end."""

    @property
    def arriving(self) -> tuple[str, ...]:
        """Names of the fingers that arrive: they carry none at the start."""

    @property
    def turn(self) -> "Turn | None":
        """States on the way of a turning object; None where it keeps its orientation."""

    @property
    def start(self) -> GraspState:
        """The state at t = 0."""

    @property
    def end(self) -> GraspState:
        """The state at t = duration."""

    @property
    def scaling(self) -> Scaling:
        """The time function between them."""

    @property
    def course(self) -> Course | None:
        """Instants that the forces go through; None for the straight path."""

    @property
    def record(self) -> Record:
        """What the plan says of itself."""

    def forces(self, t: Array) -> Array:
        """(m, n, d) forces at m times [N]; set-points are compared with them."""


_Kind = tuple[Callable[[Any], bool], str]


def _is_number(value: Any) -> bool:
    return isinstance(value, float) or (type(value) is int and value.bit_length() < 1024)


def _is_array(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and value.dtype.itemsize <= 8


def _is_row(value: Any) -> bool:
    is_row = isinstance(value, (tuple, list)) or (_is_array(value) and value.ndim == 1)
    return is_row and all(map(_is_number, value))


_NUMBER: _Kind = _is_number, "a number"
_ROW: _Kind = _is_row, "a row of numbers"
_ARRAY: _Kind = _is_array, "an array of numbers"
_NO_ARRAY: _Kind = (lambda value: value is None or _is_array(value)), "an array of numbers or None"
_WORD: _Kind = (lambda value: isinstance(value, str)), "a word"
_SEVERAL: _Kind = (lambda value: isinstance(value, (tuple, list))), "a tuple"
_ANY: _Kind = (lambda value: True), "there"


def is_transition(plan: object) -> bool:
    """Whether it has what a transition has, its two states among that."""
    return all(hasattr(plan, name) for name in NEEDED) and all(
        isinstance(state, GraspState)
        for state in (plan.start, plan.end)  # type: ignore[attr-defined]
    )


def check_transition(plan: Any) -> None:
    """Refuse a transition whose values are not of the kinds that ``Plan`` says."""
    _check(plan.scaling, "scaling", duration=_NUMBER, control=_ROW)
    if plan.course is not None:
        _check(plan.course, "course", times=_ARRAY, forces=_ARRAY, loads=_ARRAY)
    if plan.turn is not None:
        _check(plan.turn, "turn", angles=_ARRAY, forces=_ARRAY, axis=_NO_ARRAY, middles=_NO_ARRAY)
    record = plan.record
    _check(record, "record", reserve=_NUMBER, balancing=_NUMBER, choices=_SEVERAL)
    _check(record, "record", rate_limits=_ROW, least_normals=_ROW)
    for k, choice in enumerate(record.choices):
        _check(choice, f"record.choices[{k}]", end=_WORD, force_limits=_ROW)
    if getattr(record, "withstands", None) is not None:
        _check(record.withstands, "record.withstands", disturbance=_ANY, stiffness=_ANY, early_loss=_ANY)


def check_regrasp(plan: Any) -> None:
    """The same of a regrasp, whose steps are transitions."""
    _check(plan, "", steps=_SEVERAL, orientations=_ROW, margin=_NUMBER)
    if getattr(plan, "rotations", None) is not None:
        _check(plan, "", rotations=_ARRAY)
    for k, step in enumerate(plan.steps):
        if not is_transition(step):
            raise InvalidInput(f"steps[{k}] of a plan must be a transition, got {shown(step)}")


def _check(owner: object, where: str, **kinds: _Kind) -> None:
    missing = object()
    for name, (is_so, words) in kinds.items():
        value = getattr(owner, name, missing)
        at = f"{where}.{name}".lstrip(".")
        if value is missing:
            raise InvalidInput(f"{at} of a plan must be {words}, there is none")
        if not is_so(value):
            raise InvalidInput(f"{at} of a plan must be {words}, got {shown(value)}")
