"""Plans as tables of the libraries that people analyze data with (extras)."""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from radmpc.arguments import value_text
from radmpc.errors import ArgumentError
from radmpc.io.export.tracks import velocities_over_ground
from radmpc.model.given import check_plan
from radmpc.model.plan import Plan

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["to_pandas", "to_xarray"]

_AXES = "xyz"


def to_pandas(plan: Plan, table: str = "trajectories") -> pandas.DataFrame:
    """Return a plan's trajectories, or its risk ledger, as a table.

    Parameters
    ----------
    plan : Plan
        Any; without trajectories the table has no rows.
    table : {'trajectories', 'ledger'}
        Which table.

    Returns
    -------
    pandas.DataFrame
        ``trajectories``: a row per vehicle and step, indexed by ``name`` and ``step``; the columns
        are those of the CSV export: ``t`` [s], mean position ``x``, ``y`` (``z``) [m], mean
        velocity over ground ``vx``, ``vy`` (``vz``) [m/s] (nan where the dynamics have none), three
        standard deviations of the position ``three_sigma_x`` … [m], the controls that follow
        ``u1``, ``u2``, … (nan at the last step). ``ledger``: ``cause``, ``vehicle``, ``other``,
        ``step`` and ``risk`` [-].

    Raises
    ------
    ImportError
        If pandas is not installed (extra ``pandas``).
    ArgumentError
        If there is no such table.
    """
    check_plan(plan)
    if not (isinstance(table, str) and table in {"trajectories", "ledger"}):
        raise ArgumentError(f"table must be 'trajectories' or 'ledger', got {value_text(table)}")
    try:
        import pandas as pd  # noqa: PLC0415 - an extra
    except ImportError as error:
        raise ImportError("to_pandas needs pandas: pip install 'radmpc[pandas]'") from error
    if table == "ledger":
        columns = ["cause", "vehicle", "other", "step", "risk"]
        rows = [[getattr(row, name) for name in columns] for row in plan.risk.ledger]
        return pd.DataFrame(rows, columns=columns)
    frames = [pd.DataFrame(_columns(plan, index)) for index in range(len(plan.trajectories))]
    whole = pd.concat(frames) if frames else pd.DataFrame({"name": [], "step": []})
    return whole.set_index(["name", "step"])


def _columns(plan: Plan, index: int) -> dict[str, object]:
    """Return a vehicle's columns."""
    vehicle, trajectory = plan.scenario.vehicles[index], plan.trajectories[index]
    steps = np.arange(len(trajectory.means))
    columns: dict[str, object] = {
        "name": vehicle.name,
        "step": steps,
        "t": plan.scenario.dt * steps,
    }
    system = vehicle.system
    axes = _AXES[: system.dimension]
    for axis, state in zip(axes, system.position, strict=True):
        columns[axis] = trajectory.means[:, state]
    velocities = velocities_over_ground(vehicle, trajectory.means, plan.scenario.dt)
    for i, axis in enumerate(axes):
        columns[f"v{axis}"] = np.nan if velocities is None else velocities[:, i]
    for axis, state in zip(axes, system.position, strict=True):
        variances = np.maximum(trajectory.covariances[:, state, state], 0.0)
        columns[f"three_sigma_{axis}"] = 3.0 * np.sqrt(variances)
    for j in range(trajectory.controls.shape[1]):
        columns[f"u{j + 1}"] = np.append(trajectory.controls[:, j], np.nan)
    return columns


def to_xarray(plan: Plan) -> xarray.Dataset:
    """Return a plan's trajectories as labeled arrays.

    Parameters
    ----------
    plan : Plan
        With trajectories of one number of states and of controls.

    Returns
    -------
    xarray.Dataset
        ``mean`` (vehicle, step, state), ``covariance`` (vehicle, step, state, state_) and
        ``control`` (vehicle, step, input; nan at the last step); ``position`` (vehicle, step,
        axis) [m]; coordinate ``time`` [s]. Cost, risk and names stand in ``attrs``.

    Raises
    ------
    ImportError
        If xarray is not installed (extra ``xarray``).
    ArgumentError
        If vehicles have different numbers of states or controls, or there is no plan.
    """
    check_plan(plan)
    try:
        import xarray as xr  # noqa: PLC0415 - an extra
    except ImportError as error:
        raise ImportError("to_xarray needs xarray: pip install 'radmpc[xarray]'") from error
    shapes = {(t.means.shape, t.controls.shape) for t in plan.trajectories}
    if len(shapes) != 1:
        raise ArgumentError(
            "to_xarray needs a plan whose vehicles have equally many states and controls, got "
            f"{len(shapes)} kinds"
        )
    return _dataset(xr, plan)


def _dataset(xr: ModuleType, plan: Plan) -> xarray.Dataset:
    """Return trajectories of one shape as arrays, by the extra's module."""
    scenario, trajectories = plan.scenario, plan.trajectories
    last = np.full((1, trajectories[0].controls.shape[1]), np.nan)
    places = [
        t.means[:, list(v.system.position)]
        for v, t in zip(scenario.vehicles, trajectories, strict=True)
    ]
    dims = ("vehicle", "step")
    dataset: xarray.Dataset = xr.Dataset(
        {
            "position": ((*dims, "axis"), np.array(places), {"units": "m"}),
            "mean": ((*dims, "state"), np.array([t.means for t in trajectories])),
            "covariance": (
                (*dims, "state", "state_"), np.array([t.covariances for t in trajectories])
            ),
            "control": (
                (*dims, "input"), np.array([np.vstack([t.controls, last]) for t in trajectories])
            ),
        },
        coords={
            "vehicle": [t.name for t in trajectories],
            "axis": list(_AXES[: scenario.dimension]),
            "time": ("step", scenario.dt * np.arange(scenario.horizon + 1), {"units": "s"}),
        },
        attrs={
            "scenario": scenario.name,
            "planner": plan.planner,
            "status": plan.status.value,
            "cost": plan.cost,
            "risk_bound": scenario.risk_bound,
            "certified": plan.risk.certified,
        },
    )  # fmt: skip
    return dataset
