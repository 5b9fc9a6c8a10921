"""Whether it is certain, without a search, that a fleet has no plan."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.model.limits import outside_norms
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.infeasible.answer import WhyNot
from radmpc.planners.presolve import sure_reasons
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.records import replace
from radmpc.solvers.solution import Limits

__all__ = ["holds_outside_norms", "sure_why_not"]


def sure_why_not(
    scenario: Scenario, models: Sequence[CondensedModel], limits: Limits
) -> WhyNot | None:
    """Find out, without a search, that a fleet has no plan.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    models : sequence of CondensedModel
        Its vehicles over the whole horizon.
    limits : Limits
        When to stop looking at what would help, and at what the other vehicles could do.

    Returns
    -------
    WhyNot or None
        A proof; None where a search has to tell.
    """
    reasons = sure_reasons(scenario, models)
    if not reasons:
        return None
    # Most fleets have a plan.
    from radmpc.planners.certified.infeasible.explanation import describe_certain  # noqa: PLC0415 - few need it

    return describe_certain(scenario, reasons, limits)


def holds_outside_norms(scenario: Scenario) -> bool:
    """Tell whether what programs say of having no plan holds of the limits of norms themselves.

    Programs keep to polytopes within these. Without such limits it does; with them, if there is
    no plan at first sight, or a vehicle cannot reach its goal through empty space, even so.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    """
    vehicles = tuple(map(outside_norms, scenario.vehicles))
    if all(one is other for one, other in zip(vehicles, scenario.vehicles, strict=True)):
        return True
    from radmpc.planners.explain import unable_alone  # noqa: PLC0415 - few need it

    outside = replace(scenario, vehicles=vehicles)
    models = condensed_models(outside)
    if sure_reasons(outside, models):
        return True
    return any(unable_alone(outside, model) is not None for model in models)
