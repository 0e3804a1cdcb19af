"""What is withstood where fingers are put best: the gap of its bound, and what free answers would make of it.

python benchmarks/placing/withstood_places.py NAME FINGERS [TOLERANCE]: one outline, one line, in CPU time.
"""

import sys
from time import process_time

import regrasp as rg
from fifty_outlines import outlines

MU, LIMIT = 0.4, 3.0


def main(name: str, fingers: int, tolerance: float) -> None:
    """Print the value, both bounds, times and the verdict."""
    shape = dict(outlines())[name]
    reach = float(max(map(abs, shape.polygon().ravel())))
    pushes = [([0.3, 0.0], 0.0), ([-0.3, 0.0], 0.0), ([0.0, 0.0], 0.1 * reach), ([0.0, 0.0], -0.1 * reach)]
    deviations = rg.LoadSet.hull([rg.Wrench(f, t) for f, t in pushes])
    weight = rg.Wrench([0.0, -1.0])
    asked = {"friction": MU, "max_force": LIMIT, "disturbance": deviations, "tolerance": tolerance}
    start = process_time()
    chosen = rg.choose_grasp(shape, fingers, weight, objective="wrench", **asked)
    middle = process_time()
    answered = rg.choose_grasp(shape, fingers, weight, objective="answered", **asked)
    end = process_time()
    free = min(
        rg.largest_load(chosen.grasp, rg.Wrench(f, t), weight, max_force=LIMIT).factor for f, t in pushes
    )
    proven = rg.verify(chosen).ok
    print(
        f"| {name} | {fingers} | {chosen.value:.4f} | {chosen.bound:.4f} | {chosen.gap:.4f} | "
        f"{middle - start:.1f} s | {chosen.certificate.leaves} | {'yes' if proven else 'NO'}, "
        f"{process_time() - end:.1f} s | {answered.bound:.4f} | "
        f"{answered.bound / chosen.value - 1:.2f} | {free:.4f} |",
        flush=True,
    )


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), float(sys.argv[3]) if len(sys.argv) > 3 else 0.01)
