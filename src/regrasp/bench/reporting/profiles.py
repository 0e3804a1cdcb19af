"""Performance profiles (E. D. Dolan, J. J. More, Math. Program. 91, 2002).

With t_ps the time of solver s on problem p, infinite where its answer is not right,

    r_ps = t_ps / min_s t_ps,    rho_s(tau) = share of problems with r_ps <= tau

rho_s(1) is how often s is the fastest, and rho_s(inf) how often it is right.
"""

from math import inf

import numpy as np

from regrasp.bench.reporting.contests import Contest
from regrasp.bench.reporting.outcomes import Outcome
from regrasp.programs.blocks import Array


def ratios(contest: Contest) -> dict[str, Array]:
    """r_ps of each solver, rising; infinite where the answer is not right."""
    times = np.array(
        [[_time(there[problem]) for problem in contest.problems] for there in contest.outcomes.values()]
    )
    best = times.min(axis=0)
    # Where no solver is right every ratio is infinite, and the problem counts among those not solved.
    quotients = np.divide(times, best, out=np.full(times.shape, np.inf), where=np.isfinite(best))
    return dict(zip(contest.outcomes, np.sort(quotients, axis=1), strict=True))


def share_within(rising: Array, factor: float) -> float:
    """rho(factor) of one solver's ratios."""
    return float(np.searchsorted(rising, factor, side="right") / rising.size)


def _time(outcome: Outcome) -> float:
    return outcome.time if outcome.is_right and outcome.time else inf
