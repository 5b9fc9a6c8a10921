"""Which course the search for a plan takes: what follows its first plan."""

from __future__ import annotations

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.tuning import TUNING
from radmpc.planners.certified.proof.tuning import TUNING as PROOF_TUNING
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.turned.tuning import TUNING as TURNED_TUNING
from radmpc.solvers.solution import relative_gap

__all__ = ["is_among_many", "is_dear_alone", "is_dear_between_few", "is_tight_scene"]


def is_tight_scene(scenario: Scenario) -> bool:
    """Whether the relaxation mostly comes as near to certified plans as is asked, and soon.

    In larger fleets the search over faces takes no longer; among many obstacles this has no end.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    """
    is_small = scenario.num_vehicles <= TURNED_TUNING.few
    is_small &= len(scenario.obstacles) < max(PROOF_TUNING.many_obstacles, scenario.num_vehicles)
    is_planar = scenario.dimension == 2 and not scenario.has_windows
    return scenario.avoidance == "steps" and is_planar and is_small


def is_dear_between_few(fleet: Fleet, first: FleetIncumbent) -> bool:
    """Whether a few vehicles give up much for each other between a few obstacles.

    Sets searched at a price lead nowhere there. Of more vehicles, or among more obstacles, they
    do, and sooner than neighborhoods.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits that end the search.
    first : FleetIncumbent
        A certified plan.
    """
    scenario, tuned = fleet.scenario, TURNED_TUNING
    is_fit = 0 < len(scenario.obstacles) < tuned.many_obstacles
    is_fit &= scenario.num_vehicles < tuned.many
    is_fit &= max(map(len, first.sets), default=0) >= TUNING.least_together
    return is_fit and _is_dear(fleet, first)


def is_dear_alone(fleet: Fleet, first: FleetIncumbent) -> bool:
    """Whether a few vehicles give up much among many obstacles, each with few alternatives.

    Mixed-integer programs of each alone tell what faces cost at least there, given the time that
    sets would be searched in for little: the half-spaces of `parking` gain 0.2 % in 15 s.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits that end the search.
    first : FleetIncumbent
        A certified plan.
    """
    if len(fleet.scenario.obstacles) < TURNED_TUNING.many_obstacles or not _is_dear(fleet, first):
        return False
    from radmpc.planners.certified.phases.least_alone import are_bounded_alone  # noqa: PLC0415 - few need it

    return are_bounded_alone(fleet)


def _is_dear(fleet: Fleet, first: FleetIncumbent) -> bool:
    """Whether a plan is so dear that the search for sets may be left for something else."""
    scenario = fleet.scenario
    # Without a limit a search is to come to its end, whatever that takes.
    is_fit = not (is_tight_scene(scenario) or scenario.has_windows)
    is_fit &= fleet.limits.seconds_left < np.inf
    return is_fit and relative_gap(first.cost, float(sum(fleet.base))) > TUNING.dear


def is_among_many(fleet: Fleet) -> bool:
    """Whether several vehicles go among many obstacles, few enough to look at each.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    """
    scenario = fleet.scenario
    is_many = len(scenario.obstacles) >= PROOF_TUNING.many_obstacles
    is_many &= scenario.num_vehicles >= TUNING.least_vehicles
    return is_many and not (is_tight_scene(scenario) or fleet.is_large or scenario.has_windows)
