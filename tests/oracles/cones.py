"""Cones in plain NumPy: distances to those of a program, forces and wrenches in those of planar contacts."""

import numpy as np

import regrasp as rg
from regrasp.programs import Cone, Program


def slack(program: Program, x: np.ndarray) -> np.ndarray:
    """s = b - A x, (m,)."""
    return program.b - program.A @ x


def distance_to_cones(program: Program, s: np.ndarray, *, dual: bool = False) -> float:
    """Largest violation of a cone by s (m,), or of a dual cone; zero inside.

    Non-negative and second-order cones are their own duals; the zero cone's is everything.
    """
    worst = 0.0
    for block, rows in program.slices:
        part = s[rows]
        if block.cone is Cone.NONNEGATIVE:
            worst = max(worst, float((-part).max(initial=0.0)))
        elif block.cone is Cone.SECOND_ORDER:
            each = part.reshape(block.count, block.size)
            worst = max(worst, float((np.linalg.norm(each[:, 1:], axis=1) - each[:, 0]).max(initial=0.0)))
        elif not dual:
            worst = max(worst, float(abs(part).max(initial=0.0)))
    return worst


def in_cone(contact: rg.Contact, share: float, size: float = 1.0) -> np.ndarray:
    """The force whose tangential part is ``share`` of the friction available; within the cone up to +-1."""
    n = contact.normal
    return size * (n + share * contact.friction * np.array([-n[1], n[0]]))


def wrench(contact: rg.Contact, f: np.ndarray) -> np.ndarray:
    """(f, r x f), by hand."""
    x, y = contact.position
    return np.array([f[0], f[1], x * f[1] - y * f[0]])


def edges(grasp: rg.Grasp) -> np.ndarray:
    """(3, 2n) wrenches of unit normal force along both edges of each planar cone."""
    columns = []
    for c in grasp:
        t = np.array([-c.normal[1], c.normal[0]])
        for f in (c.normal - c.friction * t, c.normal + c.friction * t):
            columns.append([*f, c.position[0] * f[1] - c.position[1] * f[0]])
    return np.array(columns).T
