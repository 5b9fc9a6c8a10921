"""The fleet's problem: what a search is given, and what does not change while it runs.

Three quantities of risk are used throughout this package. Δ is the scenario's risk bound, which the
referee's certificate must not exceed. The *budget* is what the union (Boole) bounds of the chosen
rows of the fleet may sum to beyond the risk of the starts; it may exceed Δ, because they sum
to more than the referee finds.

The *unit* is the risk that 1 stands for in the programs: a fixed multiple of Δ, chosen once per
fleet. The rows of one set may sum to one unit at most, and no row may take more than the smaller of
the unit and `CONVEX_RISK`: its row risk cap. The budget never exceeds the unit.

The Lagrange multiplier (shadow price) of the risk bound comes in two scales. A ``unit_price`` is
the cost of one unit of risk; a ``price`` is the cost per unit of probability:
``price = unit_price / unit``.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.programs import SetPrograms
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.endpoints.floors import EndpointHazard, start_hazards
from radmpc.planners.planner import Improved, no_listener
from radmpc.planners.within_norms import models_within_norms
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass, replace
from radmpc.solvers.solution import Limits

__all__ = ["Fleet"]

_TUNED = TUNING.budgets


@dataclass(frozen=True, slots=True, eq=False)
class Fleet:
    """What a search is given: it never changes, and every phase is handed it.

    Attributes
    ----------
    scenario : Scenario
        The fleet.
    gap : float
        The relative gap asked for [-].
    limits : Limits
        When to stop early.
    progress : callable
        Called with the number of sets searched, and of all.
    found : callable
        Called with the cost of the best plan so far and its lower bound; -inf where nothing is
        proven.
    improved : callable
        Given the controls of every better plan.
    executor : Executor or None
        Where sets are searched; None searches here.
    programs : SetPrograms
        The program of every set, built when first asked for.
    unit : float
        The risk that 1 stands for in programs [-], see above.
    first_budget : float
        What union bounds may sum to beyond the starts to begin with [-].
    start_hazards : tuple of EndpointHazard
        What the starts risk, hazard by hazard.
    initial : float
        What they risk in all, whatever the plan [-].
    keeps_norms : bool
        Whether norms of controls or speeds are limited, which programs keep by polytopes.
    least_costs : tuple of float
        What every vehicle costs at least with its visits, or alone among obstacles; empty where
        nobody asked.
    """

    scenario: Scenario
    gap: float
    limits: Limits
    progress: Callable[[int, int], None]
    found: Callable[[float, float], None]
    improved: Improved
    executor: Executor | None
    programs: SetPrograms
    unit: float
    first_budget: float
    start_hazards: tuple[EndpointHazard, ...]
    initial: float
    keeps_norms: bool
    least_costs: tuple[float, ...] = ()

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        gap: float,
        limits: Limits,
        *,
        progress: Callable[[int, int], None] = no_listener,
        found: Callable[[float, float], None] = no_listener,
        improved: Improved = no_listener,
        executor: Executor | None = None,
        is_costless: bool = False,
        hazards: Hazards | None = None,
    ) -> Fleet:
        """Choose the scale of risk; programs are built once they are asked for.

        Parameters
        ----------
        scenario, gap, limits, progress, found, improved, executor
            As in `Fleet`.
        is_costless : bool
            Whether effort counts for nothing, so that at a unit price of 1 only risk is minimized.
        hazards : Hazards or None
            The scenario laid out, if that was done before.

        Returns
        -------
        Fleet
            The problem.
        """
        # Union bounds may sum to more than the referee finds, by a factor that is not known yet.
        risk_bound = scenario.risk_bound
        # Where only risk is minimized, Δ itself is the scale.
        most, begin = (1.0, 1.0) if is_costless else _TUNED.slack[scenario.avoidance]
        unit = most * risk_bound
        if hazards is None:
            hazards = Hazards.of(scenario, models_within_norms(scenario))
        programs = SetPrograms(scenario, unit, hazards, is_costless=is_costless)
        # Under intervals the start is part of what plans choose, and is charged there.
        at_start = scenario.avoidance == "steps"
        at_starts = start_hazards(scenario, programs.models) if at_start else ()
        # Presolved avoidances are not charged here: what they run at most is no part of a bound,
        # and what they run in a plan is for the referee to say.
        initial = sum(hazard.risk for hazard in at_starts)
        return cls(
            scenario,
            gap,
            limits,
            progress,
            found,
            improved,
            executor,
            programs,
            unit,
            first_budget=max(risk_bound, min(begin * risk_bound, _TUNED.fill * unit)) - initial,
            start_hazards=at_starts,
            initial=initial,
            keeps_norms=any(
                vehicle.control_norm is not None or vehicle.speed_norm is not None
                for vehicle in scenario.vehicles
            ),
        )

    def with_limits(self, limits: Limits) -> Fleet:
        """Return the same problem, to be stopped by other limits."""
        return replace(self, limits=limits)

    @property
    def base(self) -> tuple[float, ...]:
        """What every vehicle is known to cost at least."""
        costs = self.programs.least_costs()
        return tuple(map(max, costs, self.least_costs)) if self.least_costs else costs

    @property
    def is_large(self) -> bool:
        """Whether it has so many vehicles that no single set matters much."""
        return self.scenario.num_vehicles > TUNING.sets.many

    @property
    def singles(self) -> tuple[Members, ...]:
        """The partition in which every vehicle is alone."""
        return tuple((i,) for i in range(self.scenario.num_vehicles))

    @property
    def least_budget(self) -> float:
        """What the union bounds of the starts leave of Δ; a little where they exceed it."""
        risk_bound = self.scenario.risk_bound
        return max(risk_bound - self.initial, _TUNED.least_share * risk_bound)

    @property
    def most_budget(self) -> float:
        """The most that union bounds may sum to beyond the starts."""
        return _TUNED.fill * self.unit - self.initial

    def clipped_budget(self, budget: float) -> float:
        """Return a budget that is allowed: Δ at least, the unit at most, less the starts."""
        return max(self.least_budget, min(budget, self.most_budget))

    def first_unit_price(self, budget: float) -> float:
        """Guess the price of one unit of risk from what plans cost without hazards."""
        total = float(sum(self.base))
        guess = max(_TUNED.risk_to_cost * total, 1e-6 * max(1.0, total))
        return guess * self.unit / (budget + self.initial)
