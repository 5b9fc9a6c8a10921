"""Arguments and options of the commands that fly plans."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from radmpc.console.completing import BACKENDS, complete_backend, complete_replan

__all__ = [
    "BackendName",
    "BackendOptions",
    "Deadline",
    "FlightFilm",
    "FlightLog",
    "FlightOutput",
    "FlightSeed",
    "Missions",
    "Replan",
]

BackendName = Annotated[
    str | None,
    typer.Option(
        "--with",
        help=f"{', '.join(BACKENDS[:-1])} or {BACKENDS[-1]} (model).",
        autocompletion=complete_backend,
    ),
]
BackendOptions = Annotated[
    list[str] | None,
    typer.Option("--option", help="For what it is flown with; may be repeated."),
]
Replan = Annotated[
    str | None,
    typer.Option(
        "--replan",
        help="What plans anew at every step, or none (certified).",
        autocompletion=complete_replan,
    ),
]
Missions = Annotated[
    int | None, typer.Option("--missions", min=1, help="How many times to fly it (1).")
]
Deadline = Annotated[
    float | None,
    typer.Option(
        "--deadline",
        min=0.0,
        help="Seconds for each decision (the planner's limit; certified: 60).",
    ),
]
FlightSeed = Annotated[
    int | None, typer.Option("--seed", min=0, help="Seed of all noise and of every plan (0).")
]
FlightOutput = Annotated[
    Path | None, typer.Option("-o", "--output", help="Write the flight here, tick by tick.")
]
FlightLog = Annotated[
    Path | None, typer.Option("--log", help="Log for other tools, and for identify: .mcap.")
]
FlightFilm = Annotated[
    Path | None, typer.Option("--film", help="Film it here: .gif, or .mp4 with ffmpeg.")
]
