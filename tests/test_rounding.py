from __future__ import annotations

import numpy as np
import pytest

from radmpc.rounding import rounded_down, rounded_up


@pytest.mark.parametrize("num_digits", [2, 3])
def test_short_numbers_are_next_to_what_they_stand_for_and_on_the_right_side(num_digits):
    for value in 10.0 ** np.random.default_rng(0).uniform(-12.0, 6.0, 300):
        low, high = rounded_down(value, num_digits), rounded_up(value, num_digits)
        assert low <= value <= high
        assert high - low <= 1.0001 * value * 10.0 ** (1 - num_digits)
        assert (low, high) == (float(f"{low:.{num_digits}g}"), float(f"{high:.{num_digits}g}"))


@pytest.mark.parametrize("value", [0.07, 0.29, 1.1, 57.0, 3e-5, 120.0])
def test_short_numbers_stand_for_themselves(value):
    assert rounded_down(value) == rounded_up(value) == value


def test_nothing_is_nothing():
    assert rounded_down(0.0) == rounded_up(0.0) == 0.0


@pytest.mark.parametrize(
    "value", [np.nextafter(0.01, 1.0), np.nextafter(0.01, 0.0), 0.1 + 0.2, 1.0 + 1e-10, 5e-324]
)
def test_rounding_errors_put_no_number_on_the_wrong_side(value):
    assert rounded_down(value) <= value <= rounded_up(value)
    assert rounded_down(value) < rounded_up(value) or value == 5e-324


def test_a_risk_just_above_a_short_one_is_not_within_it():
    assert rounded_up(0.0100000000001) == 0.011
    assert rounded_down(0.0099999999999) == 0.0099
