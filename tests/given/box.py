"""A box held by four fingers, and where they are to go."""

import numpy as np

import regrasp as rg
from regrasp.mesh import Mesh

WEIGHT = rg.Wrench([0, 0, -1.0])
BOX = Mesh.box(0.06, 0.04, 0.05)
MU = 0.6


def on_box(*points):
    return rg.Grasp(BOX.contact_at(np.array(p) + BOX.centre_of_mass, friction=MU) for p in points)


START = on_box((0.03, 0.004, 0.003), (-0.03, 0.003, -0.004), (0.004, 0.02, 0.002), (0.003, -0.02, 0.004))
GOAL = on_box((0.03, 0.006, -0.005), (-0.03, -0.006, 0.004), (0.01, -0.004, 0.025), (0.003, 0.004, -0.025))
