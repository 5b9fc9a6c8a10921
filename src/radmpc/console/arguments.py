"""Arguments and options of the commands: types, limits, help and what the shell completes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from radmpc.console.completing import (
    FORMATS,
    complete_drawn,
    complete_format,
    complete_plan,
    complete_plan_or_flight,
    complete_planner,
    complete_planners,
    complete_scenario,
    complete_template,
    complete_view,
)
from radmpc.data import TEMPLATES

__all__ = [
    "Agents",
    "Altitude",
    "AsJson",
    "AvoidanceName",
    "Axes",
    "DaskAddress",
    "DrawnFile",
    "DrawnOutput",
    "ExportFormat",
    "Film",
    "FlownFile",
    "ForeignFiles",
    "Jobs",
    "JudgedAvoidance",
    "JudgedFile",
    "Layers",
    "LedgerFigure",
    "Methods",
    "NewScenario",
    "Noise",
    "PanelFigure",
    "PlaceOnEarth",
    "PlanFigure",
    "PlanFile",
    "PlanOutput",
    "PlannerName",
    "PlannerNames",
    "PlannerSeconds",
    "PlanningSeconds",
    "ProvenGap",
    "Radius",
    "RiskBound",
    "Samples",
    "ScenarioFile",
    "ScenarioOutput",
    "Seed",
    "Settings",
    "StudyCap",
    "StudySeconds",
    "StudySeeds",
    "SweepFigure",
    "SweepSeconds",
    "SweepTable",
    "Template",
    "ThinnedRiskBound",
    "Tolerance",
    "Verbose",
    "View",
]

ScenarioFile = Annotated[
    Path,
    typer.Argument(
        metavar="SCENARIO", help="Scenario file, YAML or JSON.", autocompletion=complete_scenario
    ),
]
PlanFile = Annotated[
    Path, typer.Argument(metavar="PLAN", help="Plan file, JSON.", autocompletion=complete_plan)
]
JudgedFile = Annotated[
    Path,
    typer.Argument(
        metavar="PLAN",
        help="Plan file, JSON; or a flight file.",
        autocompletion=complete_plan_or_flight,
    ),
]
FlownFile = Annotated[
    Path,
    typer.Argument(
        metavar="PLAN",
        help="Plan file, JSON; or a flight file, to resume that flight.",
        autocompletion=complete_plan_or_flight,
    ),
]
ForeignFiles = Annotated[
    list[Path],
    typer.Argument(metavar="FILE", help="Problem in another format; of charts, one or several."),
]
Layers = Annotated[
    list[str] | None,
    typer.Option(
        "--layer",
        metavar="NAME[=ROLE]",
        help="Read only this layer of the charts, in this role; repeatable.",
    ),
]

PlannerName = Annotated[
    str | None,
    typer.Option(
        "--planner",
        help="A name from 'radmpc planners'. [default: certified]",
        autocompletion=complete_planner,
    ),
]
PlannerNames = Annotated[
    str | None,
    typer.Option(
        "--planners",
        help="Names, separated by commas. "
        "[default: rmpc-rrt,distance,radmpc,multi-vehicle,certified]",
        autocompletion=complete_planners,
    ),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of every random choice.")]
PlanningSeconds = Annotated[
    float | None,
    typer.Option(
        "--time-limit",
        min=0.0,
        help="Seconds until planning ends with the best plan so far. "
        "[default: 60 for certified, else none]",
    ),
]
PlannerSeconds = Annotated[
    float | None,
    typer.Option("--time-limit", min=0.0, help="Seconds for each planner, as in plan."),
]
Samples = Annotated[int, typer.Option("--samples", min=1, help="Number of missions to simulate.")]
Jobs = Annotated[int, typer.Option("--jobs", min=1, help="Number of processes.")]
DaskAddress = Annotated[
    str | None, typer.Option("--dask", help="Address of a Dask scheduler to plan on.")
]

PlanOutput = Annotated[
    Path | None, typer.Option("-o", "--output", help="Write the plan here, as JSON.")
]
ScenarioOutput = Annotated[Path, typer.Option("-o", "--output", help="Write the scenario here.")]
PlanFigure = Annotated[
    Path | None, typer.Option("--figure", help="Draw the plan here: .png, .pdf or .svg.")
]
PanelFigure = Annotated[
    Path | None, typer.Option("--figure", help="Draw a panel per planner here: .png, .pdf or .svg.")
]
LedgerFigure = Annotated[
    Path | None, typer.Option("--ledger", help="Draw the risk ledger here: .png, .pdf or .svg.")
]
Film = Annotated[
    Path | None, typer.Option("--animation", help="Film the plan here: .gif, or .mp4 with ffmpeg.")
]
DrawnFile = Annotated[
    Path,
    typer.Argument(
        metavar="FILE", help="Scenario, plan or flight file.", autocompletion=complete_drawn
    ),
]
DrawnOutput = Annotated[
    Path,
    typer.Option(
        "-o",
        "--output",
        help="Draw here: .png, .pdf or .svg; film here: .gif, or .mp4 with ffmpeg.",
    ),
]
View = Annotated[
    str | None,
    typer.Option(
        "--view",
        help="plan, ledger, couplings, distances or risk. [default: plan]",
        autocompletion=complete_view,
    ),
]
ExportFormat = Annotated[
    str,
    typer.Option(
        "--to",
        help=f"Format: {', '.join(FORMATS[:-1])} or {FORMATS[-1]}.",
        autocompletion=complete_format,
    ),
]
Verbose = Annotated[bool, typer.Option("-v", "--verbose", help="Report the stages on stderr.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Override a key of the scenario: risk_bound=0.02; repeatable.",
    ),
]
ProvenGap = Annotated[
    float | None,
    typer.Option("--gap", help="Relative gap at which the search ends. [default: 0.001]"),
]
Axes = Annotated[
    list[str],
    typer.Option(
        "--over",
        metavar="KEY=VALUE,...",
        help="A key and its values: risk_bound=0.01,0.05; noise scales all noise; repeatable.",
    ),
]
SweepTable = Annotated[
    Path | None,
    typer.Option(
        "-o", "--output", help="Write the rows here, as CSV; an existing file is resumed."
    ),
]
SweepFigure = Annotated[
    Path | None, typer.Option("--figure", help="Draw the costs as curves here: .png, .pdf or .svg.")
]
SweepSeconds = Annotated[
    float | None,
    typer.Option("--time-limit", min=0.0, help="Seconds for each scenario, as in plan."),
]
Template = Annotated[
    str | None,
    typer.Argument(
        metavar="KIND",
        help=f"Kind of scenario: {', '.join(TEMPLATES[:-1])} or {TEMPLATES[-1]}.",
        autocompletion=complete_template,
    ),
]
NewScenario = Annotated[
    Path | None, typer.Option("-o", "--output", help="Write the scenario here. [default: stdout]")
]
AsJson = Annotated[
    bool, typer.Option("--json", help="Print one JSON object on stdout and nothing else.")
]

StudyCap = Annotated[
    float | None, typer.Option("--cap", min=0.1, help="Seconds per problem. [default: 60]")
]
StudySeconds = Annotated[
    float | None,
    typer.Option("--budget", min=0.0, help="Seconds for each mixed-integer solver. [default: 600]"),
]
StudySeeds = Annotated[
    int | None,
    typer.Option("--seeds", min=1, help="Number of problems of each size. [default: 50]"),
]
Methods = Annotated[
    list[str] | None, typer.Option("--method", help="Run only this method; repeatable.")
]
Noise = Annotated[
    float | None,
    typer.Option("--noise", help="Standard deviation of the position noise per step [m]."),
]
Radius = Annotated[float | None, typer.Option("--radius", help="Hull radius of every vehicle [m].")]
RiskBound = Annotated[
    float | None, typer.Option("--risk-bound", help="Risk bound of the scenario.")
]
ThinnedRiskBound = Annotated[
    float | None,
    typer.Option("--risk-bound", help="Risk bound for --tolerance. [default: the plan's]"),
]
Agents = Annotated[
    int | None, typer.Option("--agents", help="Import only the first N vehicles. [default: all]")
]
AvoidanceName = Annotated[
    str | None, typer.Option("--avoidance", help="Where collisions count. [default: intervals]")
]
JudgedAvoidance = Annotated[
    str | None,
    typer.Option("--avoidance", help="Where collisions count. [default: as planned]"),
]
PlaceOnEarth = Annotated[
    str | None,
    typer.Option(
        "--origin",
        help="Latitude, longitude and height of the plan's origin: LAT,LON[,HEIGHT] [degrees, m].",
    ),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        "--tolerance",
        help="Leave out steps that straight legs pass within this distance [m], as far as the "
        "certificate stays within the risk bound.",
    ),
]
Altitude = Annotated[
    float | None,
    typer.Option("--altitude", help="Height of a 2-D plan above the origin [m]. [default: 0]"),
]
