"""The kinds of values that a plan, a claim or a cut has, whoever made it: no others are judged."""

from collections.abc import Callable
from math import inf
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.verification.protocols import NEEDED

_Kind = tuple[Callable[[Any], bool], str]
_MISSING = object()


def _is_number(value: Any) -> bool:
    return isinstance(value, float) or (type(value) is int and value.bit_length() < 1024)


def _is_array(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and value.dtype.itemsize <= 8


def _is_row(value: Any) -> bool:
    is_list = isinstance(value, (tuple, list)) and all(map(_is_number, value))
    return is_list or (_is_array(value) and value.ndim == 1)


def _is_table(value: Any) -> bool:
    return _is_array(value) and value.ndim > 0


def _is_doubles(value: Any) -> bool:
    """Of an array that is reckoned with before rationals are: narrow numbers round, whole ones overflow."""
    return _is_table(value) and value.dtype.kind == "f" and value.dtype.itemsize == 8


def _is_wide(value: Any) -> bool:
    """Of coordinates of somebody's shape, which may be whole."""
    return _is_table(value) and value.dtype.itemsize == 8


def _is_whole(value: Any) -> bool:
    return _is_table(value) and value.dtype.kind == "i" and value.dtype.itemsize >= 4


def _or_none(kind: _Kind) -> _Kind:
    return (lambda value: value is None or kind[0](value)), f"{kind[1]} or None"


def _columns(count: int, is_so: Callable[[Any], bool] = _is_doubles) -> _Kind:
    return (lambda value: is_so(value) and value.shape[1:] == (count,)), f"rows of {count} numbers"


def _several(is_one: Callable[[Any], bool], words: str) -> _Kind:
    return (lambda value: isinstance(value, (tuple, list)) and all(map(is_one, value))), f"a tuple of {words}"


def _answers(kind: _Kind, *given: float) -> _Kind:
    """Of a method."""

    def is_so(method: Any) -> bool:
        try:
            return kind[0](method(*given))
        except Exception:
            return False

    return is_so, f"a method that gives {kind[1]}"


_NUMBER: _Kind = _is_number, "a number"
_DOUBLE: _Kind = (lambda v: isinstance(v, float) or (type(v) is int and v.bit_length() < 64)), "a number"
_LEAST_0: _Kind = (lambda value: _is_number(value) and 0 <= value < inf), "a number of 0 or more"
_COUNT: _Kind = (lambda value: type(value) is int and 0 <= value < 2**31), "a whole number"
_PLACES = _several(lambda value: type(value) is int, "whole numbers")
_ROW: _Kind = _is_row, "a row of numbers"
_ARRAY: _Kind = _is_array, "an array of numbers"
_TABLE: _Kind = _is_doubles, "an array of doubles"
_WHOLE: _Kind = _is_whole, "an array of signed whole numbers, of 32 bits or more"
_WORD: _Kind = (lambda value: isinstance(value, str)), "a word"
_SEVERAL: _Kind = (lambda value: isinstance(value, (tuple, list))), "a tuple"
_STATES = _several(lambda value: isinstance(value, GraspState), "states")
_CONTACTS = _several(
    lambda value: isinstance(value, Contact) and value.dimension == 2, "contacts in the plane"
)
_ANY: _Kind = (lambda value: True), "there"
_PLANAR: _Kind = (lambda value: isinstance(value, Grasp) and value.dimension == 2), "a Grasp in the plane"
_SPATIAL: _Kind = (lambda value: isinstance(value, Grasp) and value.dimension == 3), "a Grasp in space"
_POINT: _Kind = (lambda value: _is_table(value) and value.shape == (2,)), "a point"
_PLACE: _Kind = (lambda value: _is_table(value) and value.shape == (3,)), "a point"
_POINTS = _columns(2, _is_wide)
_RINGS = _several(_POINTS[0], "rings")
_OUTLINE: _Kind = (
    (lambda v: _POINTS[0](v) and len(v) > 2 and bool(np.isfinite(v).all())),
    "three points or more",
)
_CUBICS: _Kind = (lambda v: _is_wide(v) and v.shape[1:] == (4, 2)), "rows of 4 control points"


def read(owner: object, name: str) -> Any:
    """An attribute; what ``is_there`` denies where there is none, or where reading it fails."""
    try:
        return getattr(owner, name, _MISSING)
    except Exception:
        return _MISSING


def is_there(owner: object, *names: str) -> bool:
    """Whether it has all of some attributes."""
    return all(read(owner, name) is not _MISSING for name in names)


def is_transition(plan: object) -> bool:
    """Whether it has what a transition has, its two states among that."""
    return is_there(plan, *NEEDED) and all(
        isinstance(read(plan, end), GraspState) for end in ("start", "end")
    )


def check_transition(plan: Any) -> None:
    """Refuse a transition whose values are not of the kinds that ``Plan`` says."""
    _check(plan.scaling, "scaling", duration=_NUMBER, control=_ROW)
    if plan.course is not None:
        _check(plan.course, "course", times=_ARRAY, forces=_ARRAY, loads=_ARRAY)
    if plan.turn is not None:
        _check(
            plan.turn, "turn", angles=_ARRAY, forces=_ARRAY, axis=_or_none(_ARRAY), middles=_or_none(_ARRAY)
        )
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


def check_claim(claim: Any) -> None:
    """Refuse a chosen grasp, a proof, regions or a cut whose values are not of the kinds that these have."""
    if is_there(claim, "reached"):
        _check_cut(claim)
    elif is_there(claim, "patches", "moments"):
        _check_face_regions(claim)
    elif is_there(claim, "corners") and not is_there(claim, "halves"):
        _check_regions(claim)
    elif is_there(claim, "certificate"):
        in_space = is_there(claim.certificate, "normals")
        grasp, places = (_SPATIAL, _columns(3)) if in_space else (_PLANAR, _ROW)
        _check(claim, "", objective=_WORD, value=_DOUBLE, bound=_DOUBLE, places=places, states=_STATES)
        _check(claim, "", others=_SEVERAL, max_force=_or_none(_DOUBLE), min_normal=_DOUBLE)
        _check(
            claim,
            "",
            length=_or_none(_DOUBLE),
            deviations=_or_none(_columns(6 if in_space else 3)),
            grasp=grasp,
        )
        for k, other in enumerate(claim.others):
            _check(other, f"others[{k}]", value=_DOUBLE, grasp=grasp, places=places)
        _check_proof(claim.certificate, "certificate")
        has_rings = not in_space and claim.certificate.rings is not None
        _check_shape(claim, **({"hole_polygons": _answers(_RINGS)} if has_rings else {}))
    else:
        _check_proof(claim, "")


def _check_shape(claim: Any, **more: _Kind) -> None:
    _check(claim, "", shape=_ANY)
    shape = claim.shape
    if is_there(shape, "surface"):
        _check(shape, "shape", centre_of_mass=_PLACE, surface=_answers((_is_surface, "vertices and faces")))
    else:
        _check(shape, "shape", polygon=_answers(_OUTLINE), cubics=_answers(_or_none(_CUBICS)), **more)


def _is_surface(value: Any) -> bool:
    is_pair = isinstance(value, (tuple, list)) and len(value) == 2
    return is_pair and _columns(3, _is_wide)[0](value[0]) and _columns(3, _is_whole)[0](value[1])


def _check_proof(proof: Any, where: str) -> None:
    _check(
        proof, where, fingers=_COUNT, friction=_DOUBLE, loads=_TABLE, size=_WORD, norm=_WORD, bound=_DOUBLE
    )
    _check(proof, where, min_distance=_DOUBLE, number=_WHOLE, twists=_TABLE, children=_columns(2, _is_whole))
    if is_there(proof, "normals"):
        _check(proof, where, corners=_TABLE, normals=_TABLE, spans=_WHOLE, halves=_WHOLE, boxes=_WHOLE)
        _check(proof, where, together=_or_none(_TABLE))
        return
    _check(proof, where, vertices=_TABLE, centre_of_mass=_TABLE, sides=_TABLE, arcs=_WHOLE, ends=_TABLE)
    _check(proof, where, pairs=_or_none(_WHOLE), seconds=_or_none(_TABLE), control=_or_none(_TABLE))
    _check(proof, where, rings=_or_none(_WHOLE), margin=_DOUBLE, tied=_or_none(_TABLE))
    _check(proof, where, movers=_or_none(_WHOLE), motions=_or_none(_TABLE))
    _check(proof, where, by_side=_or_none(_WHOLE), side_twists=_or_none(_TABLE))
    _check(
        proof,
        where,
        max_force=_or_none(_DOUBLE),
        min_normal=_DOUBLE,
        turned=((lambda v: isinstance(v, bool)), "True or False"),
    )


def _check_regions(regions: Any) -> None:
    _check(regions, "", grasp=_PLANAR, max_force=_DOUBLE, places=_TABLE, arcs=_TABLE, half_width=_DOUBLE)
    _check(regions, "", corners=_STATES, spans=_or_none(_TABLE), cells=_or_none(_TABLE))
    is_proof = (lambda v: is_there(v, "bound", "places", "starts", "at")), "a proof of the widest"
    _check(regions, "", widest=_or_none(is_proof))
    if (proof := regions.widest) is not None:
        _check(proof, "widest", bound=_DOUBLE, places=_TABLE, starts=_TABLE, at=_TABLE, loads=_TABLE)
        _check(proof, "widest", twists=_TABLE)
    holes = {"hole_polygons": _answers(_RINGS)} if is_there(read(regions, "shape"), "hole_polygons") else {}
    _check_shape(regions, points=_answers(_POINT, 0.0), **holes)


def _check_face_regions(regions: Any) -> None:
    _check(regions, "", grasp=_SPATIAL, max_force=_DOUBLE, patches=_SEVERAL, radius=_DOUBLE, radii=_TABLE)
    _check(regions, "", loads=_TABLE, moments=_TABLE, tilts=_TABLE, focus=_TABLE, forces=_TABLE)
    for k, patch in enumerate(regions.patches):
        if not _is_doubles(patch):
            raise InvalidInput(f"patches[{k}] of a plan must be an array of doubles, got {shown(patch)}")
    _check_shape(regions)


def _check_cut(cut: Any) -> None:
    if is_there(cut, "boxes"):
        _check(
            cut,
            "",
            vertices=_POINTS,
            friction=_DOUBLE,
            force=_TABLE,
            turned=_or_none(_TABLE),
            min_normal=_DOUBLE,
        )
        _check(cut, "", forbidden=_ROW, max_force=_or_none(_DOUBLE), start=_POINTS, goal=_POINTS)
        _check(cut, "", reached=_columns(3), boxes=_columns(6), twists=_columns(3))
        return
    _check(cut, "", contacts=_CONTACTS, start=_PLACES, goal=_PLACES, reached=_PLACES)
    _check(cut, "", least_margin=_LEAST_0, min_distance=_LEAST_0)


def _check(owner: object, where: str, **kinds: _Kind) -> None:
    for name, (is_so, words) in kinds.items():
        value = read(owner, name)
        at = f"{where}.{name}".lstrip(".")
        if value is _MISSING:
            raise InvalidInput(f"{at} of a plan must be {words}, there is none")
        if not is_so(value):
            raise InvalidInput(f"{at} of a plan must be {words}, got {shown(value)}")
