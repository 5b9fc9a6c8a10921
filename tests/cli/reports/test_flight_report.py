"""How the report of a flight tells its numbers."""

from __future__ import annotations

from radmpc.console.commands import flying
from radmpc.console.reports.flight import probability_text
from radmpc.console.reports.progress import ProgressLine
from radmpc.experiments.families import circle
from radmpc.io.flight.record import FlightRecord, FlightSettings
from radmpc.planning import plan


def test_probabilities_that_are_as_good_as_none_are_not_told_digit_by_digit() -> None:
    told = [probability_text(value) for value in (None, 0.0, 3e-157, 1.2e-15, 0.05)]
    assert told == ["", "0.00e+00", "< 1e-15", "1.20e-15", "5.00e-02"]


def test_progress_tells_mission_and_step() -> None:
    record = FlightRecord(plan(circle(2), "ira").require(), FlightSettings(missions=3))
    line = ProgressLine(keeps="what was flown")
    told = flying._Progress(line, record)
    # The first tick may take long.
    assert line.text() == "mission 1/3, step 0/10; 0 s; Ctrl-C keeps what was flown"
    told(1, 2)
    assert line.text() == "mission 2/3, step 2/10; 0 s; Ctrl-C keeps what was flown"
