"""Fast chance-constrained path planning for fleets, with a certificate.

Examples
--------
>>> import radmpc
>>> from radmpc.experiments.families import paper
>>> result = radmpc.plan(paper(2, seed=1), "multi-vehicle", rng=0)
>>> result.is_certified
True
>>> round(result.cost, 2)
3.6
"""

from __future__ import annotations

import logging
import sys
from typing import TYPE_CHECKING

from radmpc.front import late_names
from radmpc.version import __version__

if TYPE_CHECKING:
    from radmpc.errors import (
        ArgumentError,
        ArgumentTypeError,
        FileFormatError,
        NoPlanError,
        RadmpcError,
        RiskError,
        ScenarioError,
        SolverError,
    )
    from radmpc.flying.flight import Flight, fly
    from radmpc.flying.mission import Mission
    from radmpc.flying.model import Model
    from radmpc.flying.receding.long_mission import LongMission
    from radmpc.flying.recording.campaign import begin_flight, resume_flight
    from radmpc.flying.tick import Contact, Tick
    from radmpc.geodesy import Origin
    from radmpc.identification import Identification, Track, identify
    from radmpc.importing import ImportedScenario, ImportOptions, import_scenario
    from radmpc.importing.logs.reading import read_logs
    from radmpc.io.export.exporting import ExportOptions, export_plan, save_export, save_exported
    from radmpc.io.flight.flight_file import load_flight
    from radmpc.io.flight.record import FlightRecord, FlightSettings
    from radmpc.io.native.mapping import from_dict, to_dict
    from radmpc.io.native.plan_file import load_plan, save_plan
    from radmpc.io.native.scenario_file import load_scenario, save_scenario
    from radmpc.io.tables import to_pandas, to_xarray
    from radmpc.model.discretization import (
        double_integrator_noise,
        step_covariance,
        white_density,
    )
    from radmpc.model.dynamics import LinearSystem, double_integrator, lqr_gain
    from radmpc.model.noise.measurement import Measurement
    from radmpc.model.noise.shared import SharedDisturbance
    from radmpc.model.obstacle import Obstacle
    from radmpc.model.obstacle_reported import track_from_course
    from radmpc.model.plan import Coupling, LedgerRow, Plan, Risk, Status, Trajectory
    from radmpc.model.relations.keep import Keep
    from radmpc.model.scenario import Scenario, Workspace
    from radmpc.model.survey import survey_visits
    from radmpc.model.vehicle import Goal, Vehicle
    from radmpc.model.visits import Visit, steps_visited
    from radmpc.planners import Planner
    from radmpc.planning import plan
    from radmpc.plotting import (
        animate_plan,
        plot_couplings,
        plot_distances,
        plot_flight,
        plot_ledger,
        plot_plan,
        plot_risk,
        plot_scenario,
        save_animation,
        save_figure,
    )
    from radmpc.referee import Certificate, Simulation, Thinned, certify, simulate, thin
    from radmpc.result import Result
    from radmpc.viewing.view import view

__all__ = [
    "ArgumentError",
    "ArgumentTypeError",
    "Certificate",
    "Contact",
    "Coupling",
    "ExportOptions",
    "FileFormatError",
    "Flight",
    "FlightRecord",
    "FlightSettings",
    "Goal",
    "Identification",
    "ImportOptions",
    "ImportedScenario",
    "Keep",
    "LedgerRow",
    "LinearSystem",
    "LongMission",
    "Measurement",
    "Mission",
    "Model",
    "NoPlanError",
    "Obstacle",
    "Origin",
    "Plan",
    "Planner",
    "RadmpcError",
    "Result",
    "Risk",
    "RiskError",
    "Scenario",
    "ScenarioError",
    "SharedDisturbance",
    "Simulation",
    "SolverError",
    "Status",
    "Thinned",
    "Tick",
    "Track",
    "Trajectory",
    "Vehicle",
    "Visit",
    "Workspace",
    "__version__",
    "animate_plan",
    "begin_flight",
    "certify",
    "double_integrator",
    "double_integrator_noise",
    "export_plan",
    "fly",
    "from_dict",
    "identify",
    "import_scenario",
    "load_flight",
    "load_plan",
    "load_scenario",
    "lqr_gain",
    "plan",
    "plot_couplings",
    "plot_distances",
    "plot_flight",
    "plot_ledger",
    "plot_plan",
    "plot_risk",
    "plot_scenario",
    "read_logs",
    "resume_flight",
    "save_animation",
    "save_export",
    "save_exported",
    "save_figure",
    "save_plan",
    "save_scenario",
    "simulate",
    "step_covariance",
    "steps_visited",
    "survey_visits",
    "thin",
    "to_dict",
    "to_pandas",
    "to_xarray",
    "track_from_course",
    "view",
    "white_density",
]

# Where each name stands; it is loaded when first asked for. Solvers and matplotlib take most of a
# second, which the shell's completion and `radmpc --version` must not wait for.
_HOMES = {
    "errors": (
        "ArgumentError",
        "ArgumentTypeError",
        "FileFormatError",
        "NoPlanError",
        "RadmpcError",
        "RiskError",
        "ScenarioError",
        "SolverError",
    ),
    "io.export.exporting": ("ExportOptions", "export_plan", "save_export", "save_exported"),
    "geodesy": ("Origin",),
    "flying.flight": ("Flight", "fly"),
    "flying.mission": ("Mission",),
    "flying.model": ("Model",),
    "flying.receding.long_mission": ("LongMission",),
    "flying.recording.campaign": ("begin_flight", "resume_flight"),
    "flying.tick": ("Contact", "Tick"),
    "identification": ("Identification", "Track", "identify"),
    "io.flight.flight_file": ("load_flight",),
    "io.flight.record": ("FlightRecord", "FlightSettings"),
    "importing": ("ImportOptions", "ImportedScenario", "import_scenario"),
    "importing.logs.reading": ("read_logs",),
    "io.native.mapping": ("from_dict", "to_dict"),
    "io.native.plan_file": ("load_plan", "save_plan"),
    "io.native.scenario_file": ("load_scenario", "save_scenario"),
    "io.tables": ("to_pandas", "to_xarray"),
    "model.discretization": ("double_integrator_noise", "step_covariance", "white_density"),
    "model.dynamics": ("LinearSystem", "double_integrator", "lqr_gain"),
    "model.relations.keep": ("Keep",),
    "model.noise.measurement": ("Measurement",),
    "model.noise.shared": ("SharedDisturbance",),
    "model.obstacle": ("Obstacle",),
    "model.obstacle_reported": ("track_from_course",),
    "model.plan": ("Coupling", "LedgerRow", "Plan", "Risk", "Status", "Trajectory"),
    "model.scenario": ("Scenario", "Workspace"),
    "model.vehicle": ("Goal", "Vehicle"),
    "model.survey": ("survey_visits",),
    "model.visits": ("Visit", "steps_visited"),
    "planners.planner": ("Planner",),
    "planning": ("plan",),
    "plotting": (
        "animate_plan",
        "plot_couplings",
        "plot_distances",
        "plot_flight",
        "plot_ledger",
        "plot_plan",
        "plot_risk",
        "plot_scenario",
        "save_animation",
        "save_figure",
    ),
    "referee": ("Certificate", "Simulation", "Thinned", "certify", "simulate", "thin"),
    "result": ("Result",),
    "viewing.view": ("view",),
}
__getattr__, __dir__ = late_names(__name__, _HOMES)

logging.getLogger(__name__).addHandler(logging.NullHandler())

if "IPython" in sys.modules:
    # Notebooks alone have another way to show values, and wait for it.
    from radmpc.viewing.showing import show_in_notebooks

    show_in_notebooks()
