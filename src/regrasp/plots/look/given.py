"""What pictures are given, checked by the names of parameters before anything is drawn."""

from collections.abc import Callable, Mapping, Set
from functools import wraps
from inspect import signature
from math import inf
from typing import Any, TypeVar

from matplotlib.axes import Axes
from matplotlib.colors import is_color_like

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import file_path, finite, instance, items, number, whole
from regrasp.outline.outline import Outline
from regrasp.planning.states.objectives import objective_of
from regrasp.plots.look.solids import triangles_of
from regrasp.plots.look.units import Units

F = TypeVar("F", bound=Callable[..., Any])
_FEW = 10**6


def checked(draw: F) -> F:
    """The picture, which raises ``InvalidInput`` for arguments that its parameters do not take."""
    known = signature(draw)
    tried = {name: _CHECKS[name] for name in known.parameters if name in _CHECKS}

    @wraps(draw)
    def picture(*args: Any, **options: Any) -> Any:
        given = known.bind(*args, **options).arguments
        for name, check in tried.items():
            default = known.parameters[name].default
            if name in given and given[name] is not default:
                check(given[name], name)
        if given.get("colours") is not None:
            _check_all_have(given["colours"], next(iter(given.values())))
        return draw(*args, **options)

    return picture  # type: ignore[return-value]


def _check_all_have(colours: Mapping[str, Any], value: Any) -> None:
    """A colour for every contact of what is drawn."""
    missing = [name for name in getattr(getattr(value, "grasp", None), "names", ()) if name not in colours]
    if missing:
        raise InvalidInput(f"colours must have one for every contact, {shown(missing[0])} has none")


def _text(value: Any, what: str) -> None:
    if not isinstance(value, str):
        raise InvalidInput(f"{what} must be text, got {shown(value)}")


def _flag(value: Any, what: str) -> None:
    if not isinstance(value, bool):
        raise InvalidInput(f"{what} must be True or False, got {shown(value)}")


def _names(value: Any, what: str) -> None:
    for name in items(value, what):
        _text(name, f"every name of {what}")


def _colour(value: Any, what: str) -> None:
    try:
        is_one = is_color_like(value)
    except (TypeError, ValueError, OverflowError):
        is_one = False
    if not is_one:
        raise InvalidInput(f"{what} must be a colour that Matplotlib knows, got {shown(value)}")


def _colours(value: Any, what: str) -> None:
    if not isinstance(value, Mapping):
        raise InvalidInput(f"{what} must be a dict from names of contacts to colours, got {shown(value)}")
    for colour in value.values():
        _colour(colour, f"every entry of {what}")


def _limits(value: Any, what: str) -> None:
    limits = items(value, what)
    if len(limits) != 2 or isinstance(value, (Mapping, Set)):  # these have no order
        raise InvalidInput(f"{what} must be two numbers, got {shown(value)}")
    for limit in limits:
        if not (isinstance(limit, float) and limit == inf):
            number(limit, f"every entry of {what}", above=0)


def _numbers(value: Any, what: str) -> None:
    if finite(value, what).ndim > 1:
        raise InvalidInput(f"{what} must be numbers in a row, got {shown(value)}")


def _shape(value: Any, what: str) -> None:
    if not isinstance(value, Outline):
        try:
            triangles_of(value)
        except InvalidInput:
            raise InvalidInput(
                f"{what} must be an Outline, or in space a mesh or (vertices, faces), got {shown(value)}"
            ) from None


_CHECKS: dict[str, Callable[[Any, str], Any]] = {
    "ax": lambda value, what: instance(value, what, Axes, "; new ones are made if it is left out"),
    "units": lambda value, what: instance(value, what, Units, "; such as Units('mm', 'N')"),
    "label": _text,
    "colour": _colour,
    "colours": _colours,
    "force_scale": lambda value, what: number(value, what, above=0),
    "reach": lambda value, what: number(value, what, above=0),
    "control": _flag,
    "shadow": _flag,
    "absent": _names,
    "order": _names,
    "o": lambda value, what: whole(value, what, least=-_FEW),
    "torques": _numbers,
    "arc_lengths": _numbers,
    "force_limits": _limits,
    "mesh": lambda value, what: triangles_of(value),
    "outline": _shape,
    "shape": _shape,
    "objective": lambda value, what: objective_of(value),
    "at_value": number,
    "title": _text,
    "caption": _text,
    "path": lambda value, what: file_path(value),
    "frames_per_second": lambda value, what: number(value, what, least=0.01),
    "move_time": lambda value, what: number(value, what, least=0),
}
