from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from scipy.stats import binomtest

import closed_loop
import closed_loop_ticks as ticks
from closed_loop import fly_all, interval, known, row, write
from closed_loops.adversary import waiting, wall
from closed_loops.rules import Pool as RiskPool
from closed_loops.rules import Trial, flown, rule_of
from radmpc.flying.account import Account

TRIAL = Trial("plus", "warm", 3, False, 10.0, 0.1, 2, 0, [1.0, 3.0])

DECISION = ticks.Row(0, 0, "candidate", "better", 0.01)


def test_missions_come_back_from_a_record_scene_by_scene(tmp_path: Path) -> None:
    record = tmp_path / "m.jsonl"
    write(record, "slalom", TRIAL)
    write(record, "paper", replace(TRIAL, seed=4))
    assert known(record, "slalom") == [TRIAL]
    assert known(record, "paper") == [replace(TRIAL, seed=4)]
    assert known(tmp_path / "none.jsonl", "slalom") == []


def test_a_line_that_was_cut_costs_that_mission_alone(tmp_path: Path) -> None:
    record = tmp_path / "m.jsonl"
    write(record, "slalom", TRIAL)
    record.write_text(record.read_text() + '{"scene": "slalom", "ru')
    write(record, "slalom", replace(TRIAL, seed=4))
    assert [trial.seed for trial in known(record, "slalom")] == [3, 4]


def test_rates_have_the_interval_of_clopper_and_pearson() -> None:
    for hits, count in ((0, 20), (6, 126), (5, 5)):
        exact = binomtest(hits, count).proportion_ci(method="exact")
        assert interval(hits, count) == pytest.approx((exact.low, exact.high), abs=1e-9)


def test_a_row_tells_rates_means_and_quantiles() -> None:
    cells = row("plus", [TRIAL, replace(TRIAL, has_collided=True, effort=12.0, ticks=[5.0, 7.0])])
    assert cells[:2] == ["plus", "2"]
    assert cells[2].startswith("0.5000 [")
    assert cells[3:5] == ["11.00", "0.100"]
    assert cells[5] == "1.00"
    assert cells[7].startswith("4.0 / ")


@pytest.mark.slow
def test_the_same_noise_is_the_same_mission_and_granting_anew_risks_more() -> None:
    first = waiting(wall())
    right, again, wrong = (flown(first, rule, "staking", 0) for rule in ("plus", "plus", "anew"))
    assert replace(right, ticks=[]) == replace(again, ticks=[])
    assert not right.has_collided
    assert wrong.adopted > right.adopted == 1


def test_a_wrong_rule_is_kept_for_a_while_only() -> None:
    account = Account.opened(0.1, 0.02).kept(0.0)
    with rule_of("anew", RiskPool(0.1)):
        assert account.wealth == 0.1
    assert account.wealth == pytest.approx(0.08)


@pytest.mark.slow
def test_what_was_flown_is_not_flown_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[closed_loop.Key] = []

    def counting(plan, keys, jobs):
        asked.extend(keys)
        yield from fly_all(plan, keys, jobs)

    record = tmp_path / "m.jsonl"
    monkeypatch.setattr(closed_loop, "fly_all", counting)
    words = ["x", "--scenes", "wall", "--rules", "kept", "--record", str(record), "--missions"]
    for missions in ("1", "2"):
        monkeypatch.setattr("sys.argv", [*words, missions])
        closed_loop.main()
    assert asked == [("kept", "staking", 0), ("kept", "staking", 1)]
    assert "wall: Δ = 0.1" in capsys.readouterr().out


def test_every_miss_is_counted_and_whether_the_tail_was_flown() -> None:
    late = replace(DECISION, choice="tail", reason=ticks.LATE, seconds=0.3)
    rows = [DECISION, late, replace(DECISION, seconds=0.2), replace(DECISION, step=3)]
    told = list(ticks.answers(rows, 0.15))
    assert told[0] == "ticks 4, within 150 ms: 0.50000"
    assert told[1] == "misses 2, of which not the tail: 1"
    assert told[2] == "given up as too late: 1"


def test_ticks_of_a_mission_that_was_cut_are_flown_again(tmp_path: Path) -> None:
    record = tmp_path / "t.jsonl"
    rows = [replace(DECISION, step=0), replace(DECISION, step=1), replace(DECISION, mission=1)]
    lines = [json.dumps({"mission": r.mission, "step": r.step, "choice": r.choice,
                         "reason": r.reason, "seconds": r.seconds}) for r in rows]  # fmt: skip
    record.write_text("\n".join([*lines, '{"mission": 2, "st']))
    assert ticks.known(record, 2) == rows[:2]


def test_a_decision_beyond_its_deadline_flies_the_tail() -> None:
    rows = ticks.rows_of(waiting(wall()), 0, 0.0, "processor")
    assert {row.choice for row in rows} == {"tail"}
    assert min(row.seconds for row in rows) > 0.0
