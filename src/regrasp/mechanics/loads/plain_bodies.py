"""Bodies of load sets to and from plain data, by the name of their kind."""

from collections.abc import Mapping
from math import pi
from typing import Any

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import array, not_huge, number
from regrasp.mechanics.loads.bodies import Body, Cap, Ellipsoid, Hull, Moved
from regrasp.mechanics.plain import entries

_KEYS = {"hull": ("points",), "ellipsoid": ("middle", "axes"), "cap": ("force", "torque", "angle")}


def plain_body(body: Body) -> dict[str, Any]:
    """``kind`` and what it takes, ``moved`` besides where everything is."""
    if isinstance(body, Moved):
        return plain_body(body.inner) | {"moved": body.by.tolist()}
    kinds = {Hull: "hull", Ellipsoid: "ellipsoid", Cap: "cap"}
    if type(body) not in kinds:
        raise InvalidInput(f"a set of one's own has no plain data, got {shown(body)}")
    kind = kinds[type(body)]
    values = {key: getattr(body, key) for key in _KEYS[kind]}
    return {"kind": kind} | {k: v if isinstance(v, float) else v.tolist() for k, v in values.items()}


def body_of(data: Mapping[str, Any], size: int) -> Body:
    """The body of plain data, of loads of ``size`` 3 or 6."""
    kind = data.get("kind") if isinstance(data, Mapping) else None
    if not isinstance(kind, str) or kind not in _KEYS:
        raise InvalidInput(f"a load set's kind must be {', '.join(map(repr, _KEYS))}, got {shown(kind)}")
    given = entries(data, f"a {kind}", ("kind", *_KEYS[kind]), ("moved",))
    if (by := given.get("moved")) is not None:
        rest = {key: value for key, value in given.items() if key != "moved"}
        return Moved(body_of(rest, size), not_huge(array(by, "moved", (size,)), "moved"))
    if kind == "hull":
        return Hull(not_huge(_some(array(given["points"], "points", (None, size)), "points"), "points"))
    if kind == "ellipsoid":
        axes = not_huge(_some(array(given["axes"], "axes", (size, None)), "axes"), "axes")
        return Ellipsoid(not_huge(array(given["middle"], "middle", (size,)), "middle"), axes)
    angle = number(given["angle"], "angle", least=0)
    if angle > pi:
        raise InvalidInput(f"angle must be at most pi, every direction, got {shown(angle)}")
    d = 2 if size == 3 else 3
    force = not_huge(array(given["force"], "force", (d,)), "force")
    return Cap(force, not_huge(array(given["torque"], "torque", (size - d,)), "torque"), angle)


def _some(values: Any, what: str) -> Any:
    if not values.size:
        raise InvalidInput(f"{what} of a load set must not be empty")
    return values
