"""Value and bound of searches on meshes against the best of all triples of points on the faces.

    python benchmarks/placing/brute_force_space.py [--points 40] [--cap 60]

The bracket under six loads and a plain box under three, all four objectives, three fingers; a gap of 1 %
asked for, within ``--cap`` seconds of processor time, fingers at edges allowed. The points are drawn evenly
over the faces; all triples and the places chosen are judged by ``choose_states``, with round cones.
"""

import argparse
from time import perf_counter

import numpy as np

import regrasp as rg
from brute_force import ROUNDING
from on_surfaces import BOX, BRACKET, SIX, THREE, Surface
from placement_outlines import within
from sampled_places import Places, Task, all_of, norms

CASES = (("bracket, 6 loads", BRACKET, SIX, 0.6), ("box, 3 loads", BOX, THREE, 0.5))
OBJECTIVES = ("sum_normal", "peak_normal", "peak", "effort")
TOLERANCE = 0.01


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=40)
    parser.add_argument("--cap", type=float, default=60.0, help="of a search, of processor time [s]")
    given = parser.parse_args()
    print(
        "| mesh | objective | triples | best of them | value | bound | gap | refining buys [%] | again | "
        "time [s] | wrong |\n|---|---|--:|--:|--:|--:|--:|--:|--:|--:|---|"
    )
    for name, mesh, loads, friction in CASES:
        spots = Surface(mesh).random(np.random.default_rng(7), given.points)
        samples = all_of((spots[:, :3], spots[:, 3:]), 3)
        held = rg.LoadSet.hull(map(rg.Wrench.from_vector, loads))
        for objective in OBJECTIVES:
            task = Task(objective, friction, loads, np.inf)
            sampled = float(norms(samples, task).min())
            begin = perf_counter()
            chosen = rg.choose_grasp(
                mesh, 3, held, friction=friction, objective=objective, tolerance=TOLERANCE, from_corners=0.0,
                progress=within(given.cap)[1],
            )  # fmt: skip
            took = perf_counter() - begin
            there = Places(chosen.grasp.positions[None], chosen.grasp.normals[None])
            again = float(norms(there, task, whole=True)[0])
            wrong = [
                word
                for word, is_so in (
                    ("bound beaten", sampled < chosen.bound * (1 - ROUNDING)),
                    ("bound above value", chosen.bound > chosen.value),
                    ("not what it says", abs(again / chosen.value - 1) > 10 * ROUNDING),
                    ("not verified", not rg.verify(chosen).ok),
                )
                if is_so
            ]
            print(
                f"| {name} | `{objective}` | {len(samples.positions):,} | {sampled:.5f} | "
                f"{chosen.value:.5f} | {chosen.bound:.5f} | {chosen.gap:.3f} | "
                f"{100 * (sampled / chosen.value - 1):.2f} | "
                f"{again:.5f} | {took:.1f} | {', '.join(wrong)} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
