"""Logs of many steps that hold few returns of deviations are corrected like short ones."""

from __future__ import annotations

import numpy as np

from radmpc.identification.model import StepModel
from radmpc.identification.regression import Fit, fit
from radmpc.identification.small_sample import without_bias
from simulator import Truth, fly


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
