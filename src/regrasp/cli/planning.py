"""Planning a scenario: planned, verified, and only then written and drawn."""

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import click

from regrasp.cli.short_lived import uncollected
from regrasp.cli.speech import called, json_option, say
from regrasp.cli.verdicts import progress_bar, verdict_facts, verified

if TYPE_CHECKING:
    from regrasp.files.scenarios.scenario import PlannedScenario
    from regrasp.mesh.mesh import Mesh
    from regrasp.motions.value import Motions
    from regrasp.outline.outline import Outline
    from regrasp.plans.regrasp_plan import RegraspPlan
    from regrasp.plans.transition import Transition


@click.command()
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    default="regrasp-demo",
    show_default=True,
    help="Folder for the files.",
)
@json_option
@uncollected
def demo(output: Path) -> dict[str, Any]:
    """Work the paper's example.

    Plans it, verifies the plan, and writes plan, set-points, figures and the scenario itself.
    """
    from importlib.resources import files

    from regrasp.disk.staging import check_folder
    from regrasp.files import parse_scenario

    check_folder(output)
    name = "paper.toml"
    text = (files("regrasp.files.scenarios") / name).read_text(encoding="utf-8")
    example = cast("PlannedScenario", parse_scenario(text, name))
    facts = _work(example, name, output, copy=text)
    say(f"\nNext: change {output / name}, then run  {called()} plan {output / name} -o {output}")
    return facts


@click.command()
@click.argument("scenario", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    required=True,
    help="Folder for the files. Those of the same names in it are replaced, others left alone.",
)
@click.option("--no-figures", is_flag=True, help="Write no figures.")
@click.option(
    "--motions",
    is_flag=True,
    help="Plan the fingers' ways by [motions], too; writes motions.csv and motions.json.",
)
@click.option(
    "--html", is_flag=True, help="Write plan.html, a page that plays; in space it needs regrasp[html]."
)
@click.option("--mcap", is_flag=True, help="Write plan.mcap, a ROS 2 bag; needs regrasp[ros].")
@json_option
@uncollected
def plan(
    scenario: Path, output: Path, no_figures: bool, motions: bool, html: bool, mcap: bool
) -> dict[str, Any]:
    """Plan the change of grasp, the turn or the whole regrasp in a SCENARIO, or choose its grasp.

    SCENARIO is a TOML file. The plan is verified, then written with its set-points and figures.
    """
    from regrasp.cli.choosing import choose
    from regrasp.disk.staging import check_folder
    from regrasp.files import GraspScenario, SpaceGraspScenario, read_scenario

    check_folder(output)
    if mcap and find_spec("rosbags") is None:
        raise click.UsageError("--mcap needs rosbags: pip install 'regrasp[ros]'")
    asked = read_scenario(scenario)
    if isinstance(asked, GraspScenario | SpaceGraspScenario):
        if motions or html or mcap:
            raise click.UsageError("a grasp has nothing to play; leave --motions, --html and --mcap out")
        return choose(asked, scenario, output, draw=not no_figures)
    return _work(asked, scenario, output, draw=not no_figures, motions=motions, html=html, mcap=mcap)


def _shortest(scenario: "PlannedScenario") -> float:
    """A time that every plan of a scenario takes [s], as far as it is known before."""
    from regrasp.plans.loads import LoadSeries

    task, load = scenario.task, getattr(scenario, "external", None)
    if isinstance(load, LoadSeries):
        return load.duration
    known = getattr(task, "step_duration", None) or getattr(task, "duration", None)
    return known or (1.0 if getattr(task, "rate_limit", None) is None else 0.0)


def _work(
    scenario: "PlannedScenario",
    name: str | Path,
    output: Path,
    *,
    draw: bool = True,
    copy: str | None = None,
    motions: bool = False,
    html: bool = False,
    mcap: bool = False,
) -> dict[str, Any]:
    """Plan, verify, and only then write. ``copy`` is a scenario to write beside the plan, under ``name``."""
    from regrasp import files, verification
    from regrasp.disk.staging import whole_folder
    from regrasp.files.plans.setpoints import check_rate, checked, setpoint_blocks
    from regrasp.files.source import legible, naming
    from regrasp.mechanics.value import one_line

    rate, count = scenario.task.rate, 0
    given = [contact.name for contact in getattr(scenario, "contacts", ())]
    with legible(given), naming(name), progress_bar() as progress:
        task = progress.add_task("planning", total=None)
        check_rate(rate, _shortest(scenario))
        ways = files.plan_scenario_motions(scenario) if motions else None
        planned = files.plan_scenario(scenario) if ways is None else ways.plan
        progress.update(task, description="verifying")
        verdict = verified(verification.verify(planned), name)
        moved = None if ways is None else verified(verification.verify_motions(ways, _shape(scenario)), name)
        progress.update(task, total=planned.duration * rate)
        for rows in setpoint_blocks(planned, rate):
            verified(checked(planned, rows), name)
            count += rows.times.size
            progress.update(task, completed=count)
    shape = _shape(scenario)
    for remark in getattr(shape, "notes", ()):
        say(f"{name}: {one_line(remark)}")
    with legible(given) as shown:
        say(f"{one_line(scenario.title)}\n\n{shown(planned)}" if scenario.title else shown(planned))
    say(f"{verdict}\neach of {count} set-points verified too")
    if moved is not None:
        say(f"{ways}\n{moved}")

    with whole_folder(output) as folder:
        files.write_plan(planned, folder / "plan.json")
        files.write_setpoints(planned, folder / "setpoints.csv", rate)
        if ways is not None:
            files.write_motions(ways, folder / "motions.csv", rate)
            files.write_ways(ways, cast("Outline | Mesh", shape), folder / "motions.json")
        if mcap:
            files.write_mcap(planned if ways is None else ways, folder / "plan.mcap")
        if html:
            _page(planned if ways is None else ways, shape, scenario.title, str(verdict), folder)
        if copy is not None:
            (folder / name).write_text(copy, encoding="utf-8")
        if draw:
            _draw(planned, shape, folder, ways)
        written = sorted(file.name for file in folder.iterdir())
    say("")
    for file in written:
        say(f"wrote {output / file}")
    return verdict_facts(planned, verdict, count) | {"wrote": [output / file for file in written]}


def _shape(scenario: "PlannedScenario") -> "Outline | Mesh | None":
    """The outline or the solid of a scenario, to be drawn; None where only the contacts are known."""
    from regrasp.files import RegraspScenario

    if isinstance(scenario, RegraspScenario):
        return scenario.outline.value
    return None if scenario.object is None else scenario.object.value


def _page(planned: Any, shape: Any, title: str | None, verdict: str, folder: Path) -> None:
    """Write a page that plays the plan."""
    from regrasp.mesh.mesh import Mesh
    from regrasp.plots import html

    solid = {"mesh": shape} if isinstance(shape, Mesh) else {"outline": shape}
    try:
        html(planned, folder / "plan.html", **solid, title=title, caption=" ".join(verdict.split()))
    except ImportError as error:
        raise click.UsageError(f"--html: {error}") from None


def _draw(
    planned: "Transition | RegraspPlan",
    shape: "Outline | Mesh | None",
    folder: Path,
    ways: "Motions | None" = None,
) -> None:
    """Draw every figure into ``folder``; takes a few seconds, so a terminal sees how far it is."""
    with progress_bar() as progress:
        task = progress.add_task("drawing figures", total=None)
        from regrasp.plans.regrasp_plan import RegraspPlan
        from regrasp.plots.look.png import save_png
        from regrasp.plots.pages import overview

        first = planned.steps[0] if isinstance(planned, RegraspPlan) else planned
        solid: dict[str, Any] = {"mesh" if first.grasp.dimension == 3 else "outline": shape}
        if isinstance(planned, RegraspPlan):
            from regrasp.plots.regrasps.steps import plot_regrasp

            drawn = {"overview": plot_regrasp(planned, shape)}
            for k, step in enumerate(planned.steps, 1):
                drawn[f"step_{k}"] = overview.transition_figure(step, **solid)
                progress.update(task, total=len(planned.steps), completed=k)
        else:
            drawn = overview.figures(planned, **solid)
        if ways is not None and shape is not None:
            from regrasp.plots import plot_motions

            drawn["motions"] = plot_motions(ways, shape).figure
        progress.update(task, description="saving figures", total=len(drawn), completed=0)
        for stem, figure in drawn.items():
            save_png(figure, folder / f"{stem}.png")
            progress.advance(task)
