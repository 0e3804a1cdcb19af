"""A beam on three fingers that answer by equal stiffness: what it withstands, and a proof of it by hand."""

from fractions import Fraction
from math import inf, nextafter
from types import SimpleNamespace

import numpy as np

import regrasp as rg
from proofs import planar

EIGHTH = Fraction(1, 8)
NEAR = (0, 0), -1, (0, 0, 0)

# Three frictionless fingers below a beam, near x = -1, 0 and 1, of 2 N at most. Set-points (a, b, a) hold
# 4 N. s N more add s / 3 to each, a torque s adds s / 2 to the left one and takes it from the right one: so
# 4 - 2 a + s / 3 <= 2 and a + s / 2 <= 2, which is s <= 3 / 2 (forces that may be anything: 2).
#
# Duals: z of the triple is b (x_j - x_l) upward with S = [[a, c], [c, b]], so with y = 0, (0, 1, 0) and
# (0, 2, -3), b = 1 and -1, fingers lift under the deviations
#
#     1 + x_1 - x_2, 1 + x_2 - x_0, 1 + x_0 - x_1      and      2 - 3 x_i - those of the triple.
MORE = 1.5
BEAM = [[-2, -1], [2, -1], [2, 1], [-2, 1]]
DEVIATIONS = [[0, -1, 0], [0, 0, 1]]
ROW = [0, 0, 0, 0, 1, 0, 0, 2, -3, *(0, 0, 0, 0, 1, 0), *(0, 0, 0, 0, -1, 0)]


def beam(width=EIGHTH, more=MORE, **changes):
    """Fingers within a width of their places; no two near the same place, and fewer than three do not do."""
    stretches = [(float((x + 2 - width) / 4), float((x + 2 + width) / 4)) for x in (-1, 0, 1)]
    sides = np.array([[0, lo, hi] for lo, hi in stretches])
    one, other, third = ((k, k, *stretches[k]) for k in range(3))
    rest = (1, 2, other[2], third[3])
    nodes = [
        ([(0, 2, one[2], third[3])] * 3, (1, 4), 0, (0, 0, 0)),
        ([one, one, one], *NEAR), ([one, one, rest], *NEAR), ([one, rest, rest], (5, 3), 0, (0, 0, 0)),
        ([rest, rest, rest], (8, 4), 0, (0, 0, 0)),
        ([one, other, other], *NEAR), ([one, other, third], (0, 0), -2, (0, 0, 0)),
        ([one, third, third], *NEAR),
        ([other, other, other], *NEAR), ([other, other, third], *NEAR), ([other, third, third], *NEAR),
        ([third, third, third], *NEAR),
    ]  # fmt: skip
    loads = [[0, -4, 0], *(np.array([0, -4, 0]) + more * np.array(DEVIATIONS))]
    given = {
        "size": "force", "norm": "largest", "friction": 0.0, "sides": sides, "min_distance": 0.5,
        "tied": np.array([ROW], dtype=float),
    }  # fmt: skip
    return planar(BEAM, loads, nodes, **given | changes)


def held(forces, load):
    """A state of three frictionless fingers below the beam."""
    grasp = rg.Grasp([rg.Contact([x, -1], [0, 1], 0.0) for x in (-1, 0, 1)])
    return rg.GraspState(grasp, rg.Wrench(load[:2], load[2]), [[0, f] for f in forces])


def withstood(**changes):
    """What the beam withstands, claimed by somebody else: 3 / 2, and no more than the proof's."""
    width = Fraction(1, 1024)
    more = 1.5 * (1 + 8 * float(width))
    proof = beam(width, more, bound=nextafter(2.0, inf))
    states = (
        held((1.25, 1.5, 1.25), (0, -4, 0)), held((1.75, 2, 1.75), (0, -5.5, 0)),
        held((2, 1.5, 0.5), (0, -4, 1.5)),
    )  # fmt: skip
    given = {
        "shape": rg.Outline(BEAM), "objective": "wrench", "grasp": states[0].grasp, "states": states,
        "value": 1.5, "bound": more, "places": np.array([1.0, 2.0, 3.0]), "others": (), "certificate": proof,
        "max_force": 2.0, "min_normal": 0.0, "length": None, "deviations": np.array(DEVIATIONS, dtype=float),
    }  # fmt: skip
    return SimpleNamespace(**given | changes)
