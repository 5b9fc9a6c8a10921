"""Faces and risks searched together, against enumeration with an independent convex solver."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.optimize import LinearConstraint, NonlinearConstraint, linprog, minimize
from scipy.stats import norm

from radmpc.experiments.families import paper
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planning import plan
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.priced.set_bounds import SetBound
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

GAP = 1e-4


def tiny(seed, risk_bound=0.05):
    """One vehicle, four steps, one box somewhere in its way."""
    rng = np.random.default_rng(seed)
    center = np.array([3.0, 0.0]) + rng.uniform(-0.4, 0.4, 2)
    vehicle = Vehicle(
        name="v",
        system=double_integrator(1.0, 2),
        start=np.zeros(4),
        goal=Goal(np.array([5.8, -0.3]), np.array([6.2, 0.3]), np.full(2, 0.5)),
        radius=0.2,
        control_limit=np.full(2, 3.0),
        speed_limit=None,
        initial_covariance=float(10.0 ** rng.uniform(-3.0, -2.0)),
        disturbance_covariance=float(10.0 ** rng.uniform(-3.0, -2.0)),
    )
    return Scenario(
        name=f"tiny-{seed}",
        dt=1.0,
        horizon=4,
        risk_bound=risk_bound,
        vehicles=(vehicle,),
        obstacles=(Obstacle.box("box", center - 0.7, center + 0.7),),
        avoidance="steps",
    )


def program_of(scenario):
    return build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)


def search(program, unit, price, **more):
    options = {"gap": GAP, "scale": 1e-3, "limits": Limits()} | more
    tree = RiskTree(program, unit, price, **options)
    tree.run(10_000)
    assert not tree.is_limited
    return tree


def least_by_enumeration(program, unit, price=None, *, is_bounded=False):
    """Try all sides; solve each convex problem by SLSQP. With a price, a budget, or both."""
    is_bounded = is_bounded or price is None
    rows, best = program.rows, np.inf
    matrix = (rows.normals @ program.outputs).toarray()
    right = rows.offsets - rows.normals @ program.constant
    hard = program.hard.toarray()
    for sides in product(*(program.alternatives_of(v) for v in range(program.num_avoidances))):
        chosen = program.selected_rows(np.array(sides, dtype=np.int64))
        a, s = matrix[chosen], rows.deviations[chosen]
        b = right[chosen] - s * norm.isf(unit)
        upper = np.concatenate([b, program.hard_upper, -program.hard_lower])
        start = linprog(
            program.cost,
            np.vstack([a, hard, -hard]),
            upper,
            bounds=np.column_stack([program.lower, program.upper]),
        )
        if start.status != 0:
            continue

        def risk(z, a=a, s=s, chosen=chosen):
            return norm.sf((right[chosen] - a @ z) / s).sum() / unit

        def slope(z, a=a, s=s, chosen=chosen):
            return (norm.pdf((right[chosen] - a @ z) / s) / s) @ a / unit

        linear = LinearConstraint(
            np.vstack([a, hard]),
            np.concatenate([np.full(len(b), -np.inf), program.hard_lower]),
            np.concatenate([b, program.hard_upper]),
        )
        weight = 0.0 if price is None else price
        limits = [linear]
        if is_bounded:
            limits.append(NonlinearConstraint(risk, -np.inf, 1.0, jac=slope))
        found = minimize(
            lambda z, risk=risk, weight=weight: program.cost @ z + weight * risk(z),
            start.x,
            jac=lambda z, slope=slope, weight=weight: program.cost + weight * slope(z),
            bounds=np.column_stack([program.lower, program.upper]),
            constraints=limits,
            method="SLSQP",
            options={"maxiter": 500, "ftol": 1e-10},
        )
        within = not is_bounded or risk(found.x) <= 1.0 + 1e-7
        if within and np.all(a @ found.x <= b + 1e-7):
            best = min(best, float(found.fun))
    return best


@pytest.mark.slow
@pytest.mark.sampled(5)
@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("price", [0.02, 0.3])
def test_the_priced_search_finds_what_enumeration_finds(seed, price):
    program = program_of(tiny(seed))
    tree = search(program, 0.05, price)
    # Plans that risk more than the whole unit are left out, those just above it or not.
    least = least_by_enumeration(program, 0.05, price)
    within = least_by_enumeration(program, 0.05, price, is_bounded=True)
    assert tree.bound <= within + 1e-6
    assert tree.value >= least - 1e-6
    assert tree.value <= within * (1.0 + 2.0 * GAP) + 1e-6
    assert tree.value - tree.bound <= 1.001 * GAP * max(tree.value, 1e-3)


@pytest.mark.slow
@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(8))
def test_a_certified_plan_costs_no_more_than_the_enumerated_optimum_within_its_gap(seed):
    """It may cost less: enumerated are the faces, and the planner turns half-spaces."""
    scenario = tiny(seed)
    result = plan(scenario, "certified")
    expected = least_by_enumeration(program_of(scenario), scenario.risk_bound)
    assert result.is_certified
    assert result.lower_bound <= expected + 1e-6
    assert result.cost <= expected * 1.001
    assert result.cost >= 0.95 * expected


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(4))
def test_a_search_resumed_at_another_price_agrees_with_a_fresh_one(seed):
    scenario = paper(8, seed).subset((0, 3), 0.05)
    program = program_of(scenario)
    first = search(program, 0.05, 0.2)
    for price in (0.3, 0.1):
        again = RiskTree(program, 0.05, price, gap=GAP, scale=1e-3, limits=Limits())
        again.resume(first.frontier, first.price, first.best)
        again.run(10_000)
        fresh = search(program, 0.05, price)
        assert again.bound <= fresh.value + 1e-7
        assert fresh.bound <= again.value + 1e-7


@pytest.mark.parametrize("seed", range(4))
def test_bounds_of_parts_change_nothing_but_the_work(seed):
    scenario = paper(8, seed)
    alone = [search(program_of(scenario.subset((i,), 0.05)), 0.05, 0.2) for i in (0, 1)]
    program = program_of(scenario.subset((0, 1), 0.05))
    bounds = tuple(SetBound(frozenset({i}), tree.bound) for i, tree in enumerate(alone))
    plain, helped = search(program, 0.05, 0.2), search(program, 0.05, 0.2, bounds=bounds)
    assert helped.bound <= plain.value + 1e-7
    assert plain.bound <= helped.value + 1e-7
    assert helped.value >= sum(b.value for b in bounds) - 1e-9


def test_a_program_without_a_solution_has_an_infinite_bound():
    scenario = tiny(0)
    wall = Obstacle.box("wall", [2.0, -50.0], [4.0, 50.0])
    blocked = Scenario(
        name="blocked",
        dt=1.0,
        horizon=4,
        risk_bound=0.05,
        vehicles=(
            Vehicle(
                name="slow",
                system=double_integrator(1.0, 2),
                start=np.zeros(4),
                goal=scenario.vehicles[0].goal,
                radius=0.2,
                control_limit=np.full(2, 1.7),
                speed_limit=np.full(2, 1.9),
                initial_covariance=1e-3,
                disturbance_covariance=1e-3,
            ),
        ),
        obstacles=(wall,),
    )
    tree = search(program_of(blocked), 0.05, 0.1)
    assert tree.best is None
    assert tree.bound == np.inf


@pytest.mark.slow
def test_a_node_limit_leaves_a_bound_and_a_way_to_go_on():
    program = program_of(paper(8, 0).subset((0, 3, 6), 0.05))
    tree = RiskTree(program, 0.05, 0.2, gap=GAP, scale=1e-3, limits=Limits())
    tree.run(10)
    assert tree.is_limited
    early = tree.bound
    tree.run(20_000)
    assert not tree.is_limited
    assert early <= tree.bound <= tree.value


@pytest.mark.parametrize("most", range(1, 6))
def test_after_the_limit_no_node_is_solved_and_none_is_lost(most):
    program = program_of(tiny(0))
    whole = search(program, 0.05, 0.3)
    is_patient = [False]
    limits = Limits(is_stopped=lambda: not is_patient[0] and tree.nodes >= most)
    tree = RiskTree(program, 0.05, 0.3, gap=GAP, scale=1e-3, limits=limits)
    tree.run(10_000)
    assert tree.nodes == most
    assert tree.is_limited
    assert tree.bound <= whole.value
    is_patient[0] = True
    tree.run(10_000)
    assert tree.value == pytest.approx(whole.value, rel=2.0 * GAP)


@pytest.mark.parametrize("unit", [1e-8, 1e-12])
def test_the_priced_search_closes_its_gap_where_risks_are_tiny(unit):
    scenario = tiny(0, unit)
    quiet = replace(scenario.vehicles[0], initial_covariance=1e-4, disturbance_covariance=1e-4)
    tree = search(program_of(replace(scenario, vehicles=(quiet,))), unit, 0.3)
    assert tree.value < np.inf
    assert tree.value - tree.bound <= 1.001 * GAP * tree.value


@pytest.mark.parametrize("price", [1e3, 1e12, 1e17])
def test_bounds_of_parts_enter_at_any_price(price):
    program = program_of(paper(8, 0).subset((0, 1), 0.05))
    bounds = (SetBound(frozenset({0}), 1.0),)
    tree = RiskTree(program, 0.05, price, gap=GAP, scale=price, limits=Limits(), bounds=bounds)
    tree.run(200)
    assert tree.bound <= tree.value
