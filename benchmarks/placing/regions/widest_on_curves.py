"""Least arcs and products of arcs on smooth outlines, against those of regions that are wide together.

    python benchmarks/placing/regions/widest_on_curves.py [--count 6] [--seed 3]

Splines through six to nine points and random ellipses, two or three fingers, chosen for two random loads.
Each row has the least arc and the product by the search, as multiples of what is wide together, seconds of
processor time, and whether regions verify. The last figure is the half width on the polygon that a drawing of
the curve becomes, chords that turn by 2 degrees each at most, as a multiple of that on the curve.
"""

import argparse
from time import process_time

import numpy as np

import regrasp as rg


def task(rng: np.random.Generator) -> tuple[rg.Outline, rg.Grasp, rg.LoadSet] | None:
    """A random smooth outline with a chosen grasp; None where there is none."""
    count, fingers = int(rng.integers(6, 10)), int(rng.integers(2, 4))
    angles = 2 * np.pi * (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count
    radii = rng.uniform(0.7, 1.3, count) if rng.uniform() < 0.6 else np.ones(count)
    points = radii[:, None] * np.stack([rng.uniform(1, 2) * np.cos(angles), np.sin(angles)], axis=1)
    loads = rg.LoadSet.hull([rg.Wrench(rng.normal(size=2), 0.1 * rng.normal()) for _ in range(2)])
    try:
        shape = rg.Outline.smooth(points)
        chosen = rg.choose_grasp(shape, fingers, loads, friction=0.6, objective="peak", tolerance=0.05)
        rg.contact_regions(shape, chosen.grasp, loads)
    except rg.RegraspError:
        return None
    return shape, chosen.grasp, loads


def drawn(shape: rg.Outline) -> rg.Outline:
    """Its polygon."""
    tolerance = 1e-3 * shape.length
    while True:
        corners = shape.polygon(tolerance)
        sides = np.roll(corners, -1, axis=0) - corners
        turned = np.angle(np.roll(sides @ [1, 1j], -1) / (sides @ [1, 1j]))
        if np.abs(turned).max() <= np.radians(2):
            return rg.Outline(corners)
        tolerance /= 2


def on_chords(shape: rg.Outline, grasp: rg.Grasp, loads: rg.LoadSet) -> rg.ContactRegions:
    """Regions of the nearest grasp on the polygon, about whose own centre of mass loads are."""
    chords = drawn(shape)
    near = [chords.nearest(c.position + chords.centre_of_mass) for c in grasp]
    held = rg.Grasp(chords.contact_at(s, friction=0.6) for s in near)
    return rg.contact_regions(chords, held, loads)


def main() -> None:
    """One row for each task."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=6)
    parser.add_argument("--seed", type=int, default=3)
    given = parser.parse_args()
    rng, done = np.random.default_rng(given.seed), 0
    while done < given.count:
        if (found := task(rng)) is None:
            continue
        done += 1
        shape, grasp, loads = found
        together = rg.contact_regions(shape, grasp, loads)
        words = []
        for widest in ("least", "product"):
            start = process_time()
            regions = rg.contact_regions(shape, grasp, loads, widest=widest)
            took = process_time() - start
            more = (
                regions.widths.min() / together.widths.min()
                if widest == "least"
                else regions.widths.prod() / together.widths.prod()
            )
            words.append(f"{widest} {more:.2f} in {took:.1f} s, verified {rg.verify(regions).ok}")
        start = process_time()
        chords = on_chords(shape, grasp, loads)
        ratio, took = chords.half_width / together.half_width, process_time() - start
        words.append(f"on chords {ratio:.3f} in {took:.1f} s, verified {rg.verify(chords).ok}")
        print(f"{len(grasp)} fingers: {'; '.join(words)}", flush=True)


if __name__ == "__main__":
    main()
