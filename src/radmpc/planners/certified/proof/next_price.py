"""Which price of risk a proof tries next."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from radmpc.planners.certified.proof.tuning import TUNING

if TYPE_CHECKING:
    # Who meets nobody needs no relaxation.
    from radmpc.planners.certified.proof.relaxed_set import RelaxedSet

__all__ = ["better_price", "risk_of"]


def better_price(price: float, ratio: float, most_step: float = TUNING.most_step) -> float:
    """Return a price at which relaxed plans may risk about Δ; the same where they do.

    Parameters
    ----------
    price : float
        Where they were searched, per unit of probability.
    ratio : float
        What they risk there, as a share of Δ [-].
    most_step : float
        The largest factor between the two prices [-].
    """
    if price <= 0.0 or 1.0 / TUNING.off < ratio < TUNING.off:
        return price
    return price * min(max(ratio, 1.0 / most_step), most_step)


def risk_of(found: Iterable[RelaxedSet]) -> float | None:
    """Return what relaxed plans risk; None where nobody meets anything, which says nothing.

    Parameters
    ----------
    found : iterable of RelaxedSet
        Parts that were searched.
    """
    risks = [one.best.risk for one in found if one.best is not None and not one.is_trivial]
    return sum(risks) if risks else None
