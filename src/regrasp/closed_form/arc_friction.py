"""The most friction that forces use on an arc (``turning_path``), where a part of the load does not turn.

With x = theta - delta / 2 a force is u + v cos x + w sin x, so |f_t|^2 = g and f_n^2 - (m / e)^2 = h are
trigonometric polynomials, and g / h is highest at an end or where g' h - g h' vanishes: at zeros of a
polynomial in exp(i x). Of a point contact that is 2 f_n sum_j t_j (t_j' f_n - t_j f_n'), in the plane with
one t_j: only the factors that matter are kept, for zeros that coincide, as where a force nearly vanishes, are
found badly.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_DEGREE = 4
_ROUNDING = 2.0**-42
_SAMPLES = 16  # more than 2 * 4: the transform gives the coefficients exactly


def arc_friction_angles(u: Array, v: Array, w: Array, normal: Array, torsion: float | None) -> Array:
    """Where the friction that one force uses may be highest: x (m,) in (-pi, pi].

    u, v, w: (d,), of a soft finger (4,). normal: (d,) unit. torsion: e [m]; None for a point contact.
    """
    x = 2 * np.pi * np.arange(_SAMPLES)[:, None] / _SAMPLES
    f, slope = u + v * np.cos(x) + w * np.sin(x), w * np.cos(x) - v * np.sin(x)
    d = normal.size
    n, n_slope = f[:, :d] @ normal, slope[:, :d] @ normal
    t, t_slope = f[:, :d] - n[:, None] * normal, slope[:, :d] - n_slope[:, None] * normal
    if torsion is None:
        turns = t_slope * n[:, None] - t * n_slope[:, None]
        slope_of_use = turns @ [-normal[1], normal[0]] if d == 2 else (t * turns).sum(axis=1)
    else:
        g, g_slope = (t * t).sum(axis=1), 2 * (t * t_slope).sum(axis=1)
        h = n * n - (f[:, 3] / torsion) ** 2
        h_slope = 2 * n * n_slope - 2 * f[:, 3] * slope[:, 3] / torsion**2
        slope_of_use = g_slope * h - g * h_slope
    coefficients = np.fft.fft(slope_of_use)
    largest = float(abs(coefficients).max())
    if largest == 0:
        return np.zeros(0)
    coefficients /= largest
    # Rounding in the place of a leading coefficient would spoil all zeros.
    degree = max(k for k in range(_DEGREE + 1) if abs(coefficients[k]) > _ROUNDING)
    polynomial = [coefficients[k] for k in range(degree, -degree - 1, -1)]
    return np.asarray(np.angle(np.roots(polynomial)), dtype=np.float64)


def arc_in_waves(start: Array, middle: Array, end: Array, delta: float) -> tuple[Array, Array, Array]:
    """(u, v, w) of the forces on an arc: u + v cos x + w sin x with x = theta - delta / 2."""
    half = delta / 2
    v = (middle - (start + end) / 2) * (np.cos(half) / np.sin(half) ** 2)
    return middle - v / np.cos(half), v, (end - start) / (2 * np.sin(half))
