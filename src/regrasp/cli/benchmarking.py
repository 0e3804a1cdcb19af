"""The solver benchmark: run, reported, exported."""

from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from regrasp.cli.speech import called, json_option, say
from regrasp.cli.verdicts import progress_bar
from regrasp.errors import InvalidInput, shown

# Problems that all solvers here work through in a minute or so.
_QUICK_UNKNOWNS = 60


@click.group(invoke_without_command=True)
@click.option("--family", "families", multiple=True, metavar="NAME", help="Only this family; repeatable.")
@click.option("--solver", "solvers", multiple=True, metavar="NAME", help="Only this solver; repeatable.")
@click.option(
    "--settings",
    multiple=True,
    type=click.Choice(["default", "low", "mid", "high"]),
    help="Accuracy asked for; repeatable.  [default: default]",
)
@click.option(
    "--repeat", type=click.IntRange(1, 1000), default=1, show_default=True, help="Solves of each kind."
)
@click.option(
    "--time-limit", type=float, default=None, metavar="SECONDS", help="Of each solve.  [default: 60, quick 5]"
)
@click.option("--workers", type=click.IntRange(1, 1000), help="So many at once, where times do not count.")
@click.option("--dask", metavar="ADDRESS", help="The same on a dask cluster with this scheduler.")
@click.option("--most", type=click.IntRange(1, 10**9), metavar="UNKNOWNS", help="Leave larger problems out.")
@click.option("--quick", is_flag=True, help="Small problems only: two minutes at most.")
@click.option("-o", "--output", metavar="DIR", type=click.Path(path_type=Path), help="Folder of the results.")
@json_option
@click.pass_context
def bench(
    context: click.Context,
    families: tuple[str, ...],
    solvers: tuple[str, ...],
    settings: tuple[str, ...],
    repeat: int,
    time_limit: float | None,
    workers: int | None,
    dask: str | None,
    most: int | None,
    quick: bool,
    output: Path | None,
) -> dict[str, Any] | None:
    """Run solvers on contact-force problems whose answers are known.

    A run that was ended goes on where it was when the same command is given again.
    """
    if context.invoked_subcommand:
        _hand_over(context)
        return None
    if output is None:
        raise click.UsageError("the results need a folder: -o DIR")
    apart = workers is not None or dask is not None
    if apart and repeat > 1:
        raise click.UsageError("--repeat is for times, which do not count with --workers or --dask")
    if workers is not None and dask is not None:
        raise click.UsageError("the cluster knows its workers; give one of --workers and --dask")
    from regrasp.bench.families.catalogue import FAMILIES
    from regrasp.bench.running.jobs import Limits, chosen_problems
    from regrasp.bench.running.solvers import chosen_solvers
    from regrasp.bench.running.store import stored_rows
    from regrasp.disk.staging import check_folder

    check_folder(output)
    before = len(stored_rows(output))
    if quick:
        most = min(most or _QUICK_UNKNOWNS, _QUICK_UNKNOWNS)
    if time_limit is None:
        time_limit = 5.0 if quick else 60.0
    limits = Limits(repeat, time_limit)
    with progress_bar() as progress:
        task = progress.add_task("making problems", total=None)
        problems = chosen_problems(FAMILIES, families, most)
        progress.update(task, description="looking for solvers")
        there = chosen_solvers(solvers)

        tenths, told_where = 0, not apart

        def told(what: str, done: int, total: int) -> None:
            nonlocal tenths, told_where
            if progress.disable and not told_where:
                told_where = True
                click.echo(what, err=True)
            progress.update(task, description=what or None, completed=done, total=total)
            if progress.disable and 10 * done // total > tenths:  # no terminal: a log wants few lines
                tenths = 10 * done // total
                click.echo(f"{done} of {total} solves", err=True)

        asked = (output, problems, there, settings or ("default",), limits, told)
        if apart:
            from regrasp.bench.running.apart import run_apart

            try:
                rows = run_apart(*asked, workers=workers or 1, client=dask)
            except ImportError as error:
                raise click.ClickException(str(error)) from None
        else:
            from regrasp.bench.running.runner import run

            rows = run(*asked)
    right = sum(row.correct is True for row in rows)
    unjudged = sum(row.correct is None for row in rows)
    lost = sum(row.is_lost for row in rows)
    if before:
        say(f"{before} solves were there already; another folder makes them anew.")
    say(
        f"{len(rows)} solves in {output}: {right} right, {len(rows) - right - unjudged} wrong or without an "
        f"answer ({lost} of them timed out or crashed), {unjudged} not judged"
    )
    say(f"Next: {called()} bench report {output}")
    return {
        "status": "done",
        "exit": 0,
        "folder": output,
        "solves": len(rows),
        "before": before,
        "right": right,
        "wrong": len(rows) - right - unjudged,
        "lost": lost,
        "unjudged": unjudged,
    }


def _hand_over(context: click.Context) -> None:
    """Give options that stand before a subcommand to it; an error for those it does not have."""
    name = str(context.invoked_subcommand)
    subcommand = bench.commands[name]
    known = {parameter.name for parameter in subcommand.params}
    given: dict[str, Any] = {}
    for parameter in bench.params:
        if parameter.name is None or parameter.name not in context.params:
            continue
        if context.get_parameter_source(parameter.name) == ParameterSource.DEFAULT:
            continue
        if parameter.name not in known:
            raise click.UsageError(f"{parameter.opts[0]} is of a run; bench {name} does not take it")
        given[parameter.name] = context.params[parameter.name]
    context.obj = given


@bench.command("merge")
@click.argument("folders", metavar="DIR...", nargs=-1, type=click.Path(path_type=Path))
@click.option("-o", "--output", metavar="DIR", type=click.Path(path_type=Path), help="Folder of all rows.")
@json_option
@click.pass_context
def bench_merge(context: click.Context, folders: tuple[Path, ...], output: Path | None) -> dict[str, Any]:
    """Lay the rows of several runs, of other machines too, into one folder."""
    from regrasp.bench.running.merging import merge
    from regrasp.disk.staging import check_folder

    output = output or (context.obj or {}).get("output")  # one that stood before the subcommand counts, too
    if output is None:
        raise click.UsageError("the rows need a folder: -o DIR")
    check_folder(output)
    rows = merge(folders, output)
    say(f"{len(rows)} solves of {len(folders)} runs in {output}")
    say(f"Next: {called()} bench report {output}")
    return {"status": "done", "exit": 0, "folder": output, "solves": len(rows)}


@bench.command("report")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@json_option
def bench_report(folder: Path) -> dict[str, Any]:
    """Write the report of the results in DIR."""
    from regrasp.bench.reporting.report import write_report

    written = list(write_report(folder))
    for path in written:
        say(f"wrote {path}")
    return {"status": "done", "exit": 0, "wrote": written}


@bench.command("export")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--family", "families", metavar="NAME", multiple=True, help="Only this family; repeatable.")
@json_option
@click.pass_context
def bench_export(context: click.Context, folder: Path, families: tuple[str, ...]) -> dict[str, Any]:
    """Write the problems to files in DIR, CBF for conic ones and NPZ for QPs, with a manifest."""
    from regrasp.bench.exchange import export
    from regrasp.bench.families.catalogue import FAMILIES
    from regrasp.disk.staging import check_folder

    before = (context.obj or {}).get("families", ())  # those that stood before the subcommand count, too
    families = tuple(dict.fromkeys((*before, *families)))
    unknown = [name for name in families if name not in FAMILIES]
    if unknown:
        raise InvalidInput(f"no family {shown(unknown[0])}; there are {', '.join(FAMILIES)}")
    check_folder(folder)
    written = export([FAMILIES[name] for name in families or FAMILIES], folder)
    say(f"wrote {written}")
    return {"status": "done", "exit": 0, "wrote": [written]}
