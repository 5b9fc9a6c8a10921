"""Goals that a disturbance put out of reach, widened by the least that limits leave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Matrix, Vector
from radmpc.flying.remainder import changed
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.norms import norm_rows
from radmpc.solvers.lp.exchange_lp import ExchangeLp

__all__ = ["least_slacks", "reached", "widened"]

_ROUNDING = 1e-7
"""What a widened goal is wider yet [m, m/s]: a program without any room ends by its tolerances.
Goals count as reached within 1e-6."""


def widened(scenario: Scenario, models: Sequence[CondensedModel] | None = None) -> Scenario:
    """Return a scenario whose goals limits of control and speed allow to reach, obstacles aside.

    Parameters
    ----------
    scenario : Scenario
        Of the steps that are left.
    models : sequence of CondensedModel or None
        Its vehicles over these steps, where they are known; None makes them.

    Returns
    -------
    Scenario
        The same where every goal is within reach; else goals are wider by as little as will do: the
        least sum of meters and of excess speed times a step. A vehicle that no goal would help, as
        one that cannot brake to its speed limit, is left as it is.
    """
    if models is None:
        models = condensed_models(scenario)
    slacks = least_slacks(models, scenario.dt)
    if not any(slack is not None and float(slack.max()) > _ROUNDING for slack in slacks):
        return scenario
    pairs = zip(scenario.vehicles, slacks, strict=True)
    return changed(scenario, vehicles=tuple(_wider(v, slack) for v, slack in pairs))


def reached(
    scenario: Scenario, models: Sequence[CondensedModel], controls: Sequence[Matrix]
) -> Scenario:
    """Return a scenario whose goals are as wide as some controls miss them by.

    Parameters
    ----------
    scenario : Scenario
        Of the steps that are left.
    models : sequence of CondensedModel
        Its vehicles over these steps.
    controls : sequence of (T, m) array
        Of its vehicles.
    """
    vehicles = []
    for vehicle, model, pushes in zip(scenario.vehicles, models, controls, strict=True):
        end = model.position[model.horizon] @ pushes.ravel() + model.drift_position[model.horizon]
        outside = np.maximum(np.maximum(vehicle.goal.lower - end, end - vehicle.goal.upper), 0.0)
        vehicles.append(_wider(vehicle, outside))
    return changed(scenario, vehicles=tuple(vehicles))


def least_slacks(models: Sequence[CondensedModel], dt: float) -> list[Vector | None]:
    """Return by how much goals are missed at least, per axis, then speeds; None without a plan.

    Parameters
    ----------
    models : sequence of CondensedModel
        Vehicles over the steps that are left.
    dt : float
        A step [s]; what a speed in excess counts.
    """
    lp = ExchangeLp()
    slots = [_add(lp, model, dt) for model in models]
    values = lp.solve()
    if values is not None:
        return [np.maximum(values[slot], 0.0) for slot in slots]
    if len(models) == 1:
        return [None]
    return [least_slacks([model], dt)[0] for model in models]


def _wider(vehicle: Vehicle, slack: Vector | None) -> Vehicle:
    """Return a vehicle with a goal within its reach."""
    if slack is None or float(slack.max()) <= _ROUNDING:
        return vehicle
    goal, d = vehicle.goal, vehicle.system.dimension
    wider = np.where(slack > 0.0, slack + _ROUNDING, 0.0)
    speed = goal.speed if goal.speed is None or wider.size == d else goal.speed + wider[d:]
    wide = replace(goal, lower=goal.lower - wider[:d], upper=goal.upper + wider[:d], speed=speed)
    return changed(vehicle, goal=wide)


def _add(lp: ExchangeLp, model: CondensedModel, dt: float) -> slice:
    """Add a vehicle: controls, shifted to begin at 0, then slacks; return where these stand."""
    vehicle, d = model.vehicle, model.vehicle.system.dimension
    bounds = np.maximum(model.control_bounds, 0.0).ravel()
    has_speed = vehicle.goal.speed is not None and model.velocity is not None
    begin = lp.add_columns(np.zeros(bounds.size), np.zeros(bounds.size), 2.0 * bounds)
    costs = np.concatenate([np.ones(d), np.full(d if has_speed else 0, dt)])
    first = lp.add_columns(costs, np.zeros(costs.size), np.full(costs.size, np.inf))
    rows, least = _asked(model, costs.size)
    moved = least + rows[:, : bounds.size] @ bounds
    lp.add_rows(csr_array(rows), moved, np.full(len(rows), np.inf), begin)
    return slice(first, first + costs.size)


def _asked(model: CondensedModel, num_slacks: int) -> tuple[Matrix, Vector]:
    """Return rows over controls and slacks, each with the opposite one, and what they are at least.

    Goals, speeds at every step, the goal's speed, norms: what goals and their speed may lack is
    slack.
    """
    vehicle, last, d = model.vehicle, model.horizon, model.vehicle.system.dimension
    of_place, of_speed = np.eye(d, num_slacks), np.eye(d, num_slacks, d)
    place, still = model.position[last], model.drift_position[last]
    blocks = [(place, of_place, vehicle.goal.lower - still, still - vehicle.goal.upper)]
    if model.velocity is not None and model.drift_velocity is not None:
        if vehicle.speed_limit is not None:
            speeds, idle = model.velocity[1:], model.drift_velocity[1:].ravel()
            limits, nothing = np.tile(vehicle.speed_limit, last), np.zeros((last * d, num_slacks))
            flat = speeds.reshape(last * d, -1)
            blocks.append((flat, nothing, -limits - idle, idle - limits))
        if vehicle.goal.speed is not None:
            ends = model.drift_velocity[last]
            most = vehicle.goal.speed
            blocks.append((model.velocity[last], of_speed, -most - ends, ends - most))
    both = [np.hstack([sign * rows, slack]) for rows, slack, _, _ in blocks for sign in (1.0, -1.0)]
    least = [each for block in blocks for each in block[2:]]
    for faces, upper in norm_rows(model):
        both.append(np.hstack([-faces, np.zeros((len(faces), num_slacks))]))
        least.append(-upper.ravel())
    return np.vstack(both), np.concatenate(least)
