"""Judging a plan that was written before."""

from pathlib import Path
from typing import Any

import click

from regrasp.cli.speech import json_option, say
from regrasp.cli.verdicts import verdict_facts, verified


@click.command()
@click.argument("path", metavar="PLAN", type=click.Path(path_type=Path))
@json_option
def verify(path: Path) -> dict[str, Any]:
    """Check a PLAN in exact arithmetic.

    PLAN is a plan.json or the folder that holds it. A setpoints.csv beside it is checked too, row by row.
    """
    from regrasp import verify as verdict_on
    from regrasp.files import read_plan
    from regrasp.files.plans.setpoints import checked, read_setpoints

    path = path / "plan.json" if path.is_dir() else path
    planned = read_plan(path)
    say(planned)
    verdict = verified(verdict_on(planned), path)
    say(verdict)
    table, count = path.with_name("setpoints.csv"), 0
    if table.exists():
        steps = read_setpoints(table, planned)
        for rows in steps:
            verified(checked(planned, rows), table)
        count = sum(rows.times.size for rows in steps)
        say(f"each of {count} set-points in {table} verified too")
    return verdict_facts(planned, verdict, count)
