"""What compiles says so, and nothing does after ``regrasp warm-up``."""

import logging
import subprocess
import sys

import pytest

from regrasp import compilation

pytestmark = pytest.mark.contract

USES = """
import numpy as np
import regrasp as rg
n = 500
r1, r2 = np.full((n, 2), -1.0), np.full((n, 2), 1.0)
rg.best_squeezes(r1, -r1, 0.5, r2, -r2, 0.5, [0.1, -1.0], objective="force", max_force=9.0)
angles = 2 * np.pi * np.arange(16) / 16
outline = rg.Outline.smooth(np.column_stack([3 * np.cos(angles), np.sin(angles)]))
start, goal = (
    rg.Grasp(outline.contact_at(s * outline.length, friction=0.7) for s in shares)
    for shares in ((0.05, 0.4, 0.75), (0.1, 0.45, 0.8))
)
rg.plan_regrasp(outline, start, goal, rg.Wrench([0, -2.0]), friction=0.7, candidates=15, max_force=30)
square = rg.Outline([[-1, -1], [1, -1], [1, 1], [-1, 1]])
ring = rg.LoadSet.turned(rg.Wrench([0, -1.0]))
rg.choose_grasp(square, 3, ring, friction=1, objective="effort", tolerance=0.01)
rg.choose_grasp(square, 4, rg.Wrench([0, -1.0]), friction=0.5, objective="angle", max_force=5, tolerance=0.1)
rg.choose_grasp(square, 3, ring, friction=1, objective="force", max_force=9, tolerance=0.1, most_boxes=200)
box = rg.Mesh.box(0.06, 0.04, 0.05)
start, goal = (
    rg.Grasp(box.contact_at(point, friction=0.6) for point in points)
    for points in (
        ((0.03, 0.004, 0.003), (-0.03, 0.003, -0.004), (0.004, 0.02, 0.002), (0.003, -0.02, 0.004)),
        ((0.03, 0.006, -0.005), (-0.03, -0.006, 0.004), (0.01, -0.004, 0.025), (0.003, 0.004, -0.025)),
    )
)
rg.plan_regrasp(box, start, goal, rg.Wrench([0, 0, -1.0]), friction=0.6, candidates=12, orientations=70)
"""

ASKED_FOR = (
    """
import gc
from numba.core.dispatcher import Dispatcher
from regrasp.cli.warming import warm_up

def asked_for():
    every = [d for d in gc.get_objects() if isinstance(d, Dispatcher)]
    return {(d.py_func.__module__, d.py_func.__qualname__, str(s)) for d in every for s in d.signatures}

warm_up.callback()
warmed = asked_for()
assert len(warmed) > 10, warmed
"""
    f"{USES}\nprint(sorted(asked_for() - warmed))"
)

COMPILED = (
    """
from numba.core import event

class Compiled(event.Listener):
    names = []
    def on_start(self, started):
        self.names.append(started.data["dispatcher"].py_func.__qualname__)
    def on_end(self, ended):
        pass

event.register("numba:compile", Compiled())
"""
    f"{USES}\nprint(Compiled.names)"
)


def test_after_a_warm_up_nothing_compiles() -> None:
    """What is used is what a warm-up asked for, and a later process finds all of that kept."""
    for code in (ASKED_FOR, COMPILED):
        ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
        assert ran.stdout.splitlines()[-1:] == ["[]"], ran.stderr


def test_what_compiles_for_long_says_so_while_it_does_and_then_how_long(
    monkeypatch, caplog, tmp_path
) -> None:
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))  # nothing is kept of a run before
    monkeypatch.setattr(compilation, "_LONG", -1.0)  # everything takes long
    caplog.set_level(logging.INFO, "regrasp")

    def doubled(x):
        return 2 * x

    assert compilation.kept("what is twice as much")(doubled)(4) == 8
    said = [record.getMessage() for record in caplog.records]
    assert any(text.startswith("compiled what is twice as much in ") for text in said)


def test_the_search_for_places_says_what_it_is() -> None:
    from regrasp.closed_form.compiled.places.placement_search import search

    assert compilation._words[search.py_func] == "the search for places"


def test_a_single_grasp_and_a_planar_regrasp_need_no_numba() -> None:
    code = """
import sys
import regrasp as rg
grasp = rg.Grasp(rg.Contact([x, y], normal=[-x, -y], friction=0.6) for x, y in ((1, 0), (-1, 1), (-1, -1)))
for objective in ("angle", "force", "effort", "friction_use"):
    rg.choose_state(grasp, rg.Wrench([0.1, -1.0]), objective)
print(rg.verify(rg.plan_removal(grasp, 0, load=rg.Wrench([-0.4, 0.0]))).ok)
square = rg.Outline([[-1, -1], [1, -1], [1, 1], [-1, 1]])
start, goal = (
    rg.Grasp(square.contact_at(s, friction=0.9) for s in places) for places in ((1, 3, 5), (1.2, 3.2, 5.2))
)
plan = rg.plan_regrasp(square, start, goal, rg.Wrench([0, -1.0]), friction=0.9)
print(len(plan.moves), "numba" in sys.modules)
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout == "True\n3 False\n"
