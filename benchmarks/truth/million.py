"""Hostile problems through every planning verb, answers judged in rational arithmetic that shares no code.

    python benchmarks/truth/million.py 100000 -o DIR    problems 0 to 99,999; the same line goes on
    python benchmarks/truth/million.py --table -o DIR   the table of what DIR holds
    python benchmarks/truth/million.py --again -o DIR   faults in DIR once more, by the code of today
    python benchmarks/truth/million.py --one 4711       a problem, its answers and their faults

A chunk of problems is one file of DIR, written whole. ``hostile`` makes the problems, ``exact_judge`` judges
them.
"""

import argparse
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from math import inf
from pathlib import Path

import numpy as np

import chunks
import regrasp as rg
from chunks import Judged, gathered
from exact_judge import is_escape, is_held, state_faults
from hostile import Problem, problem
from regrasp.cli.warming import warm_up

CHUNK = 250
LONG = 10
"""Seconds of this process after which a verb hangs."""
OBJECTIVES = ("angle", "force", "effort", "peak", "peak_normal", "friction_use")
HELD = 1e-6
"""A problem known to be held with this much room should not be refused."""
HAIR = 64 * 2.0**-52
"""Rounding turns the line of two contacts by this times their distance from the origin, in their own."""
WRONG = ("wrong", "unverified", "exception", "warning", "hang")


class Late(BaseException):
    """A verb took too long. No ``Exception``, so that nothing under it catches it."""


def answers(seed: int) -> Iterator[tuple[str, str]]:
    """(verb, outcome) of one problem."""
    given, rng = problem(seed), np.random.default_rng(seed + 2**40)
    grasp, load = grasp_of(given), rg.Wrench.from_vector(given.load)
    objective, limit = str(rng.choice(OBJECTIVES)), given.max_force
    options = {"objective": objective, "max_force": limit}
    yield "choose_state", outcome(lambda: chosen(given, grasp, load, options), given)
    n = len(grasp)
    if n == 2 and given.positions.shape[1] == 2 and (given.positions[0] != given.positions[1]).any():
        yield "locus_intervals", outcome(lambda: interval(given), given)
    if n > 2:
        leaving = int(rng.integers(n))
        yield (
            "plan_removal",
            outcome(lambda: planned(rg.plan_removal(grasp, leaving, load=load, **options)), given),
        )
        yield (
            "plan_addition",
            outcome(
                lambda: planned(
                    rg.plan_addition(grasp.without(leaving), grasp[leaving], load=load, **options)
                ),
                given,
            ),
        )
    angle = float(rng.uniform(-2, 2))
    axis = {} if grasp.dimension == 2 else {"axis": rng.normal(size=3)}
    yield (
        "plan_rotation",
        outcome(lambda: planned(rg.plan_rotation(grasp, angle, load=load, **axis, **options)), given),
    )
    guess = float(abs(given.load).max() or 1.0) * rng.normal(size=given.positions.shape)
    yield "balanced", outcome(lambda: moved(given, rg.GraspState(grasp, load, guess)), given)
    if seed % 100 == 0:
        yield "plan_regrasp", outcome(lambda: regrasped(rng), given)


def grasp_of(given: Problem) -> rg.Grasp:
    """The contacts as regrasp takes them."""
    return rg.Grasp(
        rg.Contact(r, n, float(mu), max_force=None if limit == inf else float(limit))
        for r, n, mu, limit in zip(given.positions, given.normals, given.frictions, given.limits, strict=True)
    )


def outcome(ask: Callable[[], str], given: Problem) -> str:
    """The word for what a verb did."""
    signal.signal(signal.SIGPROF, _late)
    signal.setitimer(signal.ITIMER_PROF, LONG)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return ask()
    except Late:
        return "hang"
    except rg.Infeasible as reason:
        return refused(reason)
    except rg.SolverFailed:
        return "solver failed"
    except rg.InvalidInput as error:
        return "needs max_force" if "needs max_force" in str(error) else f"invalid input: {str(error)[:60]}"
    except Warning as warned:
        return f"warning: {warned!s:.80}"
    except Exception as error:
        return f"exception: {type(error).__name__}: {error!s:.80}"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def _late(*_: object) -> None:
    raise Late


def refused(reason: rg.Infeasible) -> str:
    """Whether a refusal proves itself."""
    twist = reason.certificate
    if isinstance(twist, rg.EscapeTwist):
        grasp = twist.grasp
        proof = twist.is_proof and (grasp.is_soft or is_escape(
            grasp.positions, grasp.normals, np.array(twist.frictions), np.array(twist.limits),
            twist.load.vector, twist.twist
        ))  # fmt: skip
        return "proven" if proof else "wrong: a certificate proves nothing"
    if twist is not None:
        return "proven"
    return (
        "at its limit"
        if "at its limit" in reason.reason or "only in the limit" in reason.reason
        else "plain refusal"
    )


def chosen(given: Problem, grasp: rg.Grasp, load: rg.Wrench, options: dict) -> str:
    """A chosen state, or whatever it raises, against what is known of the problem."""
    most = np.minimum(given.limits, inf if given.max_force is None else given.max_force)
    try:
        state = rg.choose_state(grasp, load, **options)
    except rg.Infeasible as reason:
        word = refused(reason)
        is_planar = given.positions.shape[1] == 2 and (most == inf).all()
        truly = is_planar and is_held(given.positions, given.normals, given.frictions, given.load)
        if word == "proven" and (given.room > 1e-12 or (truly and not _far(given))):
            return "wrong: held, and a certificate says it is not"
        return "refused though held" if word != "proven" and given.room > HELD else word
    except rg.SolverFailed:
        if given.room > HELD:
            return "refused though held"
        raise
    faults = state_faults(given.positions, given.normals, given.frictions, most, given.load, state.forces)
    return f"wrong: {faults[0]}" if faults else "held"


def _far(given: Problem) -> bool:
    """Whether it is held only by forces that rounding makes: not if frictions are a fiftieth less."""
    return not is_held(given.positions, given.normals, given.frictions * 0.98, given.load)


def interval(given: Problem) -> str:
    """The closed form for arrays against exact membership, but for what is within rounding of the edge."""
    p, n, mu, w = given.positions, given.normals, given.frictions, given.load
    lo, hi = rg.locus_intervals(p[0], n[0], mu[0], p[1], n[1], mu[1], w[:2], w[2])
    says, truly = bool(lo <= hi), is_held(p, n, mu, w)
    if says == truly:
        return "right"
    if says and is_held(p, n, mu, w, most=None):
        return "by more than 1e9 loads"
    hair = 1e-11 + HAIR * float(np.linalg.norm(p, axis=1).max() / np.linalg.norm(p[1] - p[0]))
    wider, narrower = (is_held(p, n, np.maximum(mu * (1 + s * 1e-6) + s * hair, 0.0), w) for s in (1, -1))
    if wider != narrower or is_rounding(given):
        return "within rounding"
    return f"wrong: says {'held' if says else 'empty'}"


def is_rounding(given: Problem) -> bool:
    """Whether loads that differ by rounding are held, and others are not."""
    p, n, mu, w = given.positions, given.normals, given.frictions, given.load
    size, rng = float(abs(w).max()), np.random.default_rng(0)
    arm = np.array([1, 1, float(np.linalg.norm(p, axis=1).max())])
    found = {is_held(p, n, mu, w + 2e-12 * size * arm * rng.normal(size=3)) for _ in range(40)}
    return len(found) == 2


def planned(plan: object) -> str:
    """A plan, verified, and its ends judged again."""
    if not rg.verify(plan).ok:  # type: ignore[arg-type]
        return "unverified"
    ends = [plan.start, plan.end]  # type: ignore[attr-defined]
    for end in ends:
        grasp = end.grasp
        faults = state_faults(
            grasp.positions, grasp.normals, grasp.frictions, grasp.max_forces, end.load.vector, end.forces
        )
        if faults:
            return f"wrong: {faults[0]}"
    return "verified"


def moved(given: Problem, state: rg.GraspState) -> str:
    """The nearest equilibrium."""
    found = state.balanced()
    faults = state_faults(
        given.positions, given.normals, given.frictions, given.limits, given.load, found.forces
    )
    return f"wrong: {faults[0]}" if faults else "held"


def regrasped(rng: np.random.Generator) -> str:
    """A regrasp on a small outline."""
    outline = rg.Outline.ellipse(1.0, float(rng.uniform(0.3, 1)))
    friction = float(rng.choice([1e-9, 0.1, 0.3, 0.6, 1.5]))
    start, goal = (
        rg.Grasp(
            outline.contact_at(s, friction=friction)
            for s in np.sort(rng.uniform(0, outline.length, 3)).tolist()
        )
        for _ in range(2)
    )
    plan = rg.plan_regrasp(outline, start, goal, rg.Wrench(rng.normal(size=2)), friction=friction)
    return "verified" if rg.verify(plan).ok else "unverified"


def warm() -> None:
    """Everything is compiled once, so that no verb is timed while it waits for that."""
    warm_up.main([], standalone_mode=False)
    outline = rg.Outline.ellipse(2, 1)
    ends = (
        rg.Grasp(outline.contact_at(s * outline.length, friction=0.5) for s in p)
        for p in ((0.02, 0.35, 0.7), (0.2, 0.5, 0.85))
    )
    rg.plan_regrasp(outline, *ends, rg.Wrench([0, -3.0]), friction=0.5)
    rg.locus_intervals([0, 0], [1, 0], 0.5, [1, 0], [-1, 0], 0.5, [0, -1])
    for seed in range(20):
        for _ in answers(seed):
            pass


def run(count: int, folder: Path) -> None:
    """Problems up to ``count``, those of chunks not yet there."""
    warm()
    chunks.run(count, CHUNK, folder, judged)


def judged(seed: int) -> Judged:
    """What is counted of a problem."""
    for verb, word in answers(seed):
        is_fault = is_wrong(word) or word.startswith("invalid")
        yield f"{verb}|{word.split(':')[0]}", [seed, verb, word] if is_fault else None


def is_wrong(word: str) -> bool:
    """Whether an answer is none."""
    return word.startswith(WRONG) or word in ("refused though held", "solver failed")


def again(folder: Path) -> str:
    """Faults that are left of those of ``folder``, and the number of problems they were in."""
    seeds = sorted({seed for seed, _, word in gathered(folder)[1] if not word.startswith("invalid")})
    warm()
    left = [f"{seed} {verb}: {word}" for seed in seeds for verb, word in answers(seed) if is_wrong(word)]
    return "\n".join(
        [f"{len(seeds)} problems with faults; of today's answers, {len(left)} are faults", *left]
    )


def table(folder: Path) -> str:
    """Counts per verb, in Markdown."""
    counts, _, problems = gathered(folder)
    verbs = list(dict.fromkeys(key.split("|")[0] for key in counts))
    words = sorted(
        {key.split("|")[1] for key in counts}, key=lambda word: (word.startswith((*WRONG, "refused")), word)
    )
    lines = [f"{problems:,} problems", "", "| | " + " | ".join(verbs) + " |", "|---|" + "--:|" * len(verbs)]
    lines += [
        f"| {word} | " + " | ".join(f"{counts[f'{verb}|{word}']:,}" for verb in verbs) + " |"
        for word in words
    ]
    return "\n".join(lines)


def main() -> None:
    """The command line above."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("count", type=int, nargs="?", default=0)
    parser.add_argument(
        "-o", "--output", type=Path, default=Path(__file__).parents[1] / "results" / "million"
    )
    parser.add_argument("--one", type=int)
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--again", action="store_true")
    options = parser.parse_args()
    if options.one is not None:
        print(problem(options.one))
        for verb, word in answers(options.one):
            print(f"{verb}: {word}")
        sys.exit()
    if options.again:
        print(again(options.output))
        sys.exit()
    if not options.table:
        run(options.count, options.output)
    print(table(options.output))


if __name__ == "__main__":
    main()
