"""What public functions say to arguments of another kind, or beyond what floats and memory hold."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import radmpc
from radmpc.errors import ArgumentError, FileFormatError
from radmpc.experiments.families import circle

SCENE = circle(2)
PLAN = radmpc.plan(SCENE).require()
STARTS = [vehicle.start for vehicle in SCENE.vehicles]
TRACK = radmpc.Track("a", "log.csv", "one", [0.0, 1.0], np.zeros((2, 2)))
FIXED = radmpc.FlightSettings(replan=None)


def mission(**options: object) -> radmpc.Mission:
    return radmpc.Mission(PLAN, planner=None, **options)


CALLS: dict[str, tuple[Callable[[], object], str]] = {
    "no track": (lambda: radmpc.identify([None]), r"tracks must be .*, got a NoneType in it"),
    "no warnings": (lambda: radmpc.identify([TRACK], warnings=None), r"warnings must be a list or"),
    "one log": (
        lambda: radmpc.read_logs("log.csv"),
        r"paths must be a sequence of files, got 'log.csv': put it in a list$",
    ),
    "no logs": (lambda: radmpc.read_logs(None), r"paths must be a sequence of files, got None$"),
    "columns that are none": (
        lambda: radmpc.read_logs(["log.csv"], np.zeros(0)),
        r"columns must be a mapping of text or None",
    ),
    "changes that are none": (
        lambda: radmpc.load_scenario("a.yaml", True),
        r"changes must be a mapping of values by key or None, got True",
    ),
    "nothing exported": (
        lambda: radmpc.save_exported(None),
        r"exported must be an Exported, as export_plan returns, got None",
    ),
    "a flight to a number": (
        lambda: radmpc.begin_flight(PLAN, FIXED, True),
        r"path must be the name of a file \(str or Path\), got True",
    ),
    "a flight that never asks": (
        lambda: radmpc.begin_flight(PLAN, FIXED, stop=None),
        r"stop must be a function, got None",
    ),
    "a flight told to truth": (
        lambda: radmpc.begin_flight(PLAN, FIXED, progress=True),
        r"progress must be a function or None, got True",
    ),
    "a share without end": (lambda: mission(share=10**400), r"share must be a number, got 1000"),
    "a price without end": (lambda: mission(miss_price=10**400), r"miss_price must be a number"),
    "a deadline without end": (
        lambda: mission().step(STARTS, deadline=10**400),
        r"deadline must be a number, got 1000",
    ),
    "a bound without end": (
        lambda: mission().set_risk_bound(10**400),
        r"risk_bound must be a number, got 1000",
    ),
    "one number for states": (
        lambda: mission().step(np.array(1.0)),
        r"states must be a sequence of states, got ",
    ),
    "no segments": (
        lambda: radmpc.Model(SCENE, 1).advance(None),
        r"segments must be of \['v1', 'v2'\] in this order, got \[\]",
    ),
    "segments of text": (lambda: radmpc.Model(SCENE, 1).advance("x"), r"segments must be of"),
    "a text for a seed": (
        lambda: radmpc.LongMission(SCENE, window=6, overlap=2, seed="x"),
        r"seed must be an integer >= 0, got 'x'",
    ),
    "samples without end": (
        lambda: radmpc.simulate(PLAN, 2**63),
        r"samples must be at most 1000000000, got 9223372036854775808",
    ),
    "a tolerance without end": (
        lambda: radmpc.thin(PLAN, 10**400),
        r"tolerance must be a number > 0 m, got 1000",
    ),
}


@pytest.mark.parametrize(("call", "expected"), CALLS.values(), ids=CALLS)
def test_a_wrong_call_is_refused_with_what_is_allowed(
    call: Callable[[], object], expected: str
) -> None:
    with pytest.raises(ArgumentError, match=expected) as caught:
        call()
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    "save",
    [
        lambda path: radmpc.save_plan(PLAN, path),
        lambda path: radmpc.save_export(PLAN, "csv", path),
        lambda path: radmpc.begin_flight(PLAN, FIXED, path),
        radmpc.resume_flight,
    ],
    ids=["plan", "export", "flight", "resumed flight"],
)
def test_half_a_character_is_no_name_of_a_file(save: Callable[[str], object]) -> None:
    with pytest.raises(FileFormatError, match=r"'\\ud800': is no file name: half a char"):
        save("\ud800")
