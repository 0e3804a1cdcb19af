"""Ferrari and Canny's measure: the largest ball of wrenches that limited fingers can make."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf
from typing import Literal

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.measures.closure import closure, taken
from regrasp.measures.wrench_sets import WrenchSet
from regrasp.mechanics.checks import Array, ArrayLike, array, choice, not_huge, number, numbers_in, read_only
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.value import ArrayValue, numbers
from regrasp.mechanics.wrench import Wrench

Norm = Literal["Linf", "L1"]
NORMS = ("Linf", "L1")
GAP = 0.01
"""Default largest gap between the bounds in space, relative to the upper one."""

_STARTS, _STEPS = 60, 200
_CONES = 4_000_000  # some seconds
_FEW = 20_000  # where the radius is next to none: then whether there is closure is asked first
_LITTLE = 1e-3  # of the fingers' wrenches
_LOOSER = (0.05, 0.2, 0.5)
_ROUNDING = 1e-12
_FARTHEST = 1e50  # facets have normals of products, whose squares are numbers
_FLAT = 1e-9
_SURELY = 1e-6  # of the fingers' wrenches: an upper bound that no search stops at without closure


@dataclass(frozen=True, eq=False, repr=False)
class WrenchBall(ArrayValue):
    """The largest ball of disturbances, in any direction, that fingers of limited normal force balance.

    Args:
        grasp: the contacts that hold.
        norm: ``Linf``, every finger has its own limit, or ``L1``, their sum has one.
        limits: (n,) largest normal force of each finger (``Linf``), or of their sum, n times the same
            (``L1``) [N].
        length: by which torques are divided [m].
        radius: [N], torques divided by ``length`` [m]: the least found; 0 without closure.
        bounds: (lower, upper) [N], proven; equal in the plane, where the radius is exact but for rounding.
        direction: (3,) or (6,), unit, of the disturbance (force, torque / length) that is balanced least;
            where there is no closure, one that is not balanced at all.
    """

    grasp: Grasp
    norm: Norm
    limits: Array
    length: float
    radius: float
    bounds: tuple[float, float]
    direction: Array

    @property
    def gap(self) -> float:
        """Between the bounds, relative to the upper one."""
        lower, upper = self.bounds
        return (upper - lower) / upper if upper else 0.0

    @property
    def disturbance(self) -> Wrench:
        """The least disturbance at the limit, as a load: of length ``radius``, in ``direction``."""
        d = self.grasp.dimension
        return Wrench.from_vector(
            self.radius * self.direction * np.r_[np.ones(d), [self.length] * (2 * d - 3)]
        )

    def __str__(self) -> str:
        lower, upper = self.bounds
        proven = f"{self.radius:.6g} N" if lower == upper else f"between {lower:.6g} and {upper:.6g} N"
        shown = np.where(abs(self.direction) < 1e-9, 0.0, self.direction)
        return (
            f"{self.norm} wrench ball of {', '.join(self.grasp.names)}: radius {proven} (torques divided by "
            f"{self.length:.6g} m), least along {numbers(shown)}"
        )

    def __repr__(self) -> str:
        return f"WrenchBall({self})"


def wrench_ball(
    grasp: Grasp | Iterable[Contact],
    *,
    limit: ArrayLike,
    norm: Norm = "Linf",
    length: float | None = None,
    gap: float = GAP,
) -> WrenchBall:
    """Ferrari and Canny's grasp quality, with exact friction cones.

    In the plane the fingers' wrenches are a polytope, whose facets are enumerated. In space directions are
    searched by branch and bound, any wrench that can be made bounding a cone of directions from below
    (docs/quality.md): tens to hundreds of milliseconds to 1 %. Where millions of cones do not suffice, the
    bounds are wider than ``gap``.

    Source: Ferrari and Canny, Planning optimal grasps, ICRA 1992.

    Args:
        grasp: the contacts that hold.
        limit: ``Linf``, each finger's largest normal force, a number or (n,); ``L1``, the largest sum of the
            normal forces [N]. Force limits of the contacts themselves, linear ones too, do not count.
        norm: ``Linf``, every finger has its own limit, or ``L1``, their sum has one.
        length: by which torques are divided [m]; the grasp's size if not given, so that the result does not
            depend on the unit of length.
        gap: in space, how near the bounds must come, relative; inf: only the upper bound, at once, with 0 as
            the lower one.

    Raises:
        InvalidInput: For bad input.
    """
    grasp = taken(grasp)
    total = choice(norm, "norm", NORMS) == "L1"
    limits = normal_limits(limit, len(grasp), total=total)
    if grasp.out_of_range:
        raise InvalidInput(grasp.out_of_range)
    length = length_of(grasp, length)
    if not (isinstance(gap, float) and gap == inf):
        number(gap, "gap", above=0)
    found = radius(grasp, WrenchSet.of(grasp, limits, total, length), length, gap)
    return WrenchBall(grasp, norm, read_only(limits), length, found[1], found[:2], read_only(found[2]))


def radius(
    grasp: Grasp, wrenches: WrenchSet, length: float, gap: float, metric: Array | None = None
) -> tuple[float, float, Array]:
    """(lower, upper, direction) of min h(u) / |D u|; ``metric``: (m,) ones and zeros of D, or None."""
    m = wrenches.axes.shape[1]
    d = np.ones(m) if metric is None else metric
    if m == 6 and metric is None:
        # a lower bound above 0 proves closure, too; without closure no search ends
        found = _searched(wrenches, d, gap, few=True)
        if found[0] > 0 or (gap >= 1 and found[1] > _SURELY * np.abs(wrenches.axes).max()):
            return found
    if (twist := closure(grasp).escape) is not None:
        u = twist * np.where(np.arange(m) < grasp.dimension, 1.0, length)
        u = u / np.linalg.norm(u)
        if np.linalg.norm(d * u) > _FLAT:
            return 0.0, 0.0, u
        if m == 6:  # what is not resisted does not count, and no search closes in on it
            return 0.0, *_searched(wrenches, d, inf)[1:]
    if m == 6:
        return _searched(wrenches, d, gap)
    facets = wrenches.facets
    sizes = np.linalg.norm(d * facets, axis=1)
    values = np.full(len(facets), inf)
    np.divide(wrenches.support(facets), sizes, out=values, where=sizes > _FLAT)
    least = int(values.argmin())
    return float(values[least]), float(values[least]), -facets[least]


def _searched(
    wrenches: WrenchSet, metric: Array, gap: float, few: bool = False
) -> tuple[float, float, Array]:
    """``few``: of a radius next to none, few cones, and no wider gap where they do not suffice."""
    from regrasp.closed_form.compiled.direction_search import descend, prove

    # torques beside forces as large as they are, so that the cones start with the same shape in all
    # directions
    unit = float(np.abs(wrenches.axes).max())
    parts = wrenches.axes / unit, np.ascontiguousarray(wrenches.tangents / unit), wrenches.total
    starts = np.vstack([np.eye(6), -np.eye(6), np.random.default_rng(0).normal(size=(_STARTS, 6))])
    upper, u = descend(*parts, metric, starts, _STEPS)
    lower = 0.0
    few = few and upper < _LITTLE
    looser = () if few else tuple(g for g in _LOOSER if g > gap)
    for asked in (gap, *looser) if gap < 1 else ():
        upper, u, _, done = prove(*parts, metric, u, asked, _FEW if few else _CONES)
        if done:
            lower = upper * (1 - asked) * (1 - _ROUNDING)
            break
    return unit * lower, unit * float(upper), -u


def length_of(grasp: Grasp, length: float | None) -> float:
    """What torques are divided by: ``length``, checked, or the grasp's size [m]."""
    if length is None:
        return grasp.size or 1.0
    given = number(length, "length", above=0)
    if not 1 / _FARTHEST <= given <= _FARTHEST:
        raise InvalidInput(
            f"length must be between {1 / _FARTHEST:g} and {_FARTHEST:g} m, got {shown(length)}"
        )
    return given


def normal_limits(limit: ArrayLike, count: int, *, total: bool) -> Array:
    """(n,) checked limits of normal forces [N]; of a ``total`` the same number for all."""
    if numbers_in(limit, "limit must be a number or one for each finger").ndim == 0:
        return np.full(count, not_huge(number(limit, "limit", above=0), "limit", _FARTHEST))
    if total:
        number(limit, "limit of an L1 ball")  # raises: a sum has one limit
    given = array(limit, "limit", (count,))
    for value in given.tolist():
        number(value, "limit", above=0)
    return not_huge(given, "limit", _FARTHEST).copy()
