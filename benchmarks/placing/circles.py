"""Fingers on a circle under loads of every orientation, and on an ellipse that is nearly one.

python benchmarks/placing/circles.py [--nearly]
"""

import sys
from time import process_time

import regrasp as rg

LOAD = rg.LoadSet.turned(rg.Wrench([0.0, -1.0]))


def main(nearly: bool) -> None:
    """Print a line for each objective and number of fingers: gap, boxes, times to search and verify [s]."""
    shape = rg.Outline.ellipse(1.0, 1.01 if nearly else 1.0)
    rg.choose_grasp(shape, 2, rg.Wrench([0.0, -1.0]), friction=0.5)  # compiles
    for objective in ("sum_normal", "peak_normal", "peak", "effort"):
        for fingers in (2,) if nearly else (2, 3, 4):
            begin = process_time()
            chosen = rg.choose_grasp(shape, fingers, LOAD, friction=0.5, objective=objective)
            found = process_time()
            good = rg.verify(chosen).ok
            print(
                f"| {objective}, {fingers} | {chosen.gap:.1e} | {len(chosen.certificate.children):,} | "
                f"{found - begin:.2f} | {'yes' if good else 'NO'}, {process_time() - found:.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main("--nearly" in sys.argv)
