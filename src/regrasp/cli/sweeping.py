"""Studies: run, and looked at while they run."""

from pathlib import Path
from typing import Any

import click

from regrasp.cli.speech import called, json_option, log_on_stderr, say, wants_json


class _WithRun(click.Group):
    """A group whose first argument may be what its command ``run`` takes."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        words = [word for word in args if not word.startswith("-")]
        if args and not {"-h", "--help"} & set(args[:1]) and (not words or words[0] not in self.commands):
            args = ["run", *args]
        return super().parse_args(ctx, args)


@click.group(cls=_WithRun)
@json_option
def sweep() -> None:
    r"""Run a study: a scenario or a function over many cases, a row for each.

    \b
    regrasp sweep STUDY.toml -o DIR
    regrasp sweep status DIR
    """


@sweep.command("run", hidden=True)
@click.argument("study", metavar="STUDY", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    required=True,
    help="Folder of the rows.",
)
@click.option("--workers", type=click.IntRange(0, 1000), help="Processes.  [default: one per core]")
@click.option("--dask", metavar="ADDRESS", help="Scheduler of a dask cluster that does the cases.")
@click.option("--time-limit", type=float, metavar="SECONDS", help="Of a case.")
@click.option("--memory-limit", type=click.IntRange(1), metavar="MB", help="Of a process.")
@click.option("--extend", is_flag=True, help="Where the study changed: keep its rows, do the new cases.")
@json_option
def run(
    study: Path,
    output: Path,
    workers: int | None,
    dask: str | None,
    time_limit: float | None,
    memory_limit: int | None,
    extend: bool,
) -> dict[str, Any]:
    """Run a STUDY, a TOML file, and keep its rows in DIR.

    A run that was ended goes on where it was when the same command is given again.
    """
    from regrasp.disk.staging import check_folder
    from regrasp.files.study_file import read_study_file
    from regrasp.studies.sweeping import sweep as swept

    check_folder(output)
    log_on_stderr()
    given, grid = read_study_file(study)
    try:
        done = swept(
            given.function if given.function is not None else study.parent / str(given.scenario),
            grid,
            out=output,
            keep=given.keep,
            zipped=given.zipped,
            plans=given.plans,
            workers=workers,
            client=dask,
            time_limit=time_limit or given.time_limit,
            memory_limit=None if memory_limit is None else memory_limit * 10**6,
            extend=extend,
            progress=not wants_json(),
        )
    except ImportError as error:
        raise click.ClickException(str(error)) from None
    say(done)
    say(f"Next: {called()} sweep status {output}, or regrasp.read_study({str(output)!r}) in Python")
    return _facts(done)


@sweep.command("status")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@json_option
def status(folder: Path) -> dict[str, Any]:
    """Say how far the study in DIR is."""
    from regrasp.studies.study import study_in

    try:
        found = study_in(folder)
    except ImportError as error:
        raise click.ClickException(str(error)) from None
    say(found)
    return _facts(found)


def _facts(study: Any) -> dict[str, Any]:
    return {
        "status": "done",
        "exit": 0,
        "folder": study.folder,
        "cases": study.cases,
        "rows": study.rows,
        "left": study.left,
        "verdicts": study.verdicts,
        "seconds": study.seconds,
    }
