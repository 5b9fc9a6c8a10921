"""Plans that state too small a saturation, or couplings that cannot be, are caught."""

from dataclasses import replace

import numpy as np
import pytest
from referee_scenes import glider, straight_plan

from radmpc.model.plan import Coupling, FirstPlan, Risk, Status
from radmpc.model.scenario import Scenario
from radmpc.planners.planner import Planner
from radmpc.planners.presets import parse_planner
from radmpc.referee import certify

GAIN = np.array([[-0.3, 0.0, -0.9, 0.0], [0.0, -0.3, 0.0, -0.9]])


@pytest.fixture(scope="module")
def plan():
    """A sound plan, whose feedback is cut off now and then."""
    vehicles = (
        replace(
            glider("ann", [0, 0], [8, 0], gain=GAIN),
            control_limit=np.full(2, 0.6),
            control_sigmas=0.0,
        ),
        glider("bob", [0, 6], [8, 6]),
    )
    return straight_plan(Scenario("statements", 1.0, 10, 0.05, vehicles))


def stating(plan, saturation):
    return replace(plan, risk=replace(plan.risk, saturation=saturation))


@pytest.mark.parametrize("share", [0.0, 1e-9, 0.5, 1.0 - 1e-5])
def test_a_stated_saturation_that_is_too_low_is_caught(plan, share):
    true = certify(plan).saturation
    assert 0.0 < true < 1.0
    certificate = certify(stating(plan, share * true))
    assert not certificate.holds
    assert certificate.problems == (
        f"plan: states a saturation of {share * true:.9g}, the referee finds {true:.9g}",
    )


@pytest.mark.parametrize("share", [1.0 - 1e-7, 1.0, 2.0])
def test_a_stated_saturation_that_is_an_upper_bound_holds(plan, share):
    true = certify(plan).saturation
    assert certify(stating(plan, share * true)).holds
    assert certify(stating(plan, None)).holds


@pytest.mark.parametrize(
    ("coupling", "what"),
    [
        (
            Coupling("eve", "bob", "collision", 0.5),
            "a coupling of reason 'collision' names vehicle 'eve', who is not in the scenario",
        ),
        (
            Coupling("ann", "eve", "share"),
            "a coupling of reason 'share' names vehicle 'eve', who is not in the scenario",
        ),
        (
            Coupling("ann", "ann", "blocked"),
            "a coupling of reason 'blocked' names vehicle 'ann' twice",
        ),
        (
            Coupling("ann", "bob", "risk", 1.5),
            "the coupling of 'ann' and 'bob' of reason 'risk' has a value of 1.5, "
            "allowed is a number from 0 to 1",
        ),
        (
            Coupling("ann", "bob", "blocked", 0.5),
            "the coupling of 'ann' and 'bob' of reason 'blocked' has a value of 0.5, "
            "allowed is none",
        ),
        (
            Coupling("ann", "bob", "range", None),
            "the coupling of 'ann' and 'bob' of reason 'range' has a value of none, "
            "allowed is a number of at least 0",
        ),
    ],
)
def test_a_coupling_that_cannot_be_is_caught(plan, coupling, what):
    certificate = certify(replace(plan, couplings=(coupling, coupling)))
    assert not certificate.holds
    assert certificate.problems == (f"plan: {what}",)


@pytest.mark.parametrize(
    "coupling",
    [
        Coupling("ann", "bob", "collision", 2.0),
        Coupling("ann", "bob", "risk", 1.0),
        Coupling("ann", "bob", "blocked"),
        Coupling("ann", "bob", "distance", 12.0),
        Coupling("bob", "ann", "share"),
        Coupling("ann", "bob", "range", 60.0),
    ],
)
def test_couplings_as_planners_state_them_hold(plan, coupling):
    assert certify(replace(plan, couplings=(coupling,))).holds


def test_what_is_stated_too_low_twice_is_named_twice(plan):
    problems = certify(replace(plan, risk=Risk(0.05, 0.0, saturation=0.0))).problems
    assert [problem.split(" of ")[0] for problem in problems] == [
        "plan: states a certified risk", "plan: states a saturation",
    ]  # fmt: skip


@pytest.mark.parametrize("factor", [0.0, 0.5, 1.001, 10.0])
def test_a_ledger_that_does_not_sum_to_the_certified_risk_is_caught(plan, factor):
    found = certify(plan)
    honest = replace(plan, risk=Risk(0.05, found.certified, found.ledger))
    assert certify(honest).holds
    rows = tuple(replace(row, risk=factor * row.risk) for row in found.ledger)
    (problem,) = certify(replace(plan, risk=Risk(0.05, found.certified, rows))).problems
    assert problem.startswith("plan: its ledger sums to ")
    assert problem.endswith(
        f"it states a certified risk of {found.certified:.9g}: both must be equal"
    )


@pytest.mark.parametrize("seconds", [-1e-9, -5.0, float("nan"), float("inf")])
def test_seconds_that_no_clock_measures_are_caught(plan, seconds):
    stated = replace(plan, seconds={"sets": 1.0, "total": seconds})
    assert certify(stated).problems == (
        f"plan: states {seconds:.9g} seconds for 'total', must be a number >= 0",
    )
    assert certify(replace(plan, seconds={"sets": 0.0, "total": 3.0})).holds


def test_a_first_plan_before_the_beginning_is_caught(plan):
    stated = replace(plan, first=FirstPlan(-0.5, 2.0 * plan.cost))
    assert certify(stated).problems == (
        "plan: states that its first plan was there after -0.5 seconds, must be >= 0",
    )
    assert certify(replace(plan, first=FirstPlan(0.0, 2.0 * plan.cost))).holds


def test_a_first_plan_cheaper_than_any_certified_plan_is_caught(plan):
    bound = 0.9 * plan.cost
    cheap = replace(plan, first=FirstPlan(1.0, 0.5 * bound), certified_lower_bound=bound)
    assert certify(cheap).problems == (
        f"plan: states a first certified plan of cost {0.5 * bound:.9g}, below {bound:.9g}, the "
        "lower bound of any certified plan",
    )
    for cost in (bound, plan.cost):
        assert certify(replace(cheap, first=FirstPlan(1.0, cost))).holds
    # Plans by faces may cost more than others that are certified.
    by_faces = replace(cheap, lower_bound=bound, certified_lower_bound=None)
    assert certify(by_faces).holds


@pytest.mark.parametrize("sets", [((), ("ann", "bob")), (("ann",), (), ("bob",), ())])
def test_a_set_of_nobody_is_caught(plan, sets):
    assert certify(replace(plan, sets=sets)).problems == ("plan: one of its sets is empty",)


def optimal(plan, share, planner, **more):
    options = {"lower_bound": share * plan.cost} | more
    return replace(plan, status=Status.OPTIMAL, planner=planner, **options)


CERTIFIED = str(parse_planner("certified"))


@pytest.mark.parametrize(
    ("planner", "gap"),
    [
        (CERTIFIED, Planner.__dataclass_fields__["gap"].default),
        (str(parse_planner("certified(60)")), Planner.__dataclass_fields__["gap"].default),
        (str(replace(parse_planner("certified"), gap=0.05)), 0.05),
        (str(replace(parse_planner("certified(60)"), gap=2e-5)), 2e-5),
    ],
)
def test_optimal_is_within_the_gap_that_was_asked_for(plan, planner, gap):
    beyond = optimal(plan, 1.0 - 1.1 * gap, planner)
    (problem,) = certify(beyond).problems
    assert problem == (
        f"plan: status is 'optimal', asked for was a gap of {gap:g}, lower bound "
        f"{beyond.lower_bound:.9g} and cost {plan.cost:.9g} are {1.1 * gap:.3g} apart"
    )
    assert certify(optimal(plan, 1.0 - gap, planner)).holds
    # What holds for any certified plan holds for those by faces.
    proven = {"lower_bound": 0.0, "certified_lower_bound": (1.0 - gap) * plan.cost}
    assert certify(optimal(plan, 0.0, planner, **proven)).holds
    assert certify(replace(beyond, status=Status.FEASIBLE)).holds


@pytest.mark.parametrize("planner", ["by hand", "mine, gap=wide", "mine, gap=2"])
def test_a_file_that_states_no_gap_contradicts_none(plan, planner):
    assert certify(optimal(plan, 0.5, planner)).holds
