"""What a report says about plans."""

from __future__ import annotations

import pytest

from radmpc.console.output import show
from radmpc.console.reports.report import ledger_table, plan_report, vehicle_table, verdict
from radmpc.console.reports.saturating import saturation_line
from radmpc.experiments.families import circle
from radmpc.model.plan import LedgerRow, Risk, Status

from .reported import make_plan, shown


def test_a_gap_is_reported_where_there_is_a_bound(capsys: pytest.CaptureFixture[str]) -> None:
    assert "10 (lower bound 9.9, gap 1 %)" in shown(capsys, make_plan())
    assert "10 (no lower bound)" in shown(capsys, make_plan(lower_bound=None))


def test_a_plan_that_costs_nothing_has_no_gap(capsys: pytest.CaptureFixture[str]) -> None:
    assert "gap 0 %" in shown(capsys, make_plan(cost=0.0, lower_bound=0.0))


def test_the_largest_sets_come_first_and_many_are_counted(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert "{v2, v3}, {v1}" in shown(capsys, make_plan())
    many = tuple((f"v{i}",) for i in range(15))
    assert "and 3 more sets" in shown(capsys, make_plan(sets=many))


def test_stages_are_timed(capsys: pytest.CaptureFixture[str]) -> None:
    assert "1.00 (radmpc 0.50)" in shown(capsys, make_plan())
    assert "seconds           1.00\n" in shown(capsys, make_plan(seconds={"total": 1.0}))


def test_the_verdict_is_plain() -> None:
    assert verdict(0.01, 0.05).plain == "risk at most 0.01, within the bound 0.05"
    assert "EXCEEDS the bound 0.05" in verdict(0.0500001, 0.05).plain
    assert verdict(None, 0.05).plain == "none"


def test_the_ledger_shows_its_top_the_rest_and_what_is_left(
    capsys: pytest.CaptureFixture[str],
) -> None:
    rows = tuple(LedgerRow("pair", "v1", "v2", k, 0.001 * k) for k in range(1, 7)) * 2
    show(ledger_table(make_plan(risk=Risk(0.05, 0.042, rows))))
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split() == ["pair", "v1", "v2", "6", "6.00e-03", "12.0", "%"]
    assert lines[-2].split()[:2] == ["4", "more"]
    assert lines[-1].split() == ["left", "over", "8.00e-03", "16.0", "%"]


def test_nothing_is_left_of_a_spent_bound(capsys: pytest.CaptureFixture[str]) -> None:
    rows = (LedgerRow("workspace", "v1", None, 1, 0.06),)
    show(ledger_table(make_plan(risk=Risk(0.05, 0.06, rows))))
    assert "left over" not in capsys.readouterr().out


def test_a_sum_above_one_is_not_called_a_probability() -> None:
    text = verdict(4.0, 0.05).plain
    assert text.startswith("risk at most 1 (the bounds sum to 4), which EXCEEDS the bound 0.05")


def test_vehicles_bear_half_of_their_pairs_the_largest_first(
    capsys: pytest.CaptureFixture[str],
) -> None:
    rows = (
        LedgerRow("pair", "v1", "v3", 2, 0.01),
        LedgerRow("pair", "v1", "v3", 3, 0.01),
        LedgerRow("obstacle", "v3", "reef", 3, 0.005),
    )
    show(vehicle_table(make_plan(risk=Risk(0.05, 0.025, rows))))
    lines = [line.split() for line in capsys.readouterr().out.splitlines()[1:]]
    assert lines == [
        ["v3", "1.00e-02", "5.00e-03", "0.00e+00", "1.50e-02", "30.0", "%"],
        ["v1", "1.00e-02", "0.00e+00", "0.00e+00", "1.00e-02", "20.0", "%"],
        ["1", "more", "0.00e+00", "0", "%"],
    ]


def test_lines_too_small_to_matter_are_summed_up(capsys: pytest.CaptureFixture[str]) -> None:
    rows = (
        LedgerRow("pair", "v1", "v2", 2, 0.01),
        LedgerRow("pair", "v1", "v3", 2, 4e-11),
        LedgerRow("obstacle", "v3", "reef", 3, 2e-11),
    )
    show(ledger_table(make_plan(risk=Risk(0.05, 0.01, rows))))
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:2] for line in lines[1:]] == [
        ["pair", "v1"],
        ["2", "more"],
        ["left", "over"],
    ]
    assert lines[2].split()[2:] == ["6.00e-11", "<", "0.1", "%"]


@pytest.mark.parametrize(
    ("risk", "share"),
    [
        (0.0009245, "1.85 %"),
        (0.0059999, "12.0 %"),
        (0.05, "100 %"),
        (0.9, "1800 %"),
        (0.00005, "0.100 %"),
        (0.0000499, "< 0.1 %"),
    ],
)
def test_shares_of_the_bound_have_three_digits(
    capsys: pytest.CaptureFixture[str], risk: float, share: str
) -> None:
    show(ledger_table(make_plan(risk=Risk(0.05, risk, (LedgerRow("pair", "v1", "v2", 1, risk),)))))
    assert capsys.readouterr().out.splitlines()[1].endswith(f" {share}")


def test_vehicles_planned_apart_that_may_meet_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    rows = (LedgerRow("pair", "v1", "v2", 1, 0.5), LedgerRow("obstacle", "v3", "reef", 1, 0.1))
    text = shown(capsys, make_plan(risk=Risk(0.05, 0.6, rows)))
    assert "v1 and v2 were planned apart but may meet" in text
    assert "seed" not in text.replace("seeds", "")  # another one may do no better
    together = make_plan(risk=Risk(0.05, 0.6, rows), sets=(("v1", "v2"), ("v3",)))
    assert "planned apart" not in shown(capsys, together)
    assert "planned apart" not in shown(capsys, make_plan(risk=Risk(0.7, 0.6, rows)))
    assert "planned apart" not in shown(capsys, make_plan(risk=Risk(0.05, 0.6, rows[1:])))


def test_the_preset_and_the_events_are_reported(capsys: pytest.CaptureFixture[str]) -> None:
    show(*plan_report(make_plan(), "mine(3)", 2))
    lines = capsys.readouterr().out.splitlines()
    assert "planner           mine(3): ira" in lines
    assert "events            2 subproblems of RADMPC had no solution" in lines


def test_a_reason_that_is_the_status_is_said_once(capsys: pytest.CaptureFixture[str]) -> None:
    nothing = {"status": Status.LIMIT, "trajectories": (), "risk": Risk(0.05), "cost": None}
    assert shown(capsys, make_plan(**nothing)).count("without a plan") == 1
    explained = shown(capsys, make_plan(**nothing, explanation="v1 is stuck."))
    assert "no plan  v1 is stuck." in explained


def test_many_vehicles_are_summed_at_the_end(capsys: pytest.CaptureFixture[str]) -> None:
    rows = tuple(LedgerRow("workspace", f"v{i}", None, 0, 0.001) for i in range(1, 11))
    show(vehicle_table(make_plan(scenario=circle(10), risk=Risk(0.05, 0.01, rows))))
    assert capsys.readouterr().out.splitlines()[-1].split() == [
        "2",
        "more",
        "2.00e-03",
        "4.00",
        "%",
    ]


def test_saturation_is_called_none_only_where_nothing_feeds_back() -> None:
    assert saturation_line(0.0, feeds_back=False) == "none: no control can reach its limit"
    for rounded in (0.0, 2.86e-189, 9e-16):
        assert saturation_line(rounded, 0.0) == "at most 1e-15, simulated 0"
    assert saturation_line(2.861e-9) == "at most 2.86e-09"
