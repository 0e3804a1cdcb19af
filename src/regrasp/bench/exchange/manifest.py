"""All families as files, and a manifest that says what each file is and what is known of its answer."""

import json
from collections.abc import Iterable
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any

from regrasp.bench.exchange.cbf import write_cbf
from regrasp.bench.exchange.npz import write_npz
from regrasp.bench.problems.problem import BenchProblem, Family
from regrasp.disk.staging import whole_folder
from regrasp.errors import InvalidInput

MANIFEST = "manifest.json"
_LICENCE = "MIT"
_FORMATS = {
    "cbf": "Conic Benchmark Format, version 1; a quadratic objective is written as its epigraph",
    "npz": "NumPy archive: minimise 1/2 x'Px + q'x subject to G x <= h, A x = b; "
    "each matrix M as M_row, M_col, M_value",
}


def export(families: Iterable[Family], folder: Path) -> Path:
    """Write every problem into ``folder``, conic ones as CBF and the others as NPZ; returns the manifest.

    Files appear together or not at all. Raises ``InvalidInput`` where they cannot be written.
    """
    families = list(families)
    entries: list[dict[str, Any]] = []
    with whole_folder(folder) as staged:
        for family in families:
            entries.extend(_write(problem, staged) for problem in family.problems())
        files = {entry["file"] for entry in entries}
        if len(files) < len(entries):
            raise InvalidInput(f"expected one file name a problem, got {len(files)} for {len(entries)}")
        manifest = {
            "made_by": f"regrasp {version('regrasp')}",
            "licence": _LICENCE,
            "formats": _FORMATS,
            "families": {
                family.name: {"origin": family.origin, "formula": family.formula} for family in families
            },
            "problems": entries,
        }
        text = json.dumps(manifest, indent=1, ensure_ascii=False)
        (staged / MANIFEST).write_text(f"{text}\n", encoding="utf-8")
    return Path(folder) / MANIFEST


def _write(problem: BenchProblem, folder: Path) -> dict[str, Any]:
    kind = "npz" if problem.is_qp else "cbf"
    path = folder / f"{problem.name.replace('/', '_')}.{kind}"
    known, program = problem.known, problem.program
    if problem.is_qp:
        write_npz(program, path)
    else:
        optimum = "unknown" if known.optimum is None else repr(known.optimum)
        about = f"{problem.name}\n{known.verdict.value}, optimum {optimum}, known by {known.truth.value}"
        write_cbf(program, path, f"{about}\nlicence {_LICENCE}")
    unknowns, rows, nonzeros = problem.size
    return {
        "name": problem.name,
        "file": path.name,
        "sha256": sha256(path.read_bytes()).hexdigest(),
        "family": problem.family,
        "unknowns": unknowns,
        "rows": rows,
        "nonzeros": nonzeros,
        "density": nonzeros / (unknowns * rows),
        "quadratic_nonzeros": int(program.P.count_nonzero()),
        "cones": problem.cones,
        "verdict": known.verdict.value,
        "optimum": known.optimum,
        "accuracy": known.accuracy if known.optimum is not None else None,
        "scale": known.scale if known.optimum is not None else None,
        "truth": known.truth.value,
        "follows": problem.follows,
        "licence": _LICENCE,
    }
