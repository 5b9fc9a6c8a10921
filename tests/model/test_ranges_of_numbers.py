"""Numbers that files refuse are refused by constructors, too, in the same words."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import radmpc
from radmpc.model.noise.belief import Belief
from radmpc.model.obstacle import Obstacle
from radmpc.records import replace

SYSTEM = radmpc.double_integrator(1.0, 2)
BOAT = radmpc.Vehicle("a", SYSTEM, [0, 0], radmpc.Goal.at([3, 0], 0.3), 0.3, 2.0, 0.0, 1e-3)
SCENE = radmpc.Scenario("s", 1.0, 4, 0.05, [BOAT])


@pytest.mark.parametrize(
    ("make", "place"),
    [
        (lambda: replace(BOAT, cost_weight=1e300), "cost_weight"),
        (lambda: replace(BOAT, radius=2e9), "radius"),
        (lambda: replace(BOAT, control_limit=1e12), "control_limit"),
        (lambda: replace(BOAT, control_norm=1e12), "control_limit.norm"),
        (lambda: replace(BOAT, initial_covariance=1e150), "initial_covariance"),
        (lambda: replace(BOAT, initial_covariance=1e308), "initial_covariance"),
        (lambda: replace(BOAT, disturbance_covariance=[1, 1, 2e9, 1]), "disturbance_covariance[2]"),
        (lambda: replace(BOAT, start=[0, 2e9]), "start[1]"),
        (lambda: replace(BOAT, gain=np.full((2, 4), 2e9)), "feedback.gain[0][0]"),
        (lambda: replace(BOAT, drift=[0, 0, 0, 2e9]), "drift.state[3]"),
        (lambda: radmpc.Goal.at([2e9, 0]), "min[0]"),
        (lambda: radmpc.Visit.at([0, 2e9]), "min[1]"),
        (lambda: radmpc.Workspace([0, 0], [1, 1e300]), "max[1]"),
        (lambda: Obstacle.box("o", [2, -1], [1e300, 0.2]), "max[0]"),
        (lambda: Obstacle.polygon("o", [[0, 0], [1e10, 0], [0, 1]]), "vertices[1][0]"),
        (lambda: radmpc.Measurement(1e10 * np.eye(4), 1.0), "matrix[0][0]"),
        (lambda: radmpc.Keep(("a", "b"), 1e10), "within"),
        (lambda: replace(SCENE, time_weight=1e10), "time_weight"),
    ],
)
def test_a_number_that_no_file_takes_is_refused(make: Callable[[], object], place: str) -> None:
    with pytest.raises(radmpc.ScenarioError) as caught:
        make()
    assert str(caught.value).startswith(f"{place}: must be at most 1000000000, got ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("radius", [1e-320, 1e-200])
def test_a_radius_whose_square_is_none_is_refused(radius: float) -> None:
    with pytest.raises(radmpc.ScenarioError, match=r"radius: must be at least 1e-100 m, got 1e-"):
        replace(BOAT, radius=radius)


def test_steps_are_those_of_files() -> None:
    with pytest.raises(radmpc.ScenarioError, match=r"dt: must lie between 1e-06 and 1e\+06 s"):
        radmpc.double_integrator(1e7, 2)
    with pytest.raises(radmpc.ScenarioError, match=r"dt: must lie between 1e-06 and 1e\+06 s"):
        replace(SCENE, dt=1e-9)


def test_files_say_the_same() -> None:
    content = radmpc.to_dict(SCENE)
    content["vehicles"][0]["cost_weight"] = 1e300  # type: ignore[index] # a mapping
    with pytest.raises(radmpc.ScenarioError) as of_file:
        radmpc.from_dict(content)
    with pytest.raises(radmpc.ScenarioError) as of_value:
        replace(BOAT, cost_weight=1e300)
    assert of_file.value.message == of_value.value.message


def test_what_constructors_take_at_the_limit_is_read_again(tmp_path: Path) -> None:
    far = replace(BOAT, cost_weight=1e9, start=[1e9, -1e9, 0, 0], initial_covariance=1e9)
    path = tmp_path / "far.yaml"
    radmpc.save_scenario(replace(SCENE, vehicles=(far,)), path)
    assert radmpc.load_scenario(path).vehicles[0].start.tolist() == [1e9, -1e9, 0, 0]


def test_beliefs_under_way_may_have_grown_beyond_that() -> None:
    belief = Belief(np.zeros(4), 1e12)
    assert replace(BOAT, belief=belief).belief is belief
    track = Obstacle.tracked("o", [[0, 0]], [0, 0, 1e9, 0]).shape
    assert track.later(3, 1.0).start[0] == 3e9  # type: ignore[union-attr] # of a track
