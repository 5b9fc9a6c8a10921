"""Flights go on from their files, whatever ended them; each backend is opened once."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from recorded_flights import beside_the_wall, certified, drifting, forged, without_seconds

import radmpc
from radmpc.errors import FileFormatError
from radmpc.flying import backends
from radmpc.flying.backends import BACKENDS
from radmpc.flying.leg import leg_of
from radmpc.flying.model import Model
from radmpc.flying.recording.campaign import begin_flight, resume_flight
from radmpc.flying.recording.verifying import flight_problems
from radmpc.io.flight.flight_file import FlightWriter, load_flight
from radmpc.io.flight.record import FlightRecord, FlightSettings
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario

KEPT = FlightSettings(replan=None, missions=2, seed=4)


@pytest.fixture(scope="module")
def plan() -> Plan:
    return beside_the_wall()


def test_a_flight_that_was_stopped_goes_on_as_if_it_had_not(tmp_path: Path, plan: Plan) -> None:
    whole = begin_flight(plan, KEPT, tmp_path / "whole.jsonl")
    for ticks in (5, 14):
        path = tmp_path / f"cut{ticks}.jsonl"
        left = iter(range(ticks + 1 + ticks // 12))
        cut = begin_flight(plan, KEPT, path, stop=lambda left=left: next(left, None) is None)
        assert len(cut.rows) < len(whole.rows)
        with path.open("a", encoding="utf-8") as file:
            file.write('{"mission": 0, "step": 3, "sta')  # killed while writing
        record = resume_flight(path)
        assert without_seconds(record) == without_seconds(whole)
        assert without_seconds(load_flight(path)) == without_seconds(whole)
        assert load_flight(path).changed == ()


def stopped(plan: Plan, settings: FlightSettings, path: Path, ticks: int) -> FlightRecord:
    """Fly until some ticks were flown."""
    left = iter(range(ticks + 1))
    return begin_flight(plan, settings, path, stop=lambda: next(left, None) is None)


def test_a_flight_of_matrices_as_columns_goes_on_to_the_last_digit(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    eye, zero = np.eye(2), np.zeros((2, 2))
    A = np.block([[eye, 0.5 * eye], [zero, eye]]) + 0.01 * rng.standard_normal((4, 4))
    B = np.vstack([0.125 * eye, 0.5 * eye]) + 0.01 * rng.standard_normal((4, 2))
    system = radmpc.LinearSystem(np.asfortranarray(A), np.asfortranarray(B), (0, 1), (2, 3))
    gain = np.hstack([-0.3 * eye, -0.9 * eye]) + 0.01 * rng.standard_normal((2, 4))
    plan = drifting(2)
    [vehicle] = plan.scenario.vehicles
    vehicle = replace(vehicle, system=system, gain=np.asfortranarray(gain), control_limit=9.0)
    scenario = replace(plan.scenario, dt=0.5, vehicles=(vehicle,))
    plan = certified(leg_of(scenario, [0.1 * rng.standard_normal((6, 2))], 0).plan)
    once = replace(KEPT, missions=1)
    whole = begin_flight(plan, once, tmp_path / "whole.jsonl")
    stopped(plan, once, tmp_path / "cut.jsonl", 2)
    assert without_seconds(resume_flight(tmp_path / "cut.jsonl")) == without_seconds(whole)


@pytest.mark.slow
def test_a_flight_that_was_unsafe_twice_goes_on_to_the_last_digit(tmp_path: Path) -> None:
    rock = radmpc.Obstacle.box("rock", [1.0, -0.5], [1.2, 0.5])
    vehicle = radmpc.Vehicle(
        name="v",
        system=radmpc.double_integrator(0.5, 2),
        start=[0.13, 0.07, 0.0, 0.0],
        goal=radmpc.Goal.at([2.4, 0.0], 1.0, None),
        radius=0.3,
        control_limit=2.0,
        initial_covariance=np.diag([1e-3, 1e-3, 1e-4, 1e-4]),
        disturbance_covariance=1e-3,
    )
    scenario = radmpc.Scenario("rock", 0.5, 8, 0.2, (vehicle,), (rock,))
    plan = radmpc.plan(scenario, rng=0).plan
    assert plan is not None
    replanned = FlightSettings(replan="certified", seed=5)
    whole = begin_flight(plan, replanned, tmp_path / "whole.jsonl")
    unsafe = [row for row in whole.rows if row.value is not None and row.value > 0.2]
    assert len(unsafe) >= 2
    stopped(plan, replanned, tmp_path / "cut.jsonl", 1)
    assert without_seconds(resume_flight(tmp_path / "cut.jsonl")) == without_seconds(whole)


@pytest.mark.slow
def test_a_flight_that_learns_of_its_noise_goes_on_with_what_it_has_learned(tmp_path: Path) -> None:
    plan = drifting(2)
    near = radmpc.Obstacle.box("near", [2.0, 1.1], [4.0, 2.0])
    scenario = replace(plan.scenario, obstacles=(near,), covariance_samples=12, risk_bound=0.4)
    plan = certified(leg_of(scenario, [path.controls for path in plan.trajectories], 0).plan)
    replanned = replace(KEPT, replan="ira", missions=1)
    whole = begin_flight(plan, replanned, tmp_path / "whole.jsonl")
    assert any(row.choice == "candidate" for row in whole.rows)
    path, left = tmp_path / "cut.jsonl", iter(range(5))
    begin_flight(plan, replanned, path, stop=lambda: next(left, None) is None)
    assert without_seconds(resume_flight(path)) == without_seconds(whole)
    assert load_flight(path).rows[-1].scale == whole.rows[-1].scale
    assert flight_problems(whole) == ()
    # Who writes down more calm than there was is found out.
    forged(tmp_path / "whole.jsonl", 3, lambda row: row["scale"].update({"factor": 0.1}))
    assert any("factor" in text for text in flight_problems(load_flight(tmp_path / "whole.jsonl")))


KILLED = """
import os, signal, sys
from radmpc.flying.recording.campaign import begin_flight
from radmpc.io.flight.record import FlightSettings
from radmpc import load_plan

def told(mission, step):
    if (mission, step) == (1, 3):
        os.kill(os.getpid(), signal.SIGKILL)

settings = FlightSettings(replan=None, missions=2, seed=4)
begin_flight(load_plan(sys.argv[1]), settings, sys.argv[2], progress=told)
"""


@pytest.mark.slow
def test_a_flight_whose_process_is_killed_loses_no_tick(tmp_path: Path, plan: Plan) -> None:
    radmpc.save_plan(plan, tmp_path / "plan.json")
    path = tmp_path / "killed.jsonl"
    command = [sys.executable, "-c", KILLED, str(tmp_path / "plan.json"), str(path)]
    assert subprocess.run(command, timeout=120, check=False).returncode == -9
    record = load_flight(path)
    assert [(row.mission, row.step) for row in record.rows][-1] == (1, 3)
    assert flight_problems(record) == ()
    whole = begin_flight(plan, KEPT)
    assert without_seconds(resume_flight(path)) == without_seconds(whole)


def test_nothing_is_added_where_the_backend_is_elsewhere(tmp_path: Path, plan: Plan) -> None:
    path = tmp_path / "flight.jsonl"
    left = iter(range(4))
    begin_flight(plan, KEPT, path, stop=lambda: next(left, None) is None)
    forged(path, 1, lambda header: header.update({"seed": 5}))
    before = path.read_bytes()
    with pytest.raises(FileFormatError, match="cannot go on: at step 1 of mission 1 vehicle 'v'"):
        resume_flight(path)
    assert path.read_bytes() == before


def test_only_vehicles_do_not_repeat() -> None:
    assert [name for name, kind in BACKENDS.items() if not kind.repeats] == ["mavlink"]


def test_vehicles_are_not_sent_through_a_mission_again(
    tmp_path: Path, plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "flight.jsonl"
    left = iter(range(4))
    begin_flight(plan, KEPT, path, stop=lambda: next(left, None) is None)
    vehicles = replace(backends.BACKENDS["model"], repeats=False)
    monkeypatch.setattr(backends, "BACKENDS", {"model": vehicles})
    with pytest.raises(FileFormatError, match="cannot go on: model does not repeat the 3 steps of"):
        resume_flight(path)


class Link(Model):
    """A backend of which there can be but one at a time."""

    opened = 0

    def __init__(self, scenario: Scenario, rng: object) -> None:
        super().__init__(scenario, rng)
        Link.opened += 1
        assert Link.opened == 1

    def close(self) -> None:
        Link.opened -= 1


def test_every_backend_is_closed_before_the_next_is_opened(
    tmp_path: Path, plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = ModuleType("links")
    monkeypatch.setattr(module, "Link", Link, raising=False)
    monkeypatch.setitem(sys.modules, "links", module)
    link = backends.BackendKind("model", "links:Link", None, "")
    monkeypatch.setattr(backends, "BACKENDS", {"model": link})
    begin_flight(plan, KEPT, tmp_path / "flight.jsonl")
    assert Link.opened == 0
    begin_flight(plan, KEPT, stop=lambda: True)
    assert Link.opened == 0
    with pytest.raises(OSError, match="No such file"):
        begin_flight(plan, KEPT, tmp_path / "none" / "flight.jsonl")
    assert Link.opened == 0


def test_two_processes_do_not_write_one_file(tmp_path: Path, plan: Plan) -> None:
    path = tmp_path / "flight.jsonl"
    with FlightWriter.begin(path, plan, KEPT, {}):
        with pytest.raises(FileFormatError, match="is being written by another flight"):
            FlightWriter.go_on(path)
        with pytest.raises(FileFormatError, match="is being written by another flight"):
            FlightWriter.begin(path, plan, KEPT, {})
    writer, record = FlightWriter.go_on(path)
    writer.close()
    assert record.rows == ()


def test_a_device_is_no_place_for_a_flight(plan: Plan) -> None:
    with pytest.raises(FileFormatError, match="/dev/null: a flight needs a file of its own"):
        begin_flight(plan, KEPT, "/dev/null")


def test_what_cannot_be_flown_leaves_no_file(tmp_path: Path, plan: Plan) -> None:
    path = tmp_path / "flight.jsonl"
    with pytest.raises(radmpc.ArgumentError, match="takes no option 'wind'"):
        begin_flight(plan, FlightSettings(options={"wind": "3"}), path)
    assert not path.exists()


@pytest.mark.parametrize("cut", [0, 1])
def test_a_flight_of_a_header_alone_goes_on_behind_it_also_without_its_line_end(
    tmp_path: Path, plan: Plan, cut: int
) -> None:
    path = tmp_path / "flight.jsonl"
    whole = begin_flight(plan, KEPT, path)
    header = path.read_bytes().splitlines(keepends=True)[0]
    path.write_bytes(header[: len(header) - cut])
    assert without_seconds(resume_flight(path)) == without_seconds(whole)
    assert path.read_bytes().startswith(header)
    assert without_seconds(load_flight(path)) == without_seconds(whole)
    assert flight_problems(load_flight(path)) == ()
