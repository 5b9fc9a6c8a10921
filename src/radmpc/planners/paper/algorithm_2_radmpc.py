"""RADMPC (paper, Algorithm 2): one vehicle at a time, from a common pool of risk."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Event, Step
from radmpc.planners.paper.approximation import Approximation
from radmpc.planners.paper.coupling import face_risk
from radmpc.planners.paper.risk_pool import booked_risks
from radmpc.planners.paper.temporal import (
    TemporalObstacle,
    make_temporal_obstacle,
    standing_obstacle,
)
from radmpc.planners.planner import Receding
from radmpc.planners.under_policy import Solved, solve_under_policy
from radmpc.program.build import build_program, controls_of, responses
from radmpc.program.policy import Ira, Policy, Pool
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.start import start_pair_risk
from radmpc.program.subject import Subject, bent_covariances, make_subject
from radmpc.solvers.solution import Limits, Outcome, Solver

__all__ = ["approximate"]

_NO_ENCOUNTER = 1e-9
"""Collision probability below which a vehicle does not stand in another's way."""


def approximate(
    scenario: Scenario,
    policy: Policy,
    solver: Solver,
    receding: Receding,
    *,
    gap: float,
    rng: np.random.Generator,
    limits: Limits,
    progress: Callable[[int, int], None],
) -> Approximation:
    """Run Algorithm 2.

    Parameters
    ----------
    scenario : Scenario
        The question; its Δ fills the pool.
    policy : Policy
        Pool, or one that needs no risk.
    solver : Solver
        For the subproblems.
    receding : Receding
        Options.
    gap : float
        Relative gap of the subproblems.
    rng : Generator
        For the order of the vehicles at every step.
    limits : Limits
        When to stop early.
    progress : callable
        Told how many subproblems are done, of how many at most.

    Returns
    -------
    Approximation
        Executed controls, couplings, pool.
    """
    run = _Radmpc(scenario, policy, solver, receding, gap, limits)
    total = scenario.horizon * scenario.num_vehicles
    if run.risk_pool <= 0.0 and isinstance(policy, Pool):
        run.stuck = list(range(scenario.num_vehicles))
        return run.finish()
    for k in range(scenario.horizon):
        run.num_waiting = scenario.num_vehicles
        for done, i in enumerate(rng.permutation(scenario.num_vehicles)):
            if limits.reached:
                run.is_limited = True
            else:
                run.advance(k, int(i))
            progress(k * scenario.num_vehicles + done + 1, total)
            if run.stuck or run.is_limited or run.num_traveling == 0:
                return run.finish()
    return run.finish()


class _Radmpc:
    """The running state of Algorithm 2, named as there."""

    def __init__(
        self,
        scenario: Scenario,
        policy: Policy,
        solver: Solver,
        receding: Receding,
        gap: float,
        limits: Limits,
    ) -> None:
        self.scenario = scenario
        self.policy = policy
        self.solver = solver
        self.gap = gap
        self.limits = limits
        self.receding = receding
        self.resets = receding.covariances == "reset"
        self.intervals = scenario.avoidance == "intervals"
        T, N = scenario.horizon, scenario.num_vehicles
        self.responses = responses(scenario)
        self.covariances = [v.covariances(T) for v in scenario.vehicles]
        self.bounds = [
            v.control_bounds(c) for v, c in zip(scenario.vehicles, self.covariances, strict=True)
        ]
        # O <- initTemporalObstacles(V): nobody has a plan yet.
        self.obstacles: list[TemporalObstacle] = [
            standing_obstacle(v, c, intervals=self.intervals, sigmas=receding.sigmas)
            for v, c in zip(scenario.vehicles, self.covariances, strict=True)
        ]
        # Pairs at k = 0 are no part of any subproblem under steps.
        at_start = 0.0 if self.intervals else start_pair_risk(scenario, self.covariances)
        self.risk_pool = scenario.risk_bound - at_start
        self.booked = np.zeros((N, T + 1))
        self.is_limited = False
        self.num_traveling = N
        self.divisor = N
        self.num_waiting = N
        self.has_arrived = [False] * N
        self.means = [v.start for v in scenario.vehicles]
        self.controls = [np.zeros((T, v.system.num_controls)) for v in scenario.vehicles]
        self.has_plan = [False] * N
        self.pair_risk = np.zeros((N, N))
        self.forced: list[tuple[int, int]] = []
        self.pools: list[float] = []
        self.steps: list[Step] = []
        self.events: list[Event] = []
        self.stuck: list[int] = []

    def advance(self, k: int, i: int) -> None:
        """Solve vehicle i's subproblem at step k and execute its first control."""
        vehicle = self.scenario.vehicles[i]
        subject = self._subject(k, i)
        # One that has arrived cannot take what those still waiting in this round need.
        waiting = self.num_waiting if self.receding.arrivals == "once" else 1
        share = self.risk_pool / max(self.divisor, waiting)
        program = self._program(subject, k, share, self._others(i))
        solved = self._solve(program, i)
        if solved.solution.z is not None:
            self.controls[i][k:] = controls_of([subject], solved.solution.z)[0]
            self.has_plan[i] = True
            self.booked[i] = booked_risks(program, solved, self.policy, k, self.scenario.horizon)
        else:
            self._fall_back(subject, k, i, share)
            if self.stuck or self.is_limited:
                return
        executed = self.booked[i, k + 1] + (self.booked[i, 0] if k == 0 else 0.0)
        self.risk_pool = max(self.risk_pool - executed, 0.0)
        self.num_waiting -= 1
        self.pools.append(self.risk_pool)
        plan = self._planned(k, i)
        self._record_risks(k, i, plan)
        self.means[i] = plan[1]
        if vehicle.goal.contains(*self._place(i, plan[1])):
            self._arrive(i)
        self.obstacles[i] = make_temporal_obstacle(
            vehicle,
            plan,
            self._noise(k, i),
            k,
            intervals=self.intervals,
            controls=self.controls[i][k:],
            sigmas=self.receding.sigmas,
        )

    def _arrive(self, i: int) -> None:
        """Take a vehicle in its goal off N*: once, or as the pseudo-code has it every time."""
        if not self.has_arrived[i] or self.receding.arrivals == "every_step":
            self.divisor = max(self.divisor - 1, 1)
        if not self.has_arrived[i]:
            self.has_arrived[i] = True
            self.num_traveling -= 1

    def finish(self) -> Approximation:
        """Return what was executed; vehicles that all arrived early keep their last plans."""
        complete = not self.is_limited and not self.stuck
        return Approximation(
            controls=tuple(self.controls) if complete else None,
            pair_risk=self.pair_risk,
            forced=tuple(self.forced),
            pool=tuple(self.pools),
            steps=tuple(self.steps),
            events=tuple(self.events),
            stuck=tuple(self.stuck),
            is_limited=self.is_limited,
        )

    def _subject(self, k: int, i: int) -> Subject:
        """Return vehicle i from its present mean on."""
        return make_subject(
            self.scenario.vehicles[i],
            self.responses[i],
            self.means[i],
            self._noise(k, i),
            self.bounds[i][k:],
        )

    def _noise(self, k: int, i: int) -> Tensor:
        """Return the covariances from step k on: of the final plan, or as if just measured."""
        whole = self.covariances[i]
        return whole[: len(whole) - k] if self.resets else whole[k:]

    def _others(self, i: int) -> list[TemporalObstacle]:
        """Return the other vehicles' temporal obstacles."""
        return [o for j, o in enumerate(self.obstacles) if j != i]

    def _program(
        self, subject: Subject, k: int, share: float, others: list[TemporalObstacle]
    ) -> DisjunctiveProgram:
        """Build the subproblem: one vehicle, the others as temporal obstacles."""
        last = self.scenario.horizon
        # The piece at k covers the way to k+1.
        windows = range(k, last) if self.intervals else range(k + 1, last + 1)
        temporal = [o.keepout(windows) for o in others]
        return build_program(
            self.scenario, [subject], risk_bound=share, first_step=k, temporal=temporal
        )

    def _solve(self, program: DisjunctiveProgram, i: int, policy: Policy | None = None) -> Solved:
        """Solve a subproblem: fastIRA is one pass at uniform risk."""
        name = self.scenario.vehicles[i].name
        solved = solve_under_policy(
            program,
            policy or self.policy,
            self.solver,
            gap=self.gap,
            limits=self.limits,
            stage="radmpc",
            vehicles=(name,),
        )
        self.steps += solved.steps
        return solved

    def _fall_back(self, subject: Subject, k: int, i: int, share: float) -> None:
        """Keep the tail of the last plan; at k = 0 plan without the other vehicles.

        The paper is silent about subproblems without a solution.
        """
        if not self.has_plan[i]:
            program = self._program(subject, k, share, [])
            alone = self._solve(program, i)
            if alone.solution.outcome is Outcome.INFEASIBLE and isinstance(self.policy, Pool):
                alone = self._solve(program, i, Ira(max_iterations=1))
            if alone.solution.z is None:
                if alone.solution.outcome is Outcome.LIMIT:
                    self.is_limited = True
                else:
                    self.stuck.append(i)
                return
            self.controls[i][k:] = controls_of([subject], alone.solution.z)[0]
            self.has_plan[i] = True
            self.booked[i] = booked_risks(program, alone, self.policy, k, self.scenario.horizon)
        blocking = self._blocking(k, i, share)
        self.forced += [(i, j) for j in blocking]
        names = tuple(self.scenario.vehicles[j].name for j in blocking)
        self.events.append(Event(k, self.scenario.vehicles[i].name, names))

    def _blocking(self, k: int, i: int, share: float) -> list[int]:
        """Return the vehicles whose temporal obstacles the kept plan comes too close to."""
        plan = self._planned(k, i)
        risks = np.zeros(self.scenario.num_vehicles)
        for j in range(self.scenario.num_vehicles):
            if j != i:
                windows = range(len(plan) - 1)
                risks[j] = max(self._window_risk(i, j, k, plan, w) for w in windows)
        # A uniform share is at least this much; whoever exceeds it stands in the way.
        least = share / max(len(plan) * self.scenario.num_vehicles, 1)
        found = np.flatnonzero(risks > max(least, _NO_ENCOUNTER))
        return [int(j) for j in found if j != i]

    def _record_risks(self, k: int, i: int, plan: Matrix) -> None:
        """Note the collision probabilities at the subproblem's first step."""
        for j in range(self.scenario.num_vehicles):
            if j != i:
                risk = self._window_risk(i, j, k, plan, 0)
                self.pair_risk[i, j] = max(self.pair_risk[i, j], risk)

    def _window_risk(self, i: int, j: int, k: int, plan: Matrix, window: int) -> float:
        """Return the risk of i with j's temporal obstacle in one window after step k."""
        vehicle = self.scenario.vehicles[i]
        system, axes = vehicle.system, list(vehicle.system.position)
        noise = self._noise(k, i)
        places = [(plan[s][axes], noise[s][axes][:, axes]) for s in (window, window + 1)]
        if not self.intervals:
            return face_risk(self.obstacles[j].at(k + window + 1), vehicle.radius, places[1:])
        near = places[:1]
        bent = bent_covariances(vehicle, noise[window : window + 2])
        if bent is not None:
            near.append((places[0][0], bent[0]))
        return face_risk(
            self.obstacles[j].at(k + window),
            vehicle.radius,
            near,
            places[1],
            system.sagitta @ self.controls[i][k + window],
        )

    def _planned(self, k: int, i: int) -> Matrix:
        """Return vehicle i's planned means from step k to the horizon."""
        controls = self.controls[i][k:].ravel()
        response = self.responses[i]
        steps = self.scenario.horizon - k
        states = response.powers[: steps + 1] @ self.means[i]
        return np.asarray(states + response.states[: steps + 1, :, : controls.size] @ controls)

    def _place(self, i: int, mean: Vector) -> tuple[Vector, Vector | None]:
        """Return position and velocity of a state."""
        system = self.scenario.vehicles[i].system
        velocity = None if system.velocity is None else mean[list(system.velocity)]
        return mean[list(system.position)], velocity
