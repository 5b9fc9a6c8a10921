"""The command that serves a page: `serve`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from radmpc.console.completing import complete_drawn

__all__ = ["add_serving"]


def add_serving(app: typer.Typer) -> None:
    """Add the command to the command line.

    Parameters
    ----------
    app : Typer
        The command line.
    """
    app.command("serve")(serve_page)


def serve_page(
    source: Annotated[
        Path | None,
        typer.Argument(
            metavar="FILE",
            help="Scenario, plan, flight or chart file.",
            autocompletion=complete_drawn,
        ),
    ] = None,
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Port; 0 takes any free one.")
    ] = 0,
    folder: Annotated[
        Path | None,
        typer.Option(
            "--folder",
            help="Folder of the files that the page reads and writes. [default: the file's]",
        ),
    ] = None,
    opens: Annotated[
        bool, typer.Option("--open/--no-open", help="Open the page in the browser.")
    ] = False,
) -> int:
    """Draw, plan, watch and fly in a browser page."""
    from radmpc.console.commands.serving import run_serve

    return run_serve(source, port, folder, opens=opens)
