"""What is said of the price of risk where a plan leaves much of the risk bound."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.experiments.families import paper
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.state.bounds import shadow_price
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.records import replace
from radmpc.solvers.solution import Limits


@pytest.mark.parametrize(
    ("turned_price", "union_bound", "price"),
    [
        (None, 0.0, 0.0),  # alone, in nobody's way
        (1e-3, 0.0, 0.0),  # turned until Δ was worth next to nothing
        (50.0, 0.0, None),  # turned at a high price, and not at lower ones
        (50.0, 1e-3, 0.0),  # by faces, whose union bounds are not used up either
    ],
)
def test_risk_is_free_only_where_no_lower_price_was_left_untried(
    turned_price: float | None, union_bound: float, price: float | None
) -> None:
    fleet = Fleet.of(paper(2, 0), 1e-2, Limits())
    controls = tuple(np.zeros(m.control_bounds.shape) for m in fleet.programs.models)
    certified = 0.2 * fleet.scenario.risk_bound
    incumbent = FleetIncumbent(
        controls, 10.0, ((0,), (1,)), union_bound, certified=certified, turned_price=turned_price
    )
    assert shadow_price(fleet, replace(SearchState.of(fleet), incumbent=incumbent)) == price


@pytest.mark.parametrize("certified", [0.0, 0.02, 0.049])
@pytest.mark.parametrize("union_bound", [0.0, 0.5])
def test_risk_is_free_where_a_plan_costs_what_it_does_in_empty_space(
    certified: float, union_bound: float
) -> None:
    fleet = Fleet.of(paper(2, 0), 1e-2, Limits())
    controls = tuple(np.zeros(m.control_bounds.shape) for m in fleet.programs.models)
    cost = (1.0 + 1e-8) * sum(fleet.base)
    incumbent = FleetIncumbent(
        controls, cost, ((0,), (1,)), union_bound, certified=certified, turned_price=50.0
    )
    assert shadow_price(fleet, replace(SearchState.of(fleet), incumbent=incumbent)) == 0.0
