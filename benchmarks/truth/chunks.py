"""Counts and faults of many seeds, a file for each chunk, so that a run goes on where it was ended."""

import json
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path

Judged = Iterable[tuple[str, list | None]]
"""What is counted of a seed, and its fault where it is one."""


def run(count: int, size: int, folder: Path, judged: Callable[[int], Judged]) -> None:
    """Seeds up to ``count``, those of chunks not yet there; each file is written whole."""
    folder.mkdir(parents=True, exist_ok=True)
    for first in range(0, count, size):
        path = folder / f"{first:08d}.json"
        if path.exists():
            continue
        counts: Counter[str] = Counter()
        faults: list[list] = []
        seeds = range(first, min(first + size, count))
        for seed in seeds:
            for key, fault in judged(seed):
                counts[key] += 1
                if fault is not None:
                    faults.append(fault)
        part = path.with_suffix(".part")
        part.write_text(
            json.dumps({"counts": counts, "faults": faults, "seeds": len(seeds)}), encoding="utf-8"
        )
        part.replace(path)


def gathered(folder: Path) -> tuple[Counter[str], list[list], int]:
    """Counts, faults and number of seeds of all chunks in a folder."""
    counts: Counter[str] = Counter()
    faults: list[list] = []
    seeds = 0
    for path in sorted(folder.glob("*.json")):
        chunk = json.loads(path.read_text(encoding="utf-8"))
        counts.update(chunk["counts"])
        faults += chunk["faults"]
        seeds += chunk["seeds"]
    return counts, faults, seeds
