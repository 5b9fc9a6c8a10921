"""Plans handed on while planners look for better ones."""

from __future__ import annotations

import time
from collections.abc import Callable

from radmpc.arrays import Matrix
from radmpc.model.plan import Plan, Status
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft
from radmpc.planners.outcome.record import Certifying, plan_of
from radmpc.planners.outcome.trajectories import cost_of, trajectories_of
from radmpc.planners.planner import Planner

__all__ = ["Improving"]


class Improving:
    """Hands on a plan that is cheaper than all before it, with its certificate.

    Parameters
    ----------
    scenario : Scenario
        What is planned.
    planner : Planner
        By whom.
    seed : int or None
        Of its random choices, where it was a number.
    improved : callable
        Takes the plans.
    begun : float
        Value of ``time.perf_counter()`` at which planning began [s].
    referee : Certifying
        Judges them.
    """

    def __init__(
        self,
        scenario: Scenario,
        planner: Planner,
        seed: int | None,
        improved: Callable[[Plan], None],
        begun: float,
        referee: Certifying,
    ) -> None:
        self._of, self._seed = (scenario, planner), seed
        self._improved, self._begun, self._referee = improved, begun, referee
        self._known: tuple[Matrix, ...] = ()
        self._least = float("inf")

    def __call__(self, controls: tuple[Matrix, ...]) -> None:
        """Judge a plan and hand it on, unless it is known, dearer, or risks too much."""
        if controls is self._known or not controls:
            return
        self._known = controls
        scenario, planner = self._of
        trajectories = trajectories_of(scenario, controls)
        if cost_of(scenario, trajectories) >= self._least:
            return
        everyone = (tuple(range(scenario.num_vehicles)),)
        said = self._referee(controls)
        if not said.holds:
            return
        draft = Draft(Status.FEASIBLE, controls, everyone, (), (), {})
        seconds = {"total": time.perf_counter() - self._begun}
        judged = plan_of(scenario, planner, self._seed, draft, trajectories, said, seconds)
        self._least = float("inf") if judged.cost is None else judged.cost
        self._improved(judged)
