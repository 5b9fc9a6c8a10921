"""What vehicles among obstacles cost at least alone, by mixed-integer programs at once."""

from __future__ import annotations

import logging

import numpy as np

from radmpc.gaussian import CONVEX_RISK
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.tuning import TUNING
from radmpc.planners.certified.proof.part import paid_by
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.records import replace
from radmpc.solvers.milp.at_once import minimized_at_once
from radmpc.solvers.milp.big_m import encode
from radmpc.solvers.milp.highs import HighsBackend
from radmpc.solvers.milp.model import MilpModel

__all__ = ["are_bounded_alone", "with_least_alone"]

_LOG = logging.getLogger(__name__)


def with_least_alone(fleet: Fleet, incumbent: FleetIncumbent, risk: float) -> Fleet:
    """Raise what vehicles are known to cost at least, up to what they cost in the plan at hand.

    No row of a plan by faces within Δ risks more than Δ, so that no such plan is cheaper than with
    the margin of that risk at every row. What is asked is whether a vehicle alone can be cheaper
    than in the plan at hand: in narrow ways it is told sooner than what it costs at least.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits that end this: what is not told by then is not raised.
    incumbent : FleetIncumbent
        Its plan.
    risk : float
        What the union bound of plans may come to beyond the starts [-], > 0.

    Returns
    -------
    Fleet
        Whose ``base`` holds for plans by faces within that risk; the same where obstacles leave
        vehicles so many alternatives that the time left says little of them.
    """
    costs, asked = list(fleet.base), _asked(fleet)
    if not asked or fleet.limits.reached:
        return fleet
    planned = {i: costs[i] + paid_by(fleet, incumbent, (i,)) for i in asked}
    models = {i: _cheaper(fleet, i, risk, planned[i]) for i in asked}
    some = {i: model for i, model in models.items() if model is not None}
    backend = HighsBackend(most_nodes=TUNING.most_nodes_alone)
    answers = minimized_at_once(backend, tuple(some.values()), fleet.gap, fleet.limits)
    for i, answer in zip(some, answers, strict=True):
        least, most = min(answer.bound, (1.0 - fleet.gap) * planned[i]), planned[i]
        _LOG.info("vehicle %d alone costs %.6g at least, %.6g in the plan", i + 1, least, most)
        costs[i] = max(costs[i], min(least, most))
    return replace(fleet, least_costs=tuple(costs))


def are_bounded_alone(fleet: Fleet) -> bool:
    """Whether so few vehicles have so few alternatives that such programs tell most of the bound.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with every vehicle's own program built, and the limits that end its search.
    """
    few = TUNING.most_led
    return fleet.scenario.num_vehicles <= few and len(_asked(fleet)) == fleet.scenario.num_vehicles


def _asked(fleet: Fleet) -> list[int]:
    """Return the vehicles among obstacles, if all have few alternatives for the time left."""
    everyone = range(fleet.scenario.num_vehicles)
    asked = [i for i in everyone if fleet.programs.alone((i,)).obstacles]
    counts = [fleet.programs.problem((i,)).program.num_alternatives for i in asked]
    is_little = max(counts, default=0) <= TUNING.most_alternatives
    return asked if is_little and _has_time(fleet, sum(counts)) else []


def _has_time(fleet: Fleet, num_alternatives: int) -> bool:
    """Whether programs with so many alternatives are likely to end in the time left."""
    return TUNING.seconds_each * num_alternatives <= fleet.limits.seconds_left


def _cheaper(fleet: Fleet, i: int, risk: float, planned: float) -> MilpModel | None:
    """Return what asks whether a vehicle alone costs less than in a plan; None says nothing."""
    program = fleet.programs.problem((i,)).program
    are_empty = np.diff(program.avoidance_starts) == 0
    if program.num_avoidances == 0 or np.any(are_empty) or np.any(program.upper < program.lower):
        return None
    margins = program.rows.deviations * float(program.tail.clearance_for(min(risk, CONVEX_RISK)))
    # A vehicle that is dearer by less than the gap is none that closes it.
    return encode(program, margins).costing_at_most((1.0 - fleet.gap) * planned)
