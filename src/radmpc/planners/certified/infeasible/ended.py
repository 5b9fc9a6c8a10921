"""What there is to say where a limit ended the search before it knew anything."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.model.scenario import Scenario
from radmpc.planners.reaching.reserves import reserve_reason
from radmpc.planners.wording import limit_clause
from radmpc.program.condensed import CondensedModel
from radmpc.solvers.solution import Limits

__all__ = ["ended"]


def ended(scenario: Scenario, limits: Limits, models: Sequence[CondensedModel]) -> str:
    """Say what ended a search that had found nothing and ruled out nothing.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    limits : Limits
        Those of the search.
    models : sequence of CondensedModel
        Of all vehicles.

    Returns
    -------
    str
        One sentence or two.
    """
    kept = ((v.name, reserve_reason(s)) for v, s in zip(scenario.vehicles, models, strict=True))
    told = [f"The feedback of vehicle {name!r} {text}." for name, text in kept if text is not None]
    return " ".join(
        [f"No plan was found, and none was ruled out: {limit_clause(limits)}", *told[:1]]
    )
