"""Ranges that are lost in flight files: told, reported, and found out where they are not."""

from __future__ import annotations

from pathlib import Path

import pytest
from range_scenes import NAMES, abreast
from recorded_flights import certified, forged, written

from radmpc.console.reports.flight import flight_rows
from radmpc.flying.flight import fly
from radmpc.flying.model import Model
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.flying.recording.summary import summary_of
from radmpc.flying.recording.verifying import flight_problems
from radmpc.io.flight.flight_file import load_flight
from radmpc.io.flight.record import TickRow
from radmpc.model.plan import Plan


@pytest.fixture(scope="module")
def losing() -> tuple[Plan, list[TickRow]]:
    """A flight on which a range is lost."""
    plan = certified(abreast("intervals", 3.75))
    for seed in range(100):
        rows: list[TickRow] = []
        mission = RecordedMission(plan, 0, rows.append, planner=None)
        fly(mission, Model(plan.scenario, seed))
        if mission.contacts:
            return plan, rows
    raise AssertionError("no range was lost")


def test_a_flight_file_tells_which_range_was_lost(
    losing: tuple[Plan, list[TickRow]], tmp_path: Path
) -> None:
    path = tmp_path / "lost.flight.jsonl"
    written(path, *losing)
    record = load_flight(path)
    assert flight_problems(record) == ()
    assert {(t.cause, t.vehicle, t.other) for t in record.missions[0].contacts} == {
        ("range", *NAMES)
    }
    summary = summary_of(record)
    assert summary.flown is not None
    assert (summary.flown.collisions, summary.flown.range_losses) == (1, 1)
    assert summary.flown.pair_collisions == 0
    told = flight_rows(record, summary)
    assert str(told["hit"]) == "lead out of range of wing (1)"


def test_a_range_lost_that_is_kept_quiet_is_found_out(
    losing: tuple[Plan, list[TickRow]], tmp_path: Path
) -> None:
    path = tmp_path / "quiet.flight.jsonl"
    written(path, *losing)
    for line, row in enumerate(losing[1], start=2):
        if row.contacts:
            forged(path, line, lambda content: content.update({"contacts": []}))
    problems = flight_problems(load_flight(path))
    assert any(
        "'lead' and 'wing': a range that is lost, and not stated" in problem for problem in problems
    )
