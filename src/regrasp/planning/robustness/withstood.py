"""How far each thing may be off with set-points as they are and stiffness answering."""

from collections.abc import Iterable
from math import inf, pi
from typing import NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.orientation.tangents import tangents_of
from regrasp.mechanics.robust.withstanding import SLIPS, Worst
from regrasp.mechanics.wrench import Wrench, torque
from regrasp.planning.robustness.positions import farthest_offsets
from regrasp.planning.robustness.views import View

_STEPS = 60


class Failure(NamedTuple):
    """Which finger fails first beyond a tolerance, how, and when in a plan (empty for a state)."""

    finger: str
    how: str
    when: str

    def __str__(self) -> str:
        at = f" at {self.when}" if self.when else ""
        return f"{self.finger} {self.how}{at}"


Found = tuple[float, Failure | None]
_STARTS = 8  # an angle may be least at several twists


def friction_factor(views: Iterable[View], base: LoadSet | None) -> Found:
    """The least factor on all coefficients, torsions with them, with which forces stay in their cones."""
    best: Found = (0.0, None)
    for view in views:
        factors = _friction_factors(view, base)
        i = int(factors.argmax())
        if factors[i] > best[0]:
            best = float(factors[i]), Failure(view.grasp.names[i], SLIPS, view.label)
    return best


def _friction_factors(view: View, base: LoadSet | None) -> Array:
    grasp = view.grasp
    if base is None:
        measured = grasp.cones.measured(view.state.forces)
        used = grasp.cones.tangential(measured)
        available = grasp.frictions * np.maximum(grasp.cones.normal(measured), 0.0)
        return np.divide(used, available, out=np.where(used > 0, inf, 0.0), where=available > 0)
    low, high = np.zeros(len(grasp)), np.ones(len(grasp))
    unlimited = np.full(len(grasp), inf)
    for _ in range(_STEPS):
        middle = (low + high) / 2
        given = view.withstanding(base)
        given = type(given)(
            given.cones, given.forces, given.responses, middle * given.frictions, unlimited, base
        )
        held = given.spare() >= 0
        low, high = np.where(held, low, middle), np.where(held, middle, high)
        if (high - low <= 1e-12).all():
            break
    return high


def load_factor(views: Iterable[View], base: LoadSet | None) -> Found:
    """The largest factor of the load."""
    found = least(
        (view, view.withstanding(base).factors(_segment(view.state.load)))
        for view in views
        if view.state.load.vector.any()
    )
    return 1 + found[0], found[1]


def centre_distance(views: Iterable[View], base: LoadSet | None) -> Found:
    """How far the centre of mass may be off, across the load's force [m]."""
    return least(
        (view, view.withstanding(base).factors(_off_centre(view.state.load)))
        for view in views
        if view.state.load.force.any()
    )


def tilt_angle(views: Iterable[View], base: LoadSet | None) -> Found:
    """How far the load's force may turn, any way, its torque staying [rad]."""
    angle, failure = least((view, _tilted(view, base)) for view in views if view.state.load.force.any())
    return (pi, None) if angle >= pi else (angle, failure)


def _tilted(view: View, base: LoadSet | None) -> Worst:
    """A load F turned within the angle a does the work |F| |q| cos(max(psi - a, 0)) at most along a twist.

    q: the twist's force part. psi: between q and F.
    """
    force = view.state.load.force
    d, size = force.size, float(np.linalg.norm(force))

    def angle(room: Array, twists: Array) -> Array:
        q = twists[..., :d]
        length = size * np.sqrt((q * q).sum(axis=-1))
        ahead = q @ force
        known = length > 1e-14 * (length.max(initial=0.0) + np.abs(room))
        needed = np.divide(room + ahead, length, out=np.full(room.shape, inf), where=known)
        psi = np.arccos(np.clip(np.divide(ahead, length, out=np.zeros(room.shape), where=known), -1, 1))
        within = needed < 1
        beyond = pi + np.minimum(needed - 1, 1.0)  # never; less of it the nearer, so that a search has a way
        result: Array = np.where(within, psi - np.arccos(np.clip(needed, -1, 1)), beyond)
        return result

    def member(twist: Array, angle: float) -> Array:
        if angle >= pi:
            return np.zeros_like(view.state.load.vector)
        tilted = LoadSet.tilted(view.state.load, max(angle, 0.0)).extreme(twist).vector
        return tilted - view.state.load.vector

    return view.withstanding(base).worst(angle, member, _STARTS)


def offsets(
    views: Iterable[View], names: tuple[str, ...], base: LoadSet | None, surface: Array, reach: float
) -> tuple[Array, Failure | None]:
    """(n,) how far each contact alone may be off along its tangents [m]; who fails at the least."""
    result, first = np.full(len(names), inf), None
    for view in views:
        curvatures = surface[[names.index(name) for name in view.grasp.names]]
        lengths, failing = farthest_offsets(view, base, curvatures, reach)
        for name, length, (finger, how) in zip(view.grasp.names, lengths.tolist(), failing, strict=True):
            k = names.index(name)
            if length < result.min():
                first = Failure(finger, how, view.label)
            result[k] = min(result[k], length)
    return result, first


def least(found: Iterable[tuple[View, Worst]]) -> Found:
    """The least measure of all, and what fails there."""
    best: Found = (inf, None)
    for view, worst in found:
        i = worst.first
        if worst.factors[i] < best[0]:
            best = float(worst.factors[i]), Failure(view.grasp.names[i], worst.hows[i], view.label)
    return best


def _segment(load: Wrench) -> LoadSet:
    none = Wrench.from_vector(np.zeros_like(load.vector))
    return LoadSet.hull([none, load], center=none)


def _off_centre(load: Wrench) -> LoadSet:
    """The torques of a load that acts up to a unit of length away, across its force."""
    across = tangents_of((load.force / np.linalg.norm(load.force))[None])[0]
    axes = np.zeros((load.vector.size, len(across)))
    axes[load.dimension :] = torque(across, load.force).T
    return LoadSet.ellipsoid(Wrench.from_vector(np.zeros_like(load.vector)), axes)
