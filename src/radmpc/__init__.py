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
from typing import TYPE_CHECKING

from radmpc.errors import (
    FileFormatError,
    NoPlanError,
    RadmpcError,
    RiskError,
    ScenarioError,
    SolverError,
)
from radmpc.io.plan_file import load_plan, save_plan
from radmpc.io.scenario_file import load_scenario, save_scenario
from radmpc.model.dynamics import LinearSystem, double_integrator, lqr_gain
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan, Status, Trajectory
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.planner import Planner
from radmpc.planning import plan
from radmpc.referee import Certificate, Simulation, certify, simulate
from radmpc.result import Result
from radmpc.version import __version__

if TYPE_CHECKING:
    from radmpc.plotting import plot_ledger, plot_plan, plot_scenario

__all__ = [
    "Certificate",
    "FileFormatError",
    "Goal",
    "LinearSystem",
    "NoPlanError",
    "Obstacle",
    "Plan",
    "Planner",
    "RadmpcError",
    "Result",
    "RiskError",
    "Scenario",
    "ScenarioError",
    "Simulation",
    "SolverError",
    "Status",
    "Trajectory",
    "Vehicle",
    "Workspace",
    "__version__",
    "certify",
    "double_integrator",
    "load_plan",
    "load_scenario",
    "lqr_gain",
    "plan",
    "plot_ledger",
    "plot_plan",
    "plot_scenario",
    "save_plan",
    "save_scenario",
    "simulate",
]

logging.getLogger(__name__).addHandler(logging.NullHandler())


def __getattr__(name: str) -> object:
    """Load the plotting functions when first used: matplotlib takes longer than planning."""
    if name in {"plot_ledger", "plot_plan", "plot_scenario"}:
        import radmpc.plotting  # noqa: PLC0415 - see above

        return getattr(radmpc.plotting, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
