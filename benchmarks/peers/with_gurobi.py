"""The big-M program through gurobipy, within what its free license allows.

The license that comes with the package solves models of at most 2,000 columns and 2,000 rows;
larger ones are reported as too large, not solved by halves.
"""

from __future__ import annotations

import time

import gurobipy as gp
import numpy as np
from gurobipy import GRB

from peers.protocol import Answer
from peers.statement import Array, Danger, Statement, state
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

PACKAGES = ("gurobipy",)


def solve(scenario: Scenario, seconds: float, gap: float, seed: int) -> Answer:
    """Plan a scenario with Gurobi."""
    begun = time.perf_counter()
    statement = state(scenario)
    if statement.share <= 0.0:
        return Answer("infeasible", note="the start alone spends the risk bound")
    with gp.Env(params={"OutputFlag": 0}) as env, gp.Model(env=env) as model:
        positions, controls = _fleet(model, statement)
        reach = statement.reach()
        for danger in statement.dangers:
            _avoid(model, danger, statement, reach, positions)
        model.Params.MIPGap = gap
        model.Params.Seed = seed
        left = seconds - (time.perf_counter() - begun)
        if left <= 0.0:
            return Answer("limit", note="time ran out while building")
        model.Params.TimeLimit = left
        try:
            model.optimize()
        except gp.GurobiError as error:
            if error.errno != GRB.Error.SIZE_LIMIT_EXCEEDED:
                raise
            size = f"{model.NumVars} columns, {model.NumConstrs} rows"
            return Answer("too large", note=f"{size}; the free license allows 2000 of each")
        if model.SolCount == 0:
            no_plan = model.Status in {GRB.INFEASIBLE, GRB.INF_OR_UNBD}
            late = model.Status == GRB.TIME_LIMIT
            return Answer("infeasible" if no_plan else "limit" if late else "failed")
        status = "optimal" if model.Status == GRB.OPTIMAL else "feasible"
        return Answer(status, tuple(np.asarray((p - m).getValue()) for p, m in controls))


def _fleet(
    model: gp.Model, statement: Statement
) -> tuple[list[gp.MLinExpr], list[tuple[gp.MVar, gp.MVar]]]:
    """Add states and controls; return positions at k = 1..T and the parts of the controls."""
    positions, controls = [], []
    scenario = statement.scenario
    for vehicle, bounds in zip(scenario.vehicles, statement.control_bounds, strict=True):
        lower, upper = _state_bounds(vehicle, scenario.horizon)
        states = model.addMVar(lower.shape, lb=lower, ub=upper)
        weight = vehicle.cost_weight
        plus = model.addMVar(bounds.shape, lb=0.0, ub=bounds, obj=weight)
        minus = model.addMVar(bounds.shape, lb=0.0, ub=bounds, obj=weight)
        A, B = vehicle.system.A, vehicle.system.B
        model.addConstr(states[1:] == states[:-1] @ A.T + (plus - minus) @ B.T)
        positions.append(states[1:, list(vehicle.system.position)])
        controls.append((plus, minus))
    return positions, controls


def _state_bounds(vehicle: Vehicle, horizon: int) -> tuple[Array, Array]:
    """Return bounds on the mean states, (T+1, n) each: the start, speed limits and the goal."""
    system = vehicle.system
    upper = np.full((horizon + 1, system.num_states), np.inf)
    if system.velocity is not None:
        columns = list(system.velocity)
        if vehicle.speed_limit is not None:
            upper[:, columns] = vehicle.speed_limit
        if vehicle.goal.speed is not None:
            upper[-1, columns] = np.minimum(upper[-1, columns], vehicle.goal.speed)
    lower = -upper
    lower[0] = upper[0] = vehicle.start
    lower[-1, list(system.position)] = vehicle.goal.lower
    upper[-1, list(system.position)] = vehicle.goal.upper
    return lower, upper


def _avoid(
    model: gp.Model,
    danger: Danger,
    statement: Statement,
    reach: tuple[Array, Array],
    positions: list[gp.MVar],
) -> None:
    """Add one danger at k = 1..T: at least one face, the others switched off by a big M."""
    normals, needs = danger.normals[1:], statement.needs(danger)[1:]
    big_m = statement.big_m(danger, reach)[1:]
    chosen = model.addMVar(needs.shape, vtype=GRB.BINARY)
    model.addConstr(chosen.sum(axis=1) >= 1)
    q = positions[danger.one]
    if danger.other is not None:
        q = q - positions[danger.other]
    for face in range(needs.shape[1]):
        beyond = (normals[:, face] * q).sum(axis=1)
        model.addConstr(beyond >= needs[:, face] - big_m[:, face] * (1 - chosen[:, face]))
