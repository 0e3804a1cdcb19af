"""Fifty outlines to put fingers on: parts, letters, gears, polygons, splines, drawings, each time alike."""

from collections.abc import Iterator

import numpy as np

import regrasp as rg
from regrasp.outline import parts

# Rows of a letter from the top, # for material; cells of 1.
LETTERS = {
    "C": "### #.. #.. #.. ###",
    "E": "### #.. ##. #.. ###",
    "F": "### #.. ##. #.. #..",
    "H": "#.# #.# ### #.# #.#",
    "L": "#.. #.. #.. #.. ###",
    "S": "### #.. ### ..# ###",
    "T": "### .#. .#. .#. .#.",
    "U": "#.# #.# #.# #.# ###",
}
# Radii about the middle, at equal angles, drawn through as a spline: a leaf, a heart, a bean ...
DRAWINGS = {
    "leaf": [2.0, 1.1, 0.7, 0.6, 0.7, 0.9, 1.2, 0.9, 0.7, 0.6, 0.7, 1.1],
    "heart": [1.3, 1.5, 1.4, 0.7, 1.4, 1.5, 1.3, 1.2, 1.3, 1.7, 1.3, 1.2],
    "bean": [1.6, 1.4, 1.0, 0.6, 1.0, 1.4, 1.6, 1.4, 1.2, 1.1, 1.2, 1.4],
    "pear": [1.0, 1.0, 1.1, 1.5, 1.1, 1.0, 1.0, 1.2, 1.4, 1.4, 1.4, 1.2],
    "clover": [1.4, 0.8, 0.8, 1.4, 0.8, 0.8, 1.4, 0.8, 0.8, 1.4, 0.8, 0.8],
    "egg": [1.3, 1.2, 1.1, 1.0, 1.0, 1.1, 1.1, 1.1, 1.0, 1.0, 1.1, 1.2],
    "guitar": [1.9, 1.3, 0.8, 0.8, 1.0, 1.3, 1.5, 1.3, 1.0, 0.8, 0.8, 1.3],
    "fish": [1.8, 1.2, 0.8, 0.7, 0.6, 0.8, 1.3, 0.8, 0.6, 0.7, 0.8, 1.2],
}


def outlines() -> Iterator[tuple[str, rg.Outline]]:
    """Fifty of them with their names, none with a hole."""
    for make in (parts.wrench, parts.cam, parts.gear, parts.bracket, parts.bottle, parts.puzzle_piece):
        yield make.__name__, make()
    for name, rows in LETTERS.items():
        yield f"letter {name}", _letter(rows)
    for teeth in (6, 8, 9, 11, 12, 14, 16, 20):
        angle = np.arange(4 * teeth) * np.pi / (2 * teeth)
        yield f"gear of {teeth}", _polar(angle, np.where(np.arange(4 * teeth) % 4 < 2, 1.0, 0.8))
    for seed in range(12):
        rng = np.random.default_rng(seed)
        yield f"polygon {seed}", polygon(rng, int(rng.integers(5, 40)))
    for seed in range(8):
        rng = np.random.default_rng(100 + seed)
        count = int(rng.integers(6, 14))
        angle = (np.arange(count) + rng.uniform(-0.2, 0.2, count)) * 2 * np.pi / count
        yield f"spline {seed}", _polar(angle, rng.uniform(0.7, 1.3, count), smooth=True)
    for name, radii in DRAWINGS.items():
        yield name, _polar(np.arange(12) * np.pi / 6, np.array(radii), smooth=True)


def polygon(rng: np.random.Generator, count: int) -> rg.Outline:
    """A random one around its middle."""
    return _polar(_angles(rng, count), rng.uniform(0.6, 1.4, count))


def _polar(angle: np.ndarray, radius: np.ndarray, *, smooth: bool = False) -> rg.Outline:
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    return rg.Outline.smooth(points) if smooth else rg.Outline(points)


def _angles(rng: np.random.Generator, count: int) -> np.ndarray:
    """In rising order, no two nearly the same."""
    steps = rng.uniform(0.3, 1.0, count)
    return np.cumsum(steps) * 2 * np.pi / steps.sum()


def _letter(rows: str) -> rg.Outline:
    """The boundary of the cells that are filled, corner after corner."""
    cells = np.array([[c == "#" for c in row] for row in rows.split()][::-1])
    after: dict[tuple[int, int], tuple[int, int]] = {}
    for y, x in np.argwhere(cells):
        for (dx, dy), start, end in (
            ((0, -1), (0, 0), (1, 0)), ((1, 0), (1, 0), (1, 1)),
            ((0, 1), (1, 1), (0, 1)), ((-1, 0), (0, 1), (0, 0)),
        ):  # fmt: skip
            i, j = y + dy, x + dx
            if not (0 <= i < cells.shape[0] and 0 <= j < cells.shape[1] and cells[i, j]):
                after[int(x) + start[0], int(y) + start[1]] = (int(x) + end[0], int(y) + end[1])
    at = min(after)
    ring = [at]
    while (at := after[at]) != ring[0]:
        ring.append(at)
    points = np.array(ring, dtype=float)
    ahead, behind = np.roll(points, -1, axis=0) - points, points - np.roll(points, 1, axis=0)
    return rg.Outline(points[ahead[:, 0] * behind[:, 1] != ahead[:, 1] * behind[:, 0]])
