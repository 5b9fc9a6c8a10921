"""What a lattice search makes of its values, window by window, and what it keeps of them."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from radmpc.gaussian import Tail
from radmpc.planners.certified.lattice import tables
from radmpc.planners.certified.lattice.slacks import Slacks
from radmpc.planners.certified.lattice.tables import (
    INFEASIBLE,
    FeasibleValues,
    WindowCosts,
    add_tails,
    changed,
    moved,
)

BOX = (1, 4, 2, 7)


@pytest.fixture(params=["as installed", "without compiled code"], autouse=True)
def code(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Search with and without compiled code."""
    if request.param == "without compiled code":
        monkeypatch.setattr(tables, "is_compiled", lambda: False)


def values_of(rng: np.random.Generator) -> np.ndarray:
    """Return values of which most are infeasible."""
    values = rng.uniform(0.0, 9.0, (3, 3, 5, 7)).astype(np.float32)
    values[rng.random(values.shape) < 0.7] = INFEASIBLE
    return values


def inside(values: np.ndarray) -> np.ndarray:
    """Return the values of the box."""
    return values[:, :, BOX[0] : BOX[1], BOX[2] : BOX[3]]


def test_feasible_values_come_back_as_they_were_and_the_others_infeasible() -> None:
    rng = np.random.default_rng(1)
    values = values_of(rng)
    kept = FeasibleValues.of(values, BOX)
    assert kept.values.size == np.count_nonzero(inside(values) < INFEASIBLE)
    for row, column in product(range(*BOX[:2]), range(*BOX[2:])):
        np.testing.assert_array_equal(kept.at(row, column), values[:, :, row, column])
    assert values[kept.cheapest] == inside(values).min()


def test_a_change_costs_the_least_over_all_last_displacements() -> None:
    rng = np.random.default_rng(2)
    values = values_of(rng)
    costs = rng.uniform(0.0, 3.0, (2, 3, 3)).astype(np.float32)
    costs[rng.random(costs.shape) < 0.3] = INFEASIBLE
    found = inside(changed(values, (costs[0], costs[1]), BOX))
    expected = np.full_like(found, INFEASIBLE)
    for i, j, a, b in product(range(3), repeat=4):
        if max(costs[0, a, i], costs[1, b, j]) < INFEASIBLE:
            ends = (inside(values)[i, j] + costs[0, a, i]) + costs[1, b, j]
            expected[a, b] = np.minimum(expected[a, b], ends)
    is_feasible = expected < 0.5 * INFEASIBLE
    np.testing.assert_array_equal(found < 0.5 * INFEASIBLE, is_feasible)
    np.testing.assert_array_equal(found[is_feasible], expected[is_feasible])
    assert is_feasible.any()


@pytest.mark.parametrize("late", [0.0, 2.5])
def test_values_move_with_their_displacement_and_pay_for_risk_and_delay(late: float) -> None:
    rng = np.random.default_rng(3)
    values = values_of(rng)
    risks = rng.uniform(0.0, 0.1, values.size).astype(np.float32)
    blocked = rng.random(values.size) < 0.2
    source, in_time = (0, 4, 1, 6), (2, 5, 0, 4)
    costs = WindowCosts(risks, np.packbits(blocked), 10.0, 0.08, late, in_time)
    found = inside(moved(values, costs, source, BOX))
    expected = np.full_like(values, INFEASIBLE)
    cells = product(range(3), range(3), range(*source[:2]), range(*source[2:]))
    for i, j, a, b in cells:
        number = np.ravel_multi_index((i, j, a, b), values.shape)
        row, column = a + i - 1, b + j - 1
        is_in_box = BOX[0] <= row < BOX[1] and BOX[2] <= column < BOX[3]
        if is_in_box and not blocked[number] and risks[number] <= np.float32(0.08):
            is_in_time = in_time[0] <= row < in_time[1] and in_time[2] <= column < in_time[3]
            value = values[i, j, a, b] + np.float32(10.0) * risks[number]
            expected[i, j, row, column] = value + np.float32(0.0 if is_in_time else late)
    is_feasible = inside(expected) < 0.5 * INFEASIBLE
    np.testing.assert_array_equal(found < 0.5 * INFEASIBLE, is_feasible)
    np.testing.assert_array_equal(found[is_feasible], inside(expected)[is_feasible])
    assert is_feasible.any()


@pytest.mark.parametrize("tail", [Tail(), Tail(7)])
def test_risks_are_tails_up_to_a_sixty_fourth_of_a_deviation(tail: Tail) -> None:
    rng = np.random.default_rng(4)
    slacks = rng.uniform(-5.0, 5.0, 200).astype(np.float32)
    numbers = rng.choice(300, 200, replace=False).astype(np.uint32)
    risks = np.full(300, 0.25, dtype=np.float32)
    add_tails(risks, Slacks(np.zeros(0, np.uint8), numbers, slacks), 0.3, tail)
    clearances = slacks.astype(float) / 0.3
    lower, upper = (tail.probability(np.clip(clearances + s, -10, 10)) for s in (0.017, -0.017))
    added = risks[numbers] - 0.25
    assert np.all((added >= lower - 1e-6) & (added <= upper + 1e-6))
    beside = np.setdiff1d(np.arange(300), numbers)
    assert np.all(risks[beside] == np.float32(0.25))
