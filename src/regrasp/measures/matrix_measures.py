"""Measures from the grasp matrix alone: singular values of what the contacts can transmit."""

from collections.abc import Iterator

import numpy as np

from regrasp.measures.measure import BY_LENGTH, ROA, Measure
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp

_UNIT = "none: torques divided by length"


def transmitted(grasp: Grasp, length: float) -> Array:
    """(3 or 6, k) G of unit components that contacts transmit, torques divided by ``length``.

    The normal alone without friction; every component of the force with it; of soft fingers also the torque
    about the normal, divided by ``length``, too.
    """
    columns = []
    for i, contact in enumerate(grasp):
        block = grasp.matrix[:, grasp.width * i : grasp.width * (i + 1)]
        d = grasp.dimension
        if contact.friction == 0:
            columns.append(block[:, :d] @ contact.normal[:, None])
            continue
        columns.append(block[:, :d])
        if contact.torsion is not None:
            columns.append(length * block[:, d:])
    weight = np.where(np.arange(len(grasp.matrix)) < grasp.dimension, 1.0, 1.0 / length)
    result: Array = np.hstack(columns) * weight[:, None]
    return result


def singular_values(matrix: Array) -> Array:
    """(m,) of m rows, from the largest on, zeros where the rank is less."""
    values = np.zeros(len(matrix))
    found = np.linalg.svd(matrix, compute_uv=False)[: len(matrix)]
    values[: len(found)] = np.where(found > 1e-12 * found[0], found, 0.0)
    return values


def matrix_measures(grasp: Grasp, length: float) -> Iterator[Measure]:
    """Of the grasp matrix."""
    s = singular_values(transmitted(grasp, length))
    li = f"{ROA}; Li and Sastry 1988"
    yield Measure("least_singular_value", float(s[-1]), "-", "[0, inf)", True, "sigma_min(G)", li, _UNIT)
    yield Measure(
        "ellipsoid_volume",
        float(s.prod()),
        "-",
        "[0, inf)",
        True,
        "sqrt det(G G') = prod sigma_i",
        li,
        _UNIT,
        origin=BY_LENGTH,
    )
    yield Measure(
        "isotropy",
        float(s[-1] / s[0]),
        "-",
        "[0, 1]",
        True,
        "sigma_min(G) / sigma_max(G)",
        f"{ROA}; Kim, Oh and Yi 2001",
        _UNIT,
    )


def hand_measures(grasp: Grasp, length: float, jacobians: list[Array]) -> Iterator[Measure]:
    """Of the hand-object Jacobian H: twist (v, length omega) = H q', least squares where fingers slip.

    jacobians: per finger (d, q_i), speeds of its tip per joint speed, in the object's frame.
    """
    d = grasp.dimension
    weight = np.where(np.arange(len(grasp.matrix)) < d, 1.0, 1.0 / length)
    point = np.hstack([grasp.matrix[:, grasp.width * i : grasp.width * i + d] for i in range(len(grasp))])
    joints = np.zeros((d * len(grasp), sum(j.shape[1] for j in jacobians)))
    column = 0
    for i, jacobian in enumerate(jacobians):
        joints[d * i : d * (i + 1), column : column + jacobian.shape[1]] = jacobian
        column += jacobian.shape[1]
    hand: Array = np.asarray(np.linalg.pinv((point * weight[:, None]).T) @ joints, dtype=np.float64)
    s = singular_values(hand)
    unit, power = "of the jacobians", f"jacobian^{len(s)}"
    yield Measure(
        "hand_least_singular_value",
        float(s[-1]),
        "jacobian",
        "[0, inf)",
        True,
        "sigma_min(H)",
        ROA,
        unit,
    )
    yield Measure(
        "hand_volume",
        float(s.prod()),
        power,
        "[0, inf)",
        True,
        "prod sigma_i(H)",
        ROA,
        unit,
    )
    yield Measure(
        "hand_isotropy", float(s[-1] / (s[0] or 1.0)), "-", "[0, 1]", True, "sigma_min(H) / sigma_max(H)",
        f"{ROA}; Salisbury and Craig 1982", "none",
    )  # fmt: skip
