"""A hundred regrasps with ways, judged by the checker that shares no code with what plans them.

    python benchmarks/execution/motions.py

Sixty in the plane around four outlines, three fingers, and forty in space around four solids, four fingers;
every finger goes from a random place to another, one after the other. Ways depend on places only, so no
forces are planned. Sequences with a finger shut in are counted and left out.
"""

import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

import regrasp as rg
from finger_moves import moved
from regrasp.mesh import parts as solids
from regrasp.motions import plan_motions
from regrasp.outline import parts
from regrasp.verification import verify_motions

RESULTS = Path(__file__).parents[1] / "results" / "motions.json"
RADIUS, CLEARANCE = 0.003, 0.002
PLANE, SPACE = 60, 40
STAR = [[(0.05 if k % 2 else 0.028) * f(np.pi * k / 5) for f in (np.cos, np.sin)] for k in range(10)]
OUTLINES: dict[str, Callable[[], rg.Outline]] = {
    "ellipse": lambda: rg.Outline.ellipse(0.04, 0.02),
    "star": lambda: rg.Outline(STAR),
    "hook": lambda: rg.Outline([[0, 0], [0.09, 0], [0.09, 0.02], [0.02, 0.02], [0.02, 0.07], [0, 0.07]]),
    "bracket": parts.bracket,
}
SOLIDS: dict[str, Callable[[], rg.Mesh]] = {
    "box": lambda: rg.Mesh.box(0.08, 0.05, 0.03),
    "cylinder": lambda: rg.Mesh.cylinder(0.03, 0.06, segments=24),
    "ball": lambda: rg.Mesh.sphere(0.03, divisions=4),
    "bracket": solids.bracket,
}


def contacts(shape: rg.Outline | rg.Mesh, seed: int) -> list[rg.Contact]:
    """Six places by chance on an outline, eight on a solid."""
    rng = np.random.default_rng(seed)
    if isinstance(shape, rg.Outline):
        places = shape.length * rng.uniform(size=6)
        return [shape.contact_at(s, friction=0.8, name=f"C{k}") for k, s in enumerate(places)]
    found = shape.contacts(8, friction=0.8, seed=seed)
    order = rng.permutation(8).tolist()
    return [rg.Contact(found[i].position, found[i].normal, 0.8, name=f"C{k}") for k, i in enumerate(order)]


def rows(shapes: dict[str, Any], count: int) -> Iterator[dict[str, Any]]:
    """A row for each regrasp with ways; seeds in which a finger is shut in come as rows without."""
    for name, made in shapes.items():
        shape, seed, done = made(), 0, 0
        while done < count // len(shapes):
            began = process_time()
            row: dict[str, Any] = {"shape": name, "space": isinstance(shape, rg.Mesh), "seed": seed}
            seed += 1
            try:
                plan = moved(contacts(shape, row["seed"]))
                motions = plan_motions(plan, shape, tip_radius=RADIUS, clearance=CLEARANCE)
            except (rg.Infeasible, rg.InvalidInput) as error:
                yield row | {"shut in": str(error), "seconds": process_time() - began}
                continue
            planned = process_time() - began
            verdict = verify_motions(motions, shape)
            done += 1
            yield row | {
                "ways": len(motions.motions),
                "seconds": planned,
                "violations": list(verdict.violations),
                "to object": verdict.to_object,
                "to fingers": verdict.to_fingers,
                "touching": verdict.touching,
                "instants": verdict.samples,
            }


def main() -> None:
    found = []
    for row in (*rows(OUTLINES, PLANE), *rows(SOLIDS, SPACE)):
        found.append(row)
    RESULTS.write_text(
        json.dumps({"python": sys.version.split()[0], "rows": found}, indent=1) + "\n", encoding="utf-8"
    )
    for space in (False, True):
        done = [r for r in found if r["space"] == space and "ways" in r]
        ways, bad = sum(r["ways"] for r in done), sum(bool(r["violations"]) for r in done)
        to_object, to_fingers = (1e3 * min(r[key] for r in done) for key in ("to object", "to fingers"))
        shut = sum("shut in" in r for r in found if r["space"] == space)
        print(
            f"{'space' if space else 'plane'}: {len(done)} regrasps, {ways} ways, {bad} with violations; "
            f"least gap to the object {to_object:.3f} mm, to fingers {to_fingers:.3f} mm, asked for "
            f"{1e3 * CLEARANCE:g} mm; {sum(r['seconds'] for r in done) / ways:.2f} s of processor a way; "
            f"{shut} sequences with a finger shut in"
        )


if __name__ == "__main__":
    main()
