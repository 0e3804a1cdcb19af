"""The explorer: a page in the browser, answered by this process."""

import threading
from typing import Any

import click

from regrasp.cli.speech import json_option, say


@click.command()
@click.argument("given", metavar="[SCENARIO|SHAPE]", required=False)
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Of this machine.  [default: any]")
@click.option("--no-browser", is_flag=True, help="Say the address and open nothing.")
@json_option
def explore(given: str | None, port: int, no_browser: bool) -> dict[str, Any]:
    """Drag contacts, load and friction in the browser and see what holds.

    SCENARIO is a TOML file, SHAPE a drawing (SVG, DXF, coordinates), a mesh (STL, OBJ, PLY) or a part that
    comes with regrasp: wrench, cam, gear, bracket, bottle, puzzle_piece; in space solid-bracket,
    solid-wrench, solid-cam, solid-nut, solid-bottle. Without either it is the paper's example. The page is
    served to this machine alone, until Ctrl-C.
    """
    from regrasp.explore.server import Server
    from regrasp.explore.start import start_of

    with Server(start_of(given), port) as server:
        say(f"{server.start.title}: {server.address}\nCtrl-C ends it.")
        if not no_browser:
            import webbrowser

            threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            say("\nEnded.")
    return {"status": "ended", "exit": 0}
