"""What a plan says about itself, compared with what follows from its scenario and controls."""

from __future__ import annotations

from collections import Counter

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.plan import Plan, Status, Trajectory
from radmpc.model.vehicle import Vehicle
from radmpc.referee.claims.plain import differing, exceeding_limits
from radmpc.referee.claims.statements import statement_problems
from radmpc.referee.claims.tolerances import (
    beyond_limit,
    of_cost,
    of_covariances,
    of_gain,
    of_means,
    of_place,
    of_speeds,
)
from radmpc.referee.motion import FleetMotion

__all__ = ["claim_problems", "cost_of", "limit_problems", "planned_effort", "shape_problems"]


def shape_problems(plan: Plan) -> list[str]:
    """Return why a plan cannot be judged at all: vehicles or arrays that do not fit."""
    if not plan.trajectories and plan.status in {Status.OPTIMAL, Status.FEASIBLE}:
        return [f"plan: status is {plan.status.value!r}, yet there are no trajectories"]
    if not plan.trajectories:
        return ["plan: holds no trajectories"]
    problems = []
    expected = [v.name for v in plan.scenario.vehicles]
    given = [t.name for t in plan.trajectories]
    known, times = set(expected), Counter(given)
    problems += [
        f"vehicle {name!r}: missing from the plan" for name in expected if name not in times
    ]
    problems += [f"vehicle {name!r}: not in the scenario" for name in given if name not in known]
    problems += [
        f"vehicle {name!r}: stands {count} times in the plan, allowed is once"
        for name, count in times.items()
        if name in known and count > 1
    ]
    if problems:
        return problems
    if given != expected:
        problems.append(f"plan: vehicles stand in the order {given}, the scenario's is {expected}")
    for vehicle, trajectory in zip(plan.scenario.vehicles, plan.trajectories, strict=True):
        if trajectory.name == vehicle.name:
            problems += _array_problems(plan.scenario.horizon, vehicle, trajectory)
    return problems


def _array_problems(horizon: int, vehicle: Vehicle, trajectory: Trajectory) -> list[str]:
    """Return which of a vehicle's arrays have the wrong shape or numbers that are not finite."""
    n, m = vehicle.system.num_states, vehicle.system.num_controls
    expected = {
        "controls": (horizon, m),
        "means": (horizon + 1, n),
        "covariances": (horizon + 1, n, n),
        "gain": (m, n),
    }
    problems = []
    for field, shape in expected.items():
        array: npt.NDArray[np.float64] | None = getattr(trajectory, field)
        if array is not None and array.shape != shape:
            problems.append(
                f"vehicle {vehicle.name!r}: {field} have shape {array.shape}, must be {shape}"
            )
    return problems


def claim_problems(plan: Plan, motion: FleetMotion) -> list[str]:
    """Return where stated means, covariances, gains, cost or bound are not the true ones.

    Numbers may differ by 1e-6, or by 1e-6 of the larger where they exceed one; never by more than a
    thousandth of the radius, of what a step adds to the speed, or of the variances.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    motion : FleetMotion
        The true one, under the plan's controls.
    """
    problems = statement_problems(plan)
    off = set(differing(plan, motion))
    for i, (vehicle, stated) in enumerate(
        zip(plan.scenario.vehicles, plan.trajectories, strict=True)
    ):
        if i in off:
            means, spreads = motion.states[i], motion.covariances[i]
            allowed = of_means(vehicle, means)
            problems += _difference(vehicle.name, "mean", stated.means, means, allowed)
            allowed = of_covariances(vehicle, spreads)
            problems += _difference(
                vehicle.name, "covariance", stated.covariances, spreads, allowed
            )
        problems += _gain_problems(vehicle, stated)
    if plan.risk.bound != plan.scenario.risk_bound:
        problems.append(
            f"plan: states a risk bound of {plan.risk.bound:.9g}, "
            f"the scenario's is {plan.scenario.risk_bound:.9g}"
        )
    cost = cost_of(plan)
    # Negated, so that nan is no cost either.
    if plan.cost is None or not abs(plan.cost - cost) <= of_cost(plan.scenario, cost):
        stated_cost = "no cost" if plan.cost is None else f"a cost of {plan.cost:.9g}"
        problems.append(f"plan: states {stated_cost}, its controls cost {cost:.9g}")
    return problems


def planned_effort(plan: Plan) -> float:
    """Return ``Σ weight · ‖u‖₁`` over vehicles and steps."""
    pairs = zip(plan.scenario.vehicles, plan.trajectories, strict=True)
    return float(sum(v.cost_weight * np.abs(t.controls).sum() for v, t in pairs))


def cost_of(plan: Plan) -> float:
    """Return ``Σ weight · ‖u‖₁`` over vehicles and steps, and what times until arrival cost."""
    effort = planned_effort(plan)
    per_step = plan.scenario.time_weight * plan.scenario.dt
    if per_step == 0.0:
        return effort
    pairs = zip(plan.scenario.vehicles, plan.trajectories, strict=True)
    from radmpc.referee.claims.visits import arrival_step  # noqa: PLC0415 - few pay for time

    free = [(v, t.means) for v, t in pairs if v.goal.within is not None]
    return effort + per_step * sum(arrival_step(v, means) for v, means in free)


def _difference(name: str, field: str, stated: Tensor, true: Tensor, allowed: Tensor) -> list[str]:
    """Name the first step at which a stated array leaves the true one."""
    excess = np.abs(stated - true) > allowed
    if not excess.any():
        return []
    step, *entry = (int(i) for i in np.argwhere(excess)[0])
    at = (step, *entry)
    return [
        f"vehicle {name!r}: {field} {entry} at step {step} is stated as {stated[at]:.9g}, "
        f"start, controls and noise give {true[at]:.9g}"
    ]


def _gain_problems(vehicle: Vehicle, stated: Trajectory) -> list[str]:
    """Name a feedback gain that is not the scenario's."""
    if vehicle.gain is None or stated.gain is None:
        if vehicle.gain is stated.gain:
            return []
        has, wants = ("a", "none") if vehicle.gain is None else ("no", "one")
        return [f"vehicle {vehicle.name!r}: the plan has {has} feedback gain, the scenario {wants}"]
    off = np.abs(stated.gain - vehicle.gain) > of_gain(vehicle.gain)
    if not off.any():
        return []
    row, column = (int(i) for i in np.argwhere(off)[0])
    return [
        f"vehicle {vehicle.name!r}: gain [{row}, {column}] is stated as "
        f"{stated.gain[row, column]:.9g}, the scenario's is {vehicle.gain[row, column]:.9g}"
    ]


def limit_problems(plan: Plan, motion: FleetMotion) -> list[str]:
    """Return which limits, goals and visits the mean does not keep, beyond a millionth of limits.

    Goals and visits may be missed by 1e-6, as long as that is a thousandth of the radius, or of
    what a step adds to the speed, at most.

    Speeds are checked at k = 1..T: the start is the scenario's, not the plan's.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    motion : FleetMotion
        The true one, under the plan's controls.
    """
    problems = []
    for i in exceeding_limits(plan, motion):
        vehicle, trajectory = plan.scenario.vehicles[i], plan.trajectories[i]
        bounds = _control_bounds(vehicle, motion.seen[i][:-1])
        allowed = beyond_limit(bounds, vehicle.control_limit)
        problems += _excess(vehicle.name, "control", trajectory.controls, bounds, allowed, 0)
        problems += _arrival_problems(vehicle, motion.states[i])
        if vehicle.control_norm is not None or vehicle.speed_norm is not None:
            from radmpc.referee.claims.norms import norm_problems  # noqa: PLC0415 - few have any

            seen = motion.seen[i][:-1]
            problems += norm_problems(vehicle, motion.states[i], trajectory.controls, seen)
        if vehicle.via or vehicle.goal.within is not None:
            from radmpc.referee.claims.visits import arrival_problems, visit_problems  # noqa: PLC0415 - few have any

            problems += visit_problems(vehicle, motion.states[i])
            problems += arrival_problems(vehicle, motion.states[i])
    return problems


def _control_bounds(vehicle: Vehicle, covariances: npt.NDArray[np.float64]) -> Matrix:
    """Return the limit less the reserve for feedback on what it sees of ``x − x̄``, (T or 1, m)."""
    if vehicle.gain is None:
        return vehicle.control_limit[None]
    spread = (vehicle.gain @ covariances) * vehicle.gain
    reserve = vehicle.control_sigmas * np.sqrt(spread.sum(axis=2).clip(min=0.0))
    return np.asarray(vehicle.control_limit - reserve)


def _arrival_problems(vehicle: Vehicle, states: Matrix) -> list[str]:
    """Name speeds above the limit, and a goal that is missed or passed too fast."""
    problems = []
    if vehicle.system.velocity is not None:
        speeds = states[:, list(vehicle.system.velocity)]
        if vehicle.speed_limit is not None:
            limits = vehicle.speed_limit[None]
            allowed = beyond_limit(limits, limits)
            problems += _excess(vehicle.name, "speed", speeds[1:], limits, allowed, 1)
        if vehicle.goal.speed is not None:
            last = len(states) - 1
            goal_speed = vehicle.goal.speed[None, :]
            allowed = of_speeds(vehicle, goal_speed)
            problems += _excess(vehicle.name, "goal speed", speeds[-1:], goal_speed, allowed, last)
    return problems + _goal_problems(vehicle, states[-1, list(vehicle.system.position)])


def _goal_problems(vehicle: Vehicle, position: Vector) -> list[str]:
    """Name the axes on which the mean ends outside the goal."""
    lower, upper = vehicle.goal.lower, vehicle.goal.upper
    allowed = of_place(vehicle)
    missed = (position < lower - allowed) | (position > upper + allowed)
    if not missed.any():
        return []
    return [
        f"vehicle {vehicle.name!r}: ends at {position[a]:.9g} on axis {a}, "
        f"its goal is {lower[a]:.9g} to {upper[a]:.9g}"
        for a in np.flatnonzero(missed)
    ]


def _excess(
    name: str, field: str, values: Matrix, limits: Matrix, allowed: Matrix, first: int
) -> list[str]:
    """Name the first value per axis whose size exceeds its limit by more than is allowed."""
    over = np.abs(values) > limits + allowed
    if not over.any():
        return []
    limits = np.broadcast_to(limits, values.shape)
    problems = []
    for axis in np.flatnonzero(over.any(axis=0)):
        k = int(over[:, axis].argmax())
        problems.append(
            f"vehicle {name!r}: {field} on axis {axis} at step {first + k} is "
            f"{values[k, axis]:.9g}, allowed is up to {limits[k, axis]:.9g} in size"
        )
    return problems
