"""Choosing the grasp of a scenario: chosen, verified, and only then written and drawn."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from threading import current_thread, main_thread
from types import FrameType
from typing import TYPE_CHECKING, Any

from regrasp.cli.speech import say
from regrasp.cli.verdicts import progress_bar, verdict_facts, verified

if TYPE_CHECKING:
    from regrasp.files import GraspScenario, SpaceGraspScenario
    from regrasp.planning.placement.chosen import ChosenGrasp

_COUNT, _SLOW = 120, 48  # places of a map, and where each of its values is a program

_KEPT = ("min_normal", "arcs", "tip_radius", "in_holes", "min_distance", "from_corners")  # on maps, too


def choose(
    scenario: "GraspScenario | SpaceGraspScenario", name: str | Path, output: Path, *, draw: bool
) -> dict[str, Any]:
    """Write the chosen grasp with its proof as plan.json, and draw it."""
    from regrasp.disk.staging import whole_folder
    from regrasp.files import write_plan
    from regrasp.files.source import naming
    from regrasp.mechanics.value import one_line
    from regrasp.verification import verify

    word = scenario.task.objective
    with naming(name), progress_bar() as progress:
        task = progress.add_task("choosing", total=None)
        with _hearing() as interrupts:
            chosen = scenario.chosen(
                lambda bound, best: progress.update(task, description=_known(word, bound, best))
            )
        progress.update(task, description="verifying")
        verdict = verified(verify(chosen), name)
    for remark in chosen.shape.notes:
        say(f"{name}: {one_line(remark)}")
    say(f"{one_line(scenario.title)}\n\n{chosen}" if scenario.title else chosen)
    say(verdict)
    with whole_folder(output) as folder:
        write_plan(chosen, folder / "plan.json")
        files = {"plan.json"}
        try:
            if interrupts:
                raise KeyboardInterrupt
            for written in _more(chosen, scenario, folder, draw=draw):
                files.add(written)
        except KeyboardInterrupt:
            say("\nInterrupted: the grasp is written, and no more than there was time for.")
            for file in folder.iterdir():
                if file.name not in files:
                    file.unlink()
    wrote = [output / file for file in sorted(files)]
    say("")
    for path in wrote:
        say(f"wrote {path}")
    return verdict_facts(chosen, verdict, 0) | {"wrote": wrote}


@contextmanager
def _hearing() -> Iterator[list[int]]:
    """The interrupts from the keyboard meanwhile, which searches answer by the best so far."""
    heard: list[int] = []
    usual = signal.getsignal(signal.SIGINT)

    def hear(number: int, frame: FrameType | None) -> None:
        heard.append(number)
        raise KeyboardInterrupt

    listens = usual is signal.default_int_handler and current_thread() is main_thread()
    if listens:
        signal.signal(signal.SIGINT, hear)
    try:
        yield heard
    finally:
        if listens:
            signal.signal(signal.SIGINT, usual)


def _more(
    chosen: "ChosenGrasp", scenario: "GraspScenario | SpaceGraspScenario", folder: Path, *, draw: bool
) -> Iterator[str]:
    """Writes what stands beside the grasp, its regions, judged first, and pictures: the files' names."""
    from regrasp.files import write_regions
    from regrasp.verification import verify

    regions = _regions(chosen, scenario)
    if regions is not None:
        verdict = verified(verify(regions), "regions.json")
        say(f"\n{regions}\n{verdict}")
        write_regions(regions, folder / "regions.json")
        yield "regions.json"
    for name, image in _pictures(chosen, regions, scenario) if draw else ():
        (folder / name).write_bytes(image)
        yield name


def _regions(chosen: "ChosenGrasp", scenario: "GraspScenario | SpaceGraspScenario") -> Any:
    """The regions around its fingers; None, and why in words, where there are none."""
    from regrasp.errors import RegraspError
    from regrasp.planning.placement.regions.asking import contact_regions

    if chosen.objective == "wrench_ball":  # its load is zero, which every region holds
        return None
    try:
        return contact_regions(chosen.shape, chosen.grasp, scenario.load.value, max_force=chosen.max_force)
    except RegraspError as error:
        say(f"\nno regions.json: {error}")
        return None


def _pictures(
    chosen: "ChosenGrasp", regions: Any, scenario: "GraspScenario | SpaceGraspScenario"
) -> Iterator[tuple[str, bytes]]:
    """The grasp, the regions around its fingers, and of two on an outline the map of all places.

    What cannot be had is said.
    """
    from regrasp import plots
    from regrasp.errors import RegraspError
    from regrasp.outline.outline import Outline
    from regrasp.planning.placement.maps.placement_map import placement_map
    from regrasp.plots.look.png import png

    def image(ax: Any) -> bytes:
        return png(ax.figure)

    shape, load, word = chosen.shape, scenario.load.value, chosen.objective
    yield "grasp.png", image(plots.plot_chosen_grasp(chosen))
    if regions is not None:
        yield "regions.png", image(plots.plot_contact_regions(regions))
    if not isinstance(shape, Outline) or len(chosen.grasp) != 2:
        return
    task: Any = scenario.task  # of the plane
    given: dict[str, Any] = {"max_force": chosen.max_force, "length": chosen.length}
    given |= {name: getattr(task, name) for name in _KEPT}
    if (disturbance := getattr(scenario.load, "disturbance", None)) is not None:
        given["disturbance"] = disturbance.around(scenario.load.wrench)
    count = _SLOW if word == "wrench" else _COUNT
    try:
        found = placement_map(shape, load, friction=scenario.friction, objective=word, count=count, **given)
        outside = regions is not None and (regions.places < shape.length).all()  # of holes
        yield "map.png", image(plots.plot_placement_map(found, regions=regions if outside else None))
    except RegraspError as error:
        say(f"\nno map.png: {error}")


def _known(word: str, bound: float, best: float) -> str:
    """The best so far and what none is better than, as a search goes on."""
    from regrasp.planning.placement.laws import without_rounding

    found = f"best {without_rounding(word, best):.5g}, " if isfinite(best) else ""
    return f"choosing: {found}none better than {without_rounding(word, bound):.5g}"
