"""What a track is made of."""

from __future__ import annotations

import numpy as np
import pytest

import radmpc

TIMES, PLACES = np.arange(5.0), np.zeros((5, 2))


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"times": np.zeros((5, 1))}, r"times: must have shape \(any\), got \(5, 1\)"),
        ({"times": "x"}, "times: must be numbers of equal row length, got 'x'"),
        (
            {"positions": np.zeros(5)},
            r"positions: must have shape \(5, 2\) or \(5, 3\), got",
        ),
        ({"positions": np.zeros((4, 2))}, r"positions: must have shape .* got \(4, 2\)"),
        ({"positions": None}, "positions: must be a matrix, got None"),
        ({"velocities": np.zeros((5, 3))}, r"velocities: must have shape \(5, 2\), got \(5, 3\)"),
        (
            {"references": np.zeros((5, 3))},
            r"references: must have shape \(5, 2\) or \(5, 4\)",
        ),
        ({"name": 3}, "name: must be text, got 3"),
    ],
)
def test_what_is_no_track_is_refused_in_one_line(parts: dict[str, object], message: str) -> None:
    whole = {"name": "a", "source": "f", "clock": "c", "times": TIMES, "positions": PLACES}
    with pytest.raises(radmpc.ScenarioError, match=f"^{message}"):
        radmpc.Track(**{**whole, **parts})  # type: ignore[arg-type] # what a caller may try


def test_steps_and_axes_that_are_none_are_refused() -> None:
    track = radmpc.Track("a", "f", "c", TIMES, PLACES)
    with pytest.raises(radmpc.ScenarioError, match="dt: must be a number, got 'x'"):
        radmpc.identify([track], dt="x")  # type: ignore[arg-type] # what a caller may try
    with pytest.raises(radmpc.ArgumentError, match="dimension must be an integer from 2 to 3"):
        radmpc.identify([track], dimension=1)
