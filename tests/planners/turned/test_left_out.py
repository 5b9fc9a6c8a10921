"""Half-spaces that a program of many begins without, and programs that are given up in time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear import group_lp, parts
from radmpc.planners.certified.turned.linear.group_lp import GroupLp
from radmpc.planners.certified.turned.linear.group_plan import GroupPlan
from radmpc.planners.certified.turned.linear.margins import Margins, priced_margins
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

PRICE, PENALTY = 30.0, 1e3


def crowd(avoidance: str) -> tuple[Hazards, Paths, HalfSpaces]:
    """Ten vehicles on their paths alone, through one place, and half-spaces between all of them."""
    scenario = replace(circle(10), avoidance=avoidance)
    successive = SuccessiveLp(Hazards.of(scenario, condensed_models(scenario)), Limits())
    assert successive.begin_alone()
    everyone, near = tuple(range(10)), Near(6.5, 20.0, is_refined=True)
    spaces = half_spaces(successive.hazards, successive.paths, everyone, near)
    return successive.hazards, successive.paths, spaces


def asked(spaces: HalfSpaces) -> Margins:
    """Return what half-spaces ask for at a price of risk."""
    return priced_margins(spaces.deviations, spaces.clearances, (PRICE, PENALTY), 0.5)


def solved(hazards: Hazards, paths: Paths, spaces: HalfSpaces) -> tuple[GroupPlan, int]:
    """Share risk among all; return what they do, and how many rows the program has."""
    margins = asked(spaces)
    program = GroupLp(hazards, tuple(range(10)))
    plan = program.solve(spaces, paths, margins)
    assert plan is not None
    return plan, program._lp.num_rows


def value(plan: GroupPlan, hazards: Hazards) -> float:
    """Return what the program minimizes."""
    weights = [model.vehicle.cost_weight for model in hazards.models]
    effort = [w * np.abs(u).sum() for w, u in zip(weights, plan.controls, strict=True)]
    return float(sum(effort)) + PRICE * plan.risk + PENALTY * plan.shortfall


FEWEST = 0.3
"""Share of what is asked for within which half-spaces are too few to keep a crowd apart."""


@pytest.mark.parametrize("share", [FEWEST, 0.75])
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_a_program_that_begins_with_near_half_spaces_ends_with_the_solution_of_all(
    avoidance: str, share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    hazards, paths, spaces = crowd(avoidance)
    monkeypatch.setattr(parts, "_NEAR_SHARE", share)
    assert spaces.count > parts.FEW_PRICED
    some, few_rows = solved(hazards, paths, spaces)
    monkeypatch.setattr(parts, "FEW_PRICED", spaces.count)
    every, all_rows = solved(hazards, paths, spaces)
    assert few_rows < all_rows
    # What is left out is worth no more than this share each.
    whole, part = value(every, hazards), value(some, hazards)
    assert whole * (1.0 - spaces.count * group_lp.UNASKED) <= part <= whole * (1.0 + 1e-9)


def test_a_crowd_is_not_kept_apart_by_near_half_spaces_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hazards, paths, spaces = crowd("steps")
    monkeypatch.setattr(parts, "_NEAR_SHARE", FEWEST)
    near = spaces.of(parts.near_first(spaces, asked(spaces)))
    assert 0 < near.count < spaces.count
    some, _ = solved(hazards, paths, near)
    every, _ = solved(hazards, paths, spaces)
    assert value(some, hazards) < value(every, hazards) - 1e-4


def test_sharing_risk_leaves_paths_as_they_are_once_time_is_up() -> None:
    scenario = circle(6)
    hazards, everyone = Hazards.of(scenario, condensed_models(scenario)), tuple(range(6))
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    before = successive.paths.means.copy()
    late = SuccessiveLp(hazards, Limits(deadline=0.0))
    late.begin(successive.paths.controls)
    late.share_risk(everyone, PRICE, 0.5)
    assert np.array_equal(late.paths.means, before)
    successive.share_risk(everyone, PRICE, 0.5)
    assert not np.allclose(successive.paths.means, before)
