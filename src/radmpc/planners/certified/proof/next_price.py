"""Which price of risk a proof tries next."""

from __future__ import annotations

from radmpc.planners.certified.proof.tuning import TUNING

__all__ = ["better_price"]


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
