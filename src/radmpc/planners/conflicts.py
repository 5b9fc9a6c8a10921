"""What stands in the way at starts and at single steps, in sentences."""

from __future__ import annotations

from radmpc.model.scenario import Scenario
from radmpc.planners.wording import hazard_name
from radmpc.program.program import DisjunctiveProgram, RiskItem

__all__ = ["cannot_avoid", "start_too_risky"]


def start_too_risky(program: DisjunctiveProgram, at_start: float) -> str:
    """Return the sentence about starts whose risk alone exceeds the bound.

    Parameters
    ----------
    program : DisjunctiveProgram
        Of the vehicles.
    at_start : float
        What their starts risk [-].
    """
    ranked = sorted(program.initial, key=lambda item: -item[1])
    worst, risk = ranked[0]
    if risk >= 0.5:
        return _start_in_conflict(worst)
    parts = [f"{hazard_name(risk_item)} (risk {risk:.3g})" for risk_item, risk in ranked[:3]]
    return (
        f"The starts alone carry a collision risk of {at_start:.3g} by union bounds, above the "
        f"{program.risk_bound:.3g} allocated: {'; '.join(parts)}."
    )


def _start_in_conflict(risk_item: RiskItem) -> str:
    """Return the sentence about a start in contact."""
    if risk_item.cause == "pair":
        return (
            f"The starts of vehicles {risk_item.vehicle!r} and {risk_item.other!r} are too close: "
            "they touch before anything moves."
        )
    if risk_item.cause == "obstacle":
        return (
            f"The start of vehicle {risk_item.vehicle!r} lies within obstacle {risk_item.other!r} "
            "grown by the vehicle's radius."
        )
    if risk_item.cause == "range":
        return (
            f"The starts of vehicles {risk_item.vehicle!r} and {risk_item.other!r} are out of the "
            "range that they keep."
        )
    return f"The start of vehicle {risk_item.vehicle!r} lies outside the workspace."


def cannot_avoid(scenario: Scenario, risk_item: RiskItem) -> str:
    """Name a hazard that exists wherever the vehicles may be at that time.

    Parameters
    ----------
    scenario : Scenario
        The vehicles.
    risk_item : RiskItem
        The hazard.
    """
    when = f"at step {risk_item.step}"
    if scenario.avoidance == "intervals":
        when = f"between steps {risk_item.step} and {risk_item.step + 1}"
    if risk_item.cause == "range":
        return (
            f"Vehicles {risk_item.vehicle!r} and {risk_item.other!r} cannot be in the range that "
            f"they keep {when}: limits and goals lead them apart."
        )
    return (
        f"{_capitalized(hazard_name(risk_item))} cannot be kept apart {when}: none of the faces "
        "between them leaves space for any motion that limits and goals allow."
    )


def _capitalized(text: str) -> str:
    """Return a text with a capital at its front, names within it as they are."""
    return text[:1].upper() + text[1:]
