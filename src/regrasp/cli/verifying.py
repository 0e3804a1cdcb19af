"""Judging a plan that was written before."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from regrasp.cli.speech import json_option, say
from regrasp.cli.statuses import VERIFIED
from regrasp.cli.verdicts import names_of, verdict_facts, verified


@click.command()
@click.argument("path", metavar="PLAN", type=click.Path(path_type=Path))
@click.option("--rate", type=float, metavar="HZ", help="Set-points per second there must be.  [default: any]")
@json_option
def verify(path: Path, rate: float | None) -> dict[str, Any]:
    """Check a PLAN in exact arithmetic.

    PLAN is a plan.json or the folder that holds it, a file of the cut that proves that there is none, or a
    regions.json, by how much fingers may miss. A setpoints.csv beside a plan is checked too: every row must
    hold the object and be the plan's at its time. So is a motions.csv, with positions, velocities and
    contacts of all fingers, and with a motions.json beside it the ways between rows, against the shape and
    one another.
    """
    import numpy as np

    from regrasp import ChosenGrasp
    from regrasp import verify as verdict_on
    from regrasp.files import read_plan
    from regrasp.files.plans.cut_file import holds_a_cut, read_cut
    from regrasp.files.plans.regions_file import holds_regions, read_regions
    from regrasp.files.plans.setpoints import checked, read_setpoints
    from regrasp.files.source import legible
    from regrasp.mechanics.checks import number

    if rate is not None:
        number(rate, "rate", above=0)
    path = path / "plan.json" if path.is_dir() else path
    if holds_a_cut(path) or holds_regions(path):
        claim: Any = read_cut(path) if holds_a_cut(path) else read_regions(path)
        with np.errstate(all="ignore"):
            say(claim)
            verdict = verified(verdict_on(claim), path)
        say(verdict)
        return {"status": "verified", "exit": VERIFIED, "verification": asdict(verdict)}
    planned = read_plan(path)
    table, count, more = path.with_name("setpoints.csv"), 0, dict[str, Any]()
    with np.errstate(all="ignore"), legible(names_of(planned)) as shown:  # any numbers at all
        say(shown(planned))
        verdict = verified(verdict_on(planned), path)
        say(verdict)
        if table.exists() and not isinstance(planned, ChosenGrasp):
            steps = read_setpoints(table, planned, rate)
            for rows in steps:
                verified(checked(planned, rows), table)
            count = sum(rows.times.size for rows in steps)
            say(f"each of {count} set-points in {table} verified too")
        if not isinstance(planned, ChosenGrasp):
            more = _judged_ways(path, planned, rate)
    return verdict_facts(planned, verdict, count) | more


def _judged_ways(path: Path, planned: Any, rate: float | None) -> dict[str, Any]:
    """What JSON says of ways beside the plan, when they have been judged."""
    from regrasp.files import read_motions, read_ways
    from regrasp.verification import verify_motion_rows, verify_motions

    facts, ways = dict[str, Any](), None
    file = path.with_name("motions.json")
    if file.exists():
        ways, shape = read_ways(file, planned)
        judged = verified(verify_motions(ways, shape), file)
        say(f"{file}: {judged}")
        facts["ways"] = {"instants": judged.samples, "to_object": judged.to_object}
    table = path.with_name("motions.csv")
    if table.exists():
        found = verified(verify_motion_rows(planned, read_motions(table, planned, rate), ways), table)
        say(f"{table}: {found}")
        facts["motions"] = found.rows
    return facts
