"""Flight files whose rows do not follow one another, as after two files were put together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from recorded_flights import certified, drifting, written

from radmpc.flying.flight import fly
from radmpc.flying.model import Model
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.flying.recording.verifying import flight_problems
from radmpc.io.flight.flight_file import load_flight
from radmpc.io.flight.record import TickRow
from radmpc.model.plan import Plan


@pytest.fixture(scope="module")
def flown() -> tuple[Plan, list[TickRow]]:
    plan = certified(drifting(2))
    rows: list[TickRow] = []
    fly(RecordedMission(plan, 0, rows.append, planner=None), Model(plan.scenario, 1))
    return plan, rows


def problems_of(path: Path, plan: Plan, rows: list[TickRow]) -> tuple[str, ...]:
    written(path, plan, rows)
    return flight_problems(load_flight(path))


def test_a_last_row_that_stands_there_twice_is_a_problem(
    flown: tuple[Plan, list[TickRow]], tmp_path: Path
) -> None:
    plan, rows = flown
    found = problems_of(tmp_path / "twice.flight.jsonl", plan, [*rows, rows[-1]])
    assert found == ("mission 1, step 6: stands where step 7 is due",)


def test_controls_that_end_too_soon_are_a_problem(
    flown: tuple[Plan, list[TickRow]], tmp_path: Path
) -> None:
    plan, rows = flown
    cut = [replace(row, controls=()) if row.step == 2 else row for row in rows]
    found = problems_of(tmp_path / "cut.flight.jsonl", plan, cut)
    assert "mission 1, step 2: controls must end with step 5" in found


def test_saturation_where_nothing_is_flown_any_more_is_a_problem(
    flown: tuple[Plan, list[TickRow]], tmp_path: Path
) -> None:
    plan, rows = flown
    made_up = [*rows[:-1], replace(rows[-1], excess=0.5)]
    found = problems_of(tmp_path / "saturated.flight.jsonl", plan, made_up)
    assert found == ("mission 1, step 6: states a saturation of 0.5, recomputed it is 0",)


def test_a_state_too_large_to_be_squared_is_a_problem_and_no_warning(
    flown: tuple[Plan, list[TickRow]], tmp_path: Path
) -> None:
    plan, rows = flown
    assert rows[2].states is not None
    far = tuple(np.full_like(state, 1e300) for state in rows[2].states)
    changed = [replace(row, states=far) if row.step == 2 else row for row in rows]
    found = problems_of(tmp_path / "far.flight.jsonl", plan, changed)
    assert "mission 1, step 2: states a value of" in found[0]
