"""What goes into scenarios: true, or on the safe side."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from radmpc import Scenario
from radmpc.errors import FileFormatError
from radmpc.identification import Track, identify
from radmpc.importing.logs.applying import noise_text, with_noise
from radmpc.importing.logs.block import noise_block
from radmpc.importing.logs.reading import read_logs
from radmpc.io.native.scenario_file import decode_scenario
from simulator import Truth, fly

PX4 = Path(__file__).parent.parent / "data" / "logs" / "px4.ulg"


def renamed(track: Track, name: str) -> Track:
    return Track(name, track.source, track.clock, track.times, track.positions, track.velocities,
                 track.controls, track.references)  # fmt: skip


def scenario(*names: str) -> Scenario:
    goal = {"center": [10.0, 0.0], "half_width": 1.0}
    return decode_scenario(
        {
            "format": "radmpc/scenario/1",
            "name": "fleet",
            "dt": 0.5,
            "horizon": 20,
            "risk_bound": 0.05,
            "defaults": {"radius": 0.5, "control_limit": 5.0},
            "vehicles": [
                {"name": name, "start": [0.0, 5.0 * i], "goal": {**goal, "center": [10.0, 5.0 * i]}}
                for i, name in enumerate(names)
            ],
        }
    )


def test_a_vehicle_in_no_log_gets_the_largest_noise_of_those_that_differ() -> None:
    [calm], [wild] = fly(Truth(), 1), fly(Truth(scale=4.0), 2)
    found = identify([renamed(calm, "calm"), renamed(wild, "wild")])
    assert found.differ
    changed, warnings = with_noise(scenario("calm", "other"), found, "today")
    calm_one, other = (np.array(one.disturbance_covariance) for one in changed.vehicles)
    assert np.diag(other) == pytest.approx(4.0 * np.diag(calm_one), rel=0.5)
    assert any("it gets the largest noise of any of them" in line for line in warnings)


def test_references_that_explain_no_commands_give_no_feedback() -> None:
    [track] = fly(Truth(steps=400), 3, "both")
    rng = np.random.default_rng(5)
    others = track.references + 0.5 * rng.standard_normal(track.references.shape)
    found = identify([track.changed({"references": others})])
    assert found.pooled.gain is None
    assert any(s.startswith("feedback: deviations from references explain") for s in found.unknown)
    assert "feedback" not in noise_block(found).content["defaults"]
    assert identify([track]).pooled.gain is not None


def test_feedback_that_lets_deviations_grow_is_not_written() -> None:
    [track] = fly(Truth(steps=60, feedback=(0.05, 0.05), scale=0.01), 4, "both")
    found = identify([track])
    assert found.pooled.gain.value[0, 0] == pytest.approx(0.05, abs=1e-6)
    assert any("deviations grow" in sentence for sentence in found.unknown)
    assert "feedback" not in noise_block(found).content["defaults"]


def test_logs_that_tell_hardly_anything_are_not_written() -> None:
    pytest.importorskip("pyulog")
    found = identify(read_logs([PX4]).tracks)
    assert found.pooled.worth < 3.0
    assert found.pooled.gain is None
    with pytest.raises(FileFormatError, match=r"px4\.ulg: is worth about 1 independent step,"):
        noise_text(found, "today")
    with pytest.raises(FileFormatError, match=r"px4\.ulg: is worth about 1 independent step,"):
        with_noise(scenario("px4"), found, "today")


def test_references_that_never_change_give_feedback_to_one_that_holds_a_place_alone() -> None:
    [track] = fly(Truth(steps=400), 6, "both")
    still = np.zeros_like(track.references)
    since = track.times[:, None]
    # Feedback to a place, and to one that goes round it and was not logged.
    gain = Truth().gain
    states = np.hstack([track.positions, track.velocities])
    held = track.changed({"references": still, "controls": states @ gain.T})
    steered = held.changed({"controls": states @ gain.T + 0.2 * np.sin(0.3 * since + [0.0, 1.0])})
    for flown in (held, steered):
        found = identify([flown])
        assert any("references never change" in line for line in found.warnings)
        assert (found.pooled.gain is None) == (flown is steered)
