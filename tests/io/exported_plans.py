"""Plans to export, made without planning, and the way back from places to local coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from radmpc.geodesy import Origin
from radmpc.io.export.exporting import ExportOptions, export_plan
from radmpc.io.native.scenario_file import decode_scenario
from radmpc.model.dynamics import rollout
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.model.scenario import Scenario

ORIGIN = Origin(54.1234, 12.0987, 38.25)
CENTIMETER = 0.01

MOLE = [[0, 0], [0, 900], [300, 900], [300, 300], [900, 300], [900, 0]]

HARBOR: dict[str, Any] = {
    "format": "radmpc/scenario/1",
    "name": "wide harbor",
    "dt": 20.0,
    "horizon": 6,
    "risk_bound": 0.05,
    "obstacles": [
        # Clockwise and not convex.
        {"name": "mole", "vertices": MOLE},
        {"name": "barge", "min": [-900, -900], "max": [-700, -500]},
        {
            "name": "ship",
            "moving": [
                [[k * 50, -2000], [k * 50 + 90, -2000], [k * 50 + 90, -1900]] for k in range(7)
            ],
        },
    ],
    "defaults": {
        "radius": 4.0,
        "control_limit": 2.0,
        "initial_covariance": [0.04, 0.09, 0.0001, 0.0001],
        "disturbance_covariance": [0.01, 0.02, 0.0001, 0.0001],
    },
    "vehicles": [
        {
            "name": "tug",
            "start": [-4000, 3000, 5, 0],
            "goal": {"center": [-3000, 3000], "half_width": 900, "speed": None},
        },
        {
            "name": "pilot 7",
            "start": [1500, -2500],
            "goal": {"center": [1500, -2500], "speed": None},
        },
    ],
}  # fmt: skip

FLIGHT: dict[str, Any] = {
    "format": "radmpc/scenario/1",
    "name": "flight",
    "dt": 2.5,
    "horizon": 5,
    "risk_bound": 0.01,
    "obstacles": [
        {"name": "tower", "min": [100, 100, 0], "max": [140, 150, 80]},
        {"name": "crane", "vertices": [[0, 0, 0], [10, 0, 0], [0, 10, 0], [2, 2, 60]]},
    ],
    "defaults": {"radius": 0.5, "control_limit": 5.0, "initial_covariance": 0.01},
    "vehicles": [
        {
            "name": "scout",
            "start": [-50, 20, 30, 4, 0, 1],
            "goal": {"min": [-20, -20, 20], "max": [90, 90, 90], "speed": None},
        }
    ],
}


def controls(scenario: Scenario) -> dict[str, npt.NDArray[np.float64]]:
    """Pushes that move the vehicles about; the second one of the harbor waits, goes, and waits."""
    steps = scenario.horizon
    pushes = {v.name: np.zeros((steps, v.system.num_controls)) for v in scenario.vehicles}
    if "pilot 7" in pushes:
        pushes["pilot 7"][2:4] = [[0.5, 0.25], [-0.5, -0.25]]
    if "tug" in pushes:
        pushes["tug"][:] = np.linspace(-0.1, 0.2, 12).reshape(6, 2)
    if "scout" in pushes:
        pushes["scout"][:] = np.linspace(-0.4, 0.5, 15).reshape(5, 3)
    return pushes


def plan_of(content: Mapping[str, Any], certified: float | None = 0.04, **changes: Any) -> Plan:
    """Return a plan for a scenario, some of whose keys are changed."""
    scenario = decode_scenario(dict(content) | changes)
    pushes = controls(scenario)
    return Plan(
        scenario=scenario,
        planner="by hand",
        seed=0,
        status=Status.FEASIBLE,
        cost=1.0,
        lower_bound=None,
        risk=Risk(scenario.risk_bound, certified),
        sets=tuple((v.name,) for v in scenario.vehicles),
        trajectories=tuple(
            Trajectory(
                v.name,
                pushes[v.name],
                rollout(v.system, v.start, pushes[v.name], v.drift),
                v.covariances(scenario.horizon),
            )
            for v in scenario.vehicles
        ),
    )


def renamed(plan: Plan, old: str, new: str) -> Plan:
    """The same plan with a vehicle called otherwise."""
    scenario = replace(
        plan.scenario,
        vehicles=tuple(
            replace(v, name=new) if v.name == old else v for v in plan.scenario.vehicles
        ),
    )
    parts = tuple(replace(t, name=new) if t.name == old else t for t in plan.trajectories)
    return replace(plan, scenario=scenario, trajectories=parts)


def contents(plan: Plan, to: str, **options: Any) -> dict[str, bytes]:
    """Return what an export holds, per file name."""
    if to != "csv":
        options = {"origin": ORIGIN} | options
    exported = export_plan(plan, to, f"fleet.{to}", ExportOptions(**options))
    return {path.name: content for path, content in exported.files.items()}


def written(plan: Plan, to: str, folder: Path, **options: Any) -> list[Path]:
    """Write an export and return its files."""
    files = []
    for name, content in contents(plan, to, **options).items():
        (folder / name).write_bytes(content)
        files.append(folder / name)
    return files


def means(plan: Plan, name: str) -> npt.NDArray[np.float64]:
    """Return a vehicle's mean positions, (T+1, d)."""
    index = [v.name for v in plan.scenario.vehicles].index(name)
    axes = list(plan.scenario.vehicles[index].system.position)
    return plan.trajectories[index].means[:, axes]


def back(places: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return east, north, up of rows of latitude, longitude, height, by a library not ours."""
    pymap3d = pytest.importorskip("pymap3d")
    lat, lon, height = np.asarray(places, dtype=float).T
    answer = pymap3d.geodetic2enu(
        lat, lon, height, ORIGIN.latitude, ORIGIN.longitude, ORIGIN.height
    )
    return np.stack(answer, axis=-1)


def assert_at(places: npt.ArrayLike, expected: npt.ArrayLike, within: float = CENTIMETER) -> None:
    """Compare places on earth with local coordinates, in the plane those of a plane."""
    local = np.asarray(expected, dtype=float)
    found = back(places)[:, : local.shape[1]]
    assert found.shape == local.shape
    assert float(np.abs(found - local).max()) < within
