"""Flights that are read from their files, as the page is told of them, and those that are begun."""

from __future__ import annotations

import asyncio
import tempfile
from pathlib import Path
from types import SimpleNamespace

import pytest

import radmpc
from radmpc.flying.recording.campaign import begin_flight
from radmpc.io.flight.record import FlightSettings
from radmpc.serving.desk.calls import answer
from radmpc.serving.desk.opening import read_file
from radmpc.serving.failures import CallError
from radmpc.serving.protocol import TickView
from radmpc.serving.work.control import Control
from radmpc.serving.work.flying import fly_plan


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


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"with": "submarine"}, "options.with must be one of model, rotorpy, irsim, boat, got "),
        ({"replan": "magic"}, "options.replan must be one of none, "),
        ({"replan": "multi-vehicle(1e-4"}, "options.replan must be one of none, "),
        ({"with": "mavlink"}, "'mavlink' is not flown from a page: radmpc fly --with mavlink"),
    ],
)
def test_a_flight_with_what_there_is_none_of_is_refused_before_it_begins(options, text):
    begun = []
    desk = SimpleNamespace(plan=lambda _: None, begin_flight=lambda *args: begun.append(args))
    args = {"plan": "p1", "seed": 0, "pace": 0.0, "options": options}
    with pytest.raises(CallError) as failure:
        asyncio.run(answer(desk, "fly", args))
    assert failure.value.kind == "refused"
    assert text in str(failure.value)
    assert "\n" not in str(failure.value)
    assert begun == []


@pytest.mark.parametrize("replan", ["none", "certified", "multi-vehicle(1e-4)", None])
def test_a_flight_with_what_there_is_begins(replan):
    begun = []

    def begin(_, how):
        begun.append(how[2])
        return SimpleNamespace(state="running")

    desk = SimpleNamespace(plan=lambda _: None, begin_flight=begin)
    args = {"plan": "p1", "seed": 0, "pace": 0.0, "options": {"with": "boat", "replan": replan}}
    assert asyncio.run(answer(desk, "fly", args)) == "running"
    assert begun == [{"with": "boat", "replan": replan}]


def test_a_flight_without_a_log_writes_no_file_that_a_kill_would_leave(
    flown: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, steps, seen = tmp_path / "temporary", [], []
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))

    def tell(_: str, tick: TickView) -> None:
        steps.append(tick["step"])
        seen.extend(folder.iterdir())

    control = Control(tell, SimpleNamespace(value=0))
    plan = radmpc.load_flight(flown).plan
    assert fly_plan(control, plan, 3, 0.0, {"replan": "none"}).startswith("flown to its end")
    assert steps == [0, 1, 2, 3]
    assert seen == []
