"""Planning in other units, so that callers see nothing of them."""

from __future__ import annotations

from collections.abc import Callable

from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Run
from radmpc.planners.units.choosing import Units, other_units
from radmpc.planners.verdict import RoughJudge
from radmpc.records import replace

__all__ = ["planned_in_units"]


def planned_in_units(
    scenario: Scenario,
    run: Run,
    plan: Callable[[Scenario, Run], Draft],
    why_not: Callable[[], str | None],
) -> Draft | None:
    """Plan a scenario in units in which its numbers are of order one.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    run : Run
        Given and told everything in the scenario's own units.
    plan : callable
        Plans.
    why_not : callable
        Asked where there is no plan: says why in the scenario's own units, None if it cannot tell.

    Returns
    -------
    Draft or None
        In the scenario's own units; where an explanation has numbers in others, it says so. None
        where the scenario's own units do, or its numbers fit into no others.
    """
    units = other_units(scenario)
    if units is None:
        return None
    from radmpc.planners.units.scenario import scenario_in_units  # noqa: PLC0415 - few need it

    try:
        there = scenario_in_units(scenario, units)
    except ScenarioError:
        # Some number is far from all others.
        return None
    draft = plan(there, _run(run, units))
    text = draft.explanation
    if text:
        here = None if draft.controls else why_not()
        text = f"{text} {_told(units)}" if here is None else here
    return replace(_here(draft, units), explanation=text)


def _run(run: Run, units: Units) -> Run:
    """Return a run that is asked and told in other units."""

    def back(controls: tuple[Matrix, ...]) -> tuple[Matrix, ...]:
        return _controls(controls, units)

    def found(cost: float, bound: float | None) -> None:
        run.found(cost / units.cost, None if bound is None else bound / units.cost)

    judge = run.judge
    there = (
        RoughJudge(lambda c: judge.verdict(back(c)), lambda c: judge.rough(back(c)))
        if isinstance(judge, RoughJudge)
        else lambda c: judge(back(c))
    )
    return replace(run, judge=there, found=found, improved=lambda c: run.improved(back(c)))


def _here(draft: Draft, units: Units) -> Draft:
    """Return a draft in the scenario's own units."""
    cost = units.cost
    lower, on_any, price = draft.lower_bound, draft.certified_lower_bound, draft.price
    return replace(
        draft,
        controls=_controls(draft.controls, units),
        steps=tuple(replace(step, cost=step.cost / cost) for step in draft.steps),
        lower_bound=None if lower is None else lower / cost,
        certified_lower_bound=None if on_any is None else on_any / cost,
        price=None if price is None else price / cost,
    )


def _controls(controls: tuple[Matrix, ...], units: Units) -> tuple[Matrix, ...]:
    """Return controls in the scenario's own units; empty without a plan."""
    if not controls:
        return ()
    return tuple(c / factor for c, factor in zip(controls, units.controls, strict=True))


def _told(units: Units) -> str:
    """Return how what is told differs from the scenario's own units."""
    return (
        f"(Told in units in which lengths are {units.length:g} and times {units.time:g} times the "
        "scenario's numbers.)"
    )
