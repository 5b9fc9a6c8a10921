"""The command line: parse, call, print, exit code. No algorithm, no default of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from radmpc.console.comparing import CompareRequest, check_compare, run_compare
from radmpc.console.demo import run_demo
from radmpc.console.exporting import ExportRequest, run_export
from radmpc.console.files import check_output, writing
from radmpc.console.guard import Code, GuardedCommands
from radmpc.console.listing import planner_table, planners_json
from radmpc.console.output import show, show_json
from radmpc.console.planning import Request, check_request, run_plan
from radmpc.console.report import facts, scenario_line
from radmpc.console.reproducing import StudyRequest, run_reproduction
from radmpc.console.verifying import verify_plan, verify_report
from radmpc.io.importing import ImportOptions, import_scenario
from radmpc.io.plan_file import load_plan
from radmpc.io.scenario_file import load_scenario, save_scenario
from radmpc.planners.presets import COMPARED, DEFAULT
from radmpc.version import __version__

__all__ = ["app", "main"]

app = typer.Typer(
    cls=GuardedCommands,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Plan fleets whose joint risk of any collision stays within one bound.",
    epilog="Exit codes: 0 yes, 1 no (no plan, or not within the bound), 2 bad input, 3 defect.",
)

ScenarioFile = Annotated[Path, typer.Argument(metavar="SCENARIO", help="Scenario, YAML or JSON.")]
PlanFile = Annotated[Path, typer.Argument(metavar="PLAN", help="Plan, JSON.")]
PlannerName = Annotated[str, typer.Option("--planner", help="A name from 'radmpc planners'.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of every random choice.")]
Jobs = Annotated[int, typer.Option("--jobs", min=1, help="Processes for separate parts.")]
DaskAddress = Annotated[
    str | None, typer.Option("--dask", help="Address of a Dask scheduler to plan on.")
]
Samples = Annotated[int, typer.Option("--samples", min=1, help="Simulated missions.")]
AsJson = Annotated[bool, typer.Option("--json", help="One JSON object on stdout, nothing else.")]


def main() -> None:
    """Run the command line and exit the process with its code."""
    app()


def _print_version(is_wanted: bool) -> None:
    """Print the version and stop."""
    if is_wanted:
        show(f"radmpc {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print it and exit."
        ),
    ] = False,
    debug: Annotated[
        bool, typer.Option("--debug", help="Show tracebacks; may stand anywhere on the line.")
    ] = False,
) -> None:
    """Plan fleets whose joint risk of any collision stays within one bound."""
    # The guard around all commands reads --debug; it stands here for the help text.
    del version, debug


@app.command()
def plan(
    scenario: ScenarioFile,
    planner: PlannerName = DEFAULT,
    seed: Seed = 0,
    time_limit: Annotated[
        float | None,
        typer.Option(
            "--time-limit", min=0.0, help="Seconds, then the best so far (certified: 60)."
        ),
    ] = None,
    jobs: Jobs = 1,
    dask: DaskAddress = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Write the plan here, as JSON.")
    ] = None,
    figure: Annotated[
        Path | None, typer.Option("--figure", help="Draw it here: .png, .pdf or .svg.")
    ] = None,
    ledger: Annotated[
        Path | None, typer.Option("--ledger", help="Draw where the risk goes, likewise.")
    ] = None,
    verbose: Annotated[
        bool, typer.Option("-v", "--verbose", help="Tell the stages on stderr as they go.")
    ] = False,
    as_json: AsJson = False,
) -> int:
    """Plan a scenario; write it where -o says."""
    request = Request(
        planner, seed, time_limit, jobs, output, figure, as_json, ledger, dask, verbose
    )
    check_request(request)
    return run_plan(load_scenario(scenario), request)


@app.command("compare")
def compare_planners(
    scenario: ScenarioFile,
    planners: Annotated[
        str, typer.Option("--planners", help="Names, with commas between them.")
    ] = ",".join(COMPARED),
    seed: Seed = 0,
    time_limit: Annotated[
        float | None, typer.Option("--time-limit", min=0.0, help="Seconds for each planner.")
    ] = None,
    samples: Samples = 100_000,
    jobs: Jobs = 1,
    dask: DaskAddress = None,
    figure: Annotated[
        Path | None, typer.Option("--figure", help="A panel per planner: .png, .pdf or .svg.")
    ] = None,
    as_json: AsJson = False,
) -> int:
    """Plan one scenario with several planners, side by side."""
    names = tuple(name.strip() for name in planners.split(",") if name.strip())
    request = CompareRequest(names, seed, time_limit, samples, jobs, dask, figure, as_json)
    check_compare(request)
    return run_compare(load_scenario(scenario), request)


@app.command()
def reproduce(
    out: Annotated[Path, typer.Option("--out", help="Folder of rows, report and figures.")],
    quick: Annotated[
        bool, typer.Option("--quick", help="A small sample, in a few minutes.")
    ] = False,
    jobs: Jobs = 1,
    dask: DaskAddress = None,
    cap: Annotated[
        float | None, typer.Option("--cap", min=0.1, help="Seconds per problem (60).")
    ] = None,
    budget: Annotated[
        float | None,
        typer.Option("--budget", min=0.0, help="Seconds for each mixed-integer solver (600)."),
    ] = None,
    seeds: Annotated[
        int | None, typer.Option("--seeds", min=1, help="Problems of each size (50).")
    ] = None,
    method: Annotated[
        list[str] | None, typer.Option("--method", help="Run this method only; may be repeated.")
    ] = None,
    report_only: Annotated[
        bool, typer.Option("--report-only", help="Write tables and figures of the rows there are.")
    ] = False,
) -> int:
    """Do the paper's experiments again; killed and started again it goes on."""
    return run_reproduction(
        StudyRequest(out, quick, jobs, dask, cap, budget, seeds, tuple(method or ()), report_only)
    )


@app.command()
def check(scenario: ScenarioFile) -> int:
    """Say whether a scenario file is valid."""
    show(f"valid: {scenario_line(load_scenario(scenario))}")
    return Code.OK


@app.command()
def verify(
    plan_file: PlanFile,
    samples: Samples = 100_000,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> int:
    """Certify and simulate a plan, from its file alone."""
    record = load_plan(plan_file)
    verification = verify_plan(record, samples, seed)
    if as_json:
        show_json(verification.as_json())
    else:
        show(*verify_report(record, verification))
    return Code.OK if verification.holds else Code.NO


@app.command()
def planners(as_json: AsJson = False) -> int:
    """List the planners and their choices."""
    if as_json:
        show_json(planners_json())
    else:
        show(planner_table())
    return Code.OK


@app.command("import")
def import_file(
    source: Annotated[Path, typer.Argument(metavar="FILE", help="A problem in another format.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Write the scenario here.")],
    dt: Annotated[float | None, typer.Option("--dt", help="Step [s].")] = None,
    horizon: Annotated[int | None, typer.Option("--horizon", help="Number of steps.")] = None,
    noise: Annotated[
        float | None, typer.Option("--noise", help="Position noise per step, std. dev. [m].")
    ] = None,
    risk_bound: Annotated[
        float | None, typer.Option("--risk-bound", help="Joint risk of the fleet.")
    ] = None,
    radius: Annotated[float | None, typer.Option("--radius", help="Of every vehicle [m].")] = None,
    avoidance: Annotated[
        str | None, typer.Option("--avoidance", help="'intervals' or 'steps'.")
    ] = None,
) -> int:
    """Import another format; print what had to be chosen."""
    check_output(output)
    options = ImportOptions(
        dt=dt,
        horizon=horizon,
        noise=noise,
        risk_bound=risk_bound,
        radius=radius,
        avoidance=avoidance,
    )
    imported = import_scenario(source, options)
    with writing(output):
        save_scenario(imported.scenario, output)
    show(scenario_line(imported.scenario))
    show(facts({name: str(value) for name, value in imported.choices.items()}))
    for warning in imported.warnings:
        show(f"warning: {warning}")
    show(f"scenario written to {output}")
    return Code.OK


@app.command()
def export(
    plan_file: PlanFile,
    to: Annotated[str, typer.Option("--to", help="qgc, waypoints, geojson, kml, mcap or csv.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Write it here.")],
    origin: Annotated[
        str | None,
        typer.Option("--origin", help="LAT,LON[,HEIGHT] of the plan's origin [degrees, m]."),
    ] = None,
    altitude: Annotated[
        float | None,
        typer.Option("--altitude", help="Of a 2-D plan above the origin [m] (0)."),
    ] = None,
) -> int:
    """Write a plan for the vehicles' own tools."""
    request = ExportRequest(plan_file, to, output, origin, altitude)
    return run_export(load_plan(plan_file), request)


@app.command()
def demo(
    out: Annotated[Path, typer.Option("--out", help="Folder for scenario, plan and picture.")] = (
        Path("out")
    ),
) -> int:
    """Plan the shipped scenario and draw it."""
    return run_demo(out)
