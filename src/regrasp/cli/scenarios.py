"""Scenarios to start from, and the schema that editors check them with."""

from pathlib import Path
from typing import Any

import click

from regrasp.cli.speech import called, json_option, say

KINDS = ("removal", "addition", "exchange", "hold", "rotation", "regrasp", "grasp")


@click.command()
@click.argument("kind", metavar="KIND", type=click.Choice(KINDS))
@click.argument("file", metavar="[FILE]", required=False, type=click.Path(path_type=Path))
@click.option("--space", is_flag=True, help="In space, with three numbers to a vector, not in the plane.")
@json_option
def new(kind: str, file: Path | None, space: bool) -> dict[str, Any]:
    """Write a scenario with comments to start from.

    KIND is removal, addition, exchange, hold, rotation, regrasp or grasp. FILE is KIND.toml unless given; one
    that is there is left alone. The scenario plans as it is.
    """
    from regrasp.files.scenarios.templates import template, write_new

    name = f"space-{kind}" if space else kind
    file = Path(f"{name}.toml") if file is None else file
    write_new(file, template(name))
    say(f"wrote {file}\n\nNext: change {file}, then run  {called()} plan {file} -o out")
    return {"status": "done", "exit": 0, "wrote": [file]}


@click.command()
@json_option
def schema() -> None:
    """Print the JSON Schema of scenarios.

    Editors use it to check and complete TOML.
    """
    import json

    from regrasp.files import scenario_schema

    click.echo(json.dumps(scenario_schema(), indent=2))
