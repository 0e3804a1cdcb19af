"""A dozen plans to be carried out in physics: plane and space, every kind of change."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import regrasp as rg
from regrasp.mesh import parts

CM = 0.01
LOAD = rg.Wrench([-1.5, -3.5])
START = [[3.7897, 3.0034], [-3.0096, 4.4156], [0.7199, -3.9190]]
TIPS = ((0.02, 0.02, -0.0105), (-0.0156, 0.02, 0.015), (-0.005, -0.02, -0.0105), (-0.0156, -0.02, 0.02))


def paper(friction: float = 0.3) -> rg.Grasp:
    """The paper's example, in metres."""
    places = (([-4, -4], [1, 1]), ([4, -5], [-1, 2]), ([0, 8], [0, -1]))
    return rg.Grasp(
        rg.Contact(np.array(p) * CM, normal=n, friction=friction, name=f"P{i}")
        for i, (p, n) in enumerate(places, 1)
    )


def removal() -> rg.Transition:
    return rg.plan_removal(rg.GraspState(paper(), LOAD, START), "P3")


@cache
def bracket() -> tuple[rg.Mesh, rg.Grasp]:
    solid = parts.bracket()
    return solid, rg.Grasp(solid.contact_at(solid.centre_of_mass + tip, friction=0.8) for tip in TIPS)


def lifted() -> rg.Transition:
    return rg.plan_removal(bracket()[1], "P4", load=rg.Wrench([0, 0, -1.82]), objective="force")


def tipped() -> rg.Transition:
    return rg.plan_rotation(lifted().end.without("P4"), np.radians(30), axis=[1, 1, 0])


def ellipse(*places: float) -> rg.Grasp:
    outline = rg.Outline.ellipse(0.04, 0.02)
    return rg.Grasp(outline.contact_at(p * outline.length, friction=0.5) for p in places)


def swung(t: float) -> rg.Wrench:
    return rg.Wrench([-1.5 - 0.5 * t, -3.5 + 0.3 * np.sin(2 * np.pi * t)])


def exchange() -> rg.Transition:
    four = rg.Grasp([*paper(0.4), rg.Contact([-0.01, 0.08], [0.2, -1], 0.4, name="P4")])
    held = rg.choose_state(paper(0.4), LOAD, "force")
    return rg.plan_exchange(held, "P3", four["P4"])


def turned() -> rg.Transition:
    outline = rg.Outline.ellipse(0.04, 0.02)
    two = rg.Grasp(outline.contact_at(p * outline.length, friction=0.8) for p in (0.0, 0.5))
    return rg.plan_rotation(rg.choose_state(two, rg.Wrench([0, -2.0]), "force"), np.radians(40))


def squeezed(objective: str, seed: int) -> rg.Transition:
    """A removal from a random triangle of fingers around the object."""
    rng = np.random.default_rng(seed)
    angles = np.array([0.3, 2.6, 4.5]) + rng.uniform(-0.3, 0.3, 3)
    points = 0.05 * np.column_stack([np.cos(angles), np.sin(angles)])
    normals = -points / 0.05 + 0.15 * rng.normal(size=points.shape)
    grasp = rg.Grasp(rg.Contact(p, n, 0.6) for p, n in zip(points, normals, strict=True))
    start = rg.choose_state(grasp, rg.Wrench([0, -1.2]), objective)
    return rg.plan_removal(start, "P3", objective=objective)


PLANS: dict[str, Callable[[], Any]] = {
    "removal of the paper": removal,
    "removal, start chosen": lambda: rg.plan_removal(paper(), "P3", load=LOAD, objective="force"),
    "removal for effort": lambda: rg.plan_removal(
        rg.GraspState(paper(), LOAD, START), "P3", objective="effort"
    ),
    "addition": lambda: removal().reversed(),
    "exchange": exchange,
    "load that varies": lambda: rg.plan_removal(paper(), "P3", load=swung, objective="effort"),
    "turn": turned,
    "triangle, effort": lambda: squeezed("effort", 1),
    "triangle, angle": lambda: squeezed("angle", 2),
    "triangle, peak": lambda: squeezed("peak", 1),
    "solid, removal": lifted,
    "solid, turn": tipped,
}
