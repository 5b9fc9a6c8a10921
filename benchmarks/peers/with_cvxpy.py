"""The big-M program in CVXPY, solved by HiGHS or by SCIP.

As one would write it in an afternoon: mean states and controls as variables, one binary per face
and step, a big M per row from where vehicles can be, the same risk for every avoidance.
"""

from __future__ import annotations

import importlib
import time
import warnings
from collections.abc import Callable

import cvxpy as cp
import numpy as np

from peers.protocol import Answer
from peers.statement import Array, Danger, Statement, state
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

PACKAGES = ("cvxpy", "highspy", "pyscipopt")

_HAS_POINT = 2
"""How HiGHS says that its point is feasible."""

Constraints = list[cp.Constraint]


def solve_highs(scenario: Scenario, seconds: float, gap: float, seed: int) -> Answer:
    """Plan a scenario with HiGHS."""
    del seed

    def options(left: float) -> dict[str, object]:
        return {"highs_options": {"time_limit": left, "mip_rel_gap": gap}}

    return _solve(scenario, seconds, cp.HIGHS, options)


def solve_scip(scenario: Scenario, seconds: float, gap: float, seed: int) -> Answer:
    """Plan a scenario with SCIP."""
    del seed
    importlib.import_module("pyscipopt")

    def options(left: float) -> dict[str, object]:
        return {"scip_params": {"limits/time": left, "limits/gap": gap}}

    return _solve(scenario, seconds, cp.SCIP, options)


def _solve(
    scenario: Scenario,
    seconds: float,
    solver: str,
    options: Callable[[float], dict[str, object]],
) -> Answer:
    """Write the program down and solve it."""
    begun = time.perf_counter()
    statement = state(scenario)
    if statement.share <= 0.0:
        return Answer("infeasible", note="the start alone spends the risk bound")
    positions, controls, constraints, cost = _fleet(statement)
    reach = statement.reach()
    for danger in statement.dangers:
        constraints += _avoid(danger, statement, reach, positions)
    problem = cp.Problem(cp.Minimize(cost), constraints)
    with warnings.catch_warnings():
        # CVXPY calls a point at the allowed gap, or at a limit, inaccurate.
        warnings.simplefilter("ignore")
        problem.get_problem_data(solver)  # compiled here, so that the time left is known
        left = seconds - (time.perf_counter() - begun)
        if left <= 0.0:
            return Answer("limit", note="time ran out while building")
        try:
            problem.solve(solver=solver, **options(left))
        except cp.SolverError as error:
            return Answer("failed", note=str(error))
    status = _status(problem)
    if status not in {"optimal", "feasible"}:
        return Answer(status)
    return Answer(status, tuple(np.asarray(u.value) for u in controls))


def _status(problem: cp.Problem) -> str:
    """Return how the solver ended."""
    stats = problem.solver_stats.extra_stats if problem.solver_stats else None
    if isinstance(stats, dict):  # SCIP's, in its own words
        word, has_point = stats["scip_status"], "primal" in stats
        proven = word in {"optimal", "gaplimit"}
    else:
        word, has_point = problem.status, getattr(stats, "primal_solution_status", 0) == _HAS_POINT
        proven = word == cp.OPTIMAL
    if "infeasible" in word:
        return "infeasible"
    if not has_point:
        return "limit" if "limit" in word else "failed"
    return "optimal" if proven else "feasible"


def _fleet(
    statement: Statement,
) -> tuple[list[cp.Expression], list[cp.Expression], Constraints, cp.Expression]:
    """Return mean positions at k = 1..T and controls per vehicle, their constraints, the cost."""
    positions, controls, terms = [], [], []
    constraints: Constraints = []
    scenario = statement.scenario
    for vehicle, bounds in zip(scenario.vehicles, statement.control_bounds, strict=True):
        states = cp.Variable((scenario.horizon + 1, vehicle.system.num_states))
        used = cp.Variable(bounds.shape)
        constraints += [
            states[0] == vehicle.start,
            states[1:] == states[:-1] @ vehicle.system.A.T + used @ vehicle.system.B.T,
            cp.abs(used) <= bounds,
            *_limits(vehicle, states),
        ]
        positions.append(states[1:, list(vehicle.system.position)])
        controls.append(used)
        terms.append(vehicle.cost_weight * cp.norm1(cp.vec(used, order="C")))
    return positions, controls, constraints, cp.sum(terms)


def _limits(vehicle: Vehicle, states: cp.Variable) -> Constraints:
    """Return a vehicle's goal and speed limits."""
    goal, last = vehicle.goal, states[-1, list(vehicle.system.position)]
    found: Constraints = [last >= goal.lower, last <= goal.upper]
    if vehicle.system.velocity is not None:
        speeds = cp.abs(states[1:, list(vehicle.system.velocity)])
        if vehicle.speed_limit is not None:
            found.append(speeds <= np.tile(vehicle.speed_limit, (speeds.shape[0], 1)))
        if goal.speed is not None:
            found.append(speeds[-1] <= goal.speed)
    return found


def _avoid(
    danger: Danger,
    statement: Statement,
    reach: tuple[Array, Array],
    positions: list[cp.Expression],
) -> Constraints:
    """Return one danger at k = 1..T: at least one face, the others switched off by a big M."""
    q = positions[danger.one]
    if danger.other is not None:
        q = q - positions[danger.other]
    normals, needs = danger.normals[1:], statement.needs(danger)[1:]
    big_m = statement.big_m(danger, reach)[1:]
    chosen = cp.Variable(needs.shape, boolean=True)
    found: Constraints = [cp.sum(chosen, axis=1) >= 1]
    for face in range(needs.shape[1]):
        beyond = cp.sum(cp.multiply(normals[:, face], q), axis=1)
        off = cp.multiply(big_m[:, face], 1 - chosen[:, face])
        found.append(beyond >= needs[:, face] - off)
    return found
