from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from visiting import GAIN, vehicle

from radmpc import Goal, Scenario, ScenarioError, Vehicle, certify, plan, simulate
from radmpc.io.native.mapping import from_dict, to_dict
from radmpc.model.limits import tight_limits

DIAGONAL = [8.0, 8.0]


def alone(horizon: int = 5, noise: float = 0.0, **limits: float) -> Scenario:
    """Return one vehicle that crosses an empty plane on a diagonal."""
    one = replace(
        vehicle("a", [0.0, 0.0], DIAGONAL),
        initial_covariance=noise,
        disturbance_covariance=noise,
        gain=GAIN if noise else None,
        **limits,
    )
    return Scenario("norms", 1.0, horizon, 0.01, [one])


def norms(planned) -> tuple[np.ndarray, np.ndarray]:
    flown = planned.trajectories[0]
    return np.linalg.norm(flown.controls, axis=1), np.linalg.norm(flown.means[:, 2:], axis=1)


@pytest.mark.parametrize("planner", ["dlp", "certified"])
def test_a_norm_of_control_is_used_up_to_its_polygon(planner: str) -> None:
    free, held = (
        plan(alone(control_limit=2.4, control_norm=norm), planner).require() for norm in (None, 2.4)
    )
    assert norms(free)[0].max() > 2.6
    assert 0.98 * 2.4 < norms(held)[0].max() <= 2.4 + 1e-6
    assert certify(held).problems == ()
    assert [(one.limit, one.num_steps > 0) for one in tight_limits(held)] == [("control", True)]


def test_a_norm_of_speed_is_used_up_to_its_polygon() -> None:
    given = alone(speed_limit=2.6, speed_norm=2.9)
    # The polygon's 16 faces are nearest on the diagonal. One second to come down to that speed,
    # three at it, one to stop: who starts farther away than this does not arrive.
    fastest = 2.9 * np.cos(np.pi / 16) / np.sqrt(2)
    away = (2.2 + fastest) / 2 + 3 * fastest + fastest / 2 - 7.5
    hasty = replace(given.vehicles[0], start=[1e-8 - away, 1e-8 - away, 2.2, 2.2])
    held = plan(replace(given, vehicles=(hasty,)), "dlp").require()
    assert norms(held)[1][1:].max() == pytest.approx(2.9 * np.cos(np.pi / 16), abs=1e-7)
    assert hasty.speed_limit is not None
    assert hasty.speed_limit.tolist() == [2.6, 2.6]
    assert ("speed", True) in [(one.limit, one.num_steps > 0) for one in tight_limits(held)]
    slower = replace(given, vehicles=(replace(hasty, speed_norm=2.7),))
    assert plan(slower, "dlp").plan is None


def test_the_referee_names_norms_that_are_exceeded() -> None:
    planned = plan(alone(control_limit=2.5), "dlp").require()
    given = alone(control_limit=2.5, control_norm=2.5, speed_norm=2.6)
    found = certify(replace(planned, scenario=given)).problems
    assert any("norm of its control at step 0" in problem for problem in found)
    assert any("norm of its speed at step" in problem for problem in found)


def test_feedback_keeps_its_reserve_in_every_direction() -> None:
    planned = plan(alone(6, 3e-3, control_limit=2.0, control_norm=2.0), "dlp").require()
    certificate = certify(planned)
    assert certificate.problems == ()
    greedy = replace(planned.scenario.vehicles[0], control_sigmas=5.0)
    scenario = replace(planned.scenario, vehicles=(greedy,))
    found = certify(replace(planned, scenario=scenario)).problems
    assert any("norm of its control" in problem for problem in found)
    # At three deviations in all 16 directions, at two or three steps.
    assert 1e-3 < certificate.saturation < 16 * 3 * 1.4e-3


def test_simulation_shortens_controls_and_saturates_less_than_the_bound() -> None:
    planned = plan(alone(6, 3e-3, control_limit=2.0, control_norm=2.0), "dlp").require()
    bound = certify(planned).saturation
    found = simulate(planned, 20_000, rng=2)
    assert 0.2 * bound < found.saturation_rate <= bound


@pytest.mark.parametrize(
    "limits",
    [
        {"control_limit": 2.5, "control_norm": 2.5},
        {"control_limit": [1.0, 2.0], "control_norm": 2.1, "speed_norm": 3.0},
        {"speed_limit": [1.0, 5.0], "speed_norm": 3.0},
    ],
)
def test_norms_are_read_back_as_they_were_written(limits: dict[str, float]) -> None:
    given = alone(**limits)
    read = from_dict(to_dict(given))
    assert isinstance(read, Scenario)
    for name in ("control_limit", "control_norm", "speed_limit", "speed_norm"):
        one, other = (getattr(s.vehicles[0], name) for s in (given, read))
        assert repr(one) == repr(other)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("control_limit", {"norm": 0.0}, r"vehicles\[0\]\.control_limit\.norm: must be > 0"),
        ("speed_limit", {"norm": -1}, r"vehicles\[0\]\.speed_limit\.norm: must be > 0"),
        ("control_limit", {"norms": 1.0}, r"did you mean 'norm'"),
        ("control_limit", {"axes": 1.0}, r"vehicles\[0\]\.control_limit\.norm: "),
        ("speed_limit", {"norm": 1.0, "axes": 0}, r"vehicles\[0\]\.speed_limit: must be > 0"),
    ],
)
def test_wrong_norms_are_refused_with_their_place(key: str, value: object, message: str) -> None:
    data = to_dict(alone())
    vehicles = data["vehicles"]
    assert isinstance(vehicles, list)
    with pytest.raises(ScenarioError, match=message):
        from_dict({**data, "vehicles": [{**vehicles[0], key: value}]})


def test_a_norm_of_one_control_is_refused() -> None:
    one = alone().vehicles[0]
    from radmpc import LinearSystem  # noqa: PLC0415 - only here

    system = LinearSystem(np.eye(2), np.ones((2, 1)), (0, 1), None)
    with pytest.raises(
        ScenarioError, match=r"^control_limit: a norm needs two or three axes, got 1"
    ):
        Vehicle("a", system, [0, 0], Goal.at([1, 1], speed=None), one.radius, 1.0, 0.0, 0.0,
                control_norm=1.0)  # fmt: skip


def test_random_trees_refuse_norms_in_one_line() -> None:
    with pytest.raises(
        ScenarioError, match=r"^vehicles\[0\]\.control_limit: limits a norm, which 'rmpc-rrt'"
    ):
        plan(alone(control_norm=2.5), "rmpc-rrt")
