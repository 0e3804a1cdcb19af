"""Carrying out a plan that was written before, in physics."""

from pathlib import Path
from typing import Any

import click

from regrasp.cli.speech import json_option, say
from regrasp.errors import InvalidInput, RegraspError


class NotHeld(RegraspError):
    """The plan does not hold in physics."""


@click.command()
@click.argument("path", metavar="PLAN", type=click.Path(path_type=Path))
@click.option(
    "--friction", type=float, metavar="MU", help="True friction of all contacts.  [default: the plan's]"
)
@click.option("--stiffness", type=float, metavar="N/M", help="Of every finger.")
@click.option("--mass", type=float, metavar="KG", help="Of the object.  [default: the load over gravity]")
@click.option(
    "--gravity",
    type=float,
    default=9.81,
    show_default=True,
    help="In the plan's unit of length; 981 in centimetres.",
)
@click.option("--rolling", is_flag=True, help="Fingertips keep their orientation while the object turns.")
@click.option(
    "--motions",
    "ways",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="The fingers' ways, or none.  [default: a motions.json beside the plan]",
)
@click.option("--critical", is_flag=True, help="Find the least friction with which the plan holds, too.")
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Folder for execution.csv, execution.png and execution.gif; other files in it are left alone.",
)
@json_option
def simulate(
    path: Path, ways: Path | None, critical: bool, output: Path | None, **options: Any
) -> dict[str, Any]:
    """Carry out a PLAN in MuJoCo and say whether it holds.

    PLAN is a plan.json or the folder that holds it. Fingers go the ways of a motions.json beside it, which
    ``plan --motions`` writes, around the shape written there; without it they fly over what is between. Exit
    status 1 if it does not hold. Needs the extra ``regrasp[mujoco]``.
    """
    from regrasp import ChosenGrasp, execution
    from regrasp.disk.staging import check_folder
    from regrasp.files import read_plan

    if output is not None:
        check_folder(output)
    execution.Setup(**options)
    path = path / "plan.json" if path.is_dir() else path
    planned = read_plan(path)
    if isinstance(planned, ChosenGrasp):
        raise InvalidInput(f"{path}: a chosen grasp has no forces over time to simulate; plan its change")
    say(planned)
    options |= _ways(path, ways, planned)
    try:
        run = execution.simulate(planned, **options)
    except ImportError as error:
        raise click.UsageError(str(error)) from None
    say(f"\n{run}")
    facts: dict[str, Any] = {"status": "holds", "exit": 0, "execution": _facts(run)}
    if critical:
        least = execution.critical_friction(planned, **options)
        facts["execution"]["critical_friction"] = least
        say(
            f"holds in physics from a friction of {least:.4g}, "
            f"by computation from {planned.friction_needed:.4g}"
        )
    if output is not None:
        facts["wrote"] = _write(run, output)
    if not run.held:
        raise NotHeld(f"{path}: does not hold in physics{_advice(planned, run)}")
    return facts


def _ways(path: Path, given: Path | None, planned: Any) -> dict[str, Any]:
    """The ways of fingers and the shape they go around; empty where none are given or lie beside a plan."""
    from regrasp.files import read_ways

    if given == Path("none"):
        return {}
    file = path.with_name("motions.json") if given is None else given
    if given is None and not file.exists():
        if file.with_suffix(".csv").exists():
            say(f"{file.with_suffix('.csv')} has rows alone, no motions.json: fingers go ways of their own")
        return {}
    found = read_ways(file, planned)
    say(f"fingers go the {len(found.motions.motions)} ways of {file}")
    return found._asdict()


def _advice(planned: Any, run: Any) -> str:
    """What may help a run in which contacts creep because the object turns fast."""
    turns = any(step.turn is not None for step in getattr(planned, "steps", (planned,)))
    if run.dropped or not turns:
        return ""
    return "; the object turns, and contacts creep with the square of its speed: give its steps more time"


def _facts(run: Any) -> dict[str, Any]:
    """What JSON says of a run."""
    return {
        "held": run.held,
        "dropped": run.dropped,
        "slipped": run.slipped,
        "lost": run.lost,
        "largest_slip": float(run.slip.max()),
        "drift": float(run.drift.max()),
        "tilt": float(run.tilt.max()),
        "force_error": run.error,
        "mass": run.mass,
        "stiffness": run.stiffness,
        "ways": 0 if run.setup.motions is None else len(run.setup.motions.motions),
    }


def _write(run: Any, output: Path) -> list[Path]:
    """The run as a table, a figure and a film."""
    import csv

    from regrasp.disk.staging import whole_folder
    from regrasp.plots import animate_execution, execution_figure
    from regrasp.plots.look.png import save_png

    columns = {"t": run.times} | run.columns()
    with whole_folder(output) as folder:
        with (folder / "execution.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(zip(*(c.tolist() for c in columns.values()), strict=True))
        save_png(execution_figure(run), folder / "execution.png")
        animate_execution(run, path=folder / "execution.gif", frames_per_second=10)
        written = sorted(file.name for file in folder.iterdir())
    for name in written:
        say(f"wrote {output / name}")
    return [output / name for name in written]
