"""How the report of a flight tells its numbers."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from radmpc.console.commands import flying
from radmpc.console.reports import flight
from radmpc.console.reports.flight import probability_text
from radmpc.console.reports.progress import ProgressLine
from radmpc.experiments.families import circle
from radmpc.flying.recording.campaign import begin_flight
from radmpc.flying.recording.summary import summary_of
from radmpc.io.flight.record import FlightRecord, FlightSettings, ScaleRow
from radmpc.planning import plan


def test_probabilities_that_are_as_good_as_none_are_not_told_digit_by_digit() -> None:
    told = [probability_text(value) for value in (None, 0.0, 3e-157, 1.2e-15, 0.05)]
    assert told == ["", "0.00e+00", "< 1e-15", "1.20e-15", "5.00e-02"]


def test_the_report_tells_covariances_and_whose_noise_it_was() -> None:
    made = plan(circle(2), "ira").require()
    record = begin_flight(made, FlightSettings(replan=None))
    strange = tuple(replace(row, alarms=("the last 2 disturbances",)) for row in record.rows)
    told = flight.flight_rows(record, summary_of(record))
    assert (told["alarms"], "covariances" in told) == ("none", False)
    for backend, is_told in (("model", False), ("irsim", True)):
        settings = replace(record.settings, backend=backend)
        flown = replace(record, rows=strange, settings=settings)
        text = str(flight.flight_rows(flown, summary_of(flown))["alarms"])
        assert ("irsim has other noise than the scenario" in text) == is_told
    once = replace(record, rows=(*record.rows[:-1], replace(strange[-1], scale=ScaleRow(42, 1.25))))
    assert "other noise" not in str(flight.flight_rows(once, summary_of(once))["alarms"])
    noise = flight.flight_rows(once, summary_of(once))["covariances"]
    assert noise == "stated ones times 1.25, as known from 42 samples by the end"


def test_progress_tells_mission_and_step(monkeypatch: pytest.MonkeyPatch) -> None:
    record = FlightRecord(plan(circle(2), "ira").require(), FlightSettings(missions=3))
    line = ProgressLine(keeps="what was flown")
    told = flying._Progress(line, record)
    # The first tick may take long.
    assert line.text() == "mission 1/3, step 0/10; 0 s; Ctrl-C keeps what was flown"
    told(0, 10)
    later = time.monotonic() + 7.0
    monkeypatch.setattr(time, "monotonic", lambda: later)
    told(1, 2)
    text = "about 14 s to go, mission 2/3, step 2/10; 7 s; Ctrl-C keeps what was flown"
    assert line.text() == text
    told(1, 3)
    assert "about 14 s to go, mission 2/3, step 3/10" in line.text()


def test_what_is_left_of_a_flight_that_goes_on_is_told_by_whole_missions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made, settings = plan(circle(2), "ira").require(), FlightSettings(missions=4, replan=None)
    rows = begin_flight(made, settings, stop=iter([False] * 14 + [True] * 9).__next__).rows
    assert (rows[-1].mission, rows[-1].step) == (1, 0)
    line = ProgressLine()
    told = flying._Progress(line, FlightRecord(made, settings, rows))
    assert line.text() == "mission 2/4, step 0/10; 0 s"
    begun = time.monotonic()
    for seconds, mission, text in ((3.0, 2, "mission 3/4"), (8.0, 3, "about 5 s to go, mission 4")):
        monkeypatch.setattr(time, "monotonic", lambda now=begun + seconds: now)
        told(mission, 0)
        assert line.text().startswith(text)
