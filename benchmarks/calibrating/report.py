"""What the trials say, as a Markdown text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from scipy.special import bdtrc, betaincinv

from calibrating.trial import Trial

__all__ = ["doubtful", "lower_limit", "report", "second_look", "violations", "world_violations"]

_LEVEL = 0.05
_LEAST_HITS = 20
_QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
_ROUNDING = 1e-6
"""Slack for "not above": the exact integral is within this share of the true value."""


def lower_limit(hits: int, samples: int, level: float) -> float:
    """Return the one-sided lower Clopper-Pearson limit: above the truth with chance <= level."""
    return 0.0 if hits <= 0 else float(betaincinv(hits, samples - hits + 1, level))


def violations(plans: Sequence[Trial], level: float) -> list[Trial]:
    """Return the plans whose rate is surely above their certificate, each at this level."""
    return [t for t in plans if lower_limit(t.hits, t.samples, level) > t.certified]


def world_violations(plans: Sequence[Trial], level: float) -> list[Trial]:
    """Return the same of missions in the world, of those plans that were flown there."""
    flown = [t for t in plans if t.world_hits >= 0]
    return [t for t in flown if lower_limit(t.world_hits, t.world_samples, level) > t.certified]


def doubtful(trials: Sequence[Trial]) -> list[Trial]:
    """Return the plans that collide, the least likely under their certificate first."""
    # The chance of as many hits under the certificate, if that were the truth: a binomial's tail.
    chances = {
        t.index: float(bdtrc(t.hits - 1, t.samples, min(t.certified, 1.0)))
        for t in trials
        if t.hits > 0
    }
    found = [t for t in trials if t.index in chances]
    return sorted(found, key=lambda t: chances[t.index])


def second_look(trials: Sequence[Trial]) -> list[str]:
    """Return a table of single plans: certificate and rate with its 95 % interval."""
    lines = [
        f"**Second look**, {trials[0].samples:,} flights each",
        "",
        "| trial | certificate | rate | 95 % interval |",
        "|---|---|---|---|",
    ]
    for t in trials:
        low = lower_limit(t.hits, t.samples, 0.025)
        high = 1.0 - lower_limit(t.samples - t.hits, t.samples, 0.025)
        lines.append(f"| {t.index} | {t.certified:.6g} | {t.rate:.6g} | {low:.6g} to {high:.6g} |")
    return lines


def report(trials: Sequence[Trial]) -> list[str]:
    """Return the lines of the report."""
    plans = [t for t in trials if t.has_plan]
    if not plans:
        return ["no plans yet"]
    return [
        *_overview(trials, plans),
        *_soundness(plans),
        *_in_the_world(plans),
        *_tightness(plans),
        *_own_bounds(plans),
        *_bounds_kept(plans),
        *_slack(plans),
    ]


def _overview(trials: Sequence[Trial], plans: Sequence[Trial]) -> list[str]:
    """Return what was tried."""
    flights = sum(t.samples for t in plans)
    seconds = [float(np.median([getattr(t, name) for t in plans])) for name in _SECONDS]
    states = Counter(t.status for t in trials if not t.has_plan)
    failed = ", ".join(f"{count} {status}" for status, count in sorted(states.items()))
    rates = np.array([t.rate for t in plans])
    return [
        f"{len(trials)} scenarios, {len(plans)} plans ({failed or 'none'} without), "
        f"{flights:,} flights; seed {plans[0].seed}.",
        f"Medians: planning {seconds[0]:.3f} s, certificate {seconds[1]:.4f} s, "
        f"{plans[0].samples:,} flights {seconds[2]:.3f} s.",
        f"{np.mean(rates > 0.1):.0%} of the plans collide in more than 10 % of their flights, "
        f"{np.mean(rates < 1e-3):.0%} in less than 0.1 %.",
        "",
        *_counts("planner", plans),
        *_counts("vehicles", plans),
        *_counts("dimension", plans),
        *_counts("avoidance", plans),
        f"plans with problems besides their risk: {sum(t.problems > 0 for t in plans)}",
        "",
    ]


_SECONDS = ("plan_seconds", "certify_seconds", "fly_seconds")


def _counts(name: str, plans: Sequence[Trial]) -> list[str]:
    """Return how many plans there are of each kind."""
    counts = Counter(getattr(t, name) for t in plans)
    return [f"- {name}: " + ", ".join(f"{key} {counts[key]}" for key in sorted(counts))]


def _soundness(plans: Sequence[Trial]) -> list[str]:
    """Return (a): whether the certificate is ever below the rate."""
    strict = violations(plans, _LEVEL / len(plans))
    loose = violations(plans, _LEVEL)
    found = [t for t in plans if t.hits >= _LEAST_HITS]
    lines = [
        "**(a) Sound?**",
        "",
        f"Lower limits above the certificate, at level {_LEVEL}/{len(plans)} each: "
        f"**{len(strict)}** of {len(plans)} (none should be).",
        f"The same at level {_LEVEL} each, without the allowance: {len(loose)} "
        f"(chance alone may give up to {_LEVEL * len(plans):.0f}).",
    ]
    lines += [
        f"- VIOLATION: {t.index} ({t.planner}), {t.certified:.6g}, {t.rate:.6g}" for t in strict
    ]
    if found:
        least = min(found, key=lambda t: t.certified / t.rate)
        lines.append(
            f"Smallest certificate/rate with at least {_LEAST_HITS} hits: "
            f"{least.certified / least.rate:.3f} ({least.hits} hits)."
        )
    return [*lines, ""]


def _in_the_world(plans: Sequence[Trial]) -> list[str]:
    """Return whether the certificate is ever below the rate in the world, by what was added."""
    flown = [t for t in plans if t.world_hits >= 0]
    if not flown:
        return []
    strict = world_violations(flown, _LEVEL / len(flown))
    lines = [
        f"In the world as it is measured, {flown[0].world_samples:,} missions each without the "
        f"referee: **{len(strict)}** of {len(flown)} above at level {_LEVEL}/{len(flown)}, "
        f"{len(world_violations(flown, _LEVEL))} at level {_LEVEL}.",
        "",
        "| with | plans | above | certificate over rate there, median |",
        "|---|---|---|---|",
    ]
    for name in sorted({name for t in flown for name in t.noise.split("+")}):
        chosen = [t for t in flown if name in t.noise.split("+")]
        above = sum(t in strict for t in chosen)
        ratios = [
            t.certified * t.world_samples / t.world_hits
            for t in chosen
            if t.world_hits >= _LEAST_HITS
        ]
        middle = f"{np.median(ratios):.2f}" if ratios else "–"
        lines.append(f"| {name} | {len(chosen)} | {above} | {middle} |")
    lines += [
        f"- VIOLATION: {t.index} ({t.planner}, {t.noise}), {t.certified:.6g}, "
        f"{t.world_hits / t.world_samples:.6g}"
        for t in strict
    ]
    return [*lines, ""]


def _tightness(plans: Sequence[Trial]) -> list[str]:
    """Return (b): how far above the rate the certificate is."""
    rows: list[tuple[str, list[float]]] = []
    for avoidance in ("all", "steps", "intervals"):
        chosen = [t for t in plans if avoidance in {"all", t.avoidance}]
        rows.append((avoidance, _ratios(chosen, "certified", "hits")))
        for cause in ("pair", "obstacle", "workspace"):
            ratios = _ratios(chosen, f"certified_{cause}", f"hits_{cause}")
            rows.append((f"{avoidance}, {cause}", ratios))
    small = [t for t in plans if t.certified <= t.bound]
    rows.append(("within Δ, steps", _ratios(_of(small, "steps"), "certified", "hits")))
    rows.append(("within Δ, intervals", _ratios(_of(small, "intervals"), "certified", "hits")))
    return [
        f"**(b) Tight?** Certificate over rate, where there are {_LEAST_HITS} hits",
        "",
        *_table(rows),
        "",
    ]


def _of(plans: Iterable[Trial], avoidance: str) -> list[Trial]:
    """Return the plans of one kind of avoidance."""
    return [t for t in plans if t.avoidance == avoidance]


def _ratios(plans: Iterable[Trial], certified: str, hits: str) -> list[float]:
    """Return certificates over rates, where the rate is resolved."""
    return [
        getattr(t, certified) * t.samples / getattr(t, hits)
        for t in plans
        if getattr(t, hits) >= _LEAST_HITS
    ]


def _own_bounds(plans: Sequence[Trial]) -> list[str]:
    """Return (c): the referee's bound over the planner's own."""
    # Pairs across sets are not in the planner's count, so only plans of one set compare.
    own = [t for t in plans if np.isfinite(t.own) and t.own > 1e-9 and t.num_sets == 1]
    rows = [
        (avoidance, [t.certified_later / t.own for t in _of(own, avoidance)])
        for avoidance in ("steps", "intervals")
    ]
    above = [t for t in own if t.certified_later > t.own * (1.0 + _ROUNDING)]
    return [
        "**(c) The planner's own count.** Referee's bound over IRA's, steps 1 to T, one set",
        "",
        *_table(rows),
        "",
        f"Referee above planner: {len(above)} of {len(own)}.",
        "",
    ]


def _bounds_kept(plans: Sequence[Trial]) -> list[str]:
    """Return (d): whether a plan that holds keeps its Δ."""
    holding = [t for t in plans if t.holds]
    level = _LEVEL / len(plans)
    broken = [t for t in holding if lower_limit(t.hits, t.samples, level) > t.bound]
    used = [("certificate", [t.certified / t.bound for t in holding])]
    used.append(("rate", [t.rate / t.bound for t in holding]))
    return [
        "**(d) Kept?** Plans that hold, as a share of their Δ",
        "",
        *_table(used),
        "",
        f"Lower limits above Δ: **{len(broken)}** of {len(holding)} that hold (none should be).",
        "",
    ]


def _slack(plans: Sequence[Trial]) -> list[str]:
    """Return (e): what makes the certificate larger than the rate, factor by factor."""
    factors: tuple[tuple[str, Callable[[Trial], float]], ...] = (
        ("bound of single events", lambda t: t.certified * t.samples / t.overlap_events),
        ("one encounter, several windows", lambda t: t.overlap_events / t.overlap_encounters),
        ("several encounters, one flight", lambda t: t.overlap_encounters / t.overlap_joint),
        ("all", lambda t: t.certified * t.samples / t.overlap_joint),
    )
    lines = ["**(e) Slack, factor by factor**", ""]
    rows: list[tuple[str, list[float]]] = []
    for avoidance in ("steps", "intervals"):
        found = [t for t in _of(plans, avoidance) if t.overlap_joint >= _LEAST_HITS]
        rows += [(f"{avoidance}: {name}", [factor(t) for t in found]) for name, factor in factors]
    lines += [*_table(rows), ""]
    # An encounter that surely happens is charged once, however many steps it lasts.
    flat = [t for t in _of(plans, "steps") if t.dimension == 2 and t.overlap_events > 0]
    flat = [t for t in flat if t.certified < 1.0]
    pairs = [t for t in flat if t.certified_obstacle == t.certified_workspace == 0.0]
    lines += _pooled("Steps in the plane", flat) + _pooled("Of these, pairs alone", pairs)
    return lines


def _pooled(name: str, plans: Sequence[Trial]) -> list[str]:
    """Return events asked for and counted: equal but for chance where the bound is exact."""
    if not plans:
        return []
    expected = sum(t.certified * t.samples for t in plans)
    counted = sum(t.overlap_events for t in plans)
    return [
        f"{name}, pooled over {len(plans)} plans: certificates ask for {expected:,.0f} events, "
        f"{counted:,} were counted: ratio {expected / counted:.4f}.",
    ]


def _table(rows: Iterable[tuple[str, Sequence[float]]]) -> list[str]:
    """Return quantiles as a table."""
    heads = ["least", *(f"{q:.0%}" for q in _QUANTILES[1:-1]), "most"]
    lines = ["| | plans | " + " | ".join(heads) + " |", "|---|" + "---|" * (len(heads) + 1)]
    for name, values in rows:
        cells = [f"{value:.3g}" for value in np.quantile(values, _QUANTILES)] if values else []
        cells += ["–"] * (len(heads) - len(cells))
        lines.append(f"| {name} | {len(values)} | " + " | ".join(cells) + " |")
    return lines
