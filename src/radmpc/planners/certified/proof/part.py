"""A part of the fleet in the proof: what it is given, what is asked of it, and what it answers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from radmpc.arrays import Matrix
from radmpc.gaussian import Tail
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.nearby import Surroundings
from radmpc.planners.certified.proof.grouping import most_fewer
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.symmetry import symmetries
from radmpc.planners.certified.proof.tuning import TUNING
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.program.build import cost_of_time
from radmpc.program.condensed import CondensedModel
from radmpc.program.relaxed.tails import Tails, tails_of
from radmpc.records import dataclass, field, replace

__all__ = [
    "Part",
    "PartAnswer",
    "PartOrder",
    "PartTask",
    "paid_by",
    "paid_for_hazards",
    "tails_for",
]


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Vehicles whose relaxation is searched by itself; pickles.

    Attributes
    ----------
    members : tuple of int
        The vehicles, ascending.
    surroundings : Surroundings
        These vehicles alone, with what they may meet.
    models : tuple of CondensedModel
        Theirs.
    is_narrowed : bool
        Whether reach is narrowed to that of plans that matter.
    base : tuple of float
        What each costs at least in empty space.
    controls : tuple of (T, m) array
        The plan at hand.
    most_over : float
        What the plan at hand costs beyond the least of the whole fleet in empty space.
    tails : Tails or None
        For the fleet's Δ; None to search plans by the program's faces alone.
    below : mapping of tuple of int to float
        What plans by faces of some of them, by their places, cost with their risk at the price at
        least, as the relaxation says.
    symmetries : tuple of tuple of int
        How space can be turned so that the part stays the same, see `symmetries`; none where its
        sets of fewer vehicles are not searched.
    """

    members: Members
    surroundings: Surroundings
    models: tuple[CondensedModel, ...]
    is_narrowed: bool
    base: tuple[float, ...]
    controls: tuple[Matrix, ...]
    most_over: float
    tails: Tails | None
    below: Mapping[Members, float] = field(default_factory=dict)
    symmetries: tuple[Members, ...] = ()

    @classmethod
    def of(
        cls, fleet: Fleet, incumbent: FleetIncumbent, members: Members, tails: Tails | None
    ) -> Part:
        """Return what the proof needs to know of some vehicles.

        Parameters
        ----------
        fleet : Fleet
            The fleet.
        incumbent : FleetIncumbent
            The plan at hand.
        members : tuple of int
            The vehicles, ascending.
        tails : Tails or None
            As in `Part`.
        """
        surroundings = fleet.programs.surroundings_of(members)
        scenario = surroundings.scenario
        models = tuple(fleet.programs.models[i] for i in members)
        is_climbed = len(members) >= TUNING.least_climbed
        return cls(
            members,
            surroundings,
            models,
            len(scenario.obstacles) >= TUNING.many_obstacles,
            tuple(fleet.base[i] for i in members),
            tuple(incumbent.controls[i] for i in members),
            incumbent.cost - sum(fleet.base),
            tails,
            symmetries=symmetries(scenario, models) if is_climbed else (),
        )

    @property
    def scenario(self) -> Scenario:
        """These vehicles alone, with what they may meet."""
        return self.surroundings.scenario

    def paid_for_hazards(self, blocks: Members) -> float:
        """Return what the plan of some vehicles, by their places, costs beyond the least."""
        return sum(
            paid_for_hazards(self.models[block], self.controls[block], self.base[block])
            for block in blocks
        )


@dataclass(frozen=True, slots=True, eq=False)
class PartOrder:
    """What is asked of a part.

    Attributes
    ----------
    price : float
        Cost per unit of probability.
    num_directions : int
        Directions around every hazard [-].
    gap : float
        Relative gap at which a set's search stops [-].
    nodes : int
        Nodes per vehicle of a set [-].
    worth : float
        What a set must promise to be searched, in cost.
    most_nodes : float
        Nodes of all its sets together, after which nothing more is begun [-].
    is_whole : bool
        Whether hazards far from the plan at hand count where they matter; few do.
    most_fewer : int
        Vehicles of the largest sets that are searched before one of more vehicles is [-].
    enough : float
        Bound of the whole part with which that of the fleet is good enough; inf where not known.
    """

    price: float
    num_directions: int
    gap: float
    nodes: int
    worth: float
    most_nodes: float
    is_whole: bool
    most_fewer: int = 2
    enough: float = float("inf")

    @classmethod
    def of_effort(
        cls, effort: int, nodes: int, price: float, worth: float, spare: float
    ) -> PartOrder:
        """Return what is asked in a later effort: more nodes, finer gaps, sets of more vehicles.

        Parameters
        ----------
        effort : int
            How often the nodes are doubled [-].
        nodes : int
            Nodes per vehicle of a set without any more effort [-].
        price, worth
            As in `PartOrder`.
        spare : float
            Nodes of all sets together [-].
        """
        nodes, gap = nodes * 2**effort, TUNING.set_gap * TUNING.finer**effort
        asked = worth, spare, effort > 0, most_fewer(nodes)
        return cls(price, TUNING.directions, gap, nodes, *asked)

    def is_done(self, found: RelaxedSet) -> bool:
        """Tell whether no search of a set at this price is worth more nodes."""
        if found.price != self.price or (self.is_whole and not found.is_complete):
            return False
        is_over = found.is_trivial or found.bound == float("inf")
        return is_over or found.value - found.bound <= self.worth


@dataclass(frozen=True, slots=True, eq=False)
class PartTask:
    """A part to be searched on; pickles.

    Attributes
    ----------
    part : Part
        The vehicles.
    proven : mapping of tuple of int to RelaxedSet
        What is known of some of them, by their places in the part.
    order : PartOrder
        What is asked.
    """

    part: Part
    proven: Mapping[Members, RelaxedSet]
    order: PartOrder

    def to_be_sent(self) -> PartTask:
        """Return the task as other processes are given it."""
        return replace(self, proven={m: found.to_be_sent() for m, found in self.proven.items()})


@dataclass(frozen=True, slots=True, eq=False)
class PartAnswer:
    """What came of an order.

    Attributes
    ----------
    sets : mapping of tuple of int to RelaxedSet
        What is known of the part and of vehicles of it, by their places in it.
    nodes : int
        Spent now [-].
    is_new : bool
        Whether there was anything to do.
    """

    sets: Mapping[Members, RelaxedSet]
    nodes: int
    is_new: bool


def paid_for_hazards(model: CondensedModel, controls: Matrix, base: float) -> float:
    """Return what a vehicle's plan costs beyond the least in empty space.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    controls : (T, m) array
        Its plan.
    base : float
        What it costs at least in empty space.
    """
    effort = model.vehicle.cost_weight * float(np.abs(controls).sum())
    return effort + cost_of_time(model, controls) - base


def paid_by(fleet: Fleet, incumbent: FleetIncumbent, members: Members) -> float:
    """Return what a plan of some vehicles of a fleet costs beyond the least in empty space.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    incumbent : FleetIncumbent
        The plan.
    members : tuple of int
        The vehicles.
    """
    models, base, controls = fleet.programs.models, fleet.base, incumbent.controls
    return sum(paid_for_hazards(models[i], controls[i], base[i]) for i in members)


def tails_for(scenario: Scenario) -> Tails:
    """Return what clearances are charged at least where the referee judges a fleet.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    """
    tail = Tail(scenario.covariance_samples)
    are_integrated = scenario.avoidance == "steps" and scenario.dimension == 2
    return tails_of(scenario.risk_bound, tail, are_integrated=are_integrated and tail.is_gaussian)
