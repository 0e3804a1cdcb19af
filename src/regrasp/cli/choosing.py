"""Choosing the grasp of a scenario: chosen, verified, and only then written and drawn."""

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from regrasp.cli.speech import say
from regrasp.cli.verdicts import progress_bar, verdict_facts, verified

if TYPE_CHECKING:
    from regrasp.files import GraspScenario, SpaceGraspScenario


def choose(
    scenario: "GraspScenario | SpaceGraspScenario", name: str | Path, output: Path, *, draw: bool
) -> dict[str, Any]:
    """Write the chosen grasp with its proof as plan.json, and draw it."""
    from regrasp.disk.staging import whole_folder
    from regrasp.files import write_plan
    from regrasp.files.source import naming
    from regrasp.mechanics.value import one_line
    from regrasp.verification import verify

    with naming(name), progress_bar() as progress:
        task = progress.add_task("choosing", total=None)
        chosen = scenario.chosen(lambda bound, best: progress.update(task, description=_known(bound, best)))
        progress.update(task, description="verifying")
        verdict = verified(verify(chosen), name)
    for remark in chosen.shape.notes:
        say(f"{name}: {one_line(remark)}")
    say(f"{one_line(scenario.title)}\n\n{chosen}" if scenario.title else chosen)
    say(verdict)
    with whole_folder(output) as folder:
        write_plan(chosen, folder / "plan.json")
        if draw:
            from regrasp.plots.placement.chosen import chosen_grasp_png

            (folder / "grasp.png").write_bytes(chosen_grasp_png(chosen))
        written = sorted(file.name for file in folder.iterdir())
    say("")
    for file in written:
        say(f"wrote {output / file}")
    return verdict_facts(chosen, verdict, 0) | {"wrote": [output / file for file in written]}


def _known(bound: float, best: float) -> str:
    """The best so far and what none is better than, as a search goes on."""
    found = f"best {best:.5g}, " if isfinite(best) else ""
    return f"choosing: {found}none better than {bound:.5g}"
