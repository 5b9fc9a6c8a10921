"""Identified noise on one screen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from rich.table import Table
from rich.text import Text

from radmpc.console.reports.report import facts
from radmpc.identification.estimate import Estimate
from radmpc.identification.identify import Identification
from radmpc.identification.intervals import Interval
from radmpc.identification.sharing import Shared
from radmpc.identification.tails import Tails
from radmpc.identification.unknown import misfit_of_color
from radmpc.importing.logs.applying import recorded
from radmpc.importing.logs.block import acts_on_measured
from radmpc.wording import count_text

__all__ = ["noise_report", "tails_sentence"]

_MOST_GROUPS = 8
"""Vehicles that a table lists by themselves; the rest stands in the file."""

_LEAST_CORRELATION = 0.2
"""Correlation [-] below which it does not get a row; the file has all of them."""

_KNOWN = {
    "commands": "controls are the logged commands",
    "references": "controls are feedback to the logged references",
    "states": "controls are not logged: maneuvers count as noise",
}

Row = tuple[str, str, str, str]


def noise_report(identified: Identification) -> list[Table | Text]:
    """Return what was identified as parts to show.

    Parameters
    ----------
    identified : Identification
        What logs tell.

    Returns
    -------
    list of Table or Text
        From top to bottom.
    """
    parts: list[Table | Text] = [
        Text(_title(identified), style="bold"),
        facts(_facts(identified)),
        Text(),
    ]
    groups = identified.groups[:_MOST_GROUPS]
    for one in groups:
        parts += [_table(one, identified), Text()]
    if len(identified.groups) > len(groups):
        parts.append(
            Text(f"and {count_text(len(identified.groups) - len(groups), 'more vehicle')}")
        )
    parts += [Text(f"not told: {sentence}") for sentence in identified.unknown]
    parts += [Text(f"warning: {warning}", style="yellow") for warning in identified.warnings]
    return parts


def _title(identified: Identification) -> str:
    """Return from what it was identified, in one line."""
    kind = "double" if identified.model.has_velocity else "single"
    names = ", ".join(identified.sources[:3]) + (", …" if len(identified.sources) > 3 else "")
    return (
        f"{names}: {count_text(len(identified.pooled.vehicles), 'vehicle')}, "
        f"{count_text(identified.pooled.num_steps, 'step')} of {identified.model.dt:g} s, "
        f"{kind} integrator in {identified.model.dimension}-D"
    )


def _facts(identified: Identification) -> dict[str, Text | str]:
    """Return what is said in words."""
    pooled = identified.pooled
    rows: dict[str, Text | str] = {"model": _KNOWN[identified.evidence]}
    if identified.start is not None:
        rows["recorded"] = recorded(identified.start)
    rows["worth"] = f"about {count_text(round(pooled.worth), 'independent step')}"
    if len(identified.each) > 1:
        rows["vehicles"] = (
            "differ beyond chance: each has its own numbers"
            if identified.differ
            else "do not differ beyond chance: one set of numbers"
        )
    if pooled.tails is not None:
        style = "yellow" if pooled.tails.are_heavy else ""
        rows["tails"] = Text(tails_sentence(pooled.tails), style=style)
    if any(acts_on_measured(one, identified.model) for one in identified.groups):
        rows["feedback"] = (
            "acts on the measured states: their noise counts as disturbance in what is written"
        )
    misfits = [(one, misfit) for one in identified.groups if (misfit := misfit_of_color(one))]
    if misfits:
        told = [
            f"{one.vehicles[0]}: {text}" if identified.differ else text for one, text in misfits
        ]
        rows["memory"] = Text("; ".join(told[:_MOST_GROUPS]), style="yellow")
    shared = identified.shared
    if shared is not None:
        rows["shared"] = _share_sentence(shared)
    return rows


def _share_sentence(shared: Shared) -> str:
    """Return how much of the noise vehicles have in common."""
    parts = []
    if shared.is_sure:
        low, high = max(float(shared.share.low), 0.0), min(float(shared.share.high), 1.0)
        parts.append(
            f"{100 * float(shared.share.value):.0f} % of the variance is common to vehicles at "
            f"equal times ({100 * low:.0f} to {100 * high:.0f} %)"
        )
    elif shared.is_mixed:
        alike = f"alike are {_listed(shared.alike)}" if shared.alike else "no pair is surely alike"
        parts.append(f"pairs of vehicles differ, so no shared part is written: {alike}")
    elif not shared.opposed:
        parts.append("vehicles' noise at equal times is no more alike than by chance")
    if shared.opposed:
        parts.append(
            f"opposite is the noise of {_listed(shared.opposed)}: such pairs are less "
            "safe than independent ones, so covariances are written "
            f"{1.0 + shared.opposition:.3g} times as large"
        )
    return "; ".join(parts)


def _listed(pairs: Sequence[tuple[str, str]]) -> str:
    """Return some pairs of vehicles."""
    told = ", ".join(f"{one} and {other}" for one, other in pairs[:_MOST_GROUPS])
    rest = len(pairs) - _MOST_GROUPS
    return told if rest <= 0 else f"{told} and {rest} more pairs"


def tails_sentence(kind: Tails) -> str:
    """Return how residuals are distributed, in words.

    Parameters
    ----------
    kind : Tails
        What a test found.
    """
    test = f"Anderson-Darling p = {kind.chance:.2g}, excess kurtosis {kind.excess_kurtosis:.2g}"
    if kind.is_gaussian:
        return f"Gaussian: nothing speaks against it ({test})"
    if not kind.are_heavy:
        return f"not quite Gaussian, though not heavy-tailed ({test})"
    return (
        f"heavier than Gaussian: like Student-t with about {kind.freedom:.2g} degrees of freedom "
        f"({kind.freedom_low:.2g} to {kind.freedom_high:.2g}; {test}): "
        "large single disturbances are more likely than plans assume"
    )


def _table(one: Estimate, identified: Identification) -> Table:
    """Return numbers with their intervals."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column(one.vehicles[0] if identified.differ else "per step", no_wrap=True)
    table.add_column("value", justify="right", no_wrap=True)
    table.add_column("95 % interval", justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for row in _rows(one, identified):
        table.add_row(*row)
    return table


def _rows(one: Estimate, identified: Identification) -> Iterator[Row]:
    """Return a table's rows."""
    model, d = identified.model, identified.model.dimension
    names = [*"xyz"[:d], *(f"v{axis}" for axis in "xyz"[:d])][: model.num_states]
    units = ["m"] * d + ["m/s"] * d
    upper = " at most" if one.is_bound else ""
    for i, name in enumerate(names):
        yield _root(f"disturbance of {name}, std. dev.{upper}", one.covariance, i, units[i])
    yield from _correlations(one.covariance, names)
    if model.has_velocity or identified.evidence != "states":
        for i in range(d):
            current = _scaled(one.drift, i, 1.0 / model.dt)
            yield _row(f"drift of {names[i]}", *current, "m/s")
        for i in range(d, model.num_states):
            if np.isfinite(one.drift.value[i]):
                yield _row(f"push on {names[i]}", *_scaled(one.drift, i, 1.0 / model.dt), "m/s²")
    if one.time_constant is not None:
        constant = one.time_constant
        ends = (float(constant.low), float(constant.high))
        yield _row("time constant", float(constant.value), *ends, "s")
    if one.measurement is not None:
        for i, name in enumerate(names):
            if one.measurement.value[i, i] > 0.0:
                yield _sensed(name, one.measurement, i, units[i])
    if one.gain is not None:
        yield from _gains(one.gain, names, model.has_velocity)


def _gains(gain: Interval, names: Sequence[str], has_velocity: bool) -> Iterator[Row]:
    """Return the rows of a gain: those of an axis to itself, and others that are beyond chance."""
    d = gain.value.shape[0]
    order = 2 if has_velocity else 1
    for i in range(d):
        for j, name in enumerate(names):
            is_sure = gain.low[i, j] > 0.0 or gain.high[i, j] < 0.0
            if (j % d == i or is_sure) and np.isfinite(gain.high[i, j]):
                unit = "1/s²" if order == 2 and j < d else "1/s"
                entry = (gain.value[i, j], gain.low[i, j], gain.high[i, j])
                yield _row(
                    f"feedback {'a' if order == 2 else 'v'}{'xyz'[i]} by {name}", *entry, unit
                )


def _correlations(covariance: Interval, names: Sequence[str]) -> Iterator[Row]:
    """Return correlations of the disturbance that are beyond chance, and matter."""
    scale = np.sqrt(np.maximum(np.diag(covariance.value), 1e-300))
    for i in range(len(names)):
        for j in range(i + 1, len(names)):
            size = scale[i] * scale[j]
            low, high = covariance.low[i, j] / size, covariance.high[i, j] / size
            is_sure = low > 0.0 or high < 0.0
            if is_sure and abs(covariance.value[i, j]) >= _LEAST_CORRELATION * size:
                ends = max(low, -1.0), min(high, 1.0)
                value = covariance.value[i, j] / size
                yield _row(f"correlation of {names[i]} and {names[j]}", value, *ends, "")


def _scaled(interval: Interval, i: int, factor: float) -> tuple[float, float, float]:
    """Return one entry's value and ends by a factor."""
    return (
        factor * float(interval.value[i]),
        factor * float(interval.low[i]),
        factor * float(interval.high[i]),
    )


def _root(name: str, covariance: Interval, i: int, unit: str) -> Row:
    """Return the row of a standard deviation."""
    value, low, high = (
        float(np.sqrt(max(part[i, i], 0.0)))
        for part in (covariance.value, covariance.low, covariance.high)
    )
    return _row(name, value, low, high, unit)


def _sensed(name: str, measurement: Interval, i: int, unit: str) -> Row:
    """Return the row of the noise of a state's measurement: where it may be none, its upper end."""
    row = _root(f"measurement of {name}, std. dev.", measurement, i, unit)
    if measurement.low[i, i] > 0.0:
        return row
    high = float(np.sqrt(measurement.high[i, i]))
    return row[0], row[1], f"not identifiable, at most {high:.3g}", unit


def _row(name: str, value: float, low: float, high: float, unit: str) -> Row:
    """Return a row of a table."""
    return name, f"{value:.3g}", f"{low:.3g} to {high:.3g}", unit
