"""Rows aggregated: one summary per method and fleet size."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from radmpc.experiments.study.trial import Row
from radmpc.records import dataclass

__all__ = ["Quantiles", "Speedup", "Summary", "speedup", "summarize"]

_LOW, _HIGH = 10.0, 90.0
"""Percentiles beside the median."""


@dataclass(frozen=True, slots=True)
class Quantiles:
    """Median and spread.

    Attributes
    ----------
    low, median, high : float
        The 10th, 50th and 90th percentile.
    """

    low: float
    median: float
    high: float

    @classmethod
    def of(cls, values: Iterable[float]) -> Quantiles | None:
        """Return the quantiles of some values; None without any."""
        known = list(values)
        if not known:
            return None
        return cls(*(float(q) for q in np.percentile(known, [_LOW, 50.0, _HIGH])))


@dataclass(frozen=True, slots=True)
class Summary:
    """One method on all problems of one size.

    Attributes
    ----------
    method : str
        Its name.
    vehicles : int
        N.
    problems, plans, capped : int
        Problems tried, those with a plan, and those that the cap ended.
    successes : int
        Plans that collide in at most Δ of the samples.
    surely_over : int
        Plans whose collision rate is above Δ with 95 % confidence: the lower end of its interval.
    over : int
        Plans whose certificate exceeds Δ.
    coupled_wrong : int
        Plans with a pair of different sets above the coupling threshold.
    seconds : Quantiles or None
        Of planning [s]; capped runs count at the cap.
    is_censored : bool
        Whether the median itself is that of a capped run: a lower bound.
    free : Quantiles or None
        Share of samples without a collision.
    above_bound : Quantiles or None
        Cost over the proven bound of the same problem, less one.
    used : Quantiles or None
        Certificate over Δ.
    """

    method: str
    vehicles: int
    problems: int
    plans: int
    capped: int
    successes: int
    surely_over: int
    over: int
    coupled_wrong: int
    seconds: Quantiles | None
    is_censored: bool
    free: Quantiles | None
    above_bound: Quantiles | None
    used: Quantiles | None


def summarize(rows: Sequence[Row], risk_bound: float) -> tuple[Summary, ...]:
    """Return a summary per method and size, in the order in which they first appear.

    Parameters
    ----------
    rows : sequence of Row
        At most one per task.
    risk_bound : float
        Δ of the problems.
    """
    bounds = {(r.vehicles, r.seed): r.lower_bound for r in rows if r.lower_bound is not None}
    groups: dict[str, dict[int, list[Row]]] = {}
    for row in rows:
        groups.setdefault(row.method, {}).setdefault(row.vehicles, []).append(row)
    return tuple(
        _summary(method, n, sizes[n], bounds, risk_bound)
        for method, sizes in groups.items()
        for n in sorted(sizes)
    )


def _summary(
    method: str,
    vehicles: int,
    rows: Sequence[Row],
    bounds: dict[tuple[int, int], float],
    risk_bound: float,
) -> Summary:
    """Return one summary."""
    capped = [row for row in rows if row.is_capped]
    seconds = Quantiles.of(
        min(row.seconds, row.cap) if row.is_capped else row.seconds for row in rows
    )
    excess = []
    for row in rows:
        bound = bounds.get((row.vehicles, row.seed))
        if row.cost is not None and bound:
            excess.append(row.cost / bound - 1.0)
    certified = [row.certified for row in rows if row.certified is not None]
    return Summary(
        method=method,
        vehicles=vehicles,
        problems=len(rows),
        plans=sum(row.has_plan for row in rows),
        capped=len(capped),
        successes=sum(row.is_success(risk_bound) for row in rows),
        surely_over=sum((row.rate_low or 0.0) > risk_bound for row in rows),
        over=sum(value > risk_bound for value in certified),
        coupled_wrong=sum(bool(row.missed) for row in rows),
        seconds=seconds,
        is_censored=2 * len(capped) >= len(rows),
        free=Quantiles.of(1.0 - row.rate for row in rows if row.rate is not None),
        above_bound=Quantiles.of(excess),
        used=Quantiles.of(min(value, 1.0) / risk_bound for value in certified),
    )


@dataclass(frozen=True, slots=True)
class Speedup:
    """How many times as long a reference takes, on the problems that both solved or it was capped.

    Attributes
    ----------
    problems, capped : int
        Compared, and of them those where the reference was counted at the cap.
    mean, geometric, least, most : float
        Of the ratios; lower bounds where any was capped.
    """

    problems: int
    capped: int
    mean: float
    geometric: float
    least: float
    most: float


def speedup(
    rows: Sequence[Row],
    reference: str,
    method: str,
    vehicles: int,
    *,
    seconds: Callable[[Row], float] = lambda row: row.seconds,
) -> Speedup | None:
    """Return how much faster a method is than a reference at one size; None without problems.

    Parameters
    ----------
    rows : sequence of Row
        All rows.
    reference, method : str
        Names of methods.
    vehicles : int
        N.
    seconds : callable
        What counts.
    """
    slow = {r.seed: r for r in rows if r.method == reference and r.vehicles == vehicles}
    fast = {r.seed: r for r in rows if r.method == method and r.vehicles == vehicles}
    pairs = [
        (slow[seed], fast[seed])
        for seed in sorted(slow.keys() & fast.keys())
        if fast[seed].has_plan and (slow[seed].has_plan or slow[seed].is_capped)
    ]
    if not pairs:
        return None
    ratios = [
        (min(seconds(one), one.cap) if one.is_capped else seconds(one)) / seconds(two)
        for one, two in pairs
    ]
    return Speedup(
        problems=len(pairs),
        capped=sum(one.is_capped for one, _ in pairs),
        mean=statistics.fmean(ratios),
        geometric=statistics.geometric_mean(ratios),
        least=min(ratios),
        most=max(ratios),
    )
