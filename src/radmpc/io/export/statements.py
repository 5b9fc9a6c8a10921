"""What a reader of an export must know, as sentences for files and for the screen."""

from __future__ import annotations

from radmpc.io.export.origin import Placement
from radmpc.io.text.files import one_line
from radmpc.model.ledger import bound_text
from radmpc.model.plan import Plan

__all__ = ["origin_sentence", "risk_sentence", "timing_sentence", "title"]


def title(plan: Plan, vehicle: str | None = None) -> str:
    """Return what the file is of, in one line whatever the names hold.

    Parameters
    ----------
    plan : Plan
        What is exported.
    vehicle : str or None
        The one vehicle that the file holds; None is all.
    """
    whose = "" if vehicle is None else f", vehicle {vehicle}"
    return one_line(f"plan of {plan.scenario.name}{whose}, by radmpc")


def risk_sentence(plan: Plan, is_certified: bool) -> str:
    """Return what is certified, for the fleet as a whole.

    Parameters
    ----------
    plan : Plan
        What is exported.
    is_certified : bool
        Whether the certificate is within the risk bound.
    """
    bound = plan.scenario.risk_bound
    if not is_certified or plan.risk.certified is None:
        return f"NOT certified within its risk bound {bound:g}"
    return (
        f"risk of any collision, whole fleet and whole mission: at most "
        f"{bound_text(plan.risk.certified)}, risk bound {bound:g}"
    )


def timing_sentence(plan: Plan) -> str:
    """Return what waypoints leave out."""
    who = "the vehicle keeps" if plan.scenario.num_vehicles == 1 else "all vehicles keep"
    return (
        f"waypoints carry no time: the risk bound {plan.scenario.risk_bound:g} holds only if "
        f"{who} the plan's timing"
    )


def origin_sentence(placement: Placement) -> str:
    """Return where the plan's local coordinates are zero."""
    origin = placement.origin
    return (
        f"origin of the plan: latitude {origin.latitude:.9g}, longitude {origin.longitude:.9g}, "
        f"{origin.height:g} m above the WGS84 ellipsoid"
    )
