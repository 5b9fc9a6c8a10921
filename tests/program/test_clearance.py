"""Slack in standard deviations: one rule for rows with noise and rows without."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.gaussian import CONTACT_TOL, clearance
from radmpc.referee.reserve import CONTACT_TOL as CONTACT_OF_THE_REFEREE
from radmpc.referee.reserve import in_deviations


def test_a_slack_with_noise_counts_in_standard_deviations():
    assert clearance(np.array([3.0, -1.0]), np.array([2.0, 0.5])) == pytest.approx([1.5, -2.0])


def test_without_noise_touching_holds_and_overlapping_does_not():
    slacks = np.array([1.0, 0.0, -0.5 * CONTACT_TOL, -2.0 * CONTACT_TOL])
    expected = [np.inf, np.inf, np.inf, -np.inf]
    assert clearance(slacks, np.zeros(4)).tolist() == expected


def test_meters_over_next_to_no_noise_are_no_warning():
    assert clearance(np.array([5.0]), np.array([1e-320]))[0] == np.inf


def test_planner_and_referee_agree_on_what_touches():
    slacks = np.concatenate([np.linspace(-3e-9, 3e-9, 25), [-1.0, 1.0]])
    assert CONTACT_TOL == CONTACT_OF_THE_REFEREE
    for deviation in (0.0, 0.1):
        deviations = np.full(slacks.size, deviation)
        assert np.array_equal(clearance(slacks, deviations), in_deviations(slacks, deviations))
