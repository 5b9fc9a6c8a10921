"""One joint nonlinear program in CasADi, solved by IPOPT: chance-constrained NMPC by the book.

States and controls of the whole fleet are variables tied by the dynamics; ``|u|`` is split into
two non-negative parts. Every avoidance is given the same risk, so keeps c standard deviations.

- **Obstacles** by separating hyperplanes (Zhang, Liniger, Borrelli, 2018): multipliers λ >= 0 on
  the faces ``A p <= b`` with ``|n| <= 1``, ``n = Aᵀλ``, and
  ``n·p − b·λ >= r + c·sqrt(nᵀ Σ n)``. The set lies where ``n·p <= b·λ``, so a collision is a
  Gaussian more than c deviations out: at most the avoidance's share of Δ. The direction is free,
  where radmpc's own program chooses among the faces: as safe, and never dearer.
- **Pairs** by distance: ``|p − q|² >= (rᵢ + rⱼ + c·sqrt(λmax))²`` with the largest eigenvalue of
  the summed covariances. The half-space across the line of centers then holds at the same share
  of Δ: as safe as one of radmpc's four faces, and less restrictive than all of them.

The program is not convex: several initial guesses are tried, a straight line and seeded bends
of it, and the cheapest converged one is kept. IPOPT proves neither optimality nor infeasibility.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import casadi
import numpy as np

from peers.protocol import Answer
from peers.statement import Array, Danger, Statement, state
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

PACKAGES = ("casadi",)

STARTS = 5
"""Initial guesses: a straight line and bends of it."""

_TOL = 1e-8
"""Of IPOPT; the referee allows 1e-6."""

_SMOOTH = 1e-12
"""Under the root, so that it has a slope at zero [m²]; it errs on the safe side."""


@dataclass(slots=True, eq=False)
class _Nlp:
    """A nonlinear program while it is written down: parallel lists, joined at the end."""

    variables: list[casadi.SX] = field(default_factory=list)
    lower: list[Array] = field(default_factory=list)
    upper: list[Array] = field(default_factory=list)
    rows: list[casadi.SX] = field(default_factory=list)
    row_lower: list[Array] = field(default_factory=list)
    row_upper: list[Array] = field(default_factory=list)
    cost: casadi.SX = field(default_factory=lambda: casadi.SX(0))

    def add(self, name: str, lower: Array, upper: Array) -> casadi.SX:
        """Add a matrix of variables, (count, T); its entries are numbered column by column."""
        found = casadi.SX.sym(name, *lower.shape)
        self.variables.append(casadi.vec(found))
        self.lower.append(lower.ravel(order="F"))
        self.upper.append(upper.ravel(order="F"))
        return found

    def keep(self, row: casadi.SX, lower: float, upper: float) -> None:
        """Add rows with the same bounds."""
        flat = casadi.vec(row)
        self.rows.append(flat)
        self.row_lower.append(np.full(flat.numel(), lower))
        self.row_upper.append(np.full(flat.numel(), upper))


def solve(scenario: Scenario, seconds: float, gap: float, seed: int) -> Answer:
    """Plan a scenario; the gap has no meaning here."""
    del gap
    begun = time.perf_counter()
    statement = state(scenario)
    if statement.share <= 0.0:
        return Answer("infeasible", note="the start alone spends the risk bound")
    nlp = _Nlp()
    states = [_vehicle(nlp, statement, i) for i in range(scenario.num_vehicles)]
    for danger in statement.dangers:
        _avoid(nlp, statement, danger, states)
    left = seconds - (time.perf_counter() - begun)
    if left <= 0.0:
        return Answer("limit", note="time ran out while building")
    solver = _solver(nlp, left / STARTS)
    best, best_cost, converged = None, np.inf, 0
    for guess in _guesses(statement, seed):
        found = solver(
            x0=guess,
            lbx=np.concatenate(nlp.lower),
            ubx=np.concatenate(nlp.upper),
            lbg=np.concatenate(nlp.row_lower),
            ubg=np.concatenate(nlp.row_upper),
        )
        if not solver.stats()["success"]:
            continue
        converged += 1
        if float(found["f"]) < best_cost:
            best, best_cost = np.array(found["x"]).ravel(), float(found["f"])
    note = f"{converged} of {STARTS} starts converged"
    if best is None:
        is_late = time.perf_counter() - begun >= seconds
        return Answer("limit" if is_late else "failed", note=note)
    return Answer("feasible", _controls(statement, best), note)


def _solver(nlp: _Nlp, seconds: float) -> casadi.Function:
    """Return IPOPT on a program, with a time limit for each start."""
    problem = {
        "x": casadi.vertcat(*nlp.variables),
        "f": nlp.cost,
        "g": casadi.vertcat(*nlp.rows),
    }
    options = {
        "print_time": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.max_iter": 1000,
        "ipopt.max_wall_time": max(seconds, 1e-3),
        "ipopt.tol": _TOL,
        "ipopt.constr_viol_tol": _TOL,
        "ipopt.acceptable_constr_viol_tol": 1e-7,
    }
    return casadi.nlpsol("fleet", "ipopt", problem, options)


def _vehicle(nlp: _Nlp, statement: Statement, i: int) -> casadi.SX:
    """Add a vehicle's states and controls; return its mean positions at k = 1..T, (d, T)."""
    vehicle, bounds = statement.scenario.vehicles[i], statement.control_bounds[i].T
    system = vehicle.system
    lower, upper = _state_bounds(vehicle, statement.scenario.horizon)
    states = nlp.add(f"x{i}", lower, upper)
    plus = nlp.add(f"p{i}", np.zeros(bounds.shape), bounds)
    minus = nlp.add(f"m{i}", np.zeros(bounds.shape), bounds)
    before = casadi.horzcat(casadi.SX(np.asarray(vehicle.start)), states[:, :-1])
    after = casadi.SX(system.A) @ before + casadi.SX(system.B) @ (plus - minus)
    nlp.keep(states - after, 0.0, 0.0)
    nlp.cost += vehicle.cost_weight * casadi.sum1(casadi.vec(plus + minus))
    return states[list(system.position), :]


def _state_bounds(vehicle: Vehicle, horizon: int) -> tuple[Array, Array]:
    """Return bounds on the mean states at k = 1..T, (n, T) each: speed limits and the goal."""
    system = vehicle.system
    upper = np.full((system.num_states, horizon), np.inf)
    lower = -upper
    if system.velocity is not None:
        rows = list(system.velocity)
        if vehicle.speed_limit is not None:
            upper[rows] = vehicle.speed_limit[:, None]
        if vehicle.goal.speed is not None:
            upper[rows, -1] = np.minimum(upper[rows, -1], vehicle.goal.speed)
        lower[rows] = -upper[rows]
    lower[list(system.position), -1] = vehicle.goal.lower
    upper[list(system.position), -1] = vehicle.goal.upper
    return lower, upper


def _avoid(nlp: _Nlp, statement: Statement, danger: Danger, states: list[casadi.SX]) -> None:
    """Add one danger at k = 1..T."""
    sigmas = statement.sigmas
    if danger.other is not None:
        apart = states[danger.one] - states[danger.other]
        widest = np.linalg.eigvalsh(danger.covariances[1:])[:, -1]
        least = danger.gap + sigmas * np.sqrt(np.maximum(widest, 0.0))
        nlp.keep(casadi.sum1(apart**2) - casadi.SX(least**2).T, 0.0, np.inf)
        return
    shape = danger.offsets[1:].T.shape
    weights = nlp.add("w", np.zeros(shape), np.full(shape, np.inf))
    for k in range(shape[1]):
        weight, position = weights[:, k], states[danger.one][:, k]
        normal = casadi.SX(danger.normals[k + 1].T) @ weight
        level = casadi.dot(casadi.SX(danger.offsets[k + 1]), weight)
        variance = casadi.dot(normal, casadi.SX(danger.covariances[k + 1]) @ normal)
        margin = danger.gap + sigmas * casadi.sqrt(variance + _SMOOTH)
        nlp.keep(casadi.dot(normal, position) - level - margin, 0.0, np.inf)
        nlp.keep(casadi.dot(normal, normal), 0.0, 1.0)


def _guesses(statement: Statement, seed: int) -> Iterator[Array]:
    """Yield starting points in the order in which variables were added."""
    scenario, rng = statement.scenario, np.random.default_rng(seed)
    times = np.linspace(0.0, 1.0, scenario.horizon + 1)[:, None]
    for trial in range(STARTS):
        parts, paths = [], []
        for vehicle, bounds in zip(scenario.vehicles, statement.control_bounds, strict=True):
            start, way = vehicle.start_position, vehicle.goal.center - vehicle.start_position
            path = start + times * way
            if trial:
                bend = rng.normal(0.0, 0.3 * max(float(np.linalg.norm(way)), 1.0), way.size)
                path = path + np.sin(np.pi * times) * bend
            paths.append(path)
            guess = np.zeros((scenario.horizon, vehicle.system.num_states))
            guess[:, list(vehicle.system.position)] = path[1:]
            if vehicle.system.velocity is not None:
                guess[:, list(vehicle.system.velocity)] = np.diff(path, axis=0) / scenario.dt
            parts += [guess.ravel(), np.zeros(2 * bounds.size)]
        parts += [_weights(danger, paths) for danger in statement.dangers if danger.other is None]
        yield np.concatenate(parts)


def _weights(danger: Danger, paths: list[Array]) -> Array:
    """Return multipliers that pick the face furthest behind a path."""
    slack = np.einsum("kfd,kd->kf", danger.normals, paths[danger.one]) - danger.offsets
    return np.eye(slack.shape[1])[slack[1:].argmax(axis=1)].ravel()


def _controls(statement: Statement, point: Array) -> tuple[Array, ...]:
    """Return each vehicle's controls, (T, m)."""
    controls, position = [], 0
    for vehicle, bounds in zip(statement.scenario.vehicles, statement.control_bounds, strict=True):
        position += len(bounds) * vehicle.system.num_states
        plus = point[position : position + bounds.size]
        minus = point[position + bounds.size : position + 2 * bounds.size]
        controls.append((plus - minus).reshape(bounds.shape))
        position += 2 * bounds.size
    return tuple(controls)
