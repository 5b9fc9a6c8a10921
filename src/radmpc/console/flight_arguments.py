"""Arguments and options of the commands that fly plans, and that identify noise from logs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from radmpc.console.completing import (
    BACKENDS,
    complete_backend,
    complete_log,
    complete_replan,
    complete_scenario,
)

__all__ = [
    "BackendName",
    "BackendOptions",
    "Columns",
    "Deadline",
    "FlightFilm",
    "FlightLog",
    "FlightOutput",
    "FlightSeed",
    "Logs",
    "Missions",
    "NoiseOutput",
    "NoiseScenario",
    "Replan",
    "ResidualFigure",
]

BackendName = Annotated[
    str | None,
    typer.Option(
        "--with",
        help=f"Backend: {', '.join(BACKENDS[:-1])} or {BACKENDS[-1]}. [default: {BACKENDS[0]}]",
        autocompletion=complete_backend,
    ),
]
BackendOptions = Annotated[
    list[str] | None,
    typer.Option("--option", help="Option of the backend; repeatable."),
]
Replan = Annotated[
    str | None,
    typer.Option(
        "--replan",
        help="Planner that replans at every step, or none. [default: certified]",
        autocompletion=complete_replan,
    ),
]
Missions = Annotated[
    int | None, typer.Option("--missions", min=1, help="Number of missions. [default: 1]")
]
Deadline = Annotated[
    float | None,
    typer.Option(
        "--deadline",
        min=0.0,
        help="Seconds for each decision. [default: the planner's limit, 60 for certified]",
    ),
]
FlightSeed = Annotated[
    int | None,
    typer.Option("--seed", min=0, help="Seed of all noise and of every plan. [default: 0]"),
]
FlightOutput = Annotated[
    Path | None, typer.Option("-o", "--output", help="Write the flight file here, step by step.")
]
FlightLog = Annotated[
    Path | None,
    typer.Option("--log", help="Write a log for other tools and for identify here: .mcap."),
]
FlightFilm = Annotated[
    Path | None, typer.Option("--film", help="Film the flight here: .gif, or .mp4 with ffmpeg.")
]
Logs = Annotated[
    list[Path],
    typer.Argument(
        metavar="LOG",
        help="CSV, MCAP, PX4 ULog or ROS 2 bag; several are evaluated together.",
        autocompletion=complete_log,
    ),
]
NoiseOutput = Annotated[
    Path | None,
    typer.Option(
        "-o", "--output", help="Write the noise here, as YAML; with --scenario, the copy."
    ),
]
NoiseScenario = Annotated[
    Path | None,
    typer.Option(
        "--scenario",
        help="Write the noise into a copy of this scenario.",
        autocompletion=complete_scenario,
    ),
]
Columns = Annotated[
    str | None, typer.Option("--columns", help="Column names in CSV: time=t,x=east,y=north.")
]
ResidualFigure = Annotated[
    Path | None, typer.Option("--plot", help="Draw the residuals here: .png, .pdf or .svg.")
]
