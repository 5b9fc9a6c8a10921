"""What is to be said of starts and goals: above Δ, or a large part of it; with what cures it."""

from __future__ import annotations

from collections.abc import Iterator

from radmpc.preflight.outlook import Outlook

__all__ = ["describe_endpoints"]

_CURED = 2
"""Reasons for which cures are tried [-]; more would take too long."""

_Told = tuple[tuple[str, ...], str, bool]
"""Vehicles, a line, and whether that rules out any plan."""


def describe_endpoints(outlook: Outlook) -> Iterator[_Told]:
    """Yield what is to be said of starts and goals.

    Parameters
    ----------
    outlook : Outlook
        What was seen.

    Yields
    ------
    tuple of str, str and bool
        Vehicles, a line, and whether that rules out any plan.
    """
    if outlook.endpoints is None and not outlook.ranges:
        return
    # These load scipy, see `Outlook`.
    from radmpc.planners.cures.endpoints import SMALL_SHARE  # noqa: PLC0415 - loads scipy

    scenario = outlook.scenario
    told = [*_near(outlook), *_lost(outlook)]
    yield from told
    if not told and outlook.least_risk > SMALL_SHARE * scenario.risk_bound:
        yield _in_all(outlook)


def _near(outlook: Outlook) -> Iterator[_Told]:
    """Yield starts and goals too close to obstacles, the border or each other."""
    if outlook.endpoints is None:
        return
    from radmpc.planners.cures.endpoints import endpoint_cures  # noqa: PLC0415 - loads scipy
    from radmpc.planners.cures.variants import helps_sentence  # noqa: PLC0415 - loads scipy
    from radmpc.planners.presolve import endpoint_reasons, grouped, hazards_of  # noqa: PLC0415 - loads scipy

    scenario = outlook.scenario
    reasons = endpoint_reasons(scenario, outlook.endpoints)
    # Of goals that are shared others may risk less; starts stay as they are.
    worst_start = max((hazard.risk for hazard in outlook.endpoints.starts), default=0.0)
    is_fatal = not scenario.goals or worst_start > scenario.risk_bound
    for k, (reason, (_, text)) in enumerate(zip(reasons, grouped(scenario, reasons), strict=False)):
        names = tuple(scenario.vehicles[i].name for i in reason.members)
        found = hazards_of(outlook.endpoints, reason.members)
        cures = endpoint_cures(scenario, found) if k < _CURED and found else ()
        yield names, " ".join(filter(None, [text, helps_sentence(cures)])), is_fatal


def _lost(outlook: Outlook) -> Iterator[_Told]:
    """Yield starts and goals out of the ranges that vehicles keep."""
    if not outlook.ranges:
        return
    from radmpc.planners.presolve import Reason, grouped  # noqa: PLC0415 - few keep a range
    from radmpc.planners.shared_reasons import range_sentences  # noqa: PLC0415 - few keep a range

    scenario = outlook.scenario
    for at_goal in (False, True):
        found = [one for one in outlook.ranges if one.at_goal == at_goal]
        reasons = [Reason(*told) for told in range_sentences(scenario, found)]
        # Goals that are shared may be assigned otherwise.
        is_fatal = not (at_goal and scenario.goals)
        for reason, (_, text) in zip(reasons, grouped(scenario, reasons), strict=False):
            yield tuple(scenario.vehicles[i].name for i in reason.members), text, is_fatal


def _in_all(outlook: Outlook) -> _Told:
    """Return how much of Δ starts and goals take together."""
    from radmpc.planners.cures.endpoints import endpoint_cures  # noqa: PLC0415 - loads scipy
    from radmpc.planners.cures.variants import helps_sentence  # noqa: PLC0415 - loads scipy
    from radmpc.planners.shared_reasons import ROUNDING  # noqa: PLC0415 - loads scipy

    scenario = outlook.scenario
    ranked = sorted(outlook.hazards, key=lambda hazard: -hazard.risk)
    worst = ranked[0]
    names = tuple(scenario.vehicles[i].name for i in worst.members)
    place = "goal" if worst.at_goal else "start"
    if worst.cause in {"pair", "range"}:
        what = f"the {place}s of {names[0]!r} and {names[1]!r}"
        if worst.cause == "range":
            what += " at the end of their range"
    else:
        other = "the workspace border" if worst.other is None else f"obstacle {worst.other!r}"
        what = f"the {place} of {names[0]!r} at {other}"
    share = 100.0 * outlook.least_risk / scenario.risk_bound
    text = (
        f"Starts and goals alone take {outlook.least_risk:.2g} of risk_bound "
        f"{scenario.risk_bound:g} ({share:.0f} %), whatever the plan, most of it {what} "
        f"({worst.risk:.2g})."
    )
    # What is tried does not look at ranges: a place that is moved may leave them.
    cures = () if outlook.ranges else endpoint_cures(scenario, ranked)
    is_fatal = outlook.least_risk > scenario.risk_bound * (1.0 + ROUNDING) and not scenario.goals
    return names, " ".join(filter(None, [text, helps_sentence(cures)])), is_fatal
