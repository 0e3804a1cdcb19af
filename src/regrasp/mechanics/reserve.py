"""What planning keeps back, so that rounding never carries a planned force over a limit.

A plan is judged with the full friction and the full force limits, in exact arithmetic and with zero
tolerance; it is made with a little less of both.
"""

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import number

RESERVE = 1e-9
"""Default fraction of every friction coefficient kept back."""

NEGLIGIBLE = 1e-9
"""Friction up to this counts as none in planning: it takes normal forces 1e9 times what it gives."""

# Doubles place the direction of a computed force to a few units of 2^-52 [rad]; keep at least this much.
_DIRECTION = 2.0**-44


def reserve_fraction(value: float) -> float:
    """A checked ``reserve``: a fraction, 0 <= reserve < 1."""
    fraction = number(value, "reserve", least=0)
    if fraction >= 1:
        raise InvalidInput(f"reserve must be less than 1, a fraction of the friction, got {shown(value)}")
    return fraction


def kept_friction(friction: float, reserve: float) -> float:
    """The friction coefficient planning may use: ``friction`` less the reserve; zero if ``NEGLIGIBLE``."""
    if reserve == 0:
        return friction
    if friction <= NEGLIGIBLE:
        return 0.0
    return max(friction - max(reserve * friction, _DIRECTION), 0.0)


def kept_force(limit: float, reserve: float) -> float:
    """The force planning may use under a ``limit``: a last 2^-40 of it is kept back."""
    return limit if reserve == 0 else limit * (1 - 2.0**-40)
