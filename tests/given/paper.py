"""The paper's grasp and its first state, as printed."""

import regrasp as rg

GRASP = rg.Grasp(
    [
        rg.Contact([-4, -4], normal=[1, 1], friction=0.3, name="P1"),
        rg.Contact([4, -5], normal=[-1, 2], friction=0.3, name="P2"),
        rg.Contact([0, 8], normal=[0, -1], friction=0.3, name="P3"),
    ]
)
LOAD = rg.Wrench([-1.5, -3.5])
STATE = rg.GraspState(GRASP, LOAD, [[3.7897, 3.0034], [-3.0096, 4.4156], [0.7199, -3.9190]])
