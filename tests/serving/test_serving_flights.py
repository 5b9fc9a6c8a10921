"""Flights that are read from their files, as the page is told of them."""

from __future__ import annotations

from pathlib import Path

import pytest

import radmpc
from radmpc.flying.recording.campaign import begin_flight
from radmpc.io.flight.record import FlightSettings
from radmpc.serving.desk.opening import read_file


@pytest.fixture
def flown(tmp_path: Path) -> Path:
    """Two missions of a vehicle that nothing stops."""
    vehicle = radmpc.Vehicle(
        name="a",
        system=radmpc.double_integrator(1.0, 2),
        start=[0.0, 0.0, 0.0, 0.0],
        goal=radmpc.Goal.at([2.0, 0.0], 1.0, None),
        radius=0.3,
        control_limit=2.0,
        initial_covariance=1e-4,
        disturbance_covariance=1e-4,
    )
    plan = radmpc.plan(radmpc.Scenario("alone", 1.0, 3, 0.05, [vehicle])).require()
    path = tmp_path / "a.flight.jsonl"
    begin_flight(plan, FlightSettings(replan=None, missions=2), path)
    return path


def test_of_several_missions_the_page_says_which_it_shows(flown: Path) -> None:
    opened = read_file(flown, "a.flight.jsonl")
    assert opened.ticks is not None
    assert len(opened.ticks) == 4
    assert opened.note == "read from its file, the first of 2 missions"


def test_a_flight_that_was_changed_after_it_was_written_is_shown_as_that(flown: Path) -> None:
    text = flown.read_text(encoding="utf-8")
    flown.write_text(text.replace('"excess": 0.0', '"excess": 1.0', 1), encoding="utf-8")
    assert read_file(flown, "a.flight.jsonl").note == (
        "read from its file, the first of 2 missions; line 2 is not as it was written"
    )
