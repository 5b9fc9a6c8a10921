"""What a report says of reasons: prices, couplings, limits, what is left over."""

from __future__ import annotations

from dataclasses import replace

import pytest

from radmpc.console.output import show
from radmpc.console.reports.report import plan_report
from radmpc.experiments.families import circle
from radmpc.model.plan import Coupling, Risk, Status, Trajectory

from .reported import make_plan, shown, standing


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
        (
            {"risk": Risk(0.05, 0.01), "status": Status.FEASIBLE},
            "the search ended before it was known whether using more would save anything",
        ),
    ],
)
def test_a_plan_without_a_shadow_price_says_why(
    capsys: pytest.CaptureFixture[str], changes: dict[str, object], why: str
) -> None:
    planner = "optimal, branch, certified" if changes else "ira"
    text = shown(capsys, make_plan(planner=planner, **changes))
    assert f"shadow price      not computed: {why}" in text


def test_a_planner_with_another_gap_has_no_other_reason_to_lack_a_price(
    capsys: pytest.CaptureFixture[str],
) -> None:
    planner = "optimal, branch, certified(3), gap=0.01"
    text = shown(capsys, make_plan(planner=planner, risk=Risk(0.05, 0.0)))
    assert "shadow price      not computed: the plan runs no risk" in text


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


def test_sets_that_were_planned_together_from_the_start_say_so(
    capsys: pytest.CaptureFixture[str],
) -> None:
    why = "from the start: no risk of planning them apart was estimated"
    assert f"because           planned together {why}" in shown(capsys, make_plan())
    mixed = make_plan(
        sets=(("v1", "v4"), ("v2", "v3")), couplings=(Coupling("v1", "v4", "collision", 0.2),)
    )
    told = f"v1 and v4 would run a risk of 0.2 if planned apart; {{v2, v3}} planned together {why}"
    assert told in " ".join(shown(capsys, mixed).split())
    alone = make_plan(sets=(("v1",), ("v2",), ("v3",)))
    assert "because" not in shown(capsys, alone)


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
    assert f"v1 and w3, 2 more pairs {apart}\n" in shown(
        capsys, make_plan(couplings=sure, sets=(("v1", *(c.other for c in sure)),))
    )


def test_a_bound_that_is_exceeded_limited_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert "limited by" not in shown(capsys, make_plan(risk=Risk(0.05, 0.9)))


def test_the_report_says_which_limits_are_used_up(capsys: pytest.CaptureFixture[str]) -> None:
    still = standing(circle(3))
    controls = still[0].controls.copy()
    controls[:2] = circle(3).vehicles[0].control_limit
    pushed = (replace(still[0], controls=controls), *still[1:])
    told = shown(capsys, make_plan(trajectories=pushed, risk=Risk(0.05, 0.0495)))
    assert "the risk bound (99 % of it used), control limit of v1 (2 steps)" in " ".join(
        told.split()
    )
    assert "limited by" not in shown(capsys, make_plan())


def limits_told(capsys: pytest.CaptureFixture[str], *steps: int) -> str:
    """Return the report on vehicles of which each is at its limit for so many steps."""
    scene = circle(6)

    def pushed(trajectory: Trajectory, number: int) -> Trajectory:
        controls = trajectory.controls.copy()
        controls[:number] = scene.vehicles[0].control_limit
        return replace(trajectory, controls=controls)

    padded = (*steps, *[0] * (6 - len(steps)))
    moved = tuple(pushed(t, n) for t, n in zip(standing(scene), padded, strict=True))
    return " ".join(shown(capsys, make_plan(scenario=scene, trajectories=moved)).split())


def test_vehicles_at_one_limit_for_as_long_share_a_place(
    capsys: pytest.CaptureFixture[str],
) -> None:
    told = limits_told(capsys, 2, 1, 2)
    assert "limited by control limits of v1, v3 (2 steps each), control limit of v2" in told
    told = limits_told(capsys, 2, 2, 2, 2, 2)
    assert "control limits of v1, v2, v3, v4 and 1 more (2 steps each) " in told


def test_one_thing_more_is_no_several(capsys: pytest.CaptureFixture[str]) -> None:
    assert ", 1 more limit " in limits_told(capsys, 5, 4, 3, 2, 1)
    couplings = tuple(Coupling("v1", f"v{i}", "distance", 1.0) for i in range(2, 7))
    assert "; and 1 more coupling\n" in shown(capsys, make_plan(couplings=couplings))


def test_a_cost_below_its_lower_bound_comes_with_the_reason(
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = shown(capsys, make_plan(cost=9.5))
    assert "9.5 (below 9.9, the least of plans whose union bound is within the risk bound" in text
    assert ", gap" not in text


@pytest.mark.parametrize(
    ("price", "status", "told"),
    [
        (0.0, Status.FEASIBLE, "80 % of the bound: using it would not make the plan cheaper"),
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
    found = "optimal: plan found, optimal among plans by faces"
    assert f"{found}; no plan that could be certified costs 5 % less" in said
    bounds = "9.5 for any certified plan, gap 5 %; 9.9 for plans by faces, gap 1 %"
    assert f"10 (lower bounds: {bounds})" in said
    rounded = " ".join(shown(capsys, make_plan(certified_lower_bound=10 - 1e-11)).split())
    assert "no plan that could be certified costs less" in rounded
    alone = " ".join(shown(capsys, make_plan(certified_lower_bound=9.5, lower_bound=None)).split())
    assert "10 (lower bound 9.5 for any certified plan, gap 5 %)" in alone
