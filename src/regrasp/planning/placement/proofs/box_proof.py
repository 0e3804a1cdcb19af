"""What proofs by boxes of placements have in common."""

from typing import Any

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import array
from regrasp.planning.placement.proofs.sealed import Sealed


class BoxProof(Sealed):
    """Boxes that cover all placements, halved until each has a load and a twist that bound its placements.

    Subclasses are dataclasses, of fields that plain data holds in their order.
    """

    _what = "a proof"
    bound: float
    fingers: int
    children: np.ndarray

    @property
    def leaves(self) -> int:
        """Boxes that are not split: what is excluded one by one."""
        return int((self.children[:, 1] == 0).sum())

    def __repr__(self) -> str:
        return f"{type(self).__name__}(bound {self.bound:.6g}, {self.fingers} fingers, {self.leaves} boxes)"


def integers(value: Any, what: str, shape: tuple[int | None, ...]) -> np.ndarray:
    """Whole numbers of a shape, read-only."""
    found = array(value, what, shape)
    whole_numbers = found.astype(np.int64)
    if (whole_numbers != found).any():
        raise InvalidInput(f"{what} must be whole numbers")
    whole_numbers.setflags(write=False)
    return whole_numbers
