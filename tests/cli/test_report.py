"""What a report says about plans."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.console.output import show
from radmpc.console.reports.report import ledger_table, plan_report, vehicle_table, verdict
from radmpc.experiments.families import circle
from radmpc.model.plan import Coupling, LedgerRow, Plan, Risk, Status, Trajectory
from radmpc.model.scenario import Scenario


def standing(scenario: Scenario) -> tuple[Trajectory, ...]:
    """Vehicles that stay where they start."""
    steps = scenario.horizon + 1
    return tuple(
        Trajectory(
            v.name, np.zeros((steps - 1, 2)), np.tile(v.start, (steps, 1)), v.covariances(steps - 1)
        )
        for v in scenario.vehicles
    )


def make_plan(**changes: object) -> Plan:
    """A plan of nothing, to report on."""
    fields: dict[str, object] = {
        "scenario": circle(3),
        "planner": "ira",
        "seed": 0,
        "status": Status.OPTIMAL,
        "cost": 10.0,
        "lower_bound": 9.9,
        "risk": Risk(0.05, 0.01),
        "sets": (("v1",), ("v2", "v3")),
        "seconds": {"radmpc": 0.5, "total": 1.0},
        "trajectories": standing(circle(3)),
    }
    return Plan(**(fields | changes))  # type: ignore[arg-type]


def shown(capsys: pytest.CaptureFixture[str], plan: Plan) -> str:
    """The report as plain text."""
    show(*plan_report(plan))
    return capsys.readouterr().out


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
    assert shown(capsys, make_plan(**nothing)).count("before any plan was found") == 1
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


@pytest.mark.parametrize(
    ("price", "text"),
    [
        (2.0, "1 % more would save about 0.001, 0.01 % of the cost"),
        (0.0, "none: more of it would save nothing"),
    ],
)
def test_the_report_says_what_more_risk_would_save(
    capsys: pytest.CaptureFixture[str], price: float, text: str
) -> None:
    assert text in shown(capsys, make_plan(risk=Risk(0.05, 0.042, (), price)))


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({}, "only the planner 'certified' looks for it"),
        ({"risk": Risk(0.05, 0.0)}, "the plan runs no risk"),
        ({"lower_bound": None}, "the search ended before it had proven anything"),
        ({"risk": Risk(0.05, 0.049)}, "the search ended before it had proven anything"),
        ({"risk": Risk(0.05, 0.01)}, "the union bounds that the search counts by are used up"),
    ],
)
def test_a_plan_without_a_shadow_price_says_why(
    capsys: pytest.CaptureFixture[str], changes: dict[str, object], why: str
) -> None:
    planner = "optimal, branch, certified" if changes else "ira"
    text = shown(capsys, make_plan(planner=planner, **changes))
    assert f"shadow price      not computed: {why}" in text


def test_a_planner_that_bounds_no_risk_has_no_line_for_its_price(
    capsys: pytest.CaptureFixture[str],
) -> None:
    show(*plan_report(make_plan(), "milp", bounds_risk=False))
    assert "shadow price" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("coupling", "told"),
    [
        (
            Coupling("v1", "v2", "collision", 3.0),
            "v1 and v2 would almost surely collide if planned apart",
        ),
        (Coupling("v1", "v2", "risk", 2e-4), "v1 and v2 run a risk of 0.0002 in the approximation"),
        (Coupling("v1", "v2", "blocked"), "v1 and v2 block each other in the approximation"),
        (Coupling("v1", "v2", "distance", 1.5), "v1 and v2 come within 1.5 m if planned apart"),
        (Coupling("v1", "v2", "share"), "v1 and v2 need more than their shares of the risk bound"),
    ],
)
def test_the_report_says_why_vehicles_were_planned_together(
    capsys: pytest.CaptureFixture[str], coupling: Coupling, told: str
) -> None:
    assert f"because           {told}\n" in shown(capsys, make_plan(couplings=(coupling,)))


def test_of_many_reasons_the_strongest_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    couplings = tuple(Coupling("v1", f"w{i}", "collision", 0.1 * i) for i in range(1, 8))
    text = " ".join(shown(capsys, make_plan(couplings=couplings)).split())
    assert "v1 and w7 would run a risk of 0.7 if planned apart; v1 and w6" in text
    assert "and 3 more couplings" in text


def test_pairs_that_would_surely_collide_share_a_sentence(
    capsys: pytest.CaptureFixture[str],
) -> None:
    sure = tuple(Coupling("v1", f"w{i}", "collision", 1.0 + i) for i in range(1, 7))
    rest = (Coupling("v2", "v3", "collision", 0.03),)
    text = shown(capsys, make_plan(couplings=(*rest, *sure[:2])))
    apart = "would almost surely collide if planned apart"
    assert f"because           v1 and w2, v1 and w1 {apart}; v2 and v3 would run" in text
    assert f"v1 and w3, 2 more pairs {apart}\n" in shown(capsys, make_plan(couplings=sure))


def test_a_bound_that_is_exceeded_limited_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert "limited by" not in shown(capsys, make_plan(risk=Risk(0.05, 0.9)))


def test_the_report_says_which_limits_are_used_up(capsys: pytest.CaptureFixture[str]) -> None:
    still = standing(circle(3))
    controls = still[0].controls.copy()
    controls[:2] = circle(3).vehicles[0].control_limit
    pushed = (replace(still[0], controls=controls), *still[1:])
    told = shown(capsys, make_plan(trajectories=pushed, risk=Risk(0.05, 0.0495)))
    assert "the risk bound (99 % of it spent), control limit of v1 (2 steps)" in " ".join(
        told.split()
    )
    assert "limited by" not in shown(capsys, make_plan())


def test_one_thing_more_is_no_several(capsys: pytest.CaptureFixture[str]) -> None:
    still = standing(circle(5))
    pushed = tuple(
        replace(t, controls=np.tile(v.control_limit, (len(t.controls), 1)))
        for t, v in zip(still, circle(5).vehicles, strict=True)
    )
    couplings = tuple(Coupling("v1", f"v{i}", "distance", 1.0) for i in range(2, 7))
    plan = make_plan(scenario=circle(5), trajectories=pushed, couplings=couplings)
    text = shown(capsys, plan)
    assert ", 1 more limit\n" in text
    assert "; and 1 more coupling\n" in text


def test_a_cost_below_its_lower_bound_comes_with_the_reason(
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = shown(capsys, make_plan(cost=9.5))
    assert "9.5 (below 9.9, the least of plans whose union bound is within the risk bound" in text
    assert ", gap" not in text


@pytest.mark.parametrize(
    ("price", "status", "told"),
    [
        (0.0, Status.FEASIBLE, "80 % of the bound: spending it would not make the plan cheaper"),
        (None, Status.OPTIMAL, "80 % of the bound: the planner counts by union bounds"),
    ],
)
def test_an_optimal_plan_that_leaves_risk_over_says_why(
    capsys: pytest.CaptureFixture[str], price: float | None, status: Status, told: str
) -> None:
    plan = make_plan(risk=Risk(0.05, 0.01, (), price), status=status)
    assert f"risk left over    {told}" in shown(capsys, plan)


def test_nothing_is_said_of_risk_left_over_where_nothing_is_proven_or_little_is_left(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for risk, status in (
        (Risk(0.05, 0.01), Status.FEASIBLE),
        (Risk(0.05, 0.049), Status.OPTIMAL),
        (Risk(0.05, 0.01, (), 3.0), Status.OPTIMAL),
    ):
        assert "risk left over" not in shown(capsys, make_plan(risk=risk, status=status))
    show(*plan_report(make_plan(), bounds_risk=False))
    assert "risk left over" not in capsys.readouterr().out


def test_a_planner_that_bounds_no_risk_is_named_where_the_bound_is_exceeded(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for certified, is_told in ((0.9, True), (0.04, False)):
        show(*plan_report(make_plan(risk=Risk(0.05, certified)), "milp", bounds_risk=False))
        text = capsys.readouterr().out
        assert ("milp does not bound the risk" in text) is is_told
        assert ("--planner certified keeps to the bound" in text) is is_told


def test_a_limit_that_ended_the_search_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    limit = "the time limit of 2 s was reached"
    text = shown(capsys, make_plan(status=Status.FEASIBLE, stopped_by=limit))
    assert f"feasible: plan found, but {limit} before a proof that it is the best" in text
    nothing = {"trajectories": (), "risk": Risk(0.05), "cost": None, "stopped_by": limit}
    text = shown(capsys, make_plan(status=Status.LIMIT, **nothing))
    assert f"limit: ended before any plan was found: {limit}\n" in text


def test_noise_that_an_import_added_is_repeated_on_one_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    source = {"choices": {"noise": "deviation\n 0.05 m"}}
    plan = make_plan(scenario=replace(circle(3), source=source))
    told = "noise             added by the import, the problem states none: deviation 0.05 m\n"
    assert told in shown(capsys, plan)
    for other in ({"choices": {"noise": 3}}, {"choices": 3}, {}, None):
        plan = make_plan(scenario=replace(circle(3), source=other))
        assert "added by the import" not in shown(capsys, plan)


def test_a_report_tells_both_lower_bounds_and_how_much_any_plan_could_save(
    capsys: pytest.CaptureFixture[str],
) -> None:
    said = " ".join(shown(capsys, make_plan(certified_lower_bound=9.5)).split())
    assert "optimal: plan found; no plan that could be certified costs 5 % less" in said
    bounds = "9.5 for any certified plan, gap 5 %; 9.9 for plans by faces, gap 1 %"
    assert f"10 (lower bounds: {bounds})" in said
    alone = " ".join(shown(capsys, make_plan(certified_lower_bound=9.5, lower_bound=None)).split())
    assert "10 (lower bound 9.5 for any certified plan, gap 5 %)" in alone
