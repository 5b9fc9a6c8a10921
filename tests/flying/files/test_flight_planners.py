"""Planners that cannot plan a flight anew: refused before it begins."""

from __future__ import annotations

from pathlib import Path

import pytest
from range_scenes import abreast
from recorded_flights import certified, drifting

from radmpc.errors import ScenarioError
from radmpc.flying.recording.campaign import begin_flight
from radmpc.io.flight.record import FlightSettings


@pytest.mark.parametrize("planner", ["dmpc", "radmpc", "multi-vehicle", "rmpc-rrt"])
def test_a_planner_of_single_vehicles_does_not_fly_a_plan_with_ranges(
    planner: str, tmp_path: Path
) -> None:
    plan = certified(abreast("intervals", 3.75))
    path = tmp_path / "ranges.flight.jsonl"
    with pytest.raises(ScenarioError, match=f"^cannot plan anew with '{planner}': keep: "):
        begin_flight(plan, FlightSettings(replan=planner), path)
    assert not path.exists()


def test_a_planner_of_single_vehicles_flies_a_plan_that_asks_for_nothing_else() -> None:
    record = begin_flight(drifting(2), FlightSettings(replan="dmpc"))
    assert record.missions[0].is_over
