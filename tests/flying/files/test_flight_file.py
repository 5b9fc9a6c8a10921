"""Flight files: what is written reads back, what was changed is found, what was cut goes on."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from recorded_flights import beside_the_wall, certified, forged, staked_rows, told, written

import radmpc
from radmpc.errors import FileFormatError
from radmpc.experiments.families import paper
from radmpc.flying.recording.campaign import begin_flight
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.flying.recording.summary import summary_of
from radmpc.flying.recording.verifying import flight_problems
from radmpc.io.flight.flight_file import FlightWriter, is_flight, load_flight
from radmpc.io.flight.record import FlightRecord, FlightSettings, TickRow, Touch
from radmpc.model.plan import Plan
from radmpc.referee.claims.claims import shape_problems

KEPT = FlightSettings(replan=None, missions=2, seed=4)


@pytest.fixture(scope="module")
def plan() -> Plan:
    return beside_the_wall()


@pytest.fixture(scope="module")
def rows(plan: Plan) -> list[TickRow]:
    rows = staked_rows(plan)
    assert sum(row.leg is not None for row in rows) >= 2
    return rows


@pytest.fixture
def path(tmp_path: Path, plan: Plan, rows: list[TickRow]) -> Path:
    path = tmp_path / "wall.flight.jsonl"
    written(path, plan, rows)
    return path


def test_a_flight_reads_back_as_it_was_flown(path: Path, plan: Plan, rows: list[TickRow]) -> None:
    record = load_flight(path)
    assert told(record.rows) == told(tuple(rows))
    assert record.settings == FlightSettings(replan=None)
    assert record.changed == ()
    assert radmpc.to_dict(record.plan) == radmpc.to_dict(plan)
    assert flight_problems(record) == ()


def test_only_a_flight_is_one(path: Path, tmp_path: Path) -> None:
    assert is_flight(path)
    other = tmp_path / "other.json"
    other.write_text('{"format": "radmpc/plan/1"}', encoding="utf-8")
    assert not is_flight(other)
    assert not is_flight(tmp_path)
    assert not is_flight(tmp_path / "missing")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"seconds": 0.', '"seconds": 1.'),
        ('"contacts": []', '"contacts":  []'),
        ('"reason": "', '"reason": "surely '),
        ('"radmpc": "test"', '"radmpc": "tests"'),
    ],
)
def test_whatever_is_changed_in_a_file_is_found(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    at = text.index(old)
    path.write_text(text[:at] + new + text[at + len(old) :], encoding="utf-8")
    line = 1 + text.count("\n", 0, at)
    assert load_flight(path).changed[0] == line
    problem = flight_problems(load_flight(path))[0]
    assert problem == f"line {line} of the file is not as it was written"
    with pytest.raises(FileFormatError, match=f":{line}: was changed after it was written"):
        FlightWriter.go_on(path)


def test_a_line_that_is_taken_out_is_found(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join(lines[:4] + lines[5:]) + "\n", encoding="utf-8")
    first, second, *_ = flight_problems(load_flight(path))
    assert first == "line 5 of the file is not as it was written"
    assert second == "mission 1, step 4: stands where step 3 is due"


def _first_leg(rows: list[TickRow]) -> int:
    return 2 + next(i for i, row in enumerate(rows) if row.leg is not None)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("bank", 0.049, "states a bank of 0.049"),
        ("tail", 0.5, "states a tail of 0.5"),
        ("wealth", 0.5, "states a wealth of 0.5"),
        ("price", 1e-4, "states a price of 0.0001"),
        ("value", 0.3, "states a value of 0.3"),
        ("states", [[0.0, 3.0]], "recomputed it is"),
        ("controls", [[0.0, 0.0]], "the leg says"),
        ("excess", 0.5, "states a saturation of 0.5, recomputed it is 0"),
        ("alarms", ["a", "b"], "states a number of alarms of 2, recomputed it is 0"),
        ("leg", None, "a leg only where one is adopted"),
        ("mission", 3, "mission 4 stands where mission 1 is due"),
        ("contacts", [{"step": 1, "cause": "obstacle", "vehicle": "v", "other": "wall"}],
         "a contact that is stated, and not hit"),
    ],
)  # fmt: skip
def test_a_file_that_was_signed_anew_is_found_out_by_recomputing_it(
    path: Path, rows: list[TickRow], key: str, value: object, words: str
) -> None:
    forged(path, _first_leg(rows), lambda row: row.update({key: value}))
    record = load_flight(path)
    assert record.changed == ()
    assert any(words in problem for problem in flight_problems(record)), flight_problems(record)


def test_what_the_tail_risks_next_is_recomputed(path: Path, rows: list[TickRow]) -> None:
    kept = 2 + next(i for i, row in enumerate(rows) if row.leg is None)
    forged(path, kept, lambda row: row.update(next_step=0.25))
    [problem] = flight_problems(load_flight(path))
    assert "states a risk of the next step of 0.25" in problem


def test_a_leg_that_could_not_be_afforded_is_found_out(path: Path, rows: list[TickRow]) -> None:
    def dive(row: dict[str, object]) -> None:
        row["leg"]["controls"][0][0][1] -= 0.1

    forged(path, _first_leg(rows), dive)
    problems = flight_problems(load_flight(path))
    assert any("not within the remaining risk: price must be at most" in p for p in problems)


def test_a_collision_that_is_kept_quiet_is_found_out(tmp_path: Path, plan: Plan) -> None:
    rows = next(
        r for r in (staked_rows(plan, s) for s in range(2, 100)) if any(t.contacts for t in r)
    )
    path = tmp_path / "hit.jsonl"
    written(path, plan, rows)
    assert flight_problems(load_flight(path)) == ()
    for line, row in enumerate(rows, start=2):
        if row.contacts:
            forged(path, line, lambda content: content.update({"contacts": []}))
    problems = flight_problems(load_flight(path))
    assert any("'wall': a contact that is hit, and not stated" in problem for problem in problems)


def test_a_file_of_another_kind_is_refused_with_line_and_field(path: Path) -> None:
    forged(path, 3, lambda row: row.update({"bank": "much"}))
    with pytest.raises(FileFormatError, match=r"jsonl:3: bank: must be a number, got 'much'"):
        load_flight(path)
    forged(path, 3, lambda row: row.update({"bank": 0.1, "states": [[1.0]]}))
    with pytest.raises(FileFormatError, match=r"jsonl:3: states\[0\]: must have 2 numbers, got 1"):
        load_flight(path)
    path.write_text("", encoding="utf-8")
    with pytest.raises(FileFormatError, match="is empty"):
        load_flight(path)


def test_a_flight_is_told_as_a_line(plan: Plan, rows: list[TickRow]) -> None:
    record = FlightRecord(plan, KEPT, tuple(rows))
    assert repr(record) == "FlightRecord('wall': 1 of 2 missions over, 11 ticks)"
    assert repr(record.missions[0]) == "FlownMission(0: 11 ticks, no collision)"


def test_what_a_file_has_no_row_for_is_refused(plan: Plan) -> None:
    mission = RecordedMission(plan, 0, lambda row: None, planner=None)
    with pytest.raises(radmpc.ArgumentError, match=r"keeps its risk bound of 0\.05, got 0\.1"):
        mission.set_risk_bound(0.1)
    with pytest.raises(radmpc.ArgumentError, match="keeps its account"):
        mission.start_again(plan)


def test_a_recorded_flight_is_the_flight_it_records(plan: Plan) -> None:
    record = begin_flight(plan, KEPT)
    for number, mission in enumerate(record.missions):
        rng = np.random.default_rng([KEPT.seed, number])
        flight = radmpc.fly(radmpc.Mission(plan, planner=None), radmpc.Model(plan.scenario, rng))
        assert told(tuple(row.states for row in mission.rows)) == told(flight.states)
        assert [row.bank for row in mission.rows] == [entry.bank for entry in flight.account[1:]]
    first, second = (told(mission.rows[1].states) for mission in record.missions)
    assert first != second


def test_a_flight_is_summed_up_by_hand(plan: Plan) -> None:
    summary = summary_of(begin_flight(plan, KEPT))
    assert summary.missions == summary.asked == 2
    assert summary.flown is not None
    # 0 of 2: what 0.025 = (1 - p)^2 says.
    assert (summary.flown.rate_low, summary.flown.rate) == (0.0, 0.0)
    assert summary.flown.rate_high == pytest.approx(1.0 - 0.025**0.5)
    assert summary.effort == summary.effort_planned == 100.0
    assert summary.miss == 0.0
    assert (summary.accepted, summary.adopted) == (0.0, 0)
    assert summary.certified == pytest.approx(plan.risk.certified)
    assert summary.ticks == 22
    assert summary.tick_p50 <= summary.tick_p99 <= summary.tick_max
    assert summary.late is None
    assert summary.contradiction is None


def test_a_rate_above_the_bound_is_called_one(plan: Plan, rows: list[TickRow]) -> None:
    hit = replace(rows[-1], contacts=(Touch(10, "obstacle", "v", "wall"),), excess=0.5)
    flown = [replace(row, mission=m) for m in range(4) for row in (*rows[:-1], hit)]
    summary = summary_of(FlightRecord(plan, FlightSettings(missions=4), tuple(flown)))
    assert summary.flown is not None
    assert (summary.flown.rate, summary.flown.obstacle_rate, summary.flown.pair_rate) == (1, 1, 0)
    assert summary.flown.saturation_rate == 1.0
    assert "collision rate is at least 0.3976" in str(summary.contradiction)


def test_decisions_that_miss_their_deadline_are_counted(plan: Plan, rows: list[TickRow]) -> None:
    timed = [replace(row, seconds=0.4 if row.step in {1, 4} else 0.1) for row in rows]
    summary = summary_of(FlightRecord(plan, FlightSettings(deadline=0.15), tuple(timed)))
    assert summary.late == 2


ODD = (None, True, "x", -1, 0, 7, 1e9, [], {}, [[]], [None], [[1.0, "x"]], {"x": 1})


def _refusal(path: Path) -> str | None:
    """Return why a flight cannot be read; judge one that can."""
    try:
        record = load_flight(path)
    except FileFormatError as error:
        return str(error)
    assert record.changed == ()
    flight_problems(record)
    if not shape_problems(record.plan):
        summary_of(record)
    return None


def _spoiled(path: Path, line: int, keys: list[str]) -> None:
    """Put one odd value after another where keys lead, and see that each is answered."""
    whole = path.read_bytes()
    *above, last = keys
    for odd in ODD:

        def change(content: dict[str, object], odd: object = odd) -> None:
            for key in above:
                content = content[key]
            content[last] = odd

        forged(path, line, change)
        refusal = _refusal(path)
        if refusal is not None:
            assert refusal.startswith(f"{path}:{line}: "), odd
            assert "\n" not in refusal
        path.write_bytes(whole)


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    ("line", "keys"),
    [
        *((1, key.split(".")) for key in (
            "format", "backend", "options", "replan", "missions", "seed", "deadline", "versions",
            "plan", "plan.scenario", "plan.vehicles", "plan.cost", "plan.risk", "plan.sets",
        )),
        *((2, key.split(".")) for key in (
            "mission", "step", "states", "contacts", "choice", "reason", "value", "wealth",
            "price", "next_step", "tail", "bank", "controls", "excess", "leg", "alarms",
            "seconds", "leg.risk_bound", "leg.starts", "leg.controls",
        )),
    ],
    ids=lambda value: ".".join(value) if isinstance(value, list) else "",
)  # fmt: skip
def test_whatever_stands_in_a_line_is_read_or_refused_with_its_place(
    path: Path, rows: list[TickRow], line: int, keys: list[str]
) -> None:
    _spoiled(path, line if line == 1 else _first_leg(rows), keys)


def test_a_step_at_which_some_were_measured_is_recomputed_and_gone_on_with(tmp_path: Path) -> None:
    result = radmpc.plan(paper(2, seed=1), rng=0)
    plan, rows, again = certified(result.require()), [], []
    mission = RecordedMission(plan, 0, rows.append, planner=None)
    for _ in range(4):
        off, *others = (x + 0.01 for x in mission._expected)
        mission.step([off, *(np.full_like(x, np.nan) for x in others)])
    assert {(row.states, row.partly[1]) for row in rows} == {(None, None)}
    path = tmp_path / "partly.flight.jsonl"
    written(path, plan, rows)
    record = load_flight(path)
    assert told(record.rows) == told(tuple(rows))
    assert flight_problems(record) == ()
    resumed = RecordedMission(plan, 0, again.append, record.rows, planner=None)
    for one in (mission, resumed):
        one.step([None, None])
    assert told(again[-1].controls) == told(rows[-1].controls)
    forged(path, 3, lambda row: row.update(partly=row["partly"][:1]))
    with pytest.raises(FileFormatError, match="partly: must be of 2 vehicles, got 1"):
        load_flight(path)
