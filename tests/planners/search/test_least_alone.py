"""What vehicles cost at least alone, by mixed-integer programs: it holds, and raises bounds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import clutter
from radmpc.model.scenario import Scenario
from radmpc.planners import Branch, Centralized, Ira, Planner
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases import least_alone
from radmpc.planners.certified.phases.by_faces import bound_faces_of_each
from radmpc.planners.certified.phases.course import is_dear_alone
from radmpc.planners.certified.phases.least_alone import are_bounded_alone, with_least_alone
from radmpc.planners.certified.state.bounds import reported_bound
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planning import plan
from radmpc.solvers.solution import Limits

BOXES = replace(clutter(2, 12, 3), avoidance="steps")


@pytest.fixture(scope="module")
def planned() -> FleetIncumbent:
    """A plan by faces: certified, and nearly the cheapest within the union bound."""
    result = plan(BOXES, Planner(Ira(), Branch(), Centralized()))
    assert result.cost is not None
    controls = tuple(t.controls for t in result.require().trajectories)
    return FleetIncumbent(controls, result.cost, ((0, 1),), certified=BOXES.risk_bound)


def dearer(incumbent: FleetIncumbent, factor: float) -> FleetIncumbent:
    """The same plan with so many times the effort; only what it costs is asked for here."""
    controls = tuple(factor * u for u in incumbent.controls)
    return replace(incumbent, controls=controls, cost=factor * incumbent.cost)


def fleet_of(scenario: Scenario, limits: Limits | None = None) -> Fleet:
    return Fleet.of(scenario, 1e-3, limits or Limits())


def efforts(incumbent: FleetIncumbent) -> list[float]:
    return [
        vehicle.cost_weight * float(np.abs(u).sum())
        for vehicle, u in zip(BOXES.vehicles, incumbent.controls, strict=True)
    ]


def test_it_is_what_another_solver_finds_at_the_margin_of_the_whole_risk(planned) -> None:
    problem = fleet_of(BOXES)
    found = with_least_alone(problem, dearer(planned, 5.0), 0.01)
    for i, least in enumerate(found.base):
        program = problem.programs.problem((i,)).program
        margins = program.rows.deviations * float(program.tail.clearance_for(0.01))
        answer = Branch().solve(program, margins, gap=1e-4, limits=Limits())
        assert least == pytest.approx(answer.cost, rel=1.5e-3)
        assert least <= answer.cost * (1.0 + 1e-6)


def test_no_plan_within_the_risk_has_a_vehicle_below_it(planned) -> None:
    problem = fleet_of(BOXES)
    found = with_least_alone(problem, dearer(planned, 5.0), BOXES.risk_bound)
    assert sum(found.base) > 1.01 * sum(problem.base)
    for least, paid in zip(found.base, efforts(planned), strict=True):
        assert least <= paid * (1.0 + 1e-6)


def test_it_is_at_most_what_the_plan_at_hand_costs(planned) -> None:
    problem = fleet_of(BOXES)
    cheap = dearer(planned, 0.8)
    found = with_least_alone(problem, cheap, BOXES.risk_bound)
    bounds = zip(found.base, problem.base, efforts(cheap), strict=True)
    assert all(least <= max(before, paid) for least, before, paid in bounds)


def test_a_plan_that_no_plan_by_faces_reaches_is_shown_to_be_the_cheapest(planned) -> None:
    # As by turned half-spaces: each vehicle cheaper than it can be between faces.
    problem, least = fleet_of(BOXES), with_least_alone(fleet_of(BOXES), planned, 0.05)
    shares = [0.98 * one for one in least.base]
    pairs = zip(planned.controls, efforts(planned), shares, strict=True)
    controls = tuple(share / paid * u for u, paid, share in pairs)
    cheap = FleetIncumbent(controls, sum(shares), ((0, 1),), certified=0.05, turned_price=1e3)
    state = replace(SearchState.of(problem), incumbent=cheap)
    bounded = bound_faces_of_each(problem, state, 4.0e3)
    assert reported_bound(problem, bounded, problem.gap) >= (1.0 - problem.gap) * cheap.cost


@pytest.mark.parametrize("case", ["alternatives", "time"])
def test_it_is_not_asked_where_it_would_not_end(case: str, planned, monkeypatch) -> None:
    monkeypatch.setattr(least_alone, "_cheaper", lambda *_: pytest.fail("a program is solved"))
    limits = Limits()
    if case == "alternatives":
        few = replace(least_alone.TUNING, most_alternatives=3)
        monkeypatch.setattr(least_alone, "TUNING", few)
    else:
        limits = limits.within(0.1)
    problem = fleet_of(BOXES, limits)
    assert with_least_alone(problem, planned, 0.05) is problem


def test_what_is_not_told_in_time_is_not_raised(planned) -> None:
    problem = fleet_of(BOXES, Limits(is_stopped=lambda: True))
    assert with_least_alone(problem, planned, 0.05).base == problem.base


def test_few_vehicles_with_few_alternatives_are_bounded_alone() -> None:
    assert are_bounded_alone(fleet_of(BOXES))
    assert not are_bounded_alone(fleet_of(clutter(4, 12, 3)))
    assert not are_bounded_alone(fleet_of(BOXES, Limits().within(0.1)))


@pytest.mark.parametrize(("factor", "seconds"), [(1.0, 60.0), (5.0, np.inf)])
def test_sets_are_searched_where_the_plan_is_not_dear_or_time_has_no_end(
    factor: float, seconds: float, planned
) -> None:
    along = replace(BOXES, avoidance="intervals")
    problem = fleet_of(along, Limits().within(seconds))
    cheap = float(sum(problem.base)) * 1.1
    first = replace(planned, cost=factor * cheap)
    assert not is_dear_alone(problem, first)


def test_sets_are_left_where_a_plan_is_dear_among_many_obstacles(planned) -> None:
    along = replace(BOXES, avoidance="intervals")
    problem = fleet_of(along, Limits().within(60.0))
    assert is_dear_alone(problem, replace(planned, cost=2.0 * float(sum(problem.base))))
