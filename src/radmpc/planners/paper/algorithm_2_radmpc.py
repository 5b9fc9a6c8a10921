"""RADMPC (paper, Algorithm 2): one vehicle at a time, from a common pool of risk."""

from __future__ import annotations

import time
from typing import ClassVar

import numpy as np

from radmpc.arguments import check_word, is_number, value_text
from radmpc.arrays import Vector
from radmpc.errors import ArgumentError, ScenarioError
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft, Event, Step
from radmpc.planners.explain import explain_stuck
from radmpc.planners.paper.approximation import Approximation
from radmpc.planners.paper.blocking import blocking_vehicles, encounter_risks
from radmpc.planners.paper.fleet_model import FleetModel
from radmpc.planners.paper.risk_pool import charged_risks
from radmpc.planners.paper.temporal import (
    TemporalObstacle,
    make_temporal_obstacle,
    standing_obstacle,
)
from radmpc.planners.planner import Decomposition, Planner, Run
from radmpc.planners.policies import Family, Ira, Policy, Solved, SolveRequest
from radmpc.planners.randomness import children
from radmpc.program.build import build_program, controls_of
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.start import start_pair_risk
from radmpc.records import dataclass
from radmpc.solvers.solution import Outcome
from radmpc.wording import number_text, with_options

__all__ = ["Receding", "approximate"]


@dataclass(frozen=True, slots=True)
class Receding(Decomposition):
    """One vehicle at a time, the others as temporal obstacles (paper, Algorithm 2).

    Attributes
    ----------
    covariances : {'schedule', 'reset'}
        Noise seen at absolute step k: that of the final plan, or as a controller that measures
        its state at every step sees it.
    arrivals : {'once', 'every_step'}
        When a vehicle in its goal lowers N*: when it first enters, or, as the pseudo-code has it,
        at every step that it is there.
    sigmas : float
        Half-side of temporal obstacles, beside the radius, in standard deviations. 3 bounds each
        axis; 3.44 the ellipse that holds as much in the plane (99.73 %).
    """

    families: ClassVar[frozenset[Family]] = frozenset({"deterministic", "fixed", "pooled"})
    takes_shared: ClassVar[bool] = False
    plans_visits: ClassVar[bool] = False

    covariances: str = "schedule"
    arrivals: str = "once"
    sigmas: float = 3.0

    def __post_init__(self) -> None:
        """Refuse unknown words."""
        check_word(self.covariances, ("schedule", "reset"), "covariances")
        check_word(self.arrivals, ("once", "every_step"), "arrivals")
        if not (is_number(self.sigmas) and 0.0 <= self.sigmas <= 10.0):
            raise ScenarioError(f"sigmas must lie between 0 and 10, got {value_text(self.sigmas)}")

    def __str__(self) -> str:
        options = [o for o in (self.covariances, self.arrivals) if o not in {"schedule", "once"}]
        options += [f"{number_text(self.sigmas)} sigmas"] if self.sigmas != 3.0 else []
        return with_options("receding", *options)

    def plan(self, scenario: Scenario, planner: Planner, run: Run) -> Draft:
        """Run Algorithm 2 alone: its executed controls are the plan.

        Parameters
        ----------
        scenario, planner, run
            As in `Decomposition.plan`.
        """
        begun = time.perf_counter()
        found = approximate(scenario, planner, run)
        status = Status.LIMIT if found.is_limited else Status.INFEASIBLE
        return Draft(
            status=status if found.controls is None else Status.FEASIBLE,
            controls=found.controls or (),
            sets=tuple((i,) for i in range(scenario.num_vehicles)),
            steps=found.steps,
            events=found.events,
            seconds={"radmpc": time.perf_counter() - begun},
            explanation=explain_stuck(scenario, found.stuck, planner, run.limits),
        )


def approximate(scenario: Scenario, planner: Planner, run: Run) -> Approximation:
    """Run Algorithm 2.

    Parameters
    ----------
    scenario : Scenario
        The question; its Δ fills the pool.
    planner : Planner
        Policy (a pool, or one that needs no risk), solver and gap of the subproblems; its
        decomposition is a `Receding`.
    run : Run
        Limits, progress, and the order of the vehicles at every step.

    Returns
    -------
    Approximation
        Executed controls, couplings, pool.
    """
    state = _Radmpc(scenario, planner, run)
    total = scenario.horizon * scenario.num_vehicles
    if state.risk_pool <= 0.0 and planner.policy.draws_from_pool:
        state.stuck = list(range(scenario.num_vehicles))
        return state.finish()
    for k in range(scenario.horizon):
        state.num_waiting = scenario.num_vehicles
        for done, i in enumerate(run.rng.permutation(scenario.num_vehicles)):
            if run.limits.reached:
                state.is_limited = True
            else:
                state.advance(k, int(i))
            run.progress("radmpc", k * scenario.num_vehicles + done + 1, total)
            if state.stuck or state.is_limited or all(state.stays_in_goal):
                return state.finish()
    return state.finish()


class _Radmpc:
    """The running state of Algorithm 2, named as there."""

    def __init__(self, scenario: Scenario, planner: Planner, run: Run) -> None:
        if not isinstance(planner.decomposition, Receding):
            raise ArgumentError(f"decomposition must be a Receding, got {planner.decomposition}")
        self.scenario = scenario
        self.planner = planner
        self.limits = run.limits
        self.receding = planner.decomposition
        [self.sampler] = children(run.rng, 1)
        self.intervals = scenario.avoidance == "intervals"
        self.fleet = FleetModel.of(scenario, resets=self.receding.covariances == "reset")
        T, N = scenario.horizon, scenario.num_vehicles
        # O <- initTemporalObstacles(V): nobody has a plan yet.
        self.obstacles: list[TemporalObstacle] = [
            standing_obstacle(v, c, intervals=self.intervals, sigmas=self.receding.sigmas)
            for v, c in zip(scenario.vehicles, self.fleet.covariances, strict=True)
        ]
        # Pairs at k = 0 are no part of any subproblem under steps.
        at_start = 0.0 if self.intervals else start_pair_risk(scenario, self.fleet.covariances)
        self.risk_pool = scenario.risk_bound - at_start
        self.charged = np.zeros((N, T + 1))
        self.is_limited = False
        self.stays_in_goal = [False] * N
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
        model = self.fleet.model(k, i, self.means[i])
        # One that has arrived cannot take what those still waiting in this round need.
        waiting = self.num_waiting if self.receding.arrivals == "once" else 1
        share = self.risk_pool / max(self.divisor, waiting)
        program = self._program(model, k, share, self._others(i))
        solved = self._solve(program, i)
        if solved.solution.z is not None:
            self.controls[i][k:] = controls_of([model], solved.solution.z)[0]
            self.has_plan[i] = True
            self.charged[i] = self._charged(program, solved, k)
        else:
            self._fall_back(model, k, i, share)
            if self.stuck or self.is_limited:
                return
        executed = self.charged[i, k + 1] + (self.charged[i, 0] if k == 0 else 0.0)
        self.risk_pool = max(self.risk_pool - executed, 0.0)
        self.num_waiting -= 1
        self.pools.append(self.risk_pool)
        plan = self.fleet.planned(k, i, self.means[i], self.controls[i])
        # The collision probabilities at the subproblem's first step.
        risks = encounter_risks(self.fleet, k, i, plan, self.controls[i], self.obstacles, range(1))
        self.pair_risk[i] = np.maximum(self.pair_risk[i], risks)
        self.means[i] = plan[1]
        in_goal = [vehicle.goal.contains(*self.fleet.place(i, state)) for state in plan[1:]]
        # A plan that leaves the goal again may still meet others: their couplings are not known.
        self.stays_in_goal[i] = all(in_goal)
        if in_goal[0]:
            self._arrive(i)
        self.obstacles[i] = make_temporal_obstacle(
            vehicle,
            plan,
            self.fleet.noise(k, i),
            k,
            intervals=self.intervals,
            controls=self.controls[i][k:],
            sigmas=self.receding.sigmas,
        )

    def _arrive(self, i: int) -> None:
        """Take a vehicle in its goal off N*: once, or as the pseudo-code has it every time."""
        if not self.has_arrived[i] or self.receding.arrivals == "every_step":
            self.divisor = max(self.divisor - 1, 1)
        self.has_arrived[i] = True

    def finish(self) -> Approximation:
        """Return what was executed; vehicles that all stay in their goals keep their plans."""
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

    def _others(self, i: int) -> list[TemporalObstacle]:
        """Return the other vehicles' temporal obstacles."""
        return [o for j, o in enumerate(self.obstacles) if j != i]

    def _program(
        self, model: CondensedModel, k: int, share: float, others: list[TemporalObstacle]
    ) -> DisjunctiveProgram:
        """Build the subproblem: one vehicle, the others as temporal obstacles."""
        last = self.scenario.horizon
        # The piece at k covers the motion to k+1.
        windows = range(k, last) if self.intervals else range(k + 1, last + 1)
        temporal = [o.keepout(windows) for o in others]
        return build_program(
            self.scenario, [model], risk_bound=share, first_step=k, temporal=temporal
        )

    def _solve(self, program: DisjunctiveProgram, i: int, policy: Policy | None = None) -> Solved:
        """Solve a subproblem: fastIRA is one pass at uniform risk."""
        planner = self.planner
        request = SolveRequest(
            program,
            planner.solver,
            planner.gap,
            self.limits,
            "radmpc",
            (self.scenario.vehicles[i].name,),
            rng=self.sampler,
        )
        solved = (policy or planner.policy).solve(request)
        self.steps += solved.steps
        return solved

    def _charged(self, program: DisjunctiveProgram, solved: Solved, k: int) -> Vector:
        """Return what a plan takes from the pool at every step."""
        return charged_risks(program, solved, self.planner.policy, k, self.scenario.horizon)

    def _fall_back(self, model: CondensedModel, k: int, i: int, share: float) -> None:
        """Keep the tail of the last plan; at k = 0 plan without the other vehicles.

        The paper is silent about subproblems without a solution.
        """
        if not self.has_plan[i]:
            program = self._program(model, k, share, [])
            alone = self._solve(program, i)
            is_starved = self.planner.policy.draws_from_pool
            if alone.solution.outcome is Outcome.INFEASIBLE and is_starved:
                alone = self._solve(program, i, Ira(max_iterations=1))
            if alone.solution.z is None:
                if alone.solution.outcome is Outcome.LIMIT:
                    self.is_limited = True
                else:
                    self.stuck.append(i)
                return
            self.controls[i][k:] = controls_of([model], alone.solution.z)[0]
            self.has_plan[i] = True
            self.charged[i] = self._charged(program, alone, k)
        plan = self.fleet.planned(k, i, self.means[i], self.controls[i])
        blocking = blocking_vehicles(
            self.fleet, k, i, plan, self.controls[i], self.obstacles, share
        )
        self.forced += [(i, j) for j in blocking]
        names = tuple(self.scenario.vehicles[j].name for j in blocking)
        self.events.append(Event(k, self.scenario.vehicles[i].name, names))
