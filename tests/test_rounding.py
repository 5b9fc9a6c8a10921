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
