"""A load that stays in the world, seen from a turning object, in rational arithmetic."""

from fractions import Fraction
from functools import cache

from regrasp.mechanics.checks import Array
from regrasp.mechanics.wrench import Wrench
from regrasp.verification.exact import RESOLUTION, Vector, cross, dot, exact

_TERMS = 40
_BITS, _KEPT = 160, 120  # of fractions in the series, and of what comes of it


def _arctan(inverse: int) -> Fraction:
    """Of 1 / inverse, to 2^-170, by its series."""
    return sum(
        (Fraction((-1) ** k, (2 * k + 1) * inverse ** (2 * k + 1)) for k in range(40)), start=Fraction(0)
    )


@cache
def _turn() -> int:
    """2 pi in units of 2^-160, by Machin's formula; worked out when first asked for, not at the start."""
    circle: int = round(2 * (16 * _arctan(5) - 4 * _arctan(239)) * 2**_BITS)
    return circle


class TurningLoad:
    """The load at angles of the object: it turns the other way about ``axis``, (3,) or None in the plane.

    Written w = s + cos(angle) p + sin(angle) q: a still part s, and a part that turns. ``arm2`` is the square
    of the length that makes torques forces [m^2].
    """

    def __init__(self, load: Wrench, axis: Array | None, arm2: Fraction) -> None:
        self.load, self._arm2 = load, arm2
        force, torque = exact(load.force.tolist()), exact(load.torque.tolist())
        zero = Fraction(0)
        if axis is None:
            fx, fy = force
            turned = ([zero, zero], [fx, fy], [fy, -fx])
            self._parts = [turned, (torque, [zero], [zero])]  # a torque of the plane stays
        else:
            k = exact(axis.tolist())
            self._parts = [_spun(force, k), _spun(torque, k)]

    @property
    def turns_whole(self) -> bool:
        """Whether nothing of force and torque stays still, but for rounding of the axis.

        Each in its own unit: a torque over the largest distance of a contact from the centre of mass.
        """
        (force, along, _), (torque, about, _) = self._parts
        scale2 = max(dot(along, along), dot(about, about) / self._arm2)
        return max(dot(force, force), dot(torque, torque) / self._arm2) <= RESOLUTION**2 * scale2

    def at(self, angle: Fraction) -> Vector:
        """The load seen from the object turned by ``angle`` [rad], (3,) or (6,)."""
        return self._exact(angle, Fraction(1))

    def between(self, first: Fraction, second: Fraction) -> Vector:
        """The load where the tangents at two angles meet, (3,) or (6,)."""
        stretch, _ = cosine_sine((second - first) / 2)
        return self._exact((first + second) / 2, 1 / stretch)

    def differs(self, load: Wrench, angle: Fraction) -> bool:
        """Whether a load is not this one seen from ``angle``, beyond the resolution."""
        d = self.load.dimension
        given, seen = exact(load.vector.tolist()), self._exact(angle, Fraction(1))
        for part in (slice(0, d), slice(d, None)):
            off = [a - b for a, b in zip(given[part], seen[part], strict=True)]
            if dot(off, off) > RESOLUTION**2 * dot(seen[part], seen[part]):
                return True
        return False

    def _exact(self, angle: Fraction, stretch: Fraction) -> Vector:
        c, s = cosine_sine(angle)
        return [
            still + stretch * (c * along + s * across)
            for part in self._parts
            for still, along, across in zip(*part, strict=True)
        ]


def _spun(vector: Vector, axis: Vector) -> tuple[Vector, Vector, Vector]:
    """Rodrigues' formula for minus the angle: k (k.v) + cos (v - k (k.v)) - sin k x v."""
    along = dot(axis, vector)
    still = [along * k for k in axis]
    return still, [v - s for v, s in zip(vector, still, strict=True)], [-x for x in cross(axis, vector)]


def cosine_sine(angle: Fraction) -> tuple[Fraction, Fraction]:
    """Cosine and sine by Taylor's series, to 2^-80, as fractions of 2^-120; of angles up to 1e12 rad.

    In whole numbers of 2^-160: fractions look for common divisors at every step, for thirty times the time.
    """
    units = round(abs(angle) * 2**_BITS)
    units -= _turn() * ((units + _turn() // 2) // _turn())
    sixteenth = units >> 4  # then doubled four times
    cosine, sine, term = 0, 0, 1 << _BITS
    for n in range(_TERMS):
        if n % 2:
            sine += term * (-1) ** (n // 2)
        else:
            cosine += term * (-1) ** (n // 2)
        term = term * sixteenth // (n + 1) >> _BITS
    for _ in range(4):
        cosine, sine = (cosine * cosine - sine * sine) >> _BITS, 2 * cosine * sine >> _BITS
    kept = [Fraction(value >> (_BITS - _KEPT), 2**_KEPT) for value in (cosine, sine)]
    return kept[0], kept[1] if angle >= 0 else -kept[1]
