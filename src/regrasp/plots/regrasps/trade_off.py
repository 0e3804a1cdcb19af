"""What more finger moves buy: the trade-off between moves and margin of a list of plans."""

from collections.abc import Sequence
from math import degrees

from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import items
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plots.look.style import INK, PALETTE, TEXT, axes_or_new, note, short


def plot_trade_off(plans: Sequence[RegraspPlan], ax: Axes | None = None) -> Axes:
    """The worst margin that so many finger moves can keep, as a staircase of plans from ``plan_regrasps``.

    Each disc is a plan: its finger moves, the least angle margin of its holds, and beside it that margin
    and its steps. Between two discs a further move buys nothing, so the line is level.

    Args:
        plans: of ``plan_regrasps``, by rising number of moves.
        ax: the axes to draw on; new ones if not given.
    """
    plans = items(plans, "plans")
    given = () if isinstance(plans, RegraspPlan) else items(plans, "plans")
    if not given or not all(isinstance(plan, RegraspPlan) for plan in given):
        raise InvalidInput(f"plans must be RegraspPlans, as plan_regrasps gives them, got {shown(plans)}")
    ordered = sorted(plans, key=lambda plan: (len(plan.moves), plan.margin))
    moves = [len(plan.moves) for plan in ordered]
    margins = [degrees(plan.margin) for plan in ordered]
    ax = axes_or_new(ax)
    last = moves[-1] + 1
    ax.step(
        [*moves, last], [*margins, margins[-1]], where="post", color=PALETTE[0], linewidth=1.4, gid="stairs"
    )
    ax.plot(moves, margins, "o", color=PALETTE[0], markersize=5, zorder=4, gid="plans")
    top = max(margins) or 1.0
    for plan, x, y in zip(ordered, moves, margins, strict=True):
        text = f"{short(round(y, 2))}\N{DEGREE SIGN}\n{len(plan.steps)} steps"
        note(ax, text, (x, y), (1, -1), gap=4, color=INK)  # under its own stair, clear of the next disc
    ax.set(xlim=(moves[0] - 0.25, last), ylim=(0, 1.08 * top))
    ax.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    ax.set_xlabel("finger moves", fontsize=TEXT)
    ax.set_ylabel("worst angle margin [deg]", fontsize=TEXT)
    return ax
