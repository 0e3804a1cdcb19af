"""Forces of fingers at all corners of polygons, one corner for each finger, under several loads."""

from typing import Any

from regrasp.closed_form.compiled.compiling import digest
from regrasp.closed_form.compiled.patches import patch_gauge, patch_search, patch_support
from regrasp.closed_form.compiled.patches.patch_gauge import gauge
from regrasp.closed_form.compiled.places import placement_search
from regrasp.compilation import kept


def _loop(digest: str) -> Any:
    @kept("regions of fingers on surfaces", error_model="numpy", _nrt=False)
    def corner_forces(  # type: ignore[no-untyped-def]
        points, normals, corners, start, loads, law, limit, forces, spots, spare
    ):
        """A corner at which a load needs more than ``limit``, -1 for none; ``start`` is looked at first.

        points: (k, m, 3). normals: (k, 3). corners: (c, k) a point for each finger. loads:
        (s, 6) wrenches to make. forces: (c, s, k, 3) become those found.
        """
        _ = digest
        mu, size, norm, precision = law
        each, work, alone = spare[3], spare[8], (spots, *spare[9:])
        best, inverse, x, exact, shares, pushes = work[16], work[6], work[7], work[9], work[11], work[12]
        k = len(points)
        for number in range(len(corners)):
            corner = start if number == 0 else (number - 1 if number <= start else number)
            for i in range(k):
                for c in range(3):
                    spots[i, c] = points[i, corners[corner, i], c]
                    spots[i, 3 + c] = normals[i, c]
            for load in range(len(loads)):
                w = loads[load]
                found = gauge(
                    alone, each, w, mu, size, norm, limit, -1.0, precision, best, work[:16], load > 0
                )
                if found >= limit:
                    return corner
                untilted = True
                for r in range(6):
                    exact[r] = 0.0
                    for c in range(6):
                        exact[r] += inverse[r, c] * w[c]
                    untilted = untilted and exact[r] >= 0.0
                for i in range(k):
                    for c in range(3):
                        total = 0.0
                        for r in range(6):
                            total += (exact[r] if untilted else x[r]) * shares[r, i] * pushes[r, i, c]
                        forces[corner, load, i, c] = total
        return -1

    return corner_forces


# Numba's cache watches this file only; the digest in the loop's closure makes it watch these, too.
corner_forces = _loop(digest((patch_gauge, patch_search, patch_support, placement_search)))
