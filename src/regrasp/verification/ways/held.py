"""What ways and their set-points have in common: moves that velocities say, fingers at contacts."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array

Bools = NDArray[np.bool_]


def jumps(times: Array, positions: Array, velocities: Array, near: float) -> Iterator[str]:
    """Where positions are not what velocities say: between rows a velocity is one between those at both."""
    passed = np.diff(times)[:, None]
    said = (velocities[1:] + velocities[:-1]) / 2 * passed[..., None]
    off = np.linalg.norm(np.diff(positions, axis=0) - said, axis=2)
    change = np.linalg.norm(np.diff(velocities, axis=0), axis=2)
    around = np.maximum(change, np.maximum(np.roll(change, 1, axis=0), np.roll(change, -1, axis=0)))
    bad = ~(off <= passed * around + near)  # which no number fails, too
    if bad.any():
        k, i = np.argwhere(bad)[0]
        yield f"finger {i + 1} moves otherwise than its velocity says at {times[k]:.6g} s"


def contacts_of(steps: Sequence[Any]) -> dict[str, Any]:
    """The contacts of all steps by their names."""
    return {str(c.name): c for step in steps for c in step.grasp}


def touched(
    steps: Sequence[Any], positions: Array, touching: Bools, radius: float, near: float
) -> dict[str, Bools]:
    """(m, k) by the name of a contact: which finger touches there."""
    on = {}
    for name, contact in contacts_of(steps).items():
        off = positions - (contact.position - radius * contact.normal)
        on[name] = touching & (np.linalg.norm(off, axis=2) <= near)
    return on


def lost(
    times: Array,
    steps: Sequence[Any],
    during: Sequence[Any],
    touching: Bools,
    on: dict[str, Bools],
    least: int,
) -> Iterator[str]:
    """Fingers that touch off contacts, contacts without a finger ``during`` their step, too few that touch.

    least: how many have to, where steps have as many contacts.
    """
    stray = touching & ~np.logical_or.reduce(list(on.values()))
    if stray.any():
        k, i = np.argwhere(stray)[0]
        yield f"finger {i + 1} is said to touch off every contact at {times[k]:.6g} s"
    for k, (step, rows) in enumerate(zip(steps, during, strict=True)):
        for name in step.grasp.names:
            if not on[str(name)][rows].any(axis=1).all():
                yield f"during step {k + 1} no finger is at {name}"
    least = min(least, *(len(step.grasp) for step in steps))
    few = touching.sum(axis=1) < least
    if few.any():
        yield f"fewer than {least} fingers touch at {times[few.argmax()]:.6g} s"
