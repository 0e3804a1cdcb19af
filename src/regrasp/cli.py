"""The command line. Everything but click is imported inside the commands, when they need it."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from regrasp import __version__
from regrasp.cli_simulating import simulate
from regrasp.errors import Infeasible, InvalidInput, RegraspError, SolverUnavailable

if TYPE_CHECKING:
    from rich.progress import Progress

    from regrasp.files import AnyScenario
    from regrasp.mesh.mesh import Mesh
    from regrasp.outline.outline import Outline
    from regrasp.plans.regrasp_plan import RegraspPlan
    from regrasp.plans.transition import Transition
    from regrasp.verification import Verification

# Exit statuses; 0 only for a plan that verified.
UNVERIFIED, BAD_INPUT, INFEASIBLE, INTERRUPTED = 1, 2, 3, 130

# A plan with a thousand bad set-points says the same thing a thousand times.
_SHOWN = 10

# Problems that all solvers here work through in a minute or so.
_QUICK_UNKNOWNS = 60


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="regrasp")
def commands() -> None:
    """Contact forces while a grasp changes: planned, proven and explained.

    Exit status: 0 for a plan that verified, 1 for one that did not, 2 for bad input, 3 for an infeasible
    task.
    """


@commands.command()
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    default="regrasp-demo",
    show_default=True,
    help="Folder for the files.",
)
def demo(output: Path) -> None:
    """Work the paper's example.

    Plans it, verifies the plan, and writes plan, set-points, figures and the scenario itself.
    """
    from importlib.resources import files

    from regrasp.files import parse_scenario

    name = "paper.toml"
    text = (files("regrasp.files.scenarios") / name).read_text(encoding="utf-8")
    _work(parse_scenario(text, name), name, output, copy=text)
    click.echo(f"\nNext: change {output / name}, then run  {_called()} plan {output / name} -o {output}")


@commands.command()
@click.argument("scenario", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    required=True,
    help="Folder for the files. Those of the same names in it are replaced, others left alone.",
)
@click.option("--no-figures", is_flag=True, help="Write plan.json and setpoints.csv only.")
def plan(scenario: Path, output: Path, no_figures: bool) -> None:
    """Plan the change of grasp, the turn or the whole regrasp in a SCENARIO.

    SCENARIO is a TOML file. The plan is verified, then written with its set-points and figures.
    """
    from regrasp.files import read_scenario

    _work(read_scenario(scenario), scenario, output, draw=not no_figures)


@commands.command()
@click.argument("path", metavar="PLAN", type=click.Path(path_type=Path))
def verify(path: Path) -> None:
    """Check a PLAN in exact arithmetic.

    PLAN is a plan.json or the folder that holds it. A setpoints.csv beside it is checked too, row by row.
    """
    from regrasp import verify as verdict_on
    from regrasp.files import read_plan
    from regrasp.files.plans.setpoints import checked, read_setpoints

    path = path / "plan.json" if path.is_dir() else path
    planned = read_plan(path)
    click.echo(planned)
    click.echo(_verified(verdict_on(planned), path))
    table = path.with_name("setpoints.csv")
    if table.exists():
        steps = read_setpoints(table, planned)
        for rows in steps:
            _verified(checked(planned, rows), table)
        click.echo(f"each of {sum(rows.times.size for rows in steps)} set-points in {table} verified too")


@commands.command()
def schema() -> None:
    """Print the JSON Schema of scenarios.

    Editors use it to check and complete TOML.
    """
    import json

    from regrasp.files import scenario_schema

    click.echo(json.dumps(scenario_schema(), indent=2))


@commands.group(invoke_without_command=True)
@click.option("--family", "families", multiple=True, metavar="NAME", help="Only this family; repeatable.")
@click.option("--solver", "solvers", multiple=True, metavar="NAME", help="Only this solver; repeatable.")
@click.option(
    "--settings",
    multiple=True,
    type=click.Choice(["default", "low", "mid", "high"]),
    help="Accuracy asked for; repeatable.  [default: default]",
)
@click.option("--repeat", type=click.IntRange(1), default=1, show_default=True, help="Solves of each kind.")
@click.option(
    "--time-limit", type=float, default=None, metavar="SECONDS", help="Of each solve.  [default: 60, quick 5]"
)
@click.option(
    "--jobs", type=click.IntRange(1), default=1, show_default=True, help="Solves at once; disturbs timing."
)
@click.option("--most", type=click.IntRange(1), metavar="UNKNOWNS", help="Leave larger problems out.")
@click.option("--quick", is_flag=True, help="Small problems only: two minutes at most.")
@click.option("-o", "--output", metavar="DIR", type=click.Path(path_type=Path), help="Folder of the results.")
@click.pass_context
def bench(
    context: click.Context,
    families: tuple[str, ...],
    solvers: tuple[str, ...],
    settings: tuple[str, ...],
    repeat: int,
    time_limit: float | None,
    jobs: int,
    most: int | None,
    quick: bool,
    output: Path | None,
) -> None:
    """Run solvers on contact-force problems whose answers are known.

    A run that was ended goes on where it was when the same command is given again.
    """
    if context.invoked_subcommand:
        return
    if output is None:
        raise click.UsageError("the results need a folder: -o DIR")
    from regrasp.bench.families.catalogue import FAMILIES
    from regrasp.bench.running.runner import Limits, chosen_problems, run
    from regrasp.bench.running.solvers import chosen_solvers

    if quick:
        most = min(most or _QUICK_UNKNOWNS, _QUICK_UNKNOWNS)
    if jobs > 1:
        click.echo(f"Warning: {jobs} solves at once disturb one another's timing.", err=True)
    if time_limit is None:
        time_limit = 5.0 if quick else 60.0
    limits = Limits(repeat, time_limit, jobs)
    with _progress() as progress:
        task = progress.add_task("making problems", total=None)
        problems = chosen_problems(FAMILIES, families, most)
        progress.update(task, description="looking for solvers")
        there = chosen_solvers(solvers)

        tenths = 0

        def told(what: str, done: int, total: int) -> None:
            nonlocal tenths
            progress.update(task, description=what or None, completed=done, total=total)
            if progress.disable and 10 * done // total > tenths:  # no terminal: a log wants few lines
                tenths = 10 * done // total
                click.echo(f"{done} of {total} solves", err=True)

        rows = run(output, problems, there, settings or ("default",), limits, told)
    right = sum(row.correct is True for row in rows)
    unjudged = sum(row.correct is None for row in rows)
    lost = sum(row.is_lost for row in rows)
    click.echo(
        f"{len(rows)} solves in {output}: {right} right, {len(rows) - right - unjudged} wrong or without an "
        f"answer ({lost} of them timed out or crashed), {unjudged} not judged"
    )
    click.echo(f"Next: {_called()} bench report {output}")


@bench.command("report")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
def bench_report(folder: Path) -> None:
    """Write the report of the results in DIR."""
    from regrasp.bench.reporting.report import write_report

    for path in write_report(folder):
        click.echo(f"wrote {path}")


@bench.command("export")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--family", "families", metavar="NAME", multiple=True, help="Only this family; repeatable.")
def bench_export(folder: Path, families: tuple[str, ...]) -> None:
    """Write the problems to files in DIR, CBF for conic ones and NPZ for QPs, with a manifest."""
    from regrasp.bench.exchange import export
    from regrasp.bench.families.catalogue import FAMILIES

    unknown = [name for name in families if name not in FAMILIES]
    if unknown:
        raise InvalidInput(f"no family {unknown[0]!r}; there are {', '.join(FAMILIES)}")
    click.echo(f"wrote {export([FAMILIES[name] for name in families or FAMILIES], folder)}")


commands.add_command(simulate)


def main() -> None:
    """Run the command line and exit with its status; an error is one message on stderr."""
    try:
        status = commands(standalone_mode=False, prog_name="regrasp")
    except click.ClickException as error:
        error.show()
        status = error.exit_code
    except (click.Abort, KeyboardInterrupt):
        click.echo("Interrupted.", err=True)
        status = INTERRUPTED
    except RegraspError as error:
        click.echo(f"Error: {error}", err=True)
        status = _status(error)
    sys.exit(status)


def _called() -> str:
    """How a person calls this program again: as they did now."""
    called = Path(sys.argv[0])
    if called.name == "__main__.py":
        return "python -m regrasp"
    return str(called) if called.parent.name == "bin" else "regrasp"


class _Unverified(RegraspError):
    """A plan broke a condition."""


def _status(error: RegraspError) -> int:
    if isinstance(error, Infeasible):
        return INFEASIBLE
    return BAD_INPUT if isinstance(error, (InvalidInput, SolverUnavailable)) else UNVERIFIED


def _work(
    scenario: "AnyScenario", name: str | Path, output: Path, *, draw: bool = True, copy: str | None = None
) -> None:
    """Plan, verify, and only then write. ``copy`` is a scenario to write beside the plan, under ``name``."""
    from regrasp.files import plan_scenario, write_plan, write_setpoints
    from regrasp.files.plans.setpoints import checked, setpoint_blocks
    from regrasp.files.source import naming
    from regrasp.files.staging import whole_folder
    from regrasp.verification import verify

    rate, count = scenario.task.rate, 0
    with naming(name), _progress() as progress:
        task = progress.add_task("planning", total=None)
        planned = plan_scenario(scenario)
        progress.update(task, description="verifying")
        verdict = _verified(verify(planned), name)
        progress.update(task, total=planned.duration * rate)
        for rows in setpoint_blocks(planned, rate):
            _verified(checked(planned, rows), name)
            count += rows.times.size
            progress.update(task, completed=count)
    click.echo(f"{scenario.title}\n\n{planned}" if scenario.title else planned)
    click.echo(f"{verdict}\neach of {count} set-points verified too")

    with whole_folder(output) as folder:
        write_plan(planned, folder / "plan.json")
        write_setpoints(planned, folder / "setpoints.csv", rate)
        if copy is not None:
            (folder / name).write_text(copy, encoding="utf-8")
        if draw:
            _draw(planned, _shape(scenario), folder)
        written = sorted(file.name for file in folder.iterdir())
    click.echo("")
    for file in written:
        click.echo(f"wrote {output / file}")


def _verified(verdict: "Verification", name: str | Path) -> "Verification":
    """The verdict, if it is good; else an error that lists what is broken."""
    if verdict.ok:
        return verdict
    shown, more = verdict.violations[:_SHOWN], len(verdict.violations) - _SHOWN
    lines = [*shown, f"and {more} more"] if more > 0 else shown
    raise _Unverified("\n  ".join([f"{name}: does not verify:", *lines]))


def _progress() -> "Progress":
    """A display of how far something is, on stderr if that is a terminal."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    return Progress(console=console, transient=True, disable=not console.is_terminal)


def _shape(scenario: "AnyScenario") -> "Outline | Mesh | None":
    """The outline or the solid of a scenario, to be drawn; None where only the contacts are known."""
    from regrasp.files import RegraspScenario

    if isinstance(scenario, RegraspScenario):
        return scenario.outline.value
    return None if scenario.object is None else scenario.object.value


def _draw(planned: "Transition | RegraspPlan", shape: "Outline | Mesh | None", folder: Path) -> None:
    """Draw every figure into ``folder``; takes a few seconds, so a terminal sees how far it is."""
    with _progress() as progress:
        task = progress.add_task("drawing figures", total=None)
        from regrasp.plans.regrasp_plan import RegraspPlan
        from regrasp.plots.pages import overview

        first = planned.steps[0] if isinstance(planned, RegraspPlan) else planned
        solid: dict[str, Any] = {"mesh": shape} if first.grasp.dimension == 3 else {}
        if isinstance(planned, RegraspPlan):
            from regrasp.plots.regrasps.steps import plot_regrasp

            drawn = {"overview": plot_regrasp(planned, shape)}
            for k, step in enumerate(planned.steps, 1):
                drawn[f"step_{k}"] = overview.transition_figure(step, **solid)
                progress.update(task, total=len(planned.steps), completed=k)
        else:
            drawn = overview.figures(planned, **solid)
        progress.update(task, description="saving figures", total=len(drawn), completed=0)
        for stem, figure in drawn.items():
            figure.savefig(folder / f"{stem}.png")
            progress.advance(task)
