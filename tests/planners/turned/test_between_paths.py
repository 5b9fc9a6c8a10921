"""Plans between certified paths and those that risk too much, and when turning ends by them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle, paper
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.around import Around
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned.paths import Paths, SavedPaths
from radmpc.planners.certified.turned.price_control import PriceControl, SafePaths, Taken
from radmpc.planners.certified.turned.turning import Turning
from radmpc.planners.outcome.record import Certifying
from radmpc.planners.presets import parse_planner
from radmpc.planners.verdict import Verdict
from radmpc.planning import plan
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

SCENARIO = circle(2)
HAZARDS = Hazards.of(SCENARIO, condensed_models(SCENARIO))
RISK_BOUND = 0.05


def half_way(share: float) -> tuple[np.ndarray, ...]:
    """Return controls of both vehicles, each so large."""
    return tuple(np.full(model.control_bounds.shape, share) for model in HAZARDS.models)


def risk_of(controls: tuple[np.ndarray, ...]) -> float:
    """Return a risk that grows as effort falls, convex in between."""
    return 0.02 + 0.06 * (1.0 - float(controls[0][0, 0])) ** 1.5


def turning(risk=risk_of) -> Turning:
    """Return a turning whose referee knows that risk."""
    judge = lambda controls: Verdict(risk(controls), ())  # noqa: E731 - a stub
    task = Task(HAZARDS, judge, Limits(), 1e-3, RISK_BOUND)
    incumbent = FleetIncumbent(half_way(1.0), 1e3, ((0,), (1,)), certified=0.02, turned_price=5.0)
    made = Turning(task, incumbent, ((0,), (1,)), 5.0)
    made.successive.begin(half_way(0.0))
    return made


def safe_paths() -> SafePaths:
    """Return certified paths of much effort."""
    paths = Paths(HAZARDS)
    for i, controls in enumerate(half_way(1.0)):
        paths.fly(i, controls)
    return SafePaths(paths.state(), 5.0, 0.02)


def test_a_plan_in_between_risks_at_most_the_bound_and_the_latest_paths_stay() -> None:
    made = turning()
    taken = made._take_between(safe_paths(), risk_of(half_way(0.0)))
    assert taken is not None
    assert 0.8 * RISK_BOUND < taken.certified <= RISK_BOUND
    share = made.incumbent.controls[0][0, 0]
    assert share == pytest.approx(1.0 - (0.9985 * RISK_BOUND - 0.02) / 0.06)
    assert made.incumbent.cost == pytest.approx(taken.cost)
    assert np.array_equal(made.successive.paths.controls[0], half_way(0.0)[0])


@pytest.mark.parametrize("why", ["never certified", "certified", "dearer"])
def test_nothing_is_looked_for_where_there_is_nothing_in_between(why: str) -> None:
    made = turning()
    if why == "dearer":
        made.incumbent = FleetIncumbent(half_way(0.0), 0.0, certified=0.02)
    safe = None if why == "never certified" else safe_paths()
    assert made._take_between(safe, 0.04 if why == "certified" else 0.08) is None


def test_what_is_not_certified_in_between_is_not_taken() -> None:
    made = turning(lambda controls: 0.07)
    before = made.incumbent
    assert made._take_between(safe_paths(), 0.08) is None
    assert made.incumbent is before


def of_effort(share: float) -> SavedPaths:
    """Return paths of both vehicles, each so large."""
    paths = Paths(HAZARDS)
    for i, controls in enumerate(half_way(share)):
        paths.fly(i, controls)
    return paths.state()


def first_turning(share: float) -> Turning:
    """Return a turning without a plan, whose risk is linear in its logarithm: 0.2 to 0.02."""
    made = turning(lambda controls: 0.2 * 0.1 ** float(controls[0][0, 0]))
    made.incumbent = FleetIncumbent()
    made.successive.begin(half_way(share))
    return made


def test_a_first_plan_that_leaves_risk_is_nearer_to_the_riskier_paths_before_it() -> None:
    made = first_turning(1.0)
    certified = made._take((of_effort(0.0), 0.2))
    assert certified == pytest.approx(0.02)
    assert made.incumbent.certified == pytest.approx(0.97 * RISK_BOUND)
    assert made.incumbent.cost < made.successive.paths.cost()
    # What follows goes on from the paths themselves.
    assert np.array_equal(made.successive.paths.controls[0], half_way(1.0)[0])


@pytest.mark.parametrize(
    ("share", "risk_before"), [(1.0, 0.03), (1.0, np.inf), (-np.log10(0.0475 / 0.2), 0.2)]
)
def test_a_first_plan_is_its_own_paths_where_those_before_risk_as_little_or_it_leaves_little(
    share: float, risk_before: float
) -> None:
    made = first_turning(share)
    certified = made._take((of_effort(0.0), risk_before))
    assert made.incumbent.certified == certified
    assert made.incumbent.cost == made.successive.paths.cost()


def test_a_first_plan_is_its_own_paths_where_nearer_ones_risk_too_much() -> None:
    made = first_turning(1.0)
    made.task = replace(
        made.task,
        judge=lambda controls: Verdict(0.02 if controls[0][0, 0] == 1.0 else 0.06, ()),
    )
    assert made._take((of_effort(0.0), 0.2)) == 0.02
    assert made.incumbent.certified == 0.02


def test_turning_ends_by_a_plan_in_between_once_paths_hardly_move() -> None:
    control = PriceControl(1.0, RISK_BOUND, 1e-3)
    paths = Paths(HAZARDS).state()
    control.begin(0.03, 10.0, paths)
    control.follow(0.045, 9.99, paths, 0.045)
    assert not control.is_over
    # What was gained is what the risk is worth: at a price of 1 for 0.006 of it.
    control.price = 1.0
    assert control.has_nearly_stopped(0.051, 9.984, 0.051)
    control.follow(0.051, 9.984, paths, 0.051, Taken(0.0499, 9.985))
    assert control.is_over


def test_turning_goes_on_past_a_plan_in_between_while_paths_move() -> None:
    control = PriceControl(1.0, RISK_BOUND, 1e-3)
    paths = Paths(HAZARDS).state()
    control.begin(0.03, 10.0, paths)
    control.follow(0.045, 9.9, paths, 0.045)
    control.price = 1.0
    assert not control.has_nearly_stopped(0.051, 9.5, 0.051)
    control.follow(0.051, 9.5, paths, 0.051, Taken(0.0499, 9.55))
    assert not control.is_over


def test_paths_that_are_dearer_than_another_plan_though_they_risk_too_much_are_left() -> None:
    paths = Paths(HAZARDS).state()
    for rival, is_left in ((9.0, True), (9.9, False)):
        control = PriceControl(1.0, RISK_BOUND, 1e-3, rival)
        control.begin(0.03, 12.0, paths)
        for cost in (11.0, 10.1, 10.0):
            assert not control.is_over
            control.follow(0.06, cost, paths, 0.06)
        assert control.is_over == is_left


@pytest.mark.parametrize(("certified", "is_left"), [(0.06, True), (0.04, False)])
def test_a_large_fleet_is_left_after_two_rounds_dearer_than_another_plan_and_above_the_bound(
    certified: float, *, is_left: bool
) -> None:
    paths = Paths(HAZARDS).state()
    for is_large in (True, False):
        control = PriceControl(1.0, RISK_BOUND, 1e-3, 9.9, is_large=is_large)
        control.begin(float("inf"), 12.0, paths)
        # Each moves so much that there may be more to gain.
        for cost in (11.0, 10.0):
            assert not control.is_over
            control.follow(certified, cost, paths, certified)
        assert control.is_over == (is_large and is_left)


def test_a_round_that_is_cheaper_than_the_last_is_no_stall() -> None:
    control = PriceControl(1.0, RISK_BOUND, 1e-3)
    paths = Paths(HAZARDS).state()
    control.begin(0.045, 10.0, paths)
    # Above what it began with, but falling: as on the way to other sides.
    for cost in (11.0, 10.8, 10.6, 10.4):
        control.follow(0.045, cost, paths, 0.045)
    assert control.num_stalls == 0


def test_a_turned_price_is_what_programs_were_solved_at_per_certified_risk(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scenario = paper(3, 0)
    fleet = Fleet.of(scenario, 1e-3, Limits())
    hazards, judge = fleet.programs.hazards, Certifying(scenario, parse_planner("certified"))
    task = Task(hazards, judge.verdict, Limits(), 1e-3, scenario.risk_bound)
    everyone = tuple((i,) for i in range(3))
    made = Turning(task, FleetIncumbent(), everyone, 300.0)
    prices, share_risk = [], made.successive.share_risk

    def noted(group: tuple[int, ...], price: float, spacing: float) -> float:
        prices.append(price)
        return share_risk(group, price, spacing)

    monkeypatch.setattr(made.successive, "share_risk", noted)
    assert made.successive.begin_alone()
    assert made.successive.keep_apart(3.5, 20)
    found = made.run(4)
    assert found.controls
    assert found.risk_ratio > 0.9
    assert 0.0 < found.turned_price / found.risk_ratio < 300.0
    assert found.turned_price / found.risk_ratio in [pytest.approx(price) for price in prices]


def test_a_price_aims_lower_while_the_first_certificate_ends_the_rounds() -> None:
    brief, usual = (
        PriceControl(1.0, RISK_BOUND, 1e-3, is_brief=is_brief) for is_brief in (True, False)
    )
    paths = Paths(HAZARDS).state()
    for control in (brief, usual):
        control.follow(0.055, 10.0, paths)
    assert brief.price > usual.price
    for control in (brief, usual):
        control.price = 1.0
        control.follow(0.04, 10.1, paths)
        control.price = 1.0
        control.follow(0.055, 10.0, paths)
    assert brief.price == usual.price


def test_turning_that_is_to_be_brief_ends_at_the_first_plan_that_spends_enough() -> None:
    scenario = paper(3, 0)
    fleet = Fleet.of(scenario, 1e-3, Limits())
    judge = Certifying(scenario, parse_planner("certified"))
    risk_bound, everyone = scenario.risk_bound, tuple((i,) for i in range(3))
    task = Task(fleet.programs.hazards, judge.verdict, Limits(), 1e-3, risk_bound)
    rounds = {}
    for enough in (0.3 * risk_bound, np.inf):
        made = Turning(task, FleetIncumbent(), everyone, 300.0, enough=enough)
        assert made.successive.begin_alone()
        assert made.successive.keep_apart(2.5, 20)
        found = made.run(30)
        rounds[enough] = made.num_solves
        assert found.certified >= 0.3 * risk_bound
    assert 0 < rounds[0.3 * risk_bound] < rounds[np.inf]


def test_a_plan_that_leaves_risk_is_turned_once_more_before_its_faces_are_bounded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    turned = []
    turn_on = Around.turn_on

    def noted(around: Around) -> bool:
        before = around.state.incumbent
        gains = turn_on(around)
        turned.append((before, around.state.incumbent))
        return gains

    monkeypatch.setattr(Around, "turn_on", noted)
    scenario = paper(4, 0)
    result = plan(scenario, "certified", rng=0)
    assert result.is_certified
    left = [now.turned_price * (scenario.risk_bound - now.certified) for _, now in turned[-1:]]
    assert left
    assert left[0] <= 1e-3 * result.cost
    assert all(now.cost <= before.cost for before, now in turned)


def test_sweeps_end_as_soon_as_nobody_misses_anything_where_all_are_turned_together() -> None:
    swept = {}
    for is_shared in (True, False):
        made = turning()
        assert made.successive.begin_alone()
        assert made.successive.keep_apart(2.5, 20, is_shared=is_shared)
        assert made.successive.missed.sum() <= 1e-7
        swept[is_shared] = made.successive.paths.cost()
    assert swept[False] <= swept[True] * (1.0 + 1e-9)
