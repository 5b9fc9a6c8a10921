"""The paper's Algorithm 1: RADMPC finds which vehicles interact, then plans each set."""

from __future__ import annotations

import logging
import time
from typing import ClassVar

from radmpc.arguments import is_number, value_text
from radmpc.errors import ScenarioError
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft, Step
from radmpc.planners.paper.algorithm_2_radmpc import Receding, approximate
from radmpc.planners.paper.coupling import connected_sets, couplings_of, share_couplings
from radmpc.planners.planner import Decomposition, Planner, Run
from radmpc.planners.policies import Pool
from radmpc.planners.sets import SetPlan, in_order, plan_sets, verdict_of_sets
from radmpc.records import dataclass, field
from radmpc.solvers.solution import Outcome
from radmpc.wording import count_text, number_text, with_options

__all__ = ["Couplings"]

_LOG = logging.getLogger(__name__)

_MOST_TOGETHER = 12
"""Sets that are planned as one after some of them had no plan on its own share."""


@dataclass(frozen=True, slots=True)
class Couplings(Decomposition):
    """Sets that a receding approximation found to interact (paper, Algorithm 1).

    Attributes
    ----------
    threshold : float
        Ψ: vehicles are coupled if their collision probability in the approximation exceeds it.
    approximation : Receding
        How the approximation is made.
    approximation_policy : Pool
        Its risk policy.
    """

    needs_proof: ClassVar[bool] = True
    takes_shared: ClassVar[bool] = False
    plans_visits: ClassVar[bool] = False

    threshold: float = 1e-6
    approximation: Receding = field(default_factory=Receding)
    approximation_policy: Pool = field(default_factory=Pool)

    def __post_init__(self) -> None:
        """Refuse thresholds that are no probability."""
        if not (is_number(self.threshold) and 0.0 <= self.threshold <= 1.0):
            raise ScenarioError(
                f"couplings threshold must be in [0, 1], got {value_text(self.threshold)}"
            )
        for name, kind in (("approximation", Receding), ("approximation_policy", Pool)):
            part = getattr(self, name)
            if not isinstance(part, kind):
                raise ScenarioError(f"{name} must be a {kind.__name__}, got {value_text(part)}")

    def __str__(self) -> str:
        how = "" if self.approximation == Receding() else str(self.approximation)
        policy = "" if self.approximation_policy == Pool() else str(self.approximation_policy)
        return with_options("couplings", number_text(self.threshold), how, policy)

    def plan(self, scenario: Scenario, planner: Planner, run: Run) -> Draft:
        """Run Algorithm 1: approximate, find couplings, plan every set with its share of Δ.

        The sets are the connected components of the coupling graph; all vehicles together where
        a share by head count was too little for some of them.

        Parameters
        ----------
        scenario, planner, run
            As in `Decomposition.plan`.
        """
        begun = time.perf_counter()
        first = Planner(self.approximation_policy, planner.solver, self.approximation, planner.gap)
        found = approximate(scenario, first, run)
        approximated = time.perf_counter()
        seconds = {"radmpc": approximated - begun}
        if found.is_limited:
            return Draft(Status.LIMIT, (), (), found.steps, found.events, seconds)
        everyone: tuple[tuple[int, ...], ...] = (tuple(range(scenario.num_vehicles)),)
        sets = everyone
        if not found.stuck:
            sets = connected_sets(found.pair_risk, self.threshold, found.forced)

        _LOG.info(
            "approximation: %.2f s, %s without a solution; %s, the largest of %d",
            seconds["radmpc"],
            count_text(len(found.events), "subproblem"),
            count_text(len(sets), "set"),
            max(len(members) for members in sets),
        )

        edges = couplings_of(scenario, found.pair_risk, self.threshold, found.forced)
        plans = plan_sets(scenario, sets, planner, run, "sets")
        steps = found.steps + _steps_of(plans)
        if any(p.outcome is Outcome.INFEASIBLE for p in plans) and 1 < len(sets) <= _MOST_TOGETHER:
            # Shares by head count may starve a set that needs more: together they may share freely.
            edges += share_couplings(scenario, sets)
            sets, plans = everyone, plan_sets(scenario, everyone, planner, run, "sets")
            steps += _steps_of(plans)
        seconds["sets"] = time.perf_counter() - approximated
        status, why = verdict_of_sets(scenario, sets, plans, run.limits)
        ordered = in_order(sets, plans) if status is Status.FEASIBLE else ()
        return Draft(status, ordered, sets, steps, found.events, seconds, why, couplings=edges)


def _steps_of(plans: list[SetPlan]) -> tuple[Step, ...]:
    """Return the solves of all sets."""
    return tuple(step for plan in plans for step in plan.steps)
