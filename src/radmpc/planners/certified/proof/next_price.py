"""Which price of risk a proof tries next."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from radmpc.planners.certified.proof.tuning import TUNING

if TYPE_CHECKING:
    # Vehicles without conflicts need no relaxation.
    from radmpc.planners.certified.proof.relaxed_set import RelaxedSet

__all__ = ["better_price", "risk_share"]


def better_price(price: float, ratio: float | None, most_step: float = TUNING.most_step) -> float:
    """Return a price at which relaxed plans may risk about Δ; the same where they do.

    Parameters
    ----------
    price : float
        Where they were searched, per unit of probability.
    ratio : float or None
        What they risk there, as a share of Δ [-]; None where that says nothing.
    most_step : float
        The largest factor between the two prices [-].
    """
    if ratio is None or price <= 0.0 or 1.0 / TUNING.off < ratio < TUNING.off:
        return price
    return price * min(max(ratio, 1.0 / most_step), most_step)


def risk_share(found: Iterable[RelaxedSet], risk_bound: float) -> float | None:
    """Return what relaxed plans risk [-]; None where there are no conflicts.

    Parameters
    ----------
    found : iterable of RelaxedSet
        Parts that were searched.
    risk_bound : float
        Δ, of which it is a share.
    """
    risks = [one.best.risk for one in found if one.best is not None and not one.is_trivial]
    return sum(risks) / risk_bound if risks else None
