"""Plans that lie or break a rule are caught, with a sentence that names what is wrong."""

from dataclasses import replace

import numpy as np
import pytest
from referee_scenes import glider, make_plan, straight_controls, straight_plan

from radmpc.errors import ScenarioError
from radmpc.model.plan import LedgerRow, Risk, Status
from radmpc.model.scenario import Scenario
from radmpc.referee import certify, simulate

GAIN = np.array([[-0.3, 0.0, -0.9, 0.0], [0.0, -0.3, 0.0, -0.9]])


@pytest.fixture
def plan():
    vehicles = (
        glider("ann", [0, 0], [8, 0], gain=GAIN),
        glider("bob", [0, 6], [8, 6]),
    )
    return straight_plan(Scenario("faults", 1.0, 10, 0.05, vehicles))


def with_trajectory(plan, index, **changes):
    trajectories = list(plan.trajectories)
    trajectories[index] = replace(trajectories[index], **changes)
    return replace(plan, trajectories=tuple(trajectories))


def only_problem(plan):
    certificate = certify(plan)
    assert not certificate.holds
    assert len(certificate.problems) == 1, certificate.problems
    return certificate.problems[0]


def test_a_sound_plan_holds(plan):
    certificate = certify(plan)
    assert certificate.problems == ()
    assert certificate.holds
    assert certificate.summary.startswith("holds")


def test_a_shifted_control_is_caught(plan):
    controls = plan.trajectories[1].controls.copy()
    controls[3, 0] += 1e-4
    problems = certify(with_trajectory(plan, 1, controls=controls)).problems
    assert "vehicle 'bob'" in problems[0]
    assert "mean [0] at step 4" in problems[0]
    assert any("costs" in p or "cost" in p for p in problems)


def test_a_shifted_mean_is_caught(plan):
    means = plan.trajectories[0].means.copy()
    means[5, 1] += 2e-6
    problem = only_problem(with_trajectory(plan, 0, means=means))
    assert "vehicle 'ann': mean [1] at step 5" in problem


def test_a_mean_within_the_tolerance_is_accepted(plan):
    means = plan.trajectories[0].means.copy()
    means[5, 1] += 5e-7
    assert certify(with_trajectory(plan, 0, means=means)).holds


def test_swapped_trajectories_are_caught(plan):
    first, second = plan.trajectories
    swapped = (replace(first, name="bob"), replace(second, name="ann"))
    problem = only_problem(replace(plan, trajectories=swapped))
    assert "order ['bob', 'ann']" in problem


def test_trajectories_under_each_others_names_are_caught(plan):
    first, second = plan.trajectories
    swapped = (replace(second, name="ann"), replace(first, name="bob"))
    problems = certify(replace(plan, trajectories=swapped)).problems
    assert any("vehicle 'ann': mean [1] at step 0 is stated as 6" in p for p in problems)
    assert any("vehicle 'bob': mean [1] at step 0 is stated as 0" in p for p in problems)


def test_a_covariance_scaled_down_is_caught(plan):
    smaller = 0.9 * plan.trajectories[1].covariances
    problem = only_problem(with_trajectory(plan, 1, covariances=smaller))
    assert "vehicle 'bob': covariance [0, 0] at step 0" in problem


def test_a_covariance_scaled_down_does_not_lower_the_certificate(plan):
    smaller = 0.1 * plan.trajectories[1].covariances
    honest, lying = certify(plan), certify(with_trajectory(plan, 1, covariances=smaller))
    assert lying.certified == honest.certified


def test_a_missing_vehicle_is_caught(plan):
    problem = only_problem(replace(plan, trajectories=plan.trajectories[:1]))
    assert problem == "vehicle 'bob': missing from the plan"


def test_an_extra_vehicle_is_caught(plan):
    extra = replace(plan.trajectories[0], name="eve")
    problem = only_problem(replace(plan, trajectories=(*plan.trajectories, extra)))
    assert problem == "vehicle 'eve': not in the scenario"


def test_a_vehicle_twice_is_caught(plan):
    problem = only_problem(replace(plan, trajectories=(*plan.trajectories, plan.trajectories[0])))
    assert "vehicle 'ann': stands 2 times" in problem


def test_an_empty_plan_is_caught(plan):
    nothing = replace(plan, status=Status.LIMIT, trajectories=(), cost=None)
    certificate = certify(nothing)
    assert certificate.problems == ("plan: holds no trajectories",)
    assert certificate.certified == 1.0


@pytest.mark.parametrize(
    ("field", "cut"),
    [
        ("controls", lambda a: a[:-1]),
        ("means", lambda a: a[:, :2]),
        ("covariances", lambda a: a[1:]),
        ("gain", lambda a: a[:1]),
    ],
)
def test_a_wrong_shape_is_caught(plan, field, cut):
    array = getattr(plan.trajectories[0], field)
    problem = only_problem(with_trajectory(plan, 0, **{field: cut(array)}))
    assert f"vehicle 'ann': {field} have shape" in problem
    assert str(array.shape) in problem


def test_a_wrong_gain_is_caught(plan):
    problem = only_problem(with_trajectory(plan, 0, gain=1.1 * GAIN))
    assert "vehicle 'ann': gain [0, 0] is stated as -0.33" in problem


def test_a_missing_gain_is_caught(plan):
    problem = only_problem(with_trajectory(plan, 0, gain=None))
    assert problem == "vehicle 'ann': the plan has no feedback gain, the scenario one"


def test_an_unasked_gain_is_caught(plan):
    problem = only_problem(with_trajectory(plan, 1, gain=GAIN))
    assert problem == "vehicle 'bob': the plan has a feedback gain, the scenario none"


def test_a_wrong_cost_is_caught(plan):
    problem = only_problem(replace(plan, cost=plan.cost - 1e-3))
    assert problem.startswith("plan: states a cost of")


def test_an_absent_cost_is_caught(plan):
    assert "states no cost" in only_problem(replace(plan, cost=None))


def test_another_risk_bound_is_caught(plan):
    problem = only_problem(replace(plan, risk=Risk(0.4)))
    assert "risk bound of 0.4" in problem


def test_a_stated_certificate_that_is_too_low_is_caught(plan):
    true = certify(plan).certified
    assert true > 0.0
    assert certify(replace(plan, risk=Risk(0.05, true))).holds
    assert certify(replace(plan, risk=Risk(0.05, 2 * true))).holds
    problem = only_problem(replace(plan, risk=Risk(0.05, 0.5 * true)))
    assert "certified risk" in problem


def test_a_broken_control_limit_is_caught(plan):
    vehicle = replace(plan.scenario.vehicles[1], control_limit=np.array([0.2, 2.0]))
    scenario = replace(plan.scenario, vehicles=(plan.scenario.vehicles[0], vehicle))
    problem = only_problem(replace(plan, scenario=scenario))
    assert "vehicle 'bob': control on axis 0 at step 0" in problem
    assert "allowed is up to 0.2" in problem


def test_the_control_limit_keeps_the_reserve_of_the_feedback(plan):
    first = plan.scenario.vehicles[0]
    peak = np.abs(plan.trajectories[0].controls).max()
    vehicle = replace(first, control_limit=np.full(2, peak + 0.01))
    scenario = replace(plan.scenario, vehicles=(vehicle, plan.scenario.vehicles[1]))
    assert "vehicle 'ann': control on axis 0" in only_problem(replace(plan, scenario=scenario))
    relaxed = replace(vehicle, control_sigmas=0.0)
    scenario = replace(plan.scenario, vehicles=(relaxed, plan.scenario.vehicles[1]))
    assert certify(replace(plan, scenario=scenario)).holds


def test_a_broken_speed_limit_is_caught(plan):
    vehicle = replace(plan.scenario.vehicles[1], speed_limit=np.array([1.0, 3.0]))
    scenario = replace(plan.scenario, vehicles=(plan.scenario.vehicles[0], vehicle))
    problem = only_problem(replace(plan, scenario=scenario))
    assert "vehicle 'bob': speed on axis 0 at step" in problem
    assert "allowed is up to 1" in problem


def test_a_missed_goal_is_caught(plan):
    scenario = plan.scenario
    controls = [straight_controls(v, scenario.horizon) for v in scenario.vehicles]
    controls[0] = 0.9 * controls[0]
    problem = only_problem(make_plan(scenario, controls))
    assert "vehicle 'ann': ends at 7.2 on axis 0, its goal is 7.8 to 8.2" in problem


def test_passing_the_goal_too_fast_is_caught(plan):
    scenario = plan.scenario
    controls = [straight_controls(v, scenario.horizon) for v in scenario.vehicles]
    controls[0] = controls[0].copy()
    controls[0][-1, 1] += 0.2
    problem = only_problem(make_plan(scenario, controls))
    assert "vehicle 'ann': goal speed on axis 1 at step 10 is 0.2" in problem


def test_several_faults_are_all_named(plan):
    means = plan.trajectories[0].means.copy()
    means[5, 1] += 1.0
    broken = with_trajectory(replace(plan, cost=0.0), 0, means=means)
    assert len(certify(broken).problems) == 2
    assert "2 problems" in certify(broken).summary


@pytest.mark.parametrize("much", [1e200, 1e308])
def test_numbers_beyond_all_bounds_are_a_problem_not_a_crash(plan, much):
    controls = plan.trajectories[0].controls.copy()
    controls[:, 0] = much
    broken = with_trajectory(plan, 0, controls=controls)
    certificate = certify(broken)
    assert certificate.problems == ("vehicle 'ann': its mean overflows",)
    assert certificate.certified == 1.0
    with pytest.raises(ScenarioError, match="its mean overflows"):
        simulate(broken, 10)


def test_noise_beyond_all_bounds_is_a_problem_not_a_crash(plan):
    wild = replace(plan.scenario.vehicles[0], gain=10.0 * GAIN)
    object.__setattr__(wild, "initial_covariance", 1e300 * np.eye(4))  # is refused
    scenario = replace(plan.scenario, vehicles=(wild, plan.scenario.vehicles[1]))
    broken = with_trajectory(replace(plan, scenario=scenario), 0, gain=10.0 * GAIN)
    assert certify(broken).problems == ("vehicle 'ann': its covariances overflow",)


def test_words_that_cannot_be_true_together_are_caught(plan):
    cost = plan.cost
    faults = {
        "status is 'infeasible', yet there are trajectories": {"status": Status.INFEASIBLE},
        "status is 'optimal' without a lower bound": {"status": Status.OPTIMAL},
        "lower bound": {"lower_bound": cost + 1.0},
        "sets do not hold every vehicle once": {"sets": (("nobody",),)},
    }
    for text, change in faults.items():
        certificate = certify(replace(plan, **change))
        assert not certificate.holds
        assert any(text in problem for problem in certificate.problems)


@pytest.mark.parametrize("status", [Status.OPTIMAL, Status.FEASIBLE])
def test_a_plan_that_is_said_to_be_found_but_is_not_there_is_caught(plan, status):
    problem = only_problem(replace(plan, status=status, trajectories=(), cost=None))
    assert problem == f"plan: status is {status.value!r}, yet there are no trajectories"


@pytest.mark.parametrize("excess", [0.0, 1e-12])
def test_a_lower_bound_that_the_cost_attains_is_accepted(plan, excess):
    attained = plan.cost * (1.0 + excess)
    assert certify(replace(plan, status=Status.OPTIMAL, lower_bound=attained)).holds


@pytest.mark.parametrize("sets", [(), (("ann",),), (("ann", "bob"), ("bob",)), (("ann", "eve"),)])
def test_sets_that_are_no_partition_are_caught(plan, sets):
    problem = only_problem(replace(plan, sets=sets))
    assert problem == "plan: its sets do not hold every vehicle once"


@pytest.mark.parametrize(
    ("row", "what"),
    [
        (LedgerRow("pair", "eve", "bob", 1, 0.0), "vehicle 'eve', who is not in the scenario"),
        (LedgerRow("pair", "ann", "eve", 1, 0.0), "other 'eve', which is none of the scenario's"),
        (LedgerRow("pair", "ann", "ann", 1, 0.0), "other 'ann', which is none of the scenario's"),
        (
            LedgerRow("obstacle", "ann", "bob", 1, 0.0),
            "other 'bob', which is none of the scenario's",
        ),
        (
            LedgerRow("workspace", "ann", "bob", 1, 0.0),
            "other 'bob', which is none of the scenario's",
        ),
        (LedgerRow("pair", "ann", "bob", 11, 0.0), "step 11, the last is 10"),
    ],
)
def test_a_ledger_row_about_what_is_not_there_is_caught(plan, row, what):
    problem = only_problem(replace(plan, risk=Risk(0.05, None, (row, row))))
    assert problem == f"plan: a ledger row of cause {row.cause!r} names {what}"


def test_ledger_rows_without_a_partner_are_sums(plan):
    rows = tuple(LedgerRow(cause, "ann", None, 1, 0.0) for cause in ("pair", "obstacle"))
    assert certify(replace(plan, risk=Risk(0.05, None, rows))).holds
