"""Noise too large for the workspace is told as noise, and no probability is above 1."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from radmpc import Goal, Obstacle, Scenario, Vehicle, Workspace, double_integrator, plan
from radmpc.planners.wording import least_text, rounded
from radmpc.preflight import concerns_of, outlook_of

SYSTEM = double_integrator(1.0, 2)


def vehicle(name: str, y: float, noise: float = 1e-3, **more: object) -> Vehicle:
    return Vehicle(
        name=name, system=SYSTEM, start=[1.0, y], goal=Goal.at([15.0, y], 0.3), radius=0.4,
        control_limit=1.0, initial_covariance=more.get("start", 1e-3),
        disturbance_covariance=noise, gain=more.get("gain"), control_sigmas=0.0,
    )  # fmt: skip


def within(*fleet: Vehicle, horizon: int = 12) -> Scenario:
    return Scenario("basin", 1.0, horizon, 0.05, fleet, workspace=Workspace([-2, -2], [22, 22]))


def sentences(scenario: Scenario) -> list[str]:
    """What a plan and a check say, which is the same."""
    found = plan(scenario, time_limit=2.0).explanation
    assert found is not None
    told = [one.text for one in concerns_of(outlook_of(scenario)) if one.kind == "endpoint"]
    for text in told:
        assert text.partition(" What helps")[0] in found
        assert "too close" not in text
        assert not [x for x in re.findall(r"risk of ([\d.]+)", text) if float(x) > 1.0]
    return told


def test_noise_without_feedback_is_told_with_its_growth() -> None:
    (text,) = sentences(within(vehicle("a", 4.0), horizon=600))
    assert text.startswith("Vehicle 'a' strays too far for the workspace: its standard deviation")
    assert "at its goal is 26" in text
    assert "; without feedback that grows with every step." in text


def test_a_feedback_that_makes_noise_grow_is_told() -> None:
    gain = np.array([[5.0, 0.0, 5.0, 0.0], [0.0, 5.0, 0.0, 5.0]])
    (text,) = sentences(within(vehicle("a", 4.0, gain=gain)))
    assert "run a risk of 1 or more to leave it, above risk_bound 0.05" in text
    assert text.endswith("; under this feedback that grows with every step.")


def test_a_start_that_is_hardly_known_is_told() -> None:
    start, goal = sentences(within(vehicle("a", 4.0, noise=0.0, start=1e6)))
    assert "its standard deviation at its start is 1e+03 m, and even in the middle" in start
    assert "grows" not in start
    assert "at its goal is" in goal


def test_vehicles_that_stray_alike_share_a_sentence() -> None:
    fleet = [vehicle(name, y) for name, y in (("a", 4.0), ("b", 9.0), ("c", 14.0))]
    (text,) = sentences(within(*fleet, horizon=600))
    assert text.startswith("Vehicles 'a', 'b' and 'c' stray too far for the workspace: standard")
    assert "deviations at their goals are 26" in text


def test_a_goal_at_the_border_is_too_close_to_it() -> None:
    near = vehicle("a", 4.0)
    near = replace(near, goal=Goal.at([21.9, 4.0], 0.05))
    (concern,) = [
        one for one in concerns_of(outlook_of(within(near, horizon=16))) if one.kind == "endpoint"
    ]
    assert concern.text.startswith("The goal of vehicle 'a' is too close to the workspace border")


@pytest.mark.parametrize(
    ("risk", "text"), [(0.0123, "0.012"), (1.0, "1"), (1.0 + 1e-9, "1"), (1.9, "1 or more")]
)
def test_no_probability_above_1_is_told(risk: float, text: str) -> None:
    assert least_text(risk) == text
    assert rounded(risk, 0.05) == text


@pytest.mark.parametrize("planner", ["milp", "rmpc"])
def test_planners_that_ignore_noise_do_not_blame_what_all_starts_risk_together(
    planner: str,
) -> None:
    starts = np.diag([0.04, 0.04, 1e-4, 1e-4])
    fleet = [vehicle(f"v{i}", 10.0 * i, 1e-5, start=starts) for i in range(3)]
    beside = [Obstacle.box(f"b{i}", [0, 10 * i + 0.5], [2, 10 * i + 1.5]) for i in range(3)]
    wall = Obstacle.box("wall", [6.0, -50.0], [7.0, 80.0])
    closed = Scenario("starts", 1.0, 12, 0.05, tuple(fleet), obstacles=(*beside, wall))
    told = plan(closed, planner).explanation
    assert told is not None
    assert "starts" not in told
    assert "wall" in told
