"""Times that are rounded or shaken: the step is that of all samples, and nothing is made up."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.errors import FileFormatError
from radmpc.identification import Identification, Track, identify
from simulator import Truth, fly


def found(track: Track, times: np.ndarray) -> Identification:
    return identify([track.changed({}, times)])


@pytest.mark.parametrize(("dt", "decimals"), [(1 / 30, 3), (1 / 30, 2), (1 / 3, 1)])
def test_rounded_times_are_taken_as_the_even_ones_they_stand_for(dt: float, decimals: int) -> None:
    [track] = fly(Truth(steps=3000, dt=dt), 1)
    exact, rounded = identify([track]), found(track, np.round(track.times, decimals))
    assert rounded.model.dt == pytest.approx(dt, abs=0.02 * dt / 3000)
    assert rounded.pooled.num_steps == 3000
    assert rounded.pooled.measurement is None
    assert rounded.pooled.time_constant is None
    assert rounded.pooled.covariance.value == pytest.approx(
        exact.pooled.covariance.value, rel=0.01, abs=1e-5
    )
    [warning] = [line for line in rounded.warnings if "taken as even" in line]
    assert f"multiples of {10.0**-decimals:g} s" in warning


def test_even_times_with_all_their_digits_stay_as_they_are() -> None:
    [track] = fly(Truth(steps=3000, dt=1 / 30), 1)
    exact = identify([track])
    assert exact.pooled.num_steps == 3000
    assert exact.warnings == ()


@pytest.mark.parametrize("seed", range(3))
def test_shaken_times_make_no_gaps(seed: int) -> None:
    [track] = fly(Truth(steps=4000), 2)
    rng = np.random.default_rng(seed)
    shaken = track.times + 0.01 * rng.standard_normal(track.times.size)
    told = found(track, shaken)
    assert told.model.dt == pytest.approx(0.5, abs=1e-5)
    assert told.pooled.num_steps == 4000
    assert not any("gap" in line or "interpolated" in line for line in told.warnings)


def test_gaps_in_rounded_times_stay_gaps() -> None:
    [track] = fly(Truth(steps=1000, dt=1 / 30), 3)
    kept = np.r_[0:400, 500:1001]
    parts = {name: getattr(track, name)[kept] for name in track.parts()}
    told = identify([track.changed(parts, np.round(track.times[kept], 3))])
    assert told.pooled.num_steps == 399 + 500
    assert [line for line in told.warnings if "a gap of 3.367 s" in line]


def test_times_since_1970_that_run_backwards_are_told_with_all_their_digits() -> None:
    [track] = fly(Truth(), 1)
    times = 1760086400.0 + track.times
    times[100] = times[99] - 0.05
    told = "at sample 101: 1760086449.45 s after 1760086449.5 s;"
    with pytest.raises(FileFormatError, match=told):
        found(track, times)
