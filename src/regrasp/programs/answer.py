"""What a solver answers to one program, in the words every solver shares. Not yet believed."""

from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from regrasp.errors import shown
from regrasp.programs.blocks import Array


class Claim(Enum):
    """What a solver says of a program; the value is the word for it in rows and for outside solvers."""

    FOUND = "found"
    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    FAILED = "failed"
    REFUSED = "refused"


@dataclass(frozen=True, eq=False)
class Answer:
    """A solver's answer, not yet believed.

    status: a word of ``Claim``; ``refused`` for a program of a kind that the solver does not take. x: (n,),
    or None. duals: (m,) z with P x + q + A'z = 0 and z in K*; for ``infeasible`` the certificate, A'z = 0 and
    b'z < 0; None where the solver gives none. iterations: as it counts. said: its own words.
    build_time, setup_time, solve_time: [s] what the call spends on bringing the data into another form, on
    set-up (scaling, factorisation) and on iterations; None where there is no such part or it cannot be told
    apart.
    """

    status: str
    x: Array | None = None
    duals: Array | None = None
    iterations: int | None = None
    said: str = ""
    build_time: float | None = None
    setup_time: float | None = None
    solve_time: float | None = None


def given_numbers(values: Any, size: int) -> Array:
    """(size,) numbers of a solver's, copied, NaN for None. Raises ``ValueError`` where they are none."""
    if values is None:
        return np.full(size, np.nan)
    given = np.asarray(values)
    if given.dtype.kind not in "fiu" or given.shape != (size,):
        raise ValueError(f"{size} numbers were to come, got {shown(values)}")
    return np.array(given, dtype=float)
