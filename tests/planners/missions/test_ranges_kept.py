from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from visiting import vehicle

from radmpc import Keep, Scenario, ScenarioError, Status, Visit, certify, plan, simulate
from radmpc.planners.endpoints.ranges import lost_ranges
from radmpc.planners.presets import PRESETS
from radmpc.program.build import condensed_models

REFUSING = {"dmpc", "radmpc", "multi-vehicle", "rmpc-rrt"}


def escorted(within: float, avoidance: str = "steps") -> Scenario:
    """Return two side by side, of whom one has to turn aside."""
    turning = vehicle("b", [0.0, 4.0], [8.0, 4.0], Visit.at([4.0, 8.0], 0.5, between=[3, 3]))
    fleet = [vehicle("a", [0.0, 0.0], [8.0, 0.0]), turning]
    return Scenario(
        "escort", 1.0, 6, 0.05, fleet, avoidance=avoidance, keep=[Keep(["b", "a"], within)]
    )


def distances(planned) -> np.ndarray:
    one, two = (trajectory.means[:, :2] for trajectory in planned.trajectories)
    return np.linalg.norm(one - two, axis=1)


def test_without_noise_means_use_the_polygon_within_a_range() -> None:
    given = escorted(5.5)
    apart, near = plan(replace(given, keep=()), "dlp"), plan(given, "dlp")
    assert distances(apart.require()).max() > 5.6
    assert 0.98 * 5.5 < distances(near.require()).max() <= 5.5
    assert near.cost is not None
    assert apart.cost is not None
    assert near.cost > 1.05 * apart.cost


@pytest.mark.slow
def test_a_range_is_certified_with_the_noise_of_both() -> None:
    found = plan(escorted(5.5))
    planned = found.require()
    certificate = certify(planned)
    assert certificate.holds
    ranges = [row for row in certificate.ledger if row.cause == "range"]
    assert sum(row.risk for row in ranges) > 1e-4
    assert planned.sets == (("a", "b"),)
    assert [(c.reason, c.value) for c in planned.couplings] == [("range", 5.5)]
    assert found.certified_lower_bound is not None
    assert found.cost is not None
    assert found.certified_lower_bound <= found.cost
    flown = simulate(planned, 20_000, rng=1)
    assert flown.range_losses > 0
    assert flown.rate_low <= certificate.certified


def test_starts_and_goals_out_of_range_are_named_before_any_search() -> None:
    found = plan(escorted(3.0))
    assert found.status is Status.INFEASIBLE
    assert not found.steps
    assert found.explanation is not None
    assert "The starts of vehicles 'a' and 'b' are 4 m apart" in found.explanation
    assert "The goals of vehicles 'a' and 'b' are 3 m apart or more" in found.explanation
    assert found.explanation.count("the range that they keep (3 m)") == 2


@pytest.mark.parametrize("within", [3.6, 4.0, 4.3])
@pytest.mark.parametrize("at_goal", [False, True])
def test_a_range_is_lost_at_an_end_no_less_often_than_that_end_alone_says(within, at_goal) -> None:
    given = escorted(within)
    models = condensed_models(given)
    rng = np.random.default_rng(1)
    places = [v.start_position for v in given.vehicles]
    if at_goal:
        # As near as their goals allow.
        places = [np.array([8.0, 0.5]), np.array([8.0, 3.5])]
    spread = [model.position_covariances[-1 if at_goal else 0] for model in models]
    one, two = (rng.multivariate_normal(*law, 100_000) for law in zip(places, spread, strict=True))
    rate = np.mean(np.linalg.norm(one - two, axis=1) > within)
    [lost] = lost_ranges(given, models, at_goal=at_goal)
    assert rate - 0.05 <= lost.risk <= rate + 0.005


def test_a_range_without_noise_is_not_lost_by_rounding() -> None:
    given = escorted(4.0 - 1e-12)
    still = [replace(v, initial_covariance=0.0 * v.initial_covariance) for v in given.vehicles]
    models = condensed_models(given.with_vehicles(still))
    [lost] = lost_ranges(given, models, at_goal=False)
    assert lost.risk == 0.0
    [lost] = lost_ranges(escorted(4.0 - 1e-6), models, at_goal=False)
    assert lost.risk == 1.0


@pytest.mark.parametrize("name", sorted(REFUSING))
def test_planners_of_single_vehicles_refuse_ranges_in_one_line(name: str) -> None:
    with pytest.raises(
        ScenarioError, match=rf"^keep: not supported by '{name}', .*; use certified"
    ) as refused:
        plan(escorted(5.5), name)
    assert "\n" not in str(refused.value)
    assert name in PRESETS
