"""What is nothing but rounding is neither told nor written."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.console.reports.noise import noise_report
from radmpc.identification import Identification, identify
from radmpc.importing.logs.block import noise_block
from simulator import Truth, fly


def told(found: Identification) -> str:
    """All cells of the tables."""
    tables = [part for part in noise_report(found) if hasattr(part, "columns")]
    return "\n".join(str(cell) for table in tables for one in table.columns for cell in one.cells)


@pytest.mark.parametrize("truth", [Truth(steps=200), Truth(dimension=3, steps=400)])
def test_rounding_of_commands_is_no_feedback(truth: Truth) -> None:
    found = identify(fly(truth, 1, "both"))
    assert "feedback ax by x" in told(found)
    assert "feedback ay by x" not in told(found)
    assert "feedback ax by vy" not in told(found)
    written = np.array(noise_block(found).content["defaults"]["feedback"]["gain"])
    assert np.all(written[truth.gain == 0.0] == 0.0)
    assert written == pytest.approx(truth.gain)


def test_feedback_along_an_axis_of_tiny_motion_is_no_rounding() -> None:
    [track] = fly(Truth(), 2, "both")
    parts = {name: np.array(getattr(track, name)) for name in track.parts()}
    for part in parts.values():
        part[:, 1::2] *= 1e-7
    gain = identify([track.changed(parts)]).pooled.gain
    assert gain.value == pytest.approx(Truth().gain, abs=1e-9)


def test_feedback_between_axes_that_is_small_but_no_rounding_is_told() -> None:
    [track] = fly(Truth(), 3, "both")
    mixed = track.controls + 1e-4 * (track.velocities - track.references[:, 2:])[:, ::-1]
    found = identify([track.changed({"controls": mixed})])
    assert "feedback ax by vy" in told(found)
    assert found.pooled.gain.value[0, 3] == pytest.approx(1e-4, rel=1e-6)
