"""The numbers that warm candidates were tuned with, in one record."""

from __future__ import annotations

from radmpc.records import dataclass

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class Tuning:
    """How often half-spaces are turned at a tick, and at which price.

    A value that was measured names the scenes; of the others no measurement is recorded.

    Attributes
    ----------
    rounds : int
        Programs per group and tick at most [-].
    safest_rounds : int
        The same where the least risk is asked for [-].
    spacing : float
        Between clearances at which risk is interpolated around the latest [standard deviations].
    near : float
        Clearance below which vehicles share a program [standard deviations].
    aim : float
        Share of the grant that a candidate is to cost [-].
    price_steps : tuple of float
        Least and largest factor on the price from one round to the next [-].
    out_of_reach : float
        Share of the highest price above which goals count as out of reach of the grant [-].
    wasted : float
        Share of the grant below which plans that may miss their goals are made anew at a lower
        price [-].
    damping : float
        Power of the ratio of price and grant that the price of risk follows [-].
    first_dear : float
        Price of risk at the first tick: this multiple of what flying costs per Δ [-].
    cheapest, dearest : float
        What flying costs per grant: the price of risk is this multiple of it at least and at most
        [-]. Above 10 it took steps to come back down from where goals could not be reached within
        the grant: `paper(8)` without feedback, four times its deviations, flew at 45.8 instead of
        41.8 with ten thousand, 42.8 with a hundred, 41.7 with 5; `paper(4)`, `circle(4)` and all
        with feedback alike.
    safest : float
        Where the least risk is asked for [-].
    first_ratio, ratios : float, tuple of float
        Certificate per risk of the half-spaces: before any is known, least and most believed [-].
    least_cost : float
        Effort that flying costs at least where prices are made of it [-].
    """

    rounds: int = 3
    safest_rounds: int = 2
    spacing: float = 0.05
    near: float = 6.5
    aim: float = 0.9
    price_steps: tuple[float, float] = (0.15, 8.0)
    out_of_reach: float = 0.5
    wasted: float = 0.5
    damping: float = 0.8
    first_dear: float = 1.0
    cheapest: float = 1e-2
    dearest: float = 10.0
    safest: float = 1e4
    first_ratio: float = 0.8
    ratios: tuple[float, float] = (0.02, 2.0)
    least_cost: float = 1e-3


TUNING = Tuning()
"""The values in use."""
