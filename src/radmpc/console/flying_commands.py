"""The commands that fly plans and learn from what was flown: `fly`, `calibrate`, `identify`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from radmpc.console import arguments as given
from radmpc.console import flight_arguments as flown
from radmpc.console.completing import complete_backend

__all__ = ["add_flying"]


def add_flying(app: typer.Typer) -> None:
    """Add the commands to the command line.

    Parameters
    ----------
    app : Typer
        The command line.
    """
    app.command()(fly)
    app.command()(calibrate)
    app.command("identify")(identify_noise)


def fly(
    plan_file: given.FlownFile,
    backend: flown.BackendName = None,
    replan: flown.Replan = None,
    missions: flown.Missions = None,
    deadline: flown.Deadline = None,
    seed: flown.FlightSeed = None,
    option: flown.BackendOptions = None,
    output: flown.FlightOutput = None,
    log: flown.FlightLog = None,
    film: flown.FlightFilm = None,
    as_json: given.AsJson = False,
) -> int:
    """Fly a plan and replan at every step from the measured states."""
    from radmpc.console.commands.flying import FlyRequest, run_fly

    options = tuple(option or ())
    return run_fly(
        FlyRequest(
            plan_file,
            backend,
            replan,
            missions,
            deadline,
            seed,
            options,
            output,
            log,
            film,
            as_json,
        )
    )


def identify_noise(
    logs: flown.Logs,
    output: flown.NoiseOutput = None,
    scenario: flown.NoiseScenario = None,
    dt: Annotated[
        float | None, typer.Option("--dt", help="Step [s]. [default: the scenario's, or the logs']")
    ] = None,
    columns: flown.Columns = None,
    plot: flown.ResidualFigure = None,
    as_json: given.AsJson = False,
) -> int:
    """Identify noise and feedback from logs."""
    from radmpc.console.commands.identifying import IdentifyRequest, run_identify

    return run_identify(IdentifyRequest(tuple(logs), output, scenario, dt, columns, plot, as_json))


def calibrate(
    plan_file: given.PlanFile,
    backend: Annotated[
        str,
        typer.Option("--with", help="Simulator: boat, …", autocompletion=complete_backend),
    ],
    output: given.ScenarioOutput,
    plan_output: Annotated[
        Path | None,
        typer.Option("--plan", help="Plan that scenario, fly the plan, and write it here."),
    ] = None,
    missions: Annotated[int, typer.Option("--missions", min=1, help="Number of missions.")] = 20,
    seed: given.Seed = 0,
    option: flown.BackendOptions = None,
    as_json: given.AsJson = False,
) -> int:
    """Identify noise from missions of a plan in a simulator."""
    from radmpc.console.commands.calibrating import CalibrateRequest, run_calibrate

    options = tuple(option or ())
    return run_calibrate(
        CalibrateRequest(plan_file, backend, output, plan_output, missions, seed, options, as_json)
    )
