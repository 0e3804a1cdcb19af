"""Transitions to draw, in the plane and in space."""

from math import inf

import numpy as np

import regrasp as rg
from regrasp.plans.record import Record


def paper_removal(length=1.0, force=1.0):
    grasp = rg.Grasp(
        [
            rg.Contact([-4 * length, -4 * length], normal=[1, 1], friction=0.3, name="P1"),
            rg.Contact([4 * length, -5 * length], normal=[-1, 2], friction=0.3, name="P2"),
            rg.Contact([0, 8 * length], normal=[0, -1], friction=0.3, name="P3"),
        ]
    )
    forces = force * np.array([[3.7897, 3.0034], [-3.0096, 4.4156], [0.7199, -3.9190]])
    return rg.plan_removal(rg.GraspState(grasp, rg.Wrench([-1.5 * force, -3.5 * force]), forces), "P3")


def box_addition():
    """Different frictions, a load torque, and an infinite locus."""
    pair = rg.Grasp(
        [
            rg.Contact([-0.05, 0.002], [1, 0], 0.6, name="thumb"),
            rg.Contact([0.05, 0.01], [-1, 0], 0.5, name="index"),
        ]
    )
    middle = rg.Contact([0.01, -0.03], [0, 1], 0.4, name="middle")
    return rg.plan_addition(pair, middle, load=rg.Wrench([0.0, -8.0], 0.05), duration=0.4)


def five_fingers():
    angles = np.radians([10, 80, 150, 220, 300])
    grasp = rg.Grasp(
        [rg.Contact([3 * np.cos(a), 2 * np.sin(a)], [-2 * np.cos(a), -3 * np.sin(a)], 0.5) for a in angles]
    )
    return rg.plan_removal(grasp, "P2", load=rg.Wrench([1.0, -3.0], -1.5))


def unloaded():
    grasp = rg.Grasp(
        [
            rg.Contact([-1, 0], [1, 0], 0.5),
            rg.Contact([1, 0], [-1, 0], 0.5),
            rg.Contact([0, 1], [0, -1], 0.5),
        ]
    )
    return rg.plan_removal(grasp, "P3", load=rg.Wrench([0, 0]), max_force=5.0)


TRANSITIONS = {
    "paper": paper_removal,
    "tiny": lambda: paper_removal(1e-6, 1e-6),
    "huge": lambda: paper_removal(1e6, 1e6),
    "addition": box_addition,
    "five": five_fingers,
    "unloaded": unloaded,
}


def box(x, y, z):
    """(vertices, faces) of a box around the origin."""
    v = np.array([[a, b, c] for a in (-x, x) for b in (-y, y) for c in (-z, z)]) / 2
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return v, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def lifted(length=1.0, force=1.0, names=("thumb", "index", "middle", "ring")):
    """A block held by a thumb against two fingers, while a fourth leaves."""
    places = [[-0.03, 0.008, 0], [0.03, 0.012, 0.005], [0.03, -0.012, -0.004], [0, -0.02, 0.006]]
    normals = [[1, 0, 0], [-1, 0, 0], [-1, 0, 0], [0, 1, 0]]
    grasp = rg.Grasp(
        rg.Contact(length * np.array(r), n, 0.6, name=name)
        for r, n, name in zip(places, normals, names, strict=True)
    )
    load = rg.Wrench([0, 0, -5 * force], [0, 0.01 * force * length, 0])
    start = rg.GraspState(grasp, load, 8 * force * grasp.normals).balanced()
    rest = rg.GraspState(grasp.without(3), load, force * np.array([[12.0, 0, 0], [-6, 0, 0], [-6, 0, 0]]))
    end = rg.GraspState(grasp, load, np.vstack([rest.balanced().forces, np.zeros(3)]))
    return rg.Transition(start, end, rg.TimeScaling.spline(2.0), Record(1e-9), leaving=(names[3],))


def pinch(twist, load=None):
    sides = [
        rg.Contact([-0.03, 0.004, 0.01], [1, 0, 0], 0.6, name="a"),
        rg.Contact([0.03, 0, 0], [-1, 0, 0], 0.6),
    ]
    return rg.EscapeTwist(rg.Grasp(sides), load or rg.Wrench([0, 0, -5.0]), twist, (0.6, 0.6), (1.0, inf))
