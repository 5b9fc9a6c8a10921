"""The command line: parse, call, print, exit code. No algorithm, no default of its own.

Commands import what they run: neither the shell's completion nor `--version` waits for solvers.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from radmpc.console import arguments as given
from radmpc.console.flying_commands import add_flying
from radmpc.console.output import show, show_json
from radmpc.console.plain_help import PlainCommand
from radmpc.console.running.deferring import defer
from radmpc.console.running.guard import Code, GuardedCommands
from radmpc.console.serving_commands import add_serving
from radmpc.version import __version__

__all__ = ["app", "main"]

app = typer.Typer(
    cls=GuardedCommands,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Plan fleets whose joint risk of any collision stays within one bound.",
    epilog="Exit codes: 0 yes, 1 no (no plan, or not within the bound), 2 bad input, 3 defect.",
)


def main() -> None:
    """Run the command line and exit the process with its code."""
    app()


def _print_version(is_asked: bool) -> None:
    """Print the version and stop."""
    if is_asked:
        show(f"radmpc {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
    debug: Annotated[
        bool,
        typer.Option("--debug", help="Show tracebacks; accepted anywhere on the command line."),
    ] = False,
) -> None:
    """Plan fleets whose joint risk of any collision stays within one bound."""
    # The guard around all commands reads --debug; it stands here for the help text.
    del version, debug
    defer("numpy", "f2py", "testing")


@app.command()
def plan(
    scenario: given.ScenarioFile,
    planner: given.PlannerName = None,
    seed: given.Seed = 0,
    time_limit: given.PlanningSeconds = None,
    jobs: given.Jobs = 1,
    dask: given.DaskAddress = None,
    output: given.PlanOutput = None,
    figure: given.PlanFigure = None,
    ledger: given.LedgerFigure = None,
    animation: given.Film = None,
    verbose: given.Verbose = False,
    as_json: given.AsJson = False,
    settings: given.Settings = None,
    gap: given.ProvenGap = None,
) -> int:
    """Plan a scenario; -o writes the plan."""
    defer("numpy", "ma", "polynomial")  # before scipy asks for them
    from radmpc.console.commands.plan_command import Request, check_request, run_plan
    from radmpc.console.loading import read_scenario
    from radmpc.console.settings import changes_of
    from radmpc.planners.presets import DEFAULT

    planner = DEFAULT if planner is None else planner
    request = Request(
        planner, seed, time_limit, jobs, output, figure, as_json, ledger, dask, verbose, animation,
        scenario, gap,
    )  # fmt: skip
    check_request(request)
    return run_plan(read_scenario(scenario, changes_of(settings)), request)


@app.command("compare")
def compare_planners(
    scenario: given.ScenarioFile,
    planners: given.PlannerNames = None,
    seed: given.Seed = 0,
    time_limit: given.PlannerSeconds = None,
    samples: given.Samples = 100_000,
    jobs: given.Jobs = 1,
    dask: given.DaskAddress = None,
    figure: given.PanelFigure = None,
    as_json: given.AsJson = False,
    settings: given.Settings = None,
) -> int:
    """Plan one scenario with several planners, side by side."""
    from radmpc.console.commands.comparing import CompareRequest, check_compare, run_compare
    from radmpc.console.loading import read_scenario
    from radmpc.console.settings import changes_of
    from radmpc.planners.presets import COMPARED

    words = COMPARED if planners is None else planners.split(",")
    names = tuple(word.strip() for word in words if word.strip())
    request = CompareRequest(names, seed, time_limit, samples, jobs, dask, figure, as_json)
    check_compare(request)
    return run_compare(read_scenario(scenario, changes_of(settings)), request)


@app.command("sweep")
def sweep_scenario(
    scenario: given.ScenarioFile,
    over: given.Axes,
    planner: given.PlannerName = None,
    seed: given.Seed = 0,
    time_limit: given.SweepSeconds = None,
    gap: given.ProvenGap = None,
    jobs: given.Jobs = 1,
    output: given.SweepTable = None,
    figure: given.SweepFigure = None,
    as_json: given.AsJson = False,
) -> int:
    """Plan one scenario for many values of its keys."""
    from radmpc.console.commands.sweeping import SweepRequest, run_sweep
    from radmpc.console.settings import axes_of
    from radmpc.planners.presets import DEFAULT

    planner = DEFAULT if planner is None else planner
    return run_sweep(
        SweepRequest(
            scenario, axes_of(over), planner, seed, time_limit, gap, jobs, output, figure, as_json
        )
    )


@app.command()
def new(kind: given.Template = None, output: given.NewScenario = None) -> int:
    """Write a commented scenario to start from."""
    from radmpc.console.commands.starting import run_new

    return run_new(kind, output)


@app.command()
def reproduce(
    out: Annotated[Path, typer.Option("--out", help="Folder for rows, report and figures.")],
    quick: Annotated[
        bool, typer.Option("--quick", help="Run a small sample, in a few minutes.")
    ] = False,
    jobs: given.Jobs = 1,
    dask: given.DaskAddress = None,
    cap: given.StudyCap = None,
    budget: given.StudySeconds = None,
    seeds: given.StudySeeds = None,
    method: given.Methods = None,
    report_only: Annotated[
        bool,
        typer.Option("--report-only", help="Only write tables and figures of the existing rows."),
    ] = False,
) -> int:
    """Rerun the paper's experiments.

    Resumes where an interrupted run stopped.
    """
    from radmpc.console.commands.reproducing import StudyRequest, run_reproduction

    return run_reproduction(
        StudyRequest(out, quick, jobs, dask, cap, budget, seeds, tuple(method or ()), report_only)
    )


@app.command()
def check(
    scenario: given.ScenarioFile,
    as_json: given.AsJson = False,
    settings: given.Settings = None,
) -> int:
    """Check whether a scenario is valid, and what rules out a plan.

    The exit code is 0 for every valid scenario, even if it has no plan.
    """
    from radmpc.console.commands.check import run_check
    from radmpc.console.loading import read_scenario
    from radmpc.console.settings import changes_of

    return run_check(read_scenario(scenario, changes_of(settings)), as_json=as_json)


@app.command()
def verify(
    plan_file: given.JudgedFile,
    samples: given.Samples = 100_000,
    seed: given.Seed = 0,
    avoidance: given.JudgedAvoidance = None,
    as_json: given.AsJson = False,
) -> int:
    """Verify a plan or a flight from its file alone."""
    from radmpc.console.commands.verifying import run_verify

    return run_verify(plan_file, samples, seed, avoidance, as_json=as_json)


@app.command()
def planners(as_json: given.AsJson = False) -> int:
    """List the planners and what they consist of."""
    from radmpc.console.commands.listing import planner_table, planners_json

    if as_json:
        show_json(planners_json())
    else:
        show(planner_table())
    return Code.OK


@app.command("import")
def import_file(
    sources: given.ForeignFiles,
    output: given.ScenarioOutput,
    dt: Annotated[float | None, typer.Option("--dt", help="Step [s].")] = None,
    horizon: Annotated[int | None, typer.Option("--horizon", help="Number of steps.")] = None,
    noise: given.Noise = None,
    risk_bound: given.RiskBound = None,
    radius: given.Radius = None,
    avoidance: given.AvoidanceName = None,
    agents: given.Agents = None,
    layer: given.Layers = None,
) -> int:
    """Import another format; print what had to be assumed."""
    from radmpc.console.commands.importing import run_import

    options = {
        "dt": dt,
        "horizon": horizon,
        "noise": noise,
        "risk_bound": risk_bound,
        "radius": radius,
        "avoidance": avoidance,
        "agents": agents,
        "layer": layer or (),
    }
    return run_import(sources, output, options)


add_flying(app)
add_serving(app)


@app.command()
def draw(source: given.DrawnFile, output: given.DrawnOutput, view: given.View = None) -> int:
    """Draw or film a scenario, a plan or a flight."""
    from radmpc.console.commands.drawing import run_draw

    return run_draw(source, view, output)


@app.command()
def export(
    plan_file: given.PlanFile,
    to: given.ExportFormat,
    output: Annotated[Path, typer.Option("-o", "--output", help="Write the export here.")],
    origin: given.PlaceOnEarth = None,
    altitude: given.Altitude = None,
    tolerance: given.Tolerance = None,
    risk_bound: given.ThinnedRiskBound = None,
) -> int:
    """Export a plan for the vehicles' own tools."""
    from radmpc.console.commands.exporting import ExportRequest, run_export
    from radmpc.console.loading import read_plan

    request = ExportRequest(plan_file, to, output, origin, altitude, tolerance, risk_bound)
    return run_export(read_plan(plan_file), request)


@app.command()
def demo(
    out: Annotated[Path, typer.Option("--out", help="Folder for scenario, plan and picture.")] = (
        Path("out")
    ),
) -> int:
    """Plan and draw the shipped scenario."""
    from radmpc.console.commands.demo import run_demo

    return run_demo(out)


for _command in app.registered_commands:
    _command.cls = PlainCommand
