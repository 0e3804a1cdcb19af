"""What is looked at on request, since it takes longer than a frame: tolerances, and maps of placement."""

from collections.abc import Callable, Iterator
from math import degrees, inf, isfinite, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import Infeasible, InvalidInput, RegraspError
from regrasp.explore.plain import plain
from regrasp.explore.question import Question, Shape
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.outline.outline import Outline
from regrasp.planning.changes.finger_change import plan_removal
from regrasp.planning.placement.maps.placement_map import placement_map
from regrasp.planning.placement.regions.asking import contact_regions
from regrasp.planning.robustness.tolerances import tolerances
from regrasp.planning.states.batch import best_squeezes
from regrasp.planning.states.choosing import choose_state
from regrasp.plans.transition import Transition

CELLS = 96
"""Of a map, along each side."""
_COARSE = 48  # where others stay
_NORMS = ("sum_normal", "peak_normal", "peak", "effort")
_TRIED, _TRIED_TOGETHER = 240, 60
_WAY = 40  # points of a drawn region
_RESERVE = 1 - 1e-9  # as in planning

# Of normal and tangential forces (..., 2) and frictions: unit, whether more is better, value.
Value = Callable[[Array, Array, Array], Array]
_VALUES: dict[str, tuple[str, bool, Value]] = {
    "angle": ("deg", True, lambda n, t, mu: np.degrees((np.arctan(mu) - np.arctan2(t, n)).min(axis=-1))),
    "force": ("N", True, lambda n, t, mu: ((mu * n - t) / np.hypot(1, mu)).min(axis=-1)),
    "effort": ("N^2", False, lambda n, t, _: (n * n + t * t).sum(axis=-1)),
    "peak": ("N", False, lambda n, t, _: np.hypot(n, t).max(axis=-1)),
    "peak_normal": ("N", False, lambda n, _, __: n.max(axis=-1)),
    "sum_normal": ("N", False, lambda n, _, __: n.sum(axis=-1)),
    "friction_use": ("-", False, lambda n, t, mu: (t / (mu * n)).max(axis=-1)),
}


def tolerated(question: Question, shape: Shape | None = None, *, answered: bool = False) -> dict[str, Any]:
    """How far everything may be off, as rows of a table.

    Args:
        question: what is asked.
        shape: contacts stand on its nearest points.
        answered: with forces chosen anew, too, which takes seconds.
    """
    found = tolerances(_held(question.on(shape)))
    mine = found.withstood
    other = found.answered if answered else None

    def row(name: str, key: str, unit: str, k: int | None = None) -> list[str]:
        ends = [getattr(side, key) for side in (mine, other) if side is not None]
        words = [_words(float(end if k is None else end[k]), key, unit) for end in ends]
        return [name, *words, str(found.first.get(key, ""))]

    rows = [
        row("friction, all", "friction", "times"),
        row("load", "load", "times"),
        row("tilt of the load", "tilt", "deg"),
        row("centre of mass", "centre", "m"),
        *(row(f"place of {name}", "position", "m", k) for k, name in enumerate(found.names)),
    ]
    head = ["may be off", "set-points stay", *(["forces chosen anew"] if answered else []), "fails first"]
    return {"head": head, "rows": rows}


def _words(value: float, key: str, unit: str) -> str:
    if not isfinite(value) or (key == "tilt" and value == pi):
        return "any"
    number = f"{degrees(value) if key == 'tilt' else value:.3g}".replace("-", "\N{MINUS SIGN}")
    return {"friction": "down to ", "load": "up to ", "tilt": "by "}.get(key, "by ") + f"{number} {unit}"


def _held(asked: Question) -> GraspState | Transition:
    if asked.leaves is None:
        return choose_state(asked.grasp, asked.wrench, asked.objective)
    whole = choose_state(asked.grasp, asked.wrench, "force")
    return plan_removal(whole, asked.leaves, objective=asked.objective)


def _staying(asked: Question) -> Grasp:
    return asked.grasp if asked.leaves is None else asked.grasp.without(asked.leaves)


def pair_map(question: Question, shape: Shape | None = None) -> dict[str, Any]:
    """Of the first two fingers that hold, the objective's value wherever on the outline they are.

    Others that hold stay where they are; the map is coarser then, and of forces.

    Args:
        question: what is asked.
        shape: the outline.
    """
    outline = _outline(shape)
    asked = question.on(outline)
    two = _staying(asked)
    if len(two) > 2:
        return _beside(asked, two, outline)
    s = (np.arange(CELLS) + 0.5) * outline.length / CELLS
    values = np.full((CELLS, CELLS), np.nan)
    i, j = np.nonzero(~np.eye(CELLS, dtype=bool))
    values[j, i] = _values(asked, two, outline, s[i], s[j])  # rows: the second finger
    unit, more, _ = _VALUES[asked.objective]
    return {
        "names": list(two.names),
        "places": plain(outline.points(s)),
        "length": outline.length,
        "at": [_place(outline, p) for p in two.positions],
        "values": plain(values),
        "title": f"{'widest' if more else 'least'} {asked.objective.replace('_', ' ')}",
        "unit": unit,
        "more": more,
    }


def _beside(asked: Question, rest: Grasp, outline: Outline) -> dict[str, Any]:
    """The map of two fingers beside one or two that stay."""
    if len(set(rest.frictions.tolist())) > 1 or any(c.max_force is not None for c in rest):
        raise InvalidInput("a map beside fingers that stay is of one friction and without force limits")
    word = asked.objective if asked.objective in _NORMS else "peak"
    places = [_place(outline, p) for p in rest.positions]
    mu, load = float(rest.frictions[0]), asked.wrench
    found = placement_map(outline, load, friction=mu, fixed=places[2:], objective=word, count=_COARSE)
    return {
        "names": list(rest.names[:2]),
        "places": plain(outline.points(found.places)),
        "length": outline.length,
        "at": places[:2],
        "values": plain(found.values),
        "title": f"least {word.replace('_', ' ')} beside {', '.join(rest.names[2:])}",
        "unit": _VALUES[word][0],
        "more": False,
    }


def _values(asked: Question, two: Grasp, outline: Outline, s1: Array, s2: Array) -> Array:
    """Of fingers of these frictions and limits at arc lengths, NaN where nothing holds."""
    r1, r2, n1, n2 = outline.points(s1), outline.points(s2), outline.normals(s1), outline.normals(s2)
    mu = two.frictions * _RESERVE
    force, torque = np.array(asked.load[:2]), asked.load[2]
    limits = tuple(inf if c.max_force is None else c.max_force for c in two)
    x = best_squeezes(
        r1, n1, mu[0], r2, n2, mu[1], force, torque,
        objective=asked.objective, max_force=None if limits == (inf, inf) else limits,
    )  # fmt: skip
    along = r2 - r1
    u = along / np.linalg.norm(along, axis=-1, keepdims=True)
    turned = np.stack([-u[..., 1], u[..., 0]], axis=-1)
    lever = (torque - _cross(r2, force)) / _cross(along, turned)
    first = x[..., None] * u + lever[..., None] * turned  # moments about the second contact
    forces, normals = np.stack([first, -force - first], axis=-2), np.stack([n1, n2], axis=-2)
    pressing, across = (forces * normals).sum(axis=-1), np.abs(_cross(forces, normals))
    with np.errstate(all="ignore"):
        values: Array = _VALUES[asked.objective][2](pressing, across, two.frictions)
    return values


def _cross(a: Array, b: Array) -> Array:
    result: Array = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return result


def places(question: Question, shape: Shape | None = None) -> dict[str, Any]:
    """Where on the outline each finger that holds may be, alone, and all at once, with proof.

    Args:
        question: what is asked.
        shape: the outline.
    """
    outline = _outline(shape)
    asked = question.on(outline)
    rest = _staying(asked)
    tried = _TRIED if len(rest) == 2 else _TRIED_TOGETHER
    s = np.arange(tried) * outline.length / tried
    alone = []
    for k in range(len(rest)):
        held = _held_alone(asked, rest, outline, k, s)
        alone += [
            {"name": rest.names[k], "points": plain(outline.points(np.linspace(a, b, _WAY)))}
            for a, b in _runs(held, s, outline.length)
        ]
    found: dict[str, Any] = {"alone": alone, "together": [], "says": f"Of {tried} places tried for each."}
    try:
        regions = contact_regions(outline, rest, asked.wrench)
    except RegraspError as error:
        return found | {"says": f"{found['says']} All at once: {error}."}
    for name, (a, b) in zip(rest.names, regions.arcs, strict=True):
        found["together"].append(
            {"name": name, "points": plain(outline.points(np.linspace(a, b, _WAY) % outline.length))}
        )
    widths = ", ".join(f"{name} {w:.3g} m" for name, w in zip(rest.names, regions.widths, strict=True))
    limit = f"with forces up to {regions.max_force:.3g} N"
    return found | {"says": f"{found['says']} Proven, {limit}: all at once anywhere in bands of {widths}."}


def _held_alone(asked: Question, rest: Grasp, outline: Outline, k: int, s: Array) -> NDArray[np.bool_]:
    """Whether the grasp holds with one finger at each of the places, the others where they are."""
    if len(rest) == 2:
        other = np.full(len(s), _place(outline, rest.positions[1 - k]))
        apart = np.abs((s - other + outline.length / 2) % outline.length - outline.length / 2) > 0
        first, second = (s, other) if k == 0 else (other, s)
        held = np.zeros(len(s), dtype=bool)
        held[apart] = ~np.isnan(_values(asked, rest, outline, first[apart], second[apart]))
        return held
    return np.array([_holds(asked, rest, outline, k, float(place)) for place in s])


def _holds(asked: Question, rest: Grasp, outline: Outline, k: int, place: float) -> bool:
    contacts = list(rest)
    mine = contacts[k]
    try:
        contacts[k] = outline.contact_at(
            place, friction=mine.friction, max_force=mine.max_force, name=mine.name
        )
        choose_state(Grasp(contacts), asked.wrench, "peak")
    except (Infeasible, InvalidInput):  # a corner, or where another finger is
        return False
    return True


def _runs(held: NDArray[np.bool_], s: Array, length: float) -> Iterator[tuple[float, float]]:
    """Ends of stretches of places that hold, across the beginning of the outline, too."""
    if held.all():
        yield 0.0, length
        return
    begins = np.flatnonzero(held & ~np.roll(held, 1))
    for begin in begins:
        count = int(np.argmin(np.roll(held, -begin)))
        yield float(s[begin]), float(s[begin] + (count - 1) * length / len(s))


def _place(outline: Outline, position: Array) -> float:
    return float(outline.nearest(position + outline.centre_of_mass))


def _outline(shape: Shape | None) -> Outline:
    if not isinstance(shape, Outline):
        raise InvalidInput("needs an outline: regrasp explore bracket, or a drawing")
    return shape
