"""What visits cost at least in empty space, against all choices of steps enumerated."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise, product
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import linprog

import radmpc
from radmpc.model.visits import steps_of_visits
from radmpc.planners.certified.proof import least_visits
from radmpc.planners.certified.proof.least_visits import least_cost
from radmpc.planners.certified.proof.leg_chain import LegChain
from radmpc.planners.certified.proof.leg_speeds import leg_efforts
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.solvers import solution
from radmpc.solvers.solution import Limits

HORIZON = 9


def model_of(seed: int, *, price: float = 0.0, **more: object) -> CondensedModel:
    """A vehicle with two or three visits at random places, alone."""
    rng = np.random.default_rng(seed)
    count = 2 + seed % 2
    via = [
        radmpc.Visit.at(rng.uniform(-3, 7, 2), rng.uniform(0.1, 1.5), speed=0.8 if j else None)
        for j in range(count)
    ]
    start = np.append(rng.uniform(-2, 2, 2), rng.uniform(-1, 1, 2))
    within = None if price == 0.0 else (6, 8)
    goal = radmpc.Goal.at(rng.uniform(2, 10, 2), 0.5, [None, 0.0, 0.3][seed % 3], within)
    vehicle = radmpc.Vehicle(
        name="a", system=radmpc.double_integrator(1.0, 2), start=start, goal=goal, radius=0.4,
        control_limit=12.0, cost_weight=1.0 + 0.5 * (seed % 2), via=via, initial_covariance=0.0,
        disturbance_covariance=1e-6, **more,
    )  # fmt: skip
    scenario = radmpc.Scenario("alone", 1.0, HORIZON, 0.05, [vehicle], time_weight=price)
    return condensed_models(scenario)[0]


def cost_at(model: CondensedModel, steps: tuple[int, ...]) -> float:
    """The least effort with visits at some steps, and in the goal from the last on, by scipy."""
    vehicle = model.vehicle
    span = model.position.shape[2]
    rows, right = [], []
    boxes = [(v.lower, v.upper, v.speed, k) for v, k in zip(vehicle.via, steps[:-1], strict=True)]
    goal = vehicle.goal
    boxes += [(goal.lower, goal.upper, goal.speed, k) for k in range(steps[-1], HORIZON + 1)]
    assert model.velocity is not None
    assert model.drift_velocity is not None
    for lower, upper, speed, k in boxes:
        rows += [model.position[k], -model.position[k]]
        right += [upper - model.drift_position[k], model.drift_position[k] - lower]
        if speed is not None:
            rows += [model.velocity[k], -model.velocity[k]]
            right += [speed - model.drift_velocity[k], speed + model.drift_velocity[k]]
    matrix = np.vstack(rows)
    bounds = np.tile(model.control_bounds.ravel(), 2)
    found = linprog(
        np.full(2 * span, vehicle.cost_weight),
        A_ub=np.hstack([matrix, -matrix]),
        b_ub=np.concatenate(right),
        bounds=[(0.0, bound) for bound in bounds],
    )
    return found.fun if found.status == 0 else np.inf


def all_costs(model: CondensedModel, arrivals: range) -> dict[tuple[int, ...], float]:
    """The cost of every choice of rising steps, time included."""
    count = len(model.vehicle.via)
    return {
        (*steps, arrival): cost_at(model, (*steps, arrival)) + model.time_cost * arrival / HORIZON
        for steps in product(range(1, HORIZON), repeat=count)
        if all(a < b for a, b in pairwise(steps))
        for arrival in arrivals
    }


def tabulated(model: CondensedModel, table: np.ndarray, steps: tuple[int, ...]) -> float:
    """The quick bound at some steps; windows leave room for the visits before and after."""
    windows = steps_of_visits(model.vehicle.via, HORIZON)
    return float(table[tuple(k - w[0] for k, w in zip(steps[:-1], windows, strict=True))])


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(8))
def test_the_least_cost_is_that_of_the_best_steps(seed: int) -> None:
    model = model_of(seed)
    costs = all_costs(model, range(HORIZON, HORIZON + 1))
    least = least_cost(model, Limits())
    assert least == pytest.approx(min(costs.values()), rel=1e-6)
    assert least <= min(costs.values())
    table = leg_efforts(model)
    assert table is not None
    # The quick bound is one for every choice of steps, and often close.
    quick = {steps: tabulated(model, table, steps) for steps in costs}
    for steps, cost in costs.items():
        assert quick[steps] <= cost * (1.0 + 1e-9)
    finite = [steps for steps, cost in costs.items() if np.isfinite(cost)]
    assert np.median([quick[s] / costs[s] for s in finite]) > 0.6


@pytest.mark.parametrize("seed", range(6))
def test_legs_two_by_two_bound_less_than_all_together_but_not_much_less(seed: int) -> None:
    model = model_of(seed, drift=[0.2, -0.1, 0.0, 0.0] if seed % 2 else None)
    table, chain = leg_efforts(model), LegChain.of(model)
    assert table is not None
    assert chain is not None
    every = {
        places: chain.least([slice(k, k + 1) for k in places]) for places in np.ndindex(table.shape)
    }
    for places, quick in every.items():
        assert quick <= table[places] + 1e-9
        assert np.isfinite(quick) == np.isfinite(table[places])
    finite = [places for places in every if np.isfinite(every[places])]
    assert np.median([every[p] / max(table[p], 1e-9) for p in finite]) > 0.6
    some = [slice(1, 4), *(slice(None) for _ in table.shape[1:])]
    least = min(quick for places, quick in every.items() if 1 <= places[0] < 4)
    assert chain.least(some) == pytest.approx(least)


def test_the_least_cost_is_the_same_with_legs_two_by_two(monkeypatch: pytest.MonkeyPatch) -> None:
    model = model_of(3)
    least = least_cost(model, Limits())
    monkeypatch.setattr(least_visits, "leg_efforts", lambda model: None)
    assert least_cost(model, Limits()) == pytest.approx(least, rel=1e-6)


@pytest.mark.slow
def test_what_time_costs_is_part_of_it() -> None:
    model = model_of(2, price=4.0)
    costs = all_costs(model, range(6, 9))
    assert least_cost(model, Limits()) == pytest.approx(min(costs.values()), rel=1e-6)
    assert min(costs, key=lambda steps: costs[steps])[-1] < 8


def test_a_current_is_part_of_it() -> None:
    model = model_of(2, drift=[0.4, -0.3, 0.0, 0.0])
    costs = all_costs(model, range(HORIZON, HORIZON + 1))
    assert least_cost(model, Limits()) == pytest.approx(min(costs.values()), rel=1e-6)
    table = leg_efforts(model)
    assert table is not None
    assert all(tabulated(model, table, s) <= c * (1 + 1e-9) for s, c in costs.items())


def test_stopped_early_it_is_a_bound_still() -> None:
    model = model_of(0)
    bounds = [least_cost(model, Limits(), most) for most in (1, 4, 10, 1000)]
    assert bounds == sorted(bounds)
    assert bounds[0] < bounds[-1]


def test_other_dynamics_have_no_table_and_the_same_answer() -> None:
    known = model_of(0)
    system = known.vehicle.system
    same = radmpc.LinearSystem(
        A=system.A + np.diag([0, 0, -1e-6, 0]), B=system.B, position=[0, 1], velocity=[2, 3]
    )

    vehicle = replace(known.vehicle, system=same)
    (other,) = condensed_models(radmpc.Scenario("alone", 1.0, HORIZON, 0.05, [vehicle]))
    assert leg_efforts(other) is None
    assert least_cost(other, Limits()) == pytest.approx(least_cost(known, Limits()), rel=1e-4)


def test_a_plan_with_open_steps_has_its_bound_at_once() -> None:
    model = model_of(4)
    scenario = radmpc.Scenario("alone", 1.0, HORIZON, 0.05, [model.vehicle])
    result = radmpc.plan(scenario)
    least = least_cost(model, Limits())
    plan = result.require()
    assert plan.certified_lower_bound is not None
    assert plan.certified_lower_bound >= least * (1.0 - 1e-9)
    assert plan.cost == pytest.approx(least, rel=2e-3)


@dataclass(frozen=True)
class _Fleet:
    """As much of a fleet as is looked at."""

    limits: Limits
    programs: SimpleNamespace
    least_costs: tuple[float, ...] = ()


def test_a_vehicle_whose_steps_are_hard_to_choose_leaves_the_others_their_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now, given = [0.0], list[float]()

    def slow(model: CondensedModel, limits: Limits) -> float:
        given.append(limits.seconds_left)
        now[0] += limits.seconds_left if len(given) != 2 else 0.0
        return 7.0

    monkeypatch.setattr(solution.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(least_visits, "least_cost", slow)
    fleet = _Fleet(Limits(deadline=100.0), SimpleNamespace(models=[model_of(0)] * 4))
    found = least_visits.with_least_visits(fleet)  # type: ignore[arg-type] # stands in for a fleet
    assert found.least_costs == (7.0, 7.0, 7.0, 7.0)
    # A fifth of all is for all; of what the second one leaves the last two have half each.
    np.testing.assert_allclose(given, [5.0, 5.0, 7.5, 7.5])
