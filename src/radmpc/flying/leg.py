"""A leg: what is flown from some step on, and the rows it was adopted with."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector, as_matrix, unchecked
from radmpc.flying.knowing import (
    acted_on,
    best_of,
    estimates_together,
    expected_start,
    known_loop,
    renewed,
)
from radmpc.model.dynamics import rollout
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.model.relations.alike import covariances_of_all
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, replace
from radmpc.referee.claims.claims import cost_of, limit_problems
from radmpc.referee.claims.visits import time_to_come
from radmpc.referee.conditional.conditional import Conditional, conditional, witnesses_of
from radmpc.referee.conditional.rows import Witnesses
from radmpc.referee.conditional.scales import Scale

__all__ = ["Leg", "Outlook", "leg_of", "miss_of"]


@dataclass(frozen=True, slots=True)
class Outlook:
    """Effort and miss of what remains of a leg, by its mean.

    Attributes
    ----------
    effort : float
        ``Σ weight · ‖u‖₁`` still to come, feedback included, and times until arrival.
    miss : float
        By how much means end outside their goals: the sum over vehicles of meters, and of the
        excess of speed times a step [m].
    """

    effort: float
    miss: float


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """A plan of the steps that are left, and its rows.

    Attributes
    ----------
    began : int
        The mission's step at which it begins.
    witnesses : Witnesses
        What it was certified by; holds the plan.
    scale : Scale
        What its scenario takes for known of the factor of covariances, beside those stated first.
    """

    began: int
    witnesses: Witnesses
    scale: Scale

    @property
    def plan(self) -> Plan:
        """The plan, its step 0 being the step at which the leg begins."""
        return self.witnesses.plan

    def problems(self, scenario: Scenario) -> list[str]:
        """Return limits and goals that its nominal does not keep, one sentence each.

        Parameters
        ----------
        scenario : Scenario
            Whose limits and goals; of as many steps.
        """
        return limit_problems(replace(self.plan, scenario=scenario), self.witnesses.motion)

    @property
    def price(self) -> float:
        """What it costs where it begins: its certificate [-]."""
        return conditional(self.witnesses, 0, None).total

    def value(self, step: int, states: Sequence[Vector], scale: Scale | None = None) -> Conditional:
        """Return what is left of it.

        Parameters
        ----------
        step : int
            Of the mission.
        states : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
            What is known there: see `radmpc.flying.knowing`.
        scale : Scale or None
            What is known of the factor of covariances, beside those stated first; None where they
            are known.
        """
        now = None if scale is None else scale.since(self.scale)
        return conditional(self.witnesses, step - self.began, states, now)

    def begun(self, states: Sequence[Vector]) -> tuple[Vector, ...]:
        """Return what is known where it is adopted: see `radmpc.flying.knowing.renewed`.

        Parameters
        ----------
        states : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
            What is known there.
        """
        return renewed(self.plan.scenario.vehicles, states)

    def controls(self, step: int, states: Sequence[Vector]) -> tuple[Vector, ...]:
        """Return ``ū + K (x − x̄)`` of all vehicles, whatever the limits.

        Parameters
        ----------
        step : int
            Of the mission.
        states : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
            What is known there: see `radmpc.flying.knowing`.
        """
        k = step - self.began
        asked = []
        for i, path in enumerate(self.plan.trajectories):
            control, nominal = path.controls[k], self.witnesses.motion.states[i][k]
            if path.gain is not None:
                state = acted_on(self.plan.scenario.vehicles[i], states[i])
                control = control + path.gain @ (state - nominal)
            asked.append(control)
        return tuple(asked)

    def expected(
        self, step: int, states: Sequence[Vector], controls: Sequence[Vector]
    ) -> tuple[Vector, ...]:
        """Return the mean states at the next step under the controls that are flown.

        Parameters
        ----------
        step : int
            Of the mission.
        states : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
            What is known there: see `radmpc.flying.knowing`.
        controls : sequence of (m,) array
            What is flown over the step.
        """
        k = step - self.began
        means = []
        for i, vehicle in enumerate(self.plan.scenario.vehicles):
            nominal = self._nominal(i)
            A, B, _ = known_loop(vehicle)
            pushed = controls[i] - self.plan.trajectories[i].controls[k]
            off = A @ (states[i] - nominal[k]) + B @ pushed
            means.append(nominal[k + 1] + off)
        return tuple(means)

    def outlook(self, step: int, states: Sequence[Vector]) -> Outlook:
        """Return the effort still to come and by how much goals are missed, of the mean.

        Parameters
        ----------
        step : int
            Of the mission.
        states : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
            What is known there: see `radmpc.flying.knowing`.
        """
        effort, miss = time_to_come(self.plan, step - self.began), 0.0
        for i, (pushed, end) in enumerate(self._means(step, states)):
            vehicle = self.plan.scenario.vehicles[i]
            effort += vehicle.cost_weight * float(np.abs(pushed).sum())
            miss += miss_of(vehicle, end, self.plan.scenario.dt)
        return Outlook(effort, miss)

    def _nominal(self, number: int) -> Matrix:
        """Return the known state of a vehicle that flies as planned, (T+1, n) or (T+1, 2 n + s)."""
        motion, vehicle = self.witnesses.motion, self.plan.scenario.vehicles[number]
        path, lasting = motion.states[number], motion.lasting[number]
        size, copies = expected_start(vehicle).size, 3 if estimates_together(vehicle) else 1
        if size == path.shape[1]:
            return path
        rest = np.zeros((len(path), size // copies - path.shape[1])) if lasting is None else lasting
        return np.hstack([path, rest] * copies)

    def mean_controls(self, step: int, states: Sequence[Vector]) -> tuple[Matrix, ...]:
        """Return the controls still to come on average, feedback included, (T - k, m) each.

        Parameters
        ----------
        step : int
            Of the mission.
        states : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
            What is known there: see `radmpc.flying.knowing`.
        """
        return tuple(pushed for pushed, _ in self._means(step, states))

    def _means(self, step: int, states: Sequence[Vector]) -> Iterator[tuple[Matrix, Vector]]:
        """Yield every vehicle's mean controls to come, and where its mean ends."""
        k = step - self.began
        states = self.begun(states)  # on average a leg's filters come to know what all tell
        for i, vehicle in enumerate(self.plan.scenario.vehicles):
            nominal = self._nominal(i)
            pushed = self.plan.trajectories[i].controls[k:].copy()
            deviation = states[i] - nominal[k]
            if not deviation.any():
                yield pushed, best_of(vehicle, nominal[-1])
                continue
            A, B, gain = known_loop(vehicle)
            loop = A if gain is None else A + B @ gain
            for number in range(len(pushed)):
                if gain is not None:
                    pushed[number] += gain @ deviation
                deviation = loop @ deviation
            yield pushed, best_of(vehicle, nominal[-1] + deviation)


def leg_of(
    scenario: Scenario, controls: Sequence[Matrix], began: int, scale: Scale | None = None
) -> Leg:
    """Return the leg that flies some controls.

    Parameters
    ----------
    scenario : Scenario
        Of the steps that are left.
    controls : sequence of (T, m) array
        Nominal controls of all vehicles.
    began : int
        The mission's step at which it begins.
    scale : Scale or None
        What the scenario takes for known of the factor of covariances, beside those stated first;
        None where the scenario has those.

    Returns
    -------
    Leg
        Everything else in it follows from scenario and controls.

    Raises
    ------
    ScenarioError
        If controls do not fit the scenario, or are not finite.
    """
    trajectories = []
    spreads = covariances_of_all(scenario.vehicles, scenario.horizon)
    both = zip(scenario.vehicles, spreads, controls, strict=True)
    for i, (vehicle, spread, given) in enumerate(both):
        shape = (scenario.horizon, vehicle.system.num_controls)
        pushed = as_matrix(given, shape, ("vehicles", i, "controls"))
        means = rollout(vehicle.system, vehicle.start, pushed, vehicle.pushes(scenario.horizon))
        # What it would check was checked, or is, overflow too, where its rows are bought.
        path = unchecked(Trajectory, vehicle.name, pushed, means, spread, vehicle.gain)
        trajectories.append(path)
    plan = Plan(
        scenario=scenario,
        planner="under way",
        seed=None,
        status=Status.FEASIBLE,
        cost=None,
        lower_bound=None,
        risk=Risk(scenario.risk_bound),
        sets=(tuple(v.name for v in scenario.vehicles),),
        trajectories=tuple(trajectories),
    )
    known = Scale(scenario.covariance_samples) if scale is None else scale
    return Leg(began, witnesses_of(replace(plan, cost=cost_of(plan))), known)


def miss_of(vehicle: Vehicle, state: Vector, dt: float) -> float:
    """Return by how much a state is outside of a goal [m].

    Parameters
    ----------
    vehicle : Vehicle
        With the goal.
    state : (n,) array
        At the end.
    dt : float
        A step [s]: what a speed in excess counts.
    """
    place = state[list(vehicle.system.position)]
    goal = vehicle.goal
    outside = np.maximum(np.maximum(goal.lower - place, place - goal.upper), 0.0)
    total = math.sqrt(outside @ outside)
    if goal.speed is not None and vehicle.system.velocity is not None:
        excess = np.maximum(np.abs(state[list(vehicle.system.velocity)]) - goal.speed, 0.0)
        total += dt * math.sqrt(excess @ excess)
    return total
