"""What is to be known of a regrasp's forces before a robot carries it out."""

from collections.abc import Iterator, Sequence

import numpy as np

from regrasp.plans.transition import Transition

LEAST_SHARE = 0.01
"""Of the load's force; a finger that pushes with less is hardly in touch."""
MOST_SHARE = 10.0
"""Of the load's force; squeezed harder, an object needs stiff fingers (docs/facts.md, 9)."""

# Forces that planning sets to the very share may be less by rounding.
_ROUNDING = 1e-9


def notes_on(steps: Sequence[Transition]) -> Iterator[str]:
    """A line for what is weak and one for what is strong; none of either where nothing is."""
    load = _load(steps)
    if not load:
        return
    if hardly_pushes(steps):
        normal, name, k = min(_pushing(steps))
        yield (
            f"{name} pushes with {normal:.2g} N in step {k}, less than {LEAST_SHARE:.0%} of the load: what "
            f"no model knows may end its contact; min_normal= asks for more, in more moves if need be"
        )
    most, name, k = max(_carried(steps))
    if most > MOST_SHARE * load:
        yield (
            f"{name} carries {most:.3g} N in step {k}, {most / load:.3g} times the load: fingers must be "
            f"stiffer than least_stiffness(plan); max_force= or peak_ratio= ask for less"
        )


def hardly_pushes(steps: Sequence[Transition]) -> bool:
    """Whether any finger that stays pushes with less than the least share of the load."""
    return min(_pushing(steps))[0] < LEAST_SHARE * _load(steps) * (1 - _ROUNDING)


def _load(steps: Sequence[Transition]) -> float:
    return float(np.linalg.norm(steps[0].start.load.force))


def _pushing(steps: Sequence[Transition]) -> Iterator[tuple[float, str, int]]:
    """Normal forces of fingers that stay [N], with their contacts and steps."""
    for k, step in enumerate(steps, 1):
        for state in (step.start, step.end):
            normal = (state.forces[:, : step.grasp.dimension] * step.grasp.normals).sum(axis=1)
            for name, value in zip(step.grasp.names, normal.tolist(), strict=True):
                if name not in (*step.leaving, *step.arriving):
                    yield value, str(name), k


def _carried(steps: Sequence[Transition]) -> Iterator[tuple[float, str, int]]:
    """Sizes of forces [N], with their contacts and steps."""
    for k, step in enumerate(steps, 1):
        for state in (step.start, step.end):
            sizes = np.linalg.norm(state.forces[:, : step.grasp.dimension], axis=1)
            for name, value in zip(step.grasp.names, sizes.tolist(), strict=True):
                yield value, str(name), k
