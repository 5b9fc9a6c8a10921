"""Two that hover apart: how far they are from each other follows a Rice distribution."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import ncx2

from radmpc import Goal, Keep, Plan, Scenario, Vehicle, certify, double_integrator, simulate
from radmpc.planning import plan

DEVIATION = 0.3


def hovering(apart: float, within: float, dimension: int = 2) -> Plan:
    """Return a plan of two that stand still; noise is in where they start."""
    system = double_integrator(1.0, dimension)
    noise = np.zeros(2 * dimension)
    noise[:dimension] = DEVIATION**2 / 2.0
    vehicles = []
    for name, x in (("a", 0.0), ("b", apart)):
        place = np.zeros(dimension)
        place[:2] = 0.6 * x, 0.8 * x
        vehicles.append(
            Vehicle(
                name=name, system=system, start=place, goal=Goal.at(place, 0.1), radius=0.001,
                control_limit=1.0, initial_covariance=noise, disturbance_covariance=0.0,
            )
        )  # fmt: skip
    given = Scenario("hovering", 1.0, 1, 0.4, vehicles, avoidance="steps")
    made = plan(given, "dlp").plan
    assert made is not None
    return replace(made, scenario=replace(given, keep=(Keep(["a", "b"], within),)))


def lost(apart: float, within: float, dimension: int) -> float:
    """Return the probability that they are farther apart than the range."""
    scale = DEVIATION**2
    return float(ncx2.sf(within**2 / scale, dimension, apart**2 / scale))


@pytest.mark.parametrize(
    ("apart", "within", "dimension", "most"),
    [(5.0, 6.0, 2, 2.5), (1.0, 2.0, 2, 2.5), (0.5, 1.6, 2, 2.5), (5.0, 6.2, 3, 40.0)],
)
def test_the_certificate_covers_a_range_that_is_lost(
    apart: float, within: float, dimension: int, most: float
) -> None:
    made = hovering(apart, within, dimension)
    rows = [row for row in certify(made).ledger if row.cause == "range"]
    # Both steps count, and what is lost at the first is lost at the second.
    exact = lost(apart, within, dimension)
    assert {(row.vehicle, row.other, row.step) for row in rows} == {("a", "b", 0), ("a", "b", 1)}
    for row in rows:
        assert exact <= row.risk <= most * exact


def test_a_range_that_is_missed_for_certain_is_charged_in_full() -> None:
    assert certify(hovering(5.0, 4.0)).certified >= 1.0


def test_simulation_measures_the_distance_itself() -> None:
    made = hovering(1.0, 1.5)
    found = simulate(made, 40_000, rng=3)
    exact = lost(1.0, 1.5, 2)
    assert found.range_losses == found.collisions
    assert abs(found.range_rate - exact) < 4.0 * np.sqrt(exact / 40_000)


def test_along_intervals_a_range_counts_between_the_steps() -> None:
    """They part and meet again between two steps, by controls alone."""
    made = hovering(1.0, 1.6)
    first, second = made.scenario.vehicles
    moving = replace(second, start=[0.6, 0.8, 0.6, 0.8], control_limit=[3.0, 3.0])
    scenario = replace(made.scenario, vehicles=(first, moving))
    back = np.array([[-1.2, -1.6]])
    one, two = made.trajectories
    changed = replace(made, scenario=scenario, trajectories=(one, replace(two, controls=back)))
    at_steps = certify(changed, avoidance="steps").certified
    between = certify(changed, avoidance="intervals").certified
    assert between > 2.0 * at_steps
    rate = simulate(changed, 20_000, rng=1, avoidance="intervals")
    assert simulate(changed, 20_000, rng=1).range_rate < 0.5 * rate.range_rate
    assert rate.rate_low <= between
