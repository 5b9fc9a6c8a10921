"""Feedback that acts on states as they are measured: noise of sensors moves the vehicle."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.console.reports.noise import noise_report
from radmpc.identification import Track, identify
from radmpc.importing.logs.applying import noise_text, with_noise
from radmpc.importing.logs.block import noise_block
from radmpc.io.native.scenario_file import decode_scenario
from simulator import Truth, dynamics, fly

SEEN = (0.25, 0.25, 0.01, 0.01)
SMALL = np.diag([1e-4, 1e-4, 1e-3, 1e-3])
GAIN = -np.hstack([np.eye(2), 1.4 * np.eye(2)])
STEPS = 3000


def flown(color: float, seed: int, seen: tuple[float, ...] = SEEN) -> Track:
    """Fly in small noise under feedback on what sensors say."""
    rng = np.random.default_rng(seed)
    A, B = dynamics(0.5, 2)
    times = 0.5 * np.arange(STEPS + 1)
    planned = 0.3 * np.sin(np.outer(times, [0.05, 0.1]) + np.array([1.0, 2.0]))
    references, states = np.zeros((2, STEPS + 1, 4))
    logged, controls = np.zeros((STEPS + 1, 4)), np.zeros((STEPS + 1, 2))
    noise = np.sqrt(np.diag(SMALL)) * rng.standard_normal(4)
    for k in range(STEPS + 1):
        logged[k] = states[k] + np.sqrt(seen) * rng.standard_normal(4)
        controls[k] = planned[k] + GAIN @ (logged[k] - references[k])
        if k < STEPS:
            references[k + 1] = A @ references[k] + B @ planned[k]
            states[k + 1] = A @ states[k] + B @ controls[k] + noise
            fresh = np.sqrt(np.diag(SMALL)) * rng.standard_normal(4)
            noise = color * noise + np.sqrt(1.0 - color**2) * fresh
    return Track("a", "log.csv", "one", times, logged[:, :2], logged[:, 2:], controls, references)


def spread(covariance: np.ndarray, color: float, white: np.ndarray) -> np.ndarray:
    """Return the variances of positions for the step after which they no longer change."""
    A, B = dynamics(0.5, 2)
    loop = A + B @ GAIN
    found, cross = np.zeros((2, 4, 4))
    for _ in range(200):
        joint = loop @ cross
        found = loop @ found @ loop.T + joint + joint.T + covariance + white
        cross = color * (joint + covariance)
    return np.diag(found)[:2]


@pytest.mark.parametrize("color", [0.0, 0.7])
def test_noise_that_sensors_feed_into_the_loop_is_written_as_disturbance(color: float) -> None:
    block = noise_block(identify([flown(color, 1)])).content["defaults"]
    assert "measurement" not in block
    if color:
        written, constant = block["disturbance"].values()
        planned = spread(np.array(written), np.exp(-0.5 / constant), np.zeros((4, 4)))
    else:
        planned = spread(np.array(block["disturbance_covariance"]), 0.0, np.zeros((4, 4)))
    moved = dynamics(0.5, 2)[1] @ GAIN
    true = spread(SMALL, color, moved @ np.diag(SEEN) @ moved.T)
    assert np.all(planned > 0.85 * true)
    assert np.all(planned < (4.0 if color else 1.3) * true)


def test_feedback_on_the_true_state_leaves_the_sensors_to_the_filter() -> None:
    truth = Truth(steps=2000, seen=(0.05, 0.05, 0.005, 0.005))
    found = identify(fly(truth, 3, "both"))
    assert found.pooled.measurement is not None
    assert "measurement" in noise_block(found).content["defaults"]


def test_a_loop_that_sensors_disturb_is_told() -> None:
    found = identify([flown(0.0, 2)])
    sentence = "the feedback acts on the measured states"
    assert sentence in noise_text(found, "today").replace("\n# ", " ")
    cells = [str(cell) for part in noise_report(found)[1:2] for cell in part.columns[1].cells]
    assert any(cell.startswith("acts on the measured states") for cell in cells)


def test_a_scenario_has_no_filter_where_logs_show_that_there_is_none() -> None:
    goal = {"center": [10.0, 0.0], "half_width": 1.0}
    vehicle = {"name": "a", "start": [0.0, 0.0], "goal": goal, "radius": 0.5, "control_limit": 5.0}
    head = {"format": "radmpc/scenario/1", "name": "n", "dt": 0.5, "horizon": 20}
    filtered = {**vehicle, "measurement": {"of": [0, 1], "covariance": 0.25}}
    filtered["feedback"] = {"gain": GAIN.tolist()}
    scenario = decode_scenario({**head, "risk_bound": 0.05, "vehicles": [filtered]})
    changed, _ = with_noise(scenario, identify([flown(0.0, 3)]), "today")
    assert changed.vehicles[0].measurement is None
