"""Where a finger finds no way."""

from dataclasses import dataclass

from regrasp.mechanics.checks import Array
from regrasp.mechanics.value import ArrayValue


@dataclass(frozen=True, eq=False)
class ShutIn(ArrayValue):
    """A finger without a way, as ``certificate`` of ``Infeasible`` has it.

    step: before, or during which; the number of steps for what follows the last. finger: its number. Both are
    -1 where no finger of this kind gets away.
    place: the contact at which it is shut in. position: (d,) of it [m].
    origin, target: contacts between which it was to go. held: contacts of the fingers that hold meanwhile.
    other: (d,) the place of the finger that it is in, where two are in one another during a step [m].
    alone: whether the finger is shut in there by the object alone, whatever the others do.
    near: the contact of one that holds too near for any finger to come to ``place`` or leave it; or None.
    """

    step: int
    finger: int
    place: str
    position: Array
    origin: str
    target: str
    held: tuple[str, ...]
    alone: bool
    other: Array | None = None
    near: str | None = None
