"""Where contacts are on the sides that a proof is about, in doubles."""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.arc_lengths import lengths_to
from regrasp.verification.placed.protocol import Proof, after_each

_POINTS = 33  # of a side, from which the method of Gauss and Newton starts
_STEPS = 8


class Touching:
    """The sides of a proof, relative to the centre of mass [m]."""

    def __init__(self, proof: Proof) -> None:
        self._edges, least, most = proof.sides[:, 0].astype(int), proof.sides[:, 1], proof.sides[:, 2]
        self._lo, self._hi = least - self._edges, most - self._edges
        vertices = np.asarray(proof.vertices)
        if proof.control is None:
            ends = vertices[after_each(len(vertices), proof.rings)]
            thirds = [vertices + (ends - vertices) * k / 3 for k in range(4)]
            self._control = np.stack(thirds, axis=1)
        else:
            self._control = np.asarray(proof.control)
        self._control = self._control - proof.centre_of_mass
        self.reach = float(np.hypot(*self._control.reshape(-1, 2).T).max())

    def __contains__(self, contact: Contact) -> bool:
        """Whether a contact is on one of them, with its inward normal."""
        control = self._control[self._edges]
        t = self._nearest(control, contact.position)
        away = np.hypot(*(_at(control, t) - contact.position).T)
        tangent = _slope(control, t)
        tangent /= np.hypot(*tangent.T)[:, None]
        turned = np.hypot(contact.normal[0] + tangent[:, 1], contact.normal[1] - tangent[:, 0])
        near = away <= float(RESOLUTION) * self.reach
        return bool((near & (turned <= 4 * float(RESOLUTION))).any())

    def _nearest(self, control: Array, point: Array) -> Array:
        """(m,) the parameters of the nearest points, to all digits of a point that is on a side."""
        lo, hi = self._lo, self._hi
        grid = np.linspace(lo, hi, _POINTS)
        away = np.array([np.hypot(*(_at(control, t) - point).T) for t in grid])
        t: Array = grid[away.argmin(axis=0), np.arange(len(lo))]
        for _ in range(_STEPS):
            slope, off = _slope(control, t), _at(control, t) - point
            t = np.clip(t - (off * slope).sum(axis=1) / (slope**2).sum(axis=1), lo, hi)
        return t

    @property
    def share(self) -> float:
        """The part of the boundary that they are."""
        whole = lengths_to(self._control, np.ones(len(self._control))).sum()
        control = self._control[self._edges]
        return float((lengths_to(control, self._hi) - lengths_to(control, self._lo)).sum() / whole)


def _at(control: Array, t: Array) -> Array:
    """(m, 2) points of cubics (m, 4, 2)."""
    s, t = (1 - t)[:, None], t[:, None]
    p = np.moveaxis(control, 1, 0)
    result: Array = s**3 * p[0] + 3 * s * s * t * p[1] + 3 * s * t * t * p[2] + t**3 * p[3]
    return result


def _slope(control: Array, t: Array) -> Array:
    s, t = (1 - t)[:, None], t[:, None]
    d = 3 * np.moveaxis(np.diff(control, axis=1), 1, 0)
    result: Array = s * s * d[0] + 2 * s * t * d[1] + t * t * d[2]
    return result
