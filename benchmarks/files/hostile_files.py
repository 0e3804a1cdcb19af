"""Saved plans with random edits, and whether anything false verifies.

``python benchmarks/files/hostile_files.py``

Plans of every kind are written as they are saved, edited at random (``edits``), read back and verified. What
is said is held against oracles that import nothing of the project (``tests/oracles/plan_truth.py`` and
``placement_truth.py``): a lie is what verifies and is false, a false alarm what does not and is true. An
exception that is not ``InvalidInput`` is a traceback, and more than 10 s of processor time are a hang. Half
of the edits of proofs fit their digest again, as a forger's would. EDITS a kind (2,000), SEED (0), KINDS and
SECONDS in the environment; results in ``results/hostile_files.json``.
"""

import json
import os
import signal
import sys
import time
import warnings
from collections import Counter
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(Path(__file__).parent), str(ROOT / "tests" / "oracles")]

import regrasp as rg  # noqa: E402
from edits import edited  # noqa: E402
from hostile_cases import Case, cases  # noqa: E402

RESULTS = ROOT / "benchmarks" / "results" / "hostile_files.json"
LIMIT = 10.0  # s


class HangError(BaseException):
    """More than ``LIMIT``."""


def tried(case: Case, edits: int, rng: Random, until: float) -> dict[str, Any]:
    """Counts of what came of the edits of one plan, and the first of what should not be."""
    counts: Counter[str] = Counter()
    bad: list[dict[str, str]] = []
    assert case.told(json.loads(json.dumps(case.data))) == "", case.name
    for k in range(edits):
        if time.monotonic() > until:
            break
        data, how = edited(case.data, rng, case.kept)
        verdict, words = _judged(case, data)
        if verdict in ("verified", "not verified") and data != case.data:
            try:
                with np.errstate(all="ignore"):
                    expected = case.true(data, verdict == "verified")
            except (KeyError, TypeError, ValueError, IndexError, ArithmeticError):
                expected = False  # an oracle that cannot read it
            if verdict == "verified" and expected is False:
                verdict = "lies"
            elif verdict == "not verified" and expected is True:
                verdict = "false alarms"
            elif expected is None:
                counts["unknown"] += 1
        counts[verdict] += 1
        counts["edits"] += 1
        if verdict in ("lies", "false alarms", "tracebacks", "hangs", "long messages") and len(bad) < 10:
            bad.append({"verdict": verdict, "edit": how[:300], "said": words[:300], "number": str(k)})
    return {"kind": case.name, **counts, "bad": bad}


def _judged(case: Case, data: Any) -> tuple[str, str]:
    def rung(number: int, frame: Any) -> None:
        raise HangError

    signal.signal(signal.SIGVTALRM, rung)
    signal.setitimer(signal.ITIMER_VIRTUAL, LIMIT)
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("error")
            words = case.told(data)
    except rg.InvalidInput as error:
        words = str(error)
        return ("refused" if len(words) < 4000 else "long messages"), words
    except HangError:
        return "hangs", ""
    except Exception as error:
        trace = error.__traceback__
        while trace is not None and trace.tb_next is not None:
            trace = trace.tb_next
        where = f"{trace.tb_frame.f_code.co_filename}:{trace.tb_lineno}" if trace else ""
        return "tracebacks", f"{type(error).__name__}: {error} at {where.split('/src/')[-1]}"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    return ("not verified" if words else "verified"), words


def main() -> None:
    edits, seed = int(os.environ.get("EDITS", "2000")), int(os.environ.get("SEED", "0"))
    wanted = os.environ.get("KINDS", "")
    until = time.monotonic() + float(os.environ.get("SECONDS", "1e9"))
    rows = []
    with TemporaryDirectory() as folder:
        for case in cases(Path(folder)):
            if wanted in case.name:
                start = time.process_time()
                row = tried(case, edits, Random(f"{seed} {case.name}"), until)
                rows.append(row)
                shown = {key: value for key, value in row.items() if key != "bad"}
                print(f"{time.process_time() - start:6.1f} s {shown}", *row["bad"], sep="\n    ", flush=True)
    if not wanted:
        found = {"seed": seed, "rows": rows}
        RESULTS.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
