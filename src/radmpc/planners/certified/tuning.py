"""The numbers that the certified planner was tuned with, in one record, phase by phase."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from radmpc.records import dataclass, field

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class BudgetTuning:
    """How much union bounds may sum to.

    Attributes
    ----------
    slack : mapping of str to tuple of float
        The unit, and the budget to begin with, in multiples of Δ [-]. Union bounds sum to 1.3 to
        2.5 times the certificate on `paper(8)` at steps, often to 10 times along intervals.
    fill : float
        Share of the unit up to which the budget may grow [-].
    least_share : float
        Least budget as a share of Δ [-]: starts may risk less than their union bounds.
    risk_to_cost : float
        First guess of what the whole budget is worth, as a share of costs without hazards [-].
    spent : float
        Share of Δ from which on the certificate counts as having used it up [-].
    nearly : float
        The same in a large fleet [-]: a budget more takes up to a second of `fleet(1000)`, and
        turned plans are as cheap, to 0.02 % either way.
    """

    slack: Mapping[str, tuple[float, ...]] = field(
        default_factory=lambda: MappingProxyType({"steps": (4.0, 1.5), "intervals": (12.0, 4.0)})
    )
    fill: float = 0.9
    least_share: float = 1e-2
    risk_to_cost: float = 0.006
    spent: float = 0.85
    nearly: float = 0.6


@dataclass(frozen=True, slots=True)
class SetTuning:
    """How sets are searched and merged.

    Attributes
    ----------
    gap_share : float
        Share of the gap that the sets' own searches may use [-]; the rest is for the price.
    nodes : int
        Nodes of the search tree that a set gets per vehicle and round [-], multiplied by the
        effort.
    many : int
        Vehicles up to which a fleet is small [-]: in larger ones no set matters much.
    fleet_share : float
        Share of a large fleet's least cost that the gap of sets of three and more refers to [-]:
        the hardest of `fleet(256)` takes 673 nodes, not 1,028; the turned plan is as cheap.
    trial_nodes : int
        Nodes per vehicle of a set until an initial plan was tried [-]: beyond, it counts as hard.
    trial_nodes_alone : int
        Nodes of a vehicle alone until an initial plan was tried [-].
    patience : int
        Nodes per vehicle without any plan before heuristics look for one [-].
    rescue_nodes : int
        Nodes per vehicle that these get [-], a few more than those after which `branch` turns to
        heuristics: any plan will do, for half-spaces turned to it are better than faces.
    merging_rounds : int
        Rounds of merging sets and planning them anew, at most [-]: what is then left between sets
        is charged to the budget.
    negligible : float
        Share of the unit that the risk between two sets may take before they are merged [-].
    inter_set_gap_share : float
        Share of the gap that risk between sets may cost before they are merged [-].
    inter_set_budget_share : float
        Share of the budget that risk between sets may take before they are merged [-].
    """

    gap_share: float = 0.5
    nodes: int = 400
    many: int = 48
    fleet_share: float = 0.25
    trial_nodes: int = 60
    trial_nodes_alone: int = 150
    patience: int = 60
    rescue_nodes: int = 80
    merging_rounds: int = 8
    negligible: float = 1e-3
    inter_set_gap_share: float = 0.1
    inter_set_budget_share: float = 0.2


@dataclass(frozen=True, slots=True)
class PriceTuning:
    """Which price follows which.

    Attributes
    ----------
    more_effort : int
        Factor by which searches that left too much open get more nodes [-].
    overdrawn : float
        Multiple of the budget that plans may risk at a price worth a search [-].
    most_effort : int
        Effort beyond which more does not help [-]: what is left are programs that no solver solves.
    max_prices_alone : int
        Prices that vehicles alone are tried at [-]: linear programs at chosen alternatives.
    dearest_alone : float
        Multiple of the first guess that a price from vehicles alone may reach [-].
    little : float
        Share of the unit below which a vehicle's plan is not replanned at a new price [-].
    dearest_step : float
        Multiple of the first price that no price exceeds [-]: nothing but risk counts there.
    steepness : float
        Power of the ratio of risk to budget that the price follows [-]: risk falls a little less
        than in proportion.
    unused : float
        Share of the budget that may stay unused when the price is right [-].
    max_rounds : int
        Rounds at most [-]: a stop for risk that no price moves.
    coarse_gap : float
        Gap at which the search of a large fleet ends [-]: turning gains as much. Without the last
        two of four rounds the turned plan of `fleet(256)` is as cheap, in 3/4 of the time.
    search_share : float
        Share of the open gap that, left by the sets' own searches, calls for more nodes instead of
        another price [-].
    max_initial_plans : int
        Prices at which an initial plan is sought, at most [-].
    doubtful : float
        Multiple of the first price at which, without any plan, the search for the safest plan
        decides whether there can be one [-].
    dearest : float
        Multiple of the first price that no price exceeds [-]: beyond it nothing changes.
    far : float
        Multiple of the budget beyond which the initial plan is made again at a higher price [-].
    same : float
        Relative difference below which two prices are one [-].
    stubborn : float
        Relative difference below which two plans risk the same, whatever the price [-].
    fine_gap : float
        Gap to plans within the same budget that is small enough once the gap to those within Δ is
        closed [-].
    """

    more_effort: int = 3
    overdrawn: float = 1.2
    most_effort: int = 10_000
    max_prices_alone: int = 6
    dearest_alone: float = 12.0
    little: float = 1e-3
    dearest_step: float = 1e6
    steepness: float = 1.15
    unused: float = 0.03
    max_rounds: int = 40
    coarse_gap: float = 1e-2
    search_share: float = 0.5
    max_initial_plans: int = 8
    doubtful: float = 1e2
    dearest: float = 1e7
    far: float = 1.6
    same: float = 1e-4
    stubborn: float = 1e-3
    fine_gap: float = 2e-3


@dataclass(frozen=True, slots=True)
class AcceptanceTuning:
    """How a round is rescaled until the referee accepts it.

    Attributes
    ----------
    max_rescalings : int
        Budgets that the plan of one round is rescaled to at most [-]: each costs a linear program
        per set and a certificate.
    aim : float
        Share of Δ that the certificate is to come to at the next budget [-]: it grows a little
        faster than in proportion.
    back_off : float
        Factor that keeps the next budget below one that the referee rejected [-].
    stretch : float
        Factor by which a budget grows at most from one rescaling to the next [-].
    same_budget : float
        Relative difference below which two budgets are one [-].
    hidden : float
        Multiple of the risk estimated between sets that explains what the referee finds [-].
    take_backs : int
        Times that sets moved into each other's way get their plans of the round back, at most [-].
    dearer : tuple of float
        Multiples of the round's price to replan its alternatives at if rescaling fails [-].
    little : float
        Share of the unit below which a set's risk is left as it is [-].
    inter_set_share : float
        Share of gap times unit by which rescaling may raise the risk between sets [-].
    repairs : int
        Times that risks are rescaled, at most [-]: a linear program per set each.
    gentle, spare : float
        Share of its risk that each of the riskiest sets of a large fleet keeps where so few come to
        the budget, and share of it left for those that get their plans back [-]: 30 of 700 sets of
        ``fleet(1000)`` take a tenth of the time of all.
    """

    max_rescalings: int = 5
    aim: float = 0.95
    back_off: float = 0.97
    stretch: float = 3.0
    same_budget: float = 0.03
    hidden: float = 2.0
    take_backs: int = 3
    dearer: tuple[float, ...] = (2.0, 6.0, 20.0, 100.0)
    little: float = 1e-4
    inter_set_share: float = 0.04
    repairs: int = 4
    gentle: float = 0.8
    spare: float = 0.02


@dataclass(frozen=True, slots=True)
class WithinTuning:
    """How budgets are searched within where no price leads.

    Attributes
    ----------
    nodes : int
        Nodes of a search within the budget, per vehicle of a set [-], multiplied by the effort.
    max_budgets : int
        Budgets that are searched within, at most [-].
    aim : float
        Share of Δ that the certificate is to come to at the next budget, and the factor by which a
        rejected budget falls at least [-].
    same_budget : float
        Relative difference below which two budgets are one [-].
    worthwhile : float
        Share of the gap by which a search within the budget must gain to be done again [-].
    tie : float
        Share of the gap that the whole budget costs [-]: enough to prefer less risk at equal
        effort.
    gap_share : float
        Share of the gap that the search may use [-].
    bisections : int
        Prices tried for given alternatives [-]: enough to find the right one within 0.1 % of the
        range's logarithm.
    cheapest, dearest : float
        Multiples of the first price between which given alternatives are priced [-].
    """

    nodes: int = 400
    max_budgets: int = 12
    aim: float = 0.97
    same_budget: float = 0.02
    worthwhile: float = 0.1
    tie: float = 0.05
    gap_share: float = 0.5
    bisections: int = 14
    cheapest: float = 1e-3
    dearest: float = 1e5


@dataclass(frozen=True, slots=True)
class Tuning:
    """The tuned numbers of the certified planner; none of them decides what counts as certified.

    A value that was measured names the scenes; of the others no measurement is recorded.

    Attributes
    ----------
    budgets : BudgetTuning
        How much union bounds may sum to.
    sets, prices : SetTuning and PriceTuning
        How sets are searched and merged, and which price follows which.
    acceptance : AcceptanceTuning
        How a round is rescaled until the referee accepts it.
    within : WithinTuning
        How budgets are searched within where no price leads.
    """

    budgets: BudgetTuning = field(default_factory=BudgetTuning)
    sets: SetTuning = field(default_factory=SetTuning)
    prices: PriceTuning = field(default_factory=PriceTuning)
    acceptance: AcceptanceTuning = field(default_factory=AcceptanceTuning)
    within: WithinTuning = field(default_factory=WithinTuning)


TUNING = Tuning()
"""The values in use."""
