"""Widest least arcs around random grasps on random polygons: how wide, and how near the proven bound is.

    python benchmarks/placing/regions/widest_arcs.py [--count 12] [--seed 7]

Polygons of four to eight vertices, two or three fingers at random places that hold one to five random loads.
Each row has the least arc of regions that are wide together, the widest found, the gap of the bound, seconds
of processor time, and whether all of it verifies.
"""

import argparse
from time import process_time

import numpy as np

import regrasp as rg


def task(rng: np.random.Generator) -> tuple[rg.Outline, rg.Grasp, rg.Wrench | rg.LoadSet] | None:
    """A random polygon with a random grasp that holds random loads; None where none was found."""
    count = rng.integers(4, 9)
    angles, radii = np.sort(rng.uniform(0, 2 * np.pi, count)), rng.uniform(0.6, 1.4, count)
    try:
        shape = rg.Outline(radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1))
    except rg.InvalidInput:
        return None
    fingers, friction = int(rng.integers(2, 4)), float(rng.uniform(0.3, 0.8))
    loads = [rg.Wrench(rng.normal(size=2), 0.2 * rng.normal()) for _ in range(rng.integers(1, 6))]
    load = loads[0] if len(loads) == 1 else rg.LoadSet.hull(loads)
    for _ in range(60):
        places = rng.uniform(0, shape.length, fingers)
        try:
            grasp = rg.Grasp(shape.contact_at(s, friction=friction) for s in places)
            rg.contact_regions(shape, grasp, load)
        except rg.RegraspError:
            continue
        return shape, grasp, load
    return None


def main() -> None:
    """One row for each task, then how many gaps are within 1 %."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--seed", type=int, default=7)
    given = parser.parse_args()
    rng, gaps = np.random.default_rng(given.seed), list[float]()
    while len(gaps) < given.count:
        if (found := task(rng)) is None:
            continue
        shape, grasp, load = found
        together = rg.contact_regions(shape, grasp, load).widths.min()
        start = process_time()
        try:
            regions = rg.contact_regions(shape, grasp, load, widest="least")
        except rg.Infeasible as error:
            print(f"{len(grasp)} fingers: refused: {error}", flush=True)
            continue
        took = process_time() - start
        if regions.widest is None:
            print(f"{len(grasp)} fingers: past vertices, where no bound is proven", flush=True)
            continue
        least = regions.widths.min()
        gaps.append(regions.widest.bound / least - 1)
        print(
            f"{len(grasp)} fingers: together {together:.4f}, least {least:.4f}, gap {gaps[-1]:.1e}, "
            f"{len(regions.widest.at)} boxes, {took:.1f} s, verified {rg.verify(regions).ok}",
            flush=True,
        )
    print(f"{sum(gap < 0.0102 for gap in gaps)} of {len(gaps)} within 1 %, the largest {max(gaps):.2g}")


if __name__ == "__main__":
    main()
