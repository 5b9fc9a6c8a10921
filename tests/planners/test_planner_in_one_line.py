from __future__ import annotations

from itertools import combinations

import pytest

from radmpc.planners import (
    BigM,
    Branch,
    Centralized,
    Certified,
    Couplings,
    Distance,
    Ira,
    Optimal,
    Planner,
    Pool,
    Receding,
    Rrt,
    Sigmas,
    Uniform,
)
from radmpc.planners.presets import PRESETS, called, parse_planner
from radmpc.wording import names_of_choices


@pytest.mark.parametrize(
    ("choice", "text"),
    [
        (Ira(), "ira"),
        (Ira(keep=0.5, max_iterations=1), "ira(keep=0.5, max_iterations=1)"),
        (Ira(active_tol=0.02, direction="to_inactive"), "ira(to_inactive, active_tol=0.02)"),
        (Ira(spread="all"), "ira(all rows)"),
        (Uniform("all"), "uniform(all rows)"),
        (Pool("used", "all"), "pool(used, all rows)"),
        (Sigmas(2.123456789), "sigmas(2.123456789)"),
        (Branch(), "branch"),
        (Branch(3), "branch(max_nodes=3)"),
        (Rrt(1_234_567), "rrt(max_nodes=1234567)"),
        (BigM("scip"), "big_m(scip)"),
        (Distance(1234567.5), "distance(1234567.5)"),
        (Receding(sigmas=3.44444444), "receding(3.44444444 sigmas)"),
        (Couplings(), "couplings(1e-06)"),
        (Couplings(approximation_policy=Pool("used")), "couplings(1e-06, pool(used))"),
        (Couplings(0.1, Receding("reset")), "couplings(0.1, receding(reset))"),
        (Certified(), "certified"),
        (Certified(0.12345678), "certified(0.12345678)"),
    ],
)  # fmt: skip
def test_a_choice_tells_every_option_that_is_not_the_usual_one(choice: object, text: str) -> None:
    assert str(choice) == text


def test_a_planner_tells_its_gap_unless_it_is_the_usual_one() -> None:
    usual, other = (Planner(Ira(), Branch(), Centralized(), gap) for gap in (1e-3, 0.01))
    assert str(usual) == "ira, branch, centralized"
    assert str(other) == "ira, branch, centralized, gap=0.01"


def test_planners_that_differ_read_differently() -> None:
    others = [Planner(Ira(keep=k), Branch(n), Distance(m), g) for k, n, m, g in (
        (0.7, 5_000, 5.0, 1e-3), (0.5, 5_000, 5.0, 1e-3), (0.7, 3, 5.0, 1e-3),
        (0.7, 5_000, 5.0000001, 1e-3), (0.7, 5_000, 5.0, 1.0000001e-3),
    )]  # fmt: skip
    assert all(str(one) != str(other) for one, other in combinations(others, 2))


@pytest.mark.parametrize(
    "name",
    [
        "multi-vehicle(1.23456789e-05)",
        "multi-vehicle(0.1234567890123)",
        "rmpc(2.123456789)",
        "distance(1234567.5)",
        "certified(0.3333333333333333)",
    ],
)
def test_a_number_of_many_digits_is_called_by_all_of_them(name: str) -> None:
    planner = parse_planner(name)
    assert called(planner) == name
    assert parse_planner(called(planner)) == planner


def test_the_choices_of_a_planner_are_known_from_its_line_whatever_their_options() -> None:
    for name, preset in PRESETS.items():
        choices = names_of_choices(str(preset.planner))
        assert len(choices) == 3
        assert ("certified" in choices) == (name == "certified")
    told = str(Planner(Optimal(), Branch(), Certified(3.0), 0.01))
    assert names_of_choices(told) == ("optimal", "branch", "certified")
    nested = str(Planner(Ira(keep=0.5), Branch(3), Couplings(0.1, Receding("reset")), 0.01))
    assert names_of_choices(nested) == ("ira", "branch", "couplings")
