"""Plans handed on while planners look for better ones."""

from __future__ import annotations

import time

from radmpc.arrays import Matrix
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft
from radmpc.planners.outcome.best_of_all import Cheaper
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
    cheaper : Cheaper
        Takes the plans, those of other assignments of goals among them.
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
        cheaper: Cheaper,
        begun: float,
        referee: Certifying,
    ) -> None:
        self._of, self._seed = (scenario, planner), seed
        self._cheaper, self._begun, self._referee = cheaper, begun, referee
        self._known: tuple[Matrix, ...] = ()

    def __call__(self, controls: tuple[Matrix, ...]) -> None:
        """Judge a plan and hand it on, unless it is known, dearer, or risks too much."""
        if controls is self._known or not controls:
            return
        self._known = controls
        scenario, planner = self._of
        trajectories = trajectories_of(scenario, controls)
        if cost_of(scenario, trajectories) >= self._cheaper.least:
            return
        everyone = (tuple(range(scenario.num_vehicles)),)
        said = self._referee(controls)
        if not said.holds:
            return
        draft = Draft(Status.FEASIBLE, controls, everyone, (), (), {})
        seconds = {"total": time.perf_counter() - self._begun}
        self._cheaper(plan_of(scenario, planner, self._seed, draft, trajectories, said, seconds))
