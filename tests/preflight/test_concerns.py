from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scenes_checked import check_of, of_scene, warned, warned_in
from scipy.special import ndtr

import radmpc
from radmpc import Goal, Obstacle, Scenario, Vehicle, double_integrator, load_scenario, lqr_gain
from radmpc.console.files import demo_text
from radmpc.planners.cures.variants import with_noise
from radmpc.preflight.concerns import concerns_of
from radmpc.preflight.outlook import outlook_of
from radmpc.preflight.reserve import expected_saturation, reserve_of, tails


@pytest.fixture
def harbor(tmp_path: Path) -> Scenario:
    path = tmp_path / "harbor.yaml"
    path.write_text(demo_text(), encoding="utf-8")
    return load_scenario(path)


def test_a_horizon_without_slack_is_named_with_one_that_has_some() -> None:
    scenario = of_scene("horizon-is-the-cure")
    (concern,) = warned(scenario, "time")
    assert concern.vehicles == ("usv2",)
    assert "goal 23 steps away at least, horizon 25 steps (125 s): only 2 are left" in concern.text
    assert "lengthen it to about 30" in concern.text
    assert not concern.is_fatal
    # What it recommends, and what the scene needs: 26.
    assert warned(replace(scenario, horizon=30), "time") == []


def test_a_goal_out_of_reach_is_told_how_far_away_it_is() -> None:
    scenario = replace(of_scene("horizon-is-the-cure"), horizon=20)
    (concern,) = warned(scenario, "time")
    assert concern.is_fatal
    assert (
        "goal 23 steps away at least, horizon 20 steps (100 s): lengthen it to 23" in concern.text
    )
    assert radmpc.plan(scenario, time_limit=0.5).status is radmpc.Status.INFEASIBLE
    assert warned(replace(scenario, horizon=23), "time")[0].is_fatal is False


def test_a_gain_that_eats_the_control_is_named_with_what_it_keeps_back() -> None:
    (concern,) = warned_in("soft-gain-is-the-cure", "control")
    assert "0.276 of 0.3 m/s² (92 % of control_limit) on axis 0 at step 1" in concern.text
    assert "soften the gain" in concern.text


@pytest.mark.slow
def test_a_gain_that_takes_more_than_there_is_rules_out_any_plan() -> None:
    scenario = of_scene("soft-gain-is-the-cure")
    vehicle = replace(scenario.vehicles[0], control_sigmas=4.0)
    scenario = replace(scenario, vehicles=(vehicle,))
    (concern,) = warned(scenario, "control")
    assert concern.is_fatal
    assert outlook_of(scenario).vehicles[0].saturation is None
    assert radmpc.plan(scenario, time_limit=0.5).status is radmpc.Status.INFEASIBLE


@pytest.mark.parametrize("name", ["goal-too-near", "goal-too-near-fleet"])
def test_a_goal_that_costs_more_than_the_bound_is_named_with_what_is_near_it(name: str) -> None:
    outlook = outlook_of(of_scene(name))
    first, *_ = concerns_of(outlook)
    assert (first.kind, first.vehicles, first.is_fatal) == ("endpoint", ("usv4",), True)
    assert "obstacle 'mole'" in first.text
    assert "a risk of 0.026, above risk_bound 0.02" in first.text
    assert outlook.least_risk == pytest.approx(0.02555, rel=1e-3)
    seen = {vehicle.name: vehicle.goal_risk for vehicle in outlook.vehicles}
    assert seen.pop("usv4") == pytest.approx(0.02555, rel=1e-3)
    assert set(seen.values()) <= {0.0}


@pytest.mark.slow
def test_starts_too_close_are_named_and_charged_to_both() -> None:
    outlook, (first, *_) = check_of("starts-clash")
    assert first.vehicles == ("usv1", "usv2")
    assert "they overlap" in first.text
    risks = [vehicle.start_risk for vehicle in outlook.vehicles]
    assert risks[0] == risks[1] > 0.9
    assert risks[2] == 0.0


def test_a_start_that_costs_more_than_the_bound_is_named() -> None:
    _, (first, *_) = check_of("start-risk-above-bound")
    assert first.is_fatal
    assert "The start of vehicle 'v1' is too close to obstacle 'post1'" in first.text


def test_ends_that_take_a_large_part_of_the_bound_are_told_without_ruling_out() -> None:
    scenario = replace(of_scene("goal-too-near"), risk_bound=0.1)
    (concern,) = warned(scenario, "endpoint")
    assert not concern.is_fatal
    assert "take 0.026 of risk_bound 0.1 (26 %)" in concern.text
    assert "the goal of 'usv4' at obstacle 'mole'" in concern.text
    assert warned(replace(scenario, risk_bound=0.4), "endpoint") == []


def test_feedback_that_saturates_is_told_before_it_flies() -> None:
    scenario = of_scene("saturates")
    (concern,) = warned(scenario, "saturation")
    assert "with a probability of 1 (risk_bound 0.02)" in concern.text
    assert concern.text.endswith("raise control_limit to 0.6")
    # That takes more than the whole limit for the reserve, a softer gain saturates as well.
    assert "control_sigmas" not in concern.text


def test_what_is_expected_to_saturate_is_what_a_plan_in_empty_space_does() -> None:
    scenario = of_scene("horizon-is-the-cure")
    vehicle = replace(scenario.vehicles[0], control_sigmas=2.0)
    empty = replace(scenario, vehicles=(vehicle,), obstacles=(), workspace=None)
    plan = radmpc.plan(empty, "milp").require()
    expected = outlook_of(empty).vehicles[0].saturation
    assert radmpc.certify(plan).saturation == pytest.approx(expected, rel=1e-3)


@pytest.mark.slow
def test_open_loop_noise_that_grows_beyond_the_hull_asks_for_feedback() -> None:
    (concern,) = warned_in("starts-clash", "deviation")
    assert concern.vehicles == ("usv1", "usv2", "usv6")
    assert concern.text.startswith("Vehicles 'usv1', 'usv2', 'usv6': standard deviation 15.7 m")
    assert "add feedback" in concern.text


def test_a_narrow_gap_is_named_with_its_place_and_what_it_costs() -> None:
    vehicle = Vehicle(
        name="boat",
        system=double_integrator(1.0, 2),
        start=[0.0, 0.0],
        goal=Goal.at([20.0, 0.0], 0.5),
        radius=0.5,
        control_limit=2.0,
        initial_covariance=np.diag([0.01, 0.01, 0.0, 0.0]),
        disturbance_covariance=0.0,
        speed_limit=2.0,
    )

    def gate(width: float) -> Scenario:
        walls = (
            Obstacle.box("south", [9.0, -200.0], [10.0, -0.5 * width]),
            Obstacle.box("north", [9.0, 0.5 * width], [10.0, 200.0]),
        )
        return Scenario("gate", 1.0, 16, 0.02, (vehicle,), walls)

    (concern,) = warned(gate(1.4), "narrow")
    assert "must pass between" in concern.text
    assert "'south'" in concern.text
    assert "'north'" in concern.text
    assert "0.2 m to spare, 2 standard deviations, a risk of about 0.02" in concern.text
    assert warned(gate(2.0), "narrow") == []
    (closed,) = warned(gate(0.6), "narrow")
    assert "no path to the goal in time is wide enough: the widest lacks 0.2 m" in closed.text


def test_vehicles_that_share_a_concern_share_a_line() -> None:
    scenario = of_scene("goal-too-near-fleet")
    slow = replace(scenario, horizon=25, vehicles=scenario.vehicles[:3])
    (concern,) = warned(slow, "time")
    assert concern.vehicles == ("usv1", "usv2", "usv3")
    assert concern.text.count("lengthen") == 1


def test_noise_that_an_import_made_up_is_told(harbor: Scenario) -> None:
    imported = replace(harbor, source={"choices": {"noise": "0.02 m per step"}})
    (concern,) = warned(imported, "assumed noise")
    assert "(0.02 m per step)" in concern.text
    assert concern.vehicles == ()


def test_no_noise_at_all_is_told() -> None:
    scenario = of_scene("goal-too-near")
    still = replace(scenario.vehicles[0], initial_covariance=0.0, disturbance_covariance=0.0)
    (concern,) = warned(replace(scenario, vehicles=(still,)), "noise")
    assert "certificate says nothing" in concern.text


def test_a_scenario_that_is_well_chosen_has_no_warnings(harbor: Scenario) -> None:
    assert concerns_of(outlook_of(harbor)) == ()


def test_what_rules_out_any_plan_comes_first() -> None:
    scenario = replace(of_scene("goal-too-near-fleet"), horizon=24)
    fatal = [one.is_fatal for one in concerns_of(outlook_of(scenario))]
    assert len(set(fatal)) == 2
    assert fatal == sorted(fatal, reverse=True)


def test_the_reserve_is_found_where_its_share_is_largest() -> None:
    vehicle = of_scene("soft-gain-is-the-cure").vehicles[0]
    bounds = np.tile(vehicle.control_limit, (4, 1))
    bounds[2, 1] -= 0.2
    reserve = reserve_of(vehicle, bounds)
    assert (reserve.axis, reserve.step) == (1, 2)
    assert reserve.share == pytest.approx(0.2 / 0.3)
    assert reserve.kept == pytest.approx(0.2)


def test_saturation_is_a_sum_of_tails_over_steps_axes_and_both_limits() -> None:
    vehicle = of_scene("soft-gain-is-the-cure").vehicles[0]
    covariances = vehicle.covariances(3)
    controls = np.array([[0.1, 0.0], [0.0, 0.02], [-0.29, 0.0]])
    total = 0.0
    for k, control in enumerate(controls):
        spread = np.sqrt(np.diag(vehicle.gain @ covariances[k] @ vehicle.gain.T))
        total += ndtr(-(0.3 - control) / spread).sum() + ndtr(-(0.3 + control) / spread).sum()
    assert total < 1.0
    assert expected_saturation(vehicle, covariances, controls) == pytest.approx(total, rel=1e-12)
    bare = replace(vehicle, gain=None)
    assert expected_saturation(bare, covariances, controls) == 0.0


def test_saturation_of_a_vehicle_that_measures_is_that_of_its_certificate() -> None:
    """Feedback acts on the estimate: what it never learns of it never steers against."""
    scenario = of_scene("soft-gain-is-the-cure")
    coarse = radmpc.Measurement.of([0, 1], 4, [4.0, 4.0])
    soft = lqr_gain(scenario.vehicles[0].system, np.eye(4), 300.0 * np.eye(2))
    vehicle = replace(scenario.vehicles[0], measurement=coarse, gain=soft, control_sigmas=2.0)
    alone = replace(scenario, vehicles=(vehicle,), obstacles=())
    plan = radmpc.plan(alone, "ira", rng=0).require()
    [trajectory] = plan.trajectories
    told = expected_saturation(vehicle, vehicle.covariances(alone.horizon), trajectory.controls)
    assert told == pytest.approx(radmpc.certify(plan).saturation, rel=1e-6)
    assert told > 1e-6


def test_tails_are_those_of_the_normal_distribution() -> None:
    clearances = np.array([-40.0, -1.0, 0.0, 3.0, 8.0, 37.0])
    assert tails(clearances) == pytest.approx(ndtr(-clearances), rel=1e-12)


def test_a_goal_past_all_horizons_asks_for_units() -> None:
    scenario = of_scene("horizon-is-the-cure")
    far = replace(scenario.vehicles[0], goal=Goal.at([1e6, 0.0], 3.0), gain=None)
    (concern,) = warned(replace(scenario, vehicles=(far,), workspace=None), "time")
    assert concern.is_fatal
    assert "check units" in concern.text


def test_the_recommended_gain_takes_less() -> None:
    scenario = of_scene("soft-gain-is-the-cure")
    vehicle = scenario.vehicles[0]
    softer = replace(vehicle, gain=lqr_gain(vehicle.system, np.eye(4), 1e3 * np.eye(2)))
    assert warned(replace(scenario, vehicles=(softer,)), "control") == []


def test_a_track_that_is_lost_by_the_end_is_told(harbor: Scenario) -> None:
    hull, start = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [40.0, 40.0, 0.0, 0.0]
    lost = Obstacle.tracked("barge", hull, start, [0.04, 0.04, 0.09, 0.01])
    known = Obstacle.tracked("barge", hull, start, [0.04, 0.04, 1e-4, 1e-4])
    (concern,) = warned(replace(harbor, obstacles=(lost,)), "track")
    # After 12 s: the root of 0.04 + 0.09 · 144.
    assert "'barge': its place deviates by 3.61 m at the end, 0.2 m at the start" in concern.text
    assert not concern.is_fatal
    assert warned(replace(harbor, obstacles=(known,)), "track") == []
    factor = re.search(r"a track of ([0-9.]+) of these deviations is good enough", concern.text)
    assert factor is not None
    better, worse = (
        with_noise(replace(harbor, obstacles=(lost,)), (more * float(factor[1])) ** 2)
        for more in (1.0, 1.2)
    )
    assert warned(better, "track") == []
    assert warned(worse, "track") != []


@pytest.mark.parametrize("wrong", [None, 3, "harbor.yaml"], ids=["none", "number", "path"])
def test_what_is_no_scenario_or_outlook_is_refused_in_one_line(wrong: object) -> None:
    with pytest.raises(radmpc.ArgumentTypeError, match=r"^scenario must be a Scenario, got "):
        outlook_of(wrong)  # type: ignore[arg-type] # what is tried
    with pytest.raises(radmpc.ArgumentTypeError, match=r"^outlook must be an Outlook, got "):
        concerns_of(wrong)  # type: ignore[arg-type] # what is tried
