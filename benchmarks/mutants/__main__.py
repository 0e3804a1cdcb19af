"""Single changes of the source, and how many tests notice: ``python benchmarks/mutants [AREA ...]``.

Every change of the modules of an area is tried against the tests nearest to them. What was tried is kept in
``.mutants``, so that a run that was ended goes on where it was; ``--fresh`` begins anew, a module that
changed is tried anew, and ``--survivors`` tries those again where test files changed since. Quick tests that
are plain functions are asked first, of every change, and all tests then of what these did not notice, which
``--plain`` leaves open. TIME ends a run after so many seconds, and sums up what was tried. Survivors and the
reasons for them stand in ``survivors.txt``: a change that no input can tell from the original is no slip, and
does not count. ``--drawn`` tries only those of ``drawn.txt``, which ``--draw=60 [AREA ...]`` wrote by chance,
sixty an area (SEED); areas that are not named keep theirs. JOBS sets the number of processes, SLOW the
longest test and BUDGET the longest time of a change [s].
"""

import hashlib
import json
import os
import random
import sys
import time
from importlib import import_module
from pathlib import Path

os.environ.setdefault("HYPOTHESIS_STORAGE_DIRECTORY", "/tmp/regrasp-mutants-hypothesis")
HELP = ("given", "programs/given", "oracles", "kit")  # what tests share
HERE, ROOT = Path(__file__).parent, Path(__file__).resolve().parents[2]
sys.path[:0] = [
    str(HERE),
    str(ROOT / "src"),
    *(str(ROOT / "tests" / of) for of in HELP),
]
SOURCE, TESTS, KEPT = ROOT / "src" / "regrasp", ROOT / "tests", ROOT / ".mutants"
SURVIVORS, DRAWN = HERE / "survivors.txt", HERE / "drawn.txt"

_SEARCH = "planning/placement"
# Area -> modules, tests (patterns), and the least share of changes noticed.
AREAS: dict[str, tuple[list[str], list[str], float]] = {
    "verification": (
        ["verification/*.py"],
        ["verification/**/test_[!c]*.py", "verification/**/test_co*.py", "**/test_verification.py"],
        0.95,
    ),
    "placed": (
        [
            f"verification/placed/{name}.py"
            for name in (
                "chosen*",
                "claims/*",
                "touching",
                "arc_lengths",
                "re*",
                "whole_sets",
                "curved*",
                "protocol",
            )
        ],
        [
            *(f"verification/proofs/test_{name}.py" for name in ("boxes*", "c*", "what*")),
            "verification/proofs/regions/test_[!f]*.py",
            "verification/test_placement_proofs.py",
            "verification/by_hand/test_tied_by_hand.py",
            "verification/by_hand/test_answers_by_hand.py",
            *(
                f"planning/**/test_{name}.py"
                for name in ("choose_grasp", "constraints", "curves", "contact_regions", "w*_placement")
            ),
        ],
        0.95,
    ),
    "boxes": (
        [
            f"verification/placed/{name}.py"
            for name in (
                "placements",
                "straight",
                "cubic",
                "forces/*",
                "clear_boxes",
                "roots",
                "groups",
                "by_side",
            )
        ],
        [
            *(f"verification/proofs/test_{name}.py" for name in ("boxes*", "planar*", "proofs*", "trees*")),
            "verification/proofs/twists/test_*.py",
            "verification/limits/test_*.py",
            "verification/proofs/curves/test_[ct]*.py",
            "verification/by_hand/test_tied_by_hand.py",
            "verification/test_placement_proofs.py",
        ],
        0.95,
    ),
    "curves": (["verification/placed/curves/*.py"], ["verification/proofs/curves/test_[ct]*.py"], 0.95),
    "faces": (
        ["verification/placed/faces/*.py", "verification/placed/meshes/*.py"],
        [
            *(f"verification/proofs/test_{name}.py" for name in ("solid*", "what*", "claims*", "doubts*")),
            "verification/proofs/regions/test_faces*.py",
            "planning/**/test_loads_together.py",
            "planning/**/test_grasps_on_meshes.py",
            "planning/**/test_regions_on_faces.py",
        ],
        0.95,
    ),
    "refusals": (
        ["verification/refusals/*.py"],
        [
            "verification/**/test_cuts*.py",
            "verification/by_hand/test_limited_work*.py",
            "verification/by_hand/test_*cuts_by_hand.py",
            "planning/anywhere/test_*.py",
        ],
        0.95,
    ),
    "ways": (
        ["verification/ways/*.py"],
        [
            "verification/by_hand/test_*s_by_hand.py",
            "verification/motions/test_*.py",
            "files/test_ways_file.py",
            "files/test_motion_files.py",
            "motions/test_*.py",
        ],
        0.95,
    ),
    "withstood": (
        ["verification/withstood/*.py"],
        [
            "verification/by_hand/test_withstood*.py",
            "verification/test_withstood_*.py",
            "planning/**/test_tolerances.py",
            "planning/**/test_regrasps_that_withstand.py",
        ],
        0.95,
    ),
    "results": (
        [f"{_SEARCH}/results.py"],
        [f"{_SEARCH}/test_[!glt]*.py", f"{_SEARCH}/levels/test_*.py", f"{_SEARCH}/answers/test_*.py"],
        0.95,
    ),
    "constraints": (
        [f"{_SEARCH}/{name}.py" for name in ("constrained/*", "reachable", "asking", "curves/tips", "sides")],
        [*(f"{_SEARCH}/{name}.py" for name in ("test_c*", "test_f*", "test_w*", "maps/*", "answers/*"))],
        0.95,
    ),
    "choosing": (
        [
            f"{_SEARCH}/{name}.py"
            for name in (
                *("choosing", "symmetries", "sliding", "knife_edges", "circles", "loads", "laws"),
                "levels/ball",
            )
        ],
        [*(f"{_SEARCH}/{of}.py" for of in ("test_[!glt]*", "answers/*")), "**/test_circles*.py"],
        0.95,
    ),
    "programs": (["programs/*.py"], ["programs/test_*.py", "programs/asked/test_*.py"], 0.95),
    "judging": (["programs/judging/*.py"], ["programs/**/test_*.py"], 0.95),
    "calls": (["programs/calls/*.py"], ["programs/**/test_*.py", "peers/test_*.py"], 0.95),
    "path": (
        ["planning/changes/path_search.py", "planning/changes/path_program.py"],
        [
            f"**/test_{name}.py"
            for name in (
                "path*",
                "*_paths",
                "limits_of_both_ends",
                "linear_limits",
                "min_normal",
                "exchange",
                "hold*",
            )
        ],
        0.85,
    ),
    "rotation": (
        ["planning/**/rotation.py", "planning/**/turn_states.py", "planning/**/lost_loads.py"],
        [
            f"**/test_{name}.py"
            for name in ("rotation*", "turns_*", "lost_loads", "space_plans", "linear_limits", "min_normal")
        ],
        0.85,
    ),
    "files": (
        [
            f"files/**/{name}.py"
            for name in ("plan_file", "*rows", "setpoints", "regrasp_table", "strict", "source")
        ],
        ["files/test_*.py", "**/test_motion_rows.py"],
        0.85,
    ),
    "bench": (
        ["bench/**/judgement.py", "bench/**/contests.py", "bench/**/outcomes.py", "bench/**/closeness.py"],
        ["**/test_misjudgements.py", "**/test_bench_report.py", "bench/test_*.py"],
        0.85,
    ),
}


def main() -> int:
    asked = [word for word in sys.argv[1:] if not word.startswith("-")] or list(AREAS)
    if any(word not in AREAS for word in asked):
        print(f"areas: {', '.join(AREAS)}", file=sys.stderr)
        return 2
    for size in (int(word[7:]) for word in sys.argv[1:] if word.startswith("--draw=")):
        _draw(size, int(os.environ.get("SEED", "1")), asked)
        return 0
    KEPT.mkdir(exist_ok=True)
    good = True
    for area in asked:
        pid = os.fork()  # each area imports only its own tests
        if pid == 0:
            os._exit(_run(area, fresh="--fresh" in sys.argv))
        good &= os.waitstatus_to_exitcode(os.wait()[1]) == 0
    return 0 if good else 1


def _run(area: str, fresh: bool) -> int:
    import pytest

    from engine import NONE, NOTICED, OPEN, SURVIVED, UNSEEN, Engine

    sources, tests, least = AREAS[area]
    try:
        modules, against_them = matched(SOURCE, sources), matched(TESTS, tests)
    except FileNotFoundError as error:
        print(f"{area}: {error}", file=sys.stderr)
        return 2
    for path in modules:  # some are imported where they are needed
        import_module(".".join(path.relative_to(ROOT / "src").with_suffix("").parts))
    files = [str(path) for path in against_them]
    kept = KEPT / f"{area}.jsonl"
    if fresh:
        kept.unlink(missing_ok=True)
    prints = {str(path): _print([path]) for path in modules}
    against = _print([*map(Path, files), *(p for of in HELP for p in sorted((TESTS / of).rglob("*.py")))])
    rows = [json.loads(line) for line in kept.read_text().splitlines()] if kept.exists() else []
    found = {row["key"].strip(): row for row in rows if prints.get(row["module"]) == row["print"]}
    reasons = _reasons()

    def told(key: str, change: object, verdict: str) -> None:
        module = str(SOURCE / key.split(" ")[0])
        row = {"key": key, "line": change.line, "verdict": verdict, "module": module, "print": prints[module]}
        found[key] = row = row | {"against": against}
        with kept.open("a") as file:
            file.write(json.dumps(row) + "\n")
        quiet = (NOTICED, NONE) if plainly else (NOTICED, NONE, OPEN)
        if verdict not in quiet and key not in reasons:
            print(f"{verdict:9}{change.line:5} {key}", flush=True)

    again = (SURVIVED, UNSEEN) if "--survivors" in sys.argv else ()
    equal = {key for key, reason in reasons.items() if reason.startswith("=")}
    drawn = set(DRAWN.read_text(encoding="utf-8").splitlines()) if "--drawn" in sys.argv else None
    plainly, end = "--plain" in sys.argv, time.monotonic() + float(os.environ.get("TIME", "inf"))

    def wanted(key: str, first: bool) -> bool:
        if key in equal or (drawn is not None and key not in drawn) or time.monotonic() > end:
            return False
        row = found.get(key)
        if row is None:
            return True
        changed = row.get("against") != against  # the tests, since
        return (changed or not first) if row["verdict"] == OPEN else changed and row["verdict"] in again

    engine = Engine(modules, wanted, told, KEPT / f"{area}.seen.jsonl", plainly)
    silent = ["-qq", "-p", "no:cacheprovider", "--tb=no", "--assert=plain"]
    pytest.main([*silent, "--capture=no", "--hypothesis-seed=0", *files], plugins=[engine])
    rows = [row for row in found.values() if drawn is None or row["key"] in drawn]
    rows += [
        {"key": key, "verdict": SURVIVED}
        for key, reason in reasons.items()
        if reason.startswith("=") and key not in found and drawn is not None and key in drawn
        if str(SOURCE / key.split(" ")[0]) in prints
    ]
    return _summed_up(area, rows, reasons, least)


def matched(folder: Path, patterns: list[str]) -> list[Path]:
    """The files of patterns, none of which may be without one."""
    found: set[Path] = set()
    for pattern in patterns:
        if not (files := set(folder.glob(pattern))):
            raise FileNotFoundError(f"no file under {folder.relative_to(ROOT)} matches {pattern}")
        found |= files
    return sorted(found)


def _print(paths: list[Path]) -> str:
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:12]


def _draw(size: int, seed: int, areas: list[str]) -> None:
    """Write which changes of these areas are to be tried; nothing has been tried when they are drawn."""
    from changes import changes
    from engine import named

    parts: dict[str, list[str]] = {}  # of all areas, by the line that begins them
    for line in DRAWN.read_text(encoding="utf-8").splitlines() if DRAWN.exists() else []:
        if line.startswith("# "):
            parts[line[2:].split(":")[0]] = found = []
        found.append(line)
    for area in areas:
        keys = [
            key
            for path in matched(SOURCE, AREAS[area][0])
            for _, key in named(changes(path.read_text()), str(path))
        ]
        chosen = sorted(random.Random(seed).sample(keys, min(size, len(keys))))
        head = f"# {area}: {len(chosen)} of {len(keys)}, by random.Random({seed}).sample"
        parts[area] = [head, *chosen]
    lines = [line for area in AREAS for line in parts.get(area, [])]
    DRAWN.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _summed_up(area: str, rows: list[dict], reasons: dict[str, str], least: float) -> int:
    from engine import NONE, NOTICED

    judged = [row for row in rows if row["verdict"] != NONE and reasons.get(row["key"], "?")[:1] != "="]
    noticed = sum(row["verdict"] == NOTICED for row in judged)
    share = noticed / max(len(judged), 1)
    equal = sum(reasons.get(row["key"], "?")[:1] == "=" for row in rows)
    low, high = _interval(noticed, len(judged))
    print(
        f"{area}: {noticed} of {len(judged)} changes noticed, {100 * share:.1f} % ({100 * low:.0f} to "
        f"{100 * high:.0f} % of all like these; wanted {100 * least:.0f} %); {equal} more are no slips"
    )
    return 0 if share >= least else 1


def _interval(k: int, n: int, z: float = 1.96) -> tuple[float, float]:
    """Wilson's interval of a share, of which 95 % hold the true one."""
    n = max(n, 1)
    middle, half = k / n + z * z / (2 * n), z * (k * (n - k) / n**3 + z * z / (4 * n * n)) ** 0.5
    return (middle - half) / (1 + z * z / n), (middle + half) / (1 + z * z / n)


def _reasons() -> dict[str, str]:
    """Key -> reason, of ``survivors.txt``; ``=`` at its start says that nothing tells the two apart."""
    text = SURVIVORS.read_text(encoding="utf-8") if SURVIVORS.exists() else ""
    entries = [line for line in text.splitlines() if line and not line.startswith("#")]
    return {key.strip(): reason.strip() for key, _, reason in (entry.rpartition(" | ") for entry in entries)}


if __name__ == "__main__":
    sys.exit(main())
