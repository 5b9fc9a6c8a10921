"""What keeps vehicles from any plan, whatever its risk: the noise, or what stands there."""

from __future__ import annotations

from dataclasses import replace

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.infeasible.tuning import TUNING
from radmpc.planners.certified.problem import SetProblem
from radmpc.planners.cures.variants import with_noise
from radmpc.planners.explain import trivially_infeasible
from radmpc.planners.within_norms import models_within_norms
from radmpc.planners.wording import listed
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

__all__ = ["stuck_reason"]

_UNIT = 0.49
"""The unit of risk, and with it the row risk cap [-]: below one half a row's tail is convex."""

_QUIET = 1e-6
"""Factor of covariances that leaves next to nothing of them [-]."""


_BY_FACES = "by the faces of this scenario"
"""Of what a search rules out a plan: half-spaces with other normals may leave one."""


def stuck_reason(
    scenario: Scenario, members: tuple[int, ...], limits: Limits
) -> tuple[tuple[int, ...], str, str | None]:
    """Say which vehicles cannot be planned at any risk, and what stands in the way.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    members : tuple of int
        Vehicles that together have no plan.
    limits : Limits
        When to stop looking.

    Returns
    -------
    members : tuple of int
        Those of them that are stuck by themselves.
    text : str
        A sentence; of one vehicle what follows its name.
    many : str or None
        As in `Reason`.
    """
    reason = trivially_infeasible(scenario.subset(members, scenario.risk_bound))
    if reason is not None:
        return members, reason, None
    members = _smallest(scenario, members, limits)
    part = scenario.subset(members, scenario.risk_bound)
    if _has_plan(with_noise(part, _QUIET), limits):
        what = (
            f"no path {_BY_FACES} with enough clearance for the noise (without noise there is one)"
        )
    else:
        blockers = _blockers(part, limits)
        what = f"no plan {_BY_FACES}, at any risk"
        if blockers:
            standing = listed(blockers, "or")
            what += f": {standing} stands in the way (without it there is one)"
    if len(members) == 1:
        return members, f"has {what}.", f"have {what}."
    names = [repr(v.name) for v in part.vehicles]
    return members, f"Vehicles {' and '.join(names)} together have {what}.", ""


def _smallest(scenario: Scenario, members: tuple[int, ...], limits: Limits) -> tuple[int, ...]:
    """Leave out vehicles without whom the others are stuck all the same."""
    kept = list(members)
    for i in members:
        fewer = [j for j in kept if j != i]
        if fewer and _is_stuck(scenario.subset(tuple(fewer), scenario.risk_bound), limits):
            kept = fewer
    return tuple(kept)


def _blockers(scenario: Scenario, limits: Limits) -> list[str]:
    """Return the obstacles without which there is a plan."""
    found = []
    for i, obstacle in enumerate(scenario.obstacles):
        others = scenario.obstacles[:i] + scenario.obstacles[i + 1 :]
        if _has_plan(replace(scenario, obstacles=others), limits):
            found.append(f"obstacle {obstacle.name!r}")
    if scenario.workspace is not None and _has_plan(replace(scenario, workspace=None), limits):
        found.append("the workspace border")
    return found


def _search(scenario: Scenario, limits: Limits) -> RiskTree:
    """Search for any plan, whatever its risk."""
    models = models_within_norms(scenario)
    everyone = tuple(range(len(models)))
    problem = SetProblem.of(scenario, everyone, models, _UNIT).without_cost()
    tree = RiskTree(
        problem.program, _UNIT, 1.0, gap=1.0, scale=1.0, limits=limits, rater=problem.rater
    )
    tree.run(TUNING.nodes * len(everyone))
    return tree


def _has_plan(scenario: Scenario, limits: Limits) -> bool:
    """Whether a plan is found."""
    return _search(scenario, limits).best is not None


def _is_stuck(scenario: Scenario, limits: Limits) -> bool:
    """Whether it is proven that there is no plan."""
    return _search(scenario, limits).bound == float("inf")
