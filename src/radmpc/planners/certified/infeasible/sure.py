"""Whether it is certain, without a search, that a fleet has no plan."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.infeasible.answer import WhyNot
from radmpc.planners.presolve import sure_reasons
from radmpc.program.condensed import CondensedModel
from radmpc.solvers.solution import Limits

__all__ = ["sure_why_not"]


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
