"""Deviations that come back slowly: in logs of few returns, and where only positions are logged.

Logs of many steps that hold few returns are corrected like short ones. In logs of positions and
references what lasts and what comes back slowly look alike.
"""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.identification import Identification, Track, identify
from radmpc.identification.least_squares.regression import Fit, fit
from radmpc.identification.least_squares.small_sample import without_bias
from radmpc.identification.model import StepModel
from radmpc.importing.logs.block import noise_block
from simulator import Truth, fly

DT, SIGMA = 0.5, 0.05


def seen(truth: Truth) -> tuple[Fit, Fit]:
    """What least squares find in a log with references, and what is made of it."""
    (track,) = fly(truth, 0, "references")
    model = StepModel(truth.dt, truth.dimension, True)
    assert track.references is not None
    states = np.hstack([track.positions, track.velocities])
    h = states - track.references
    y = h[1:] - h[:-1] @ model.A.T
    follows = np.concatenate([[0.0], np.ones(len(y) - 1)])
    found = fit(y, h[:-1], follows, model.B, has_color=False)
    return found, without_bias(found, h[:-1], follows, model)


def test_many_steps_of_a_fast_log_that_hold_few_returns_make_feedback_less_sure() -> None:
    found, corrected = seen(Truth(dt=0.02, steps=2000, scale=0.04))
    wider = corrected.gain_deviation / found.gain_deviation
    assert np.all(wider >= 1.0)
    assert wider.mean() > 1.03
    assert not np.allclose(corrected.gain, found.gain)


def test_many_steps_that_hold_many_returns_stay_what_they_are() -> None:
    found, corrected = seen(Truth(dt=0.5, steps=2000))
    assert corrected is found


def found(feedback: float, color: float, steps: int = 1000, seed: int = 1) -> Identification:
    """What positions tell of a vehicle without inertia, pushed by noise of an autocorrelation."""
    rng = np.random.default_rng(seed)
    deviations, push = np.zeros((steps + 1, 2)), SIGMA * rng.standard_normal(2)
    for k in range(steps):
        deviations[k + 1] = (1.0 + DT * feedback) * deviations[k] + push
        fresh = SIGMA * rng.standard_normal(2)
        push = color * push + np.sqrt(1.0 - color**2) * fresh
    times = DT * np.arange(steps + 1)
    references = np.column_stack([np.sin(0.1 * times), np.cos(0.1 * times)])
    track = Track("v", "log.csv", "one", times, references + deviations, references=references)
    return identify([track], dt=DT)


def spread(back: float, color: float, variance: float, steps: int) -> float:
    """Standard deviation after some steps from a known place."""
    moves = np.array([[back, 1.0], [0.0, color]])
    covariance = np.diag([0.0, variance])
    for _ in range(steps):
        covariance = moves @ covariance @ moves.T + np.diag([0.0, variance * (1.0 - color**2)])
    return float(np.sqrt(covariance[0, 0]))


def written(told: Identification, steps: int) -> float:
    """The same along x by the block that is written."""
    fields = noise_block(told).content["defaults"]
    noise = fields.get("disturbance", {"covariance": fields.get("disturbance_covariance")})
    lasting = noise.get("time_constant")
    color = np.exp(-DT / lasting) if lasting else 0.0
    gain = fields.get("feedback", {"gain": [[0.0]]})["gain"][0][0]
    return spread(1.0 + DT * gain, color, noise["covariance"][0][0], steps)


@pytest.mark.parametrize(("feedback", "color"), [(-0.2, 0.85), (-1.0, 0.9), (-0.4, 0.6)])
def test_noise_that_lasts_is_not_written_as_white_where_only_positions_are_logged(
    feedback: float, color: float
) -> None:
    told = found(feedback, color)
    for steps in (1, 5, 10, 40):
        assert written(told, steps) > 0.85 * spread(1.0 + DT * feedback, color, SIGMA**2, steps)
    pooled = told.pooled
    assert pooled.is_bound
    assert pooled.covariance.high[0, 0] > SIGMA**2
    assert pooled.time_constant.low < -DT / np.log(color) < pooled.time_constant.high
    assert pooled.gain.low[0, 0] < feedback < pooled.gain.high[0, 0]
    assert any("slow feedback and a disturbance that lasts look alike" in s for s in told.unknown)


def test_noise_that_lasts_without_feedback_is_memory_alone() -> None:
    told = found(0.0, 0.7)
    assert "feedback" not in noise_block(told).content["defaults"]
    for steps in (1, 10, 40):
        assert written(told, steps) == pytest.approx(spread(1.0, 0.7, SIGMA**2, steps), rel=0.15)
    assert any("memory alone stands here" in sentence for sentence in told.unknown)


def test_white_noise_of_positions_keeps_its_feedback() -> None:
    pooled = found(-0.4, 0.0).pooled
    assert pooled.time_constant is None
    assert not pooled.is_bound
    assert np.diag(pooled.gain.value) == pytest.approx(-0.4, abs=0.1)


def test_a_current_told_by_states_alone_is_no_surer_than_noise_that_lasts_lets_it_be() -> None:
    truth = Truth(steps=400, color=0.8)
    hits = []
    for seed in range(40):
        [track] = fly(truth, seed, "states")
        drift = identify([track], dt=truth.dt).pooled.drift
        hits.append((drift.low[:2] <= 0.0) & (drift.high[:2] >= 0.0))
    # Of 80 intervals of 95 % fewer than 69 hold it in one of 1,600; 43 did by white noise.
    assert np.sum(hits) >= 69
