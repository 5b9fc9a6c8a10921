"""Arguments and options of the commands: types, limits, help and what the shell completes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from radmpc.console.completing import (
    FORMATS,
    complete_drawn,
    complete_format,
    complete_log,
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
    "Columns",
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
    "Logs",
    "Methods",
    "NewScenario",
    "Noise",
    "NoiseOutput",
    "NoiseScenario",
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
    "ResidualFigure",
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
    "Tolerance",
    "Verbose",
    "View",
]

ScenarioFile = Annotated[
    Path,
    typer.Argument(
        metavar="SCENARIO", help="Scenario, YAML or JSON.", autocompletion=complete_scenario
    ),
]
PlanFile = Annotated[
    Path, typer.Argument(metavar="PLAN", help="Plan, JSON.", autocompletion=complete_plan)
]
JudgedFile = Annotated[
    Path,
    typer.Argument(
        metavar="PLAN", help="Plan, JSON; or a flight.", autocompletion=complete_plan_or_flight
    ),
]
FlownFile = Annotated[
    Path,
    typer.Argument(
        metavar="PLAN",
        help="Plan, JSON; or a flight, to go on with it.",
        autocompletion=complete_plan_or_flight,
    ),
]
ForeignFiles = Annotated[
    list[Path],
    typer.Argument(metavar="FILE", help="A problem in another format; charts may be several."),
]
Layers = Annotated[
    list[str] | None,
    typer.Option(
        "--layer",
        metavar="NAME[=ROLE]",
        help="Of charts, take only this layer, and what it stands for; may be given several times.",
    ),
]

PlannerName = Annotated[
    str | None,
    typer.Option(
        "--planner",
        help="A name from 'radmpc planners' (certified).",
        autocompletion=complete_planner,
    ),
]
PlannerNames = Annotated[
    str | None,
    typer.Option(
        "--planners",
        help="Names, with commas between them (five, one for each idea).",
        autocompletion=complete_planners,
    ),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of every random choice.")]
PlanningSeconds = Annotated[
    float | None,
    typer.Option("--time-limit", min=0.0, help="Seconds, then the best so far (certified: 60)."),
]
PlannerSeconds = Annotated[
    float | None, typer.Option("--time-limit", min=0.0, help="Seconds for each planner.")
]
Samples = Annotated[int, typer.Option("--samples", min=1, help="Samples to simulate.")]
Jobs = Annotated[int, typer.Option("--jobs", min=1, help="Processes for separate parts.")]
DaskAddress = Annotated[
    str | None, typer.Option("--dask", help="Address of a Dask scheduler to plan on.")
]

PlanOutput = Annotated[
    Path | None, typer.Option("-o", "--output", help="Write the plan here, as JSON.")
]
ScenarioOutput = Annotated[Path, typer.Option("-o", "--output", help="Write the scenario here.")]
PlanFigure = Annotated[
    Path | None, typer.Option("--figure", help="Draw it here: .png, .pdf or .svg.")
]
PanelFigure = Annotated[
    Path | None, typer.Option("--figure", help="A panel per planner: .png, .pdf or .svg.")
]
LedgerFigure = Annotated[
    Path | None, typer.Option("--ledger", help="Draw where the risk goes, likewise.")
]
Film = Annotated[
    Path | None, typer.Option("--animation", help="Film it here: .gif, or .mp4 with ffmpeg.")
]
DrawnFile = Annotated[
    Path,
    typer.Argument(metavar="FILE", help="Scenario, plan or flight.", autocompletion=complete_drawn),
]
DrawnOutput = Annotated[
    Path, typer.Option("-o", "--output", help="Picture .png, .pdf, .svg, or film .gif, .mp4.")
]
View = Annotated[
    str | None,
    typer.Option(
        "--view",
        help="plan, ledger, couplings, distances or risk (plan).",
        autocompletion=complete_view,
    ),
]
ExportFormat = Annotated[
    str,
    typer.Option(
        "--to",
        help=f"{', '.join(FORMATS[:-1])} or {FORMATS[-1]}.",
        autocompletion=complete_format,
    ),
]
Verbose = Annotated[
    bool, typer.Option("-v", "--verbose", help="Tell the stages on stderr as they go.")
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Instead of the file's: risk_bound=0.02; repeatable."
    ),
]
ProvenGap = Annotated[
    float | None, typer.Option("--gap", help="Relative gap that ends the search (0.001).")
]
Axes = Annotated[
    list[str],
    typer.Option(
        "--over",
        metavar="KEY=VALUE,...",
        help="A key and its values: risk_bound=0.01,0.05; 'noise' scales all; repeatable.",
    ),
]
SweepTable = Annotated[
    Path | None, typer.Option("-o", "--output", help="Rows as CSV; an existing file is resumed.")
]
SweepFigure = Annotated[
    Path | None, typer.Option("--figure", help="Costs as curves: .png, .pdf or .svg.")
]
SweepSeconds = Annotated[
    float | None, typer.Option("--time-limit", min=0.0, help="Seconds for each scenario.")
]
Template = Annotated[
    str | None,
    typer.Argument(
        metavar="KIND",
        help=f"{', '.join(TEMPLATES[:-1])} or {TEMPLATES[-1]}.",
        autocompletion=complete_template,
    ),
]
NewScenario = Annotated[
    Path | None, typer.Option("-o", "--output", help="Write it here (on the screen).")
]
AsJson = Annotated[bool, typer.Option("--json", help="One JSON object on stdout, nothing else.")]

StudyCap = Annotated[float | None, typer.Option("--cap", min=0.1, help="Seconds per problem (60).")]
StudySeconds = Annotated[
    float | None,
    typer.Option("--budget", min=0.0, help="Seconds for each mixed-integer solver (600)."),
]
StudySeeds = Annotated[
    int | None, typer.Option("--seeds", min=1, help="Problems of each size (50).")
]
Methods = Annotated[
    list[str] | None, typer.Option("--method", help="Run this method only; may be repeated.")
]
Noise = Annotated[
    float | None, typer.Option("--noise", help="Position noise per step, std. dev. [m].")
]
Logs = Annotated[
    list[Path],
    typer.Argument(
        metavar="LOG",
        help="CSV, MCAP, PX4 ULog or ROS 2 bag; several count together.",
        autocompletion=complete_log,
    ),
]
NoiseOutput = Annotated[
    Path | None,
    typer.Option("-o", "--output", help="Write the noise here, as YAML, or the scenario."),
]
NoiseScenario = Annotated[
    Path | None,
    typer.Option("--scenario", help="Give this one the noise.", autocompletion=complete_scenario),
]
Columns = Annotated[
    str | None, typer.Option("--columns", help="Names in CSV: time=t,x=east,y=north.")
]
ResidualFigure = Annotated[
    Path | None, typer.Option("--plot", help="Draw the residuals here: .png, .pdf or .svg.")
]
RiskBound = Annotated[float | None, typer.Option("--risk-bound", help="Joint risk of the fleet.")]
Agents = Annotated[int | None, typer.Option("--agents", help="How many vehicles to take.")]
AvoidanceName = Annotated[
    str | None, typer.Option("--avoidance", help="Where collisions count (the problem's).")
]
JudgedAvoidance = Annotated[
    str | None,
    typer.Option("--avoidance", help="Where collisions count (as planned)."),
]
PlaceOnEarth = Annotated[
    str | None,
    typer.Option("--origin", help="Of the plan's origin: LAT,LON[,HEIGHT] [degrees, m]."),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        "--tolerance",
        help="Leave out steps that straight legs pass within this distance [m], as certified.",
    ),
]
Altitude = Annotated[
    float | None,
    typer.Option("--altitude", help="Of a 2-D plan above the origin [m] (0)."),
]
