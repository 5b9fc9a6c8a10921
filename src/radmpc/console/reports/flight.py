"""What a flight comes to, as JSON and as a report."""

from __future__ import annotations

from collections import Counter

from rich.table import Table
from rich.text import Text

from radmpc.console.reports.report import facts
from radmpc.console.reports.saturating import NOTHING
from radmpc.console.words import scenario_line
from radmpc.flying.recording.summary import FlightSummary
from radmpc.io.flight.record import FlightRecord, FlownMission
from radmpc.wording import count_text

__all__ = ["flight_json", "flight_report", "flight_rows"]

_OFTEN = 0.05
"""Share of ticks at which disturbances speak against the model that is no chance any more [-]: by
chance it is some 0.001."""

_MOST_ALARMS = 5
"""Alarms that a report quotes."""


def flight_json(record: FlightRecord, summary: FlightSummary) -> dict[str, object]:
    """Return what a flight comes to as plain values.

    Parameters
    ----------
    record : FlightRecord
        What was flown.
    summary : FlightSummary
        What it comes to.
    """
    flown, settings = summary.flown, record.settings
    return {
        "scenario": record.plan.scenario.name,
        "with": settings.backend,
        "replan": settings.replan,
        "seed": settings.seed,
        "deadline": settings.deadline,
        "missions": summary.missions,
        "missions_asked": summary.asked,
        "holds": summary.contradiction is None,
        "rate": None if flown is None else flown.rate,
        "rate_low": None if flown is None else flown.rate_low,
        "rate_high": None if flown is None else flown.rate_high,
        "bound": summary.bound,
        "certified": summary.certified,
        "effort": summary.effort,
        "effort_planned": summary.effort_planned,
        "miss": summary.miss,
        "saturation": None if flown is None else flown.saturation_rate,
        "accepted": summary.accepted,
        "adopted": summary.adopted,
        "alarms": summary.alarms,
        "ticks": summary.ticks,
        "tick_p50": summary.tick_p50,
        "tick_p99": summary.tick_p99,
        "tick_max": summary.tick_max,
        "late": summary.late,
        "cut_off": summary.cut_off,
    }


def flight_report(record: FlightRecord, summary: FlightSummary) -> list[Table | Text]:
    """Return the same as parts to show; of a single mission the account, tick by tick.

    Parameters
    ----------
    record : FlightRecord
        What was flown.
    summary : FlightSummary
        What it comes to.
    """
    parts: list[Table | Text] = [
        Text(scenario_line(record.plan.scenario), style="bold"),
        facts(flight_rows(record, summary)),
    ]
    missions = record.missions
    if len(missions) == 1:
        parts += [Text(), _account(missions[0])]
    return parts


def flight_rows(record: FlightRecord, summary: FlightSummary) -> dict[str, Text | str]:
    """Return what there is to say of a flight, by name.

    Parameters
    ----------
    record : FlightRecord
        What was flown.
    summary : FlightSummary
        What it comes to.
    """
    settings = record.settings
    planner = "the plan as it is" if settings.replan is None else f"anew by {settings.replan}"
    rows: dict[str, Text | str] = {
        "flown": f"{summary.missions} of {summary.asked} missions, with "
        f"{settings.backend}, {'' if settings.replan is None else 'planned '}{planner}",
        "risk bound": f"{summary.bound:g} (certificate at the start: {summary.certified:.4g})",
    }
    flown = summary.flown
    if flown is not None:
        text = (
            f"{flown.collisions} of {flown.samples} missions collide: "
            f"{flown.rate:.4g} ({flown.rate_low:.4g} to {flown.rate_high:.4g} with 95 % confidence)"
        )
        rows["collisions"] = text if summary.contradiction is None else Text(text, style="bold red")
        hits = _hits(record)
        if hits:
            rows["hit"] = Text(hits, style="red")
        rows["effort"] = f"{summary.effort:.6g} as flown, {summary.effort_planned:.6g} as planned"
        if summary.miss is not None:
            rows["goals"] = f"missed by {summary.miss:.2g} m, the mean of all vehicles"
        rows["saturation"] = f"controls saturate in {flown.saturated} of {flown.samples} missions"
    if summary.accepted is not None and settings.replan is not None:
        rows["replans"] = f"{summary.adopted} adopted, at {100.0 * summary.accepted:.3g} % of ticks"
    scale = record.rows[-1].scale if record.rows else None
    if scale is not None:
        rows["covariances"] = (
            f"stated ones times {scale.factor:.3g}, as known from {scale.samples} samples "
            "by the end"
        )
    rows["alarms"] = _alarms(record, summary)
    if summary.tick_p50 is not None:
        rows["a tick takes"] = (
            f"{summary.tick_p50:.3g} s (median), {summary.tick_p99:.3g} s (99 %), "
            f"{summary.tick_max:.3g} s (longest)"
        )
    if summary.late is not None:
        rows["deadline"] = _deadline(settings.deadline or 0.0, summary)
    return rows


def _deadline(seconds: float, summary: FlightSummary) -> str:
    """Return what a deadline kept from being told or found."""
    return (
        f"{seconds:g} s, missed at {count_text(summary.late or 0, 'tick')}; "
        f"too short for a new leg at {count_text(summary.cut_off or 0, 'tick')}"
    )


def _hits(record: FlightRecord) -> str:
    """Return what was hit, left or lost, and in how many missions."""
    found: Counter[str] = Counter()
    for mission in record.missions:
        found.update(
            {f"{t.vehicle} out of range of {t.other}" if t.cause == "range"
             else f"{t.vehicle} and {t.other}" if t.other
             else f"{t.vehicle} out of the workspace"
             for t in mission.contacts}
        )  # fmt: skip
    return ", ".join(f"{what} ({count})" for what, count in found.most_common())


def _alarms(record: FlightRecord, summary: FlightSummary) -> Text | str:
    """Return how many alarms there were, and the first of them."""
    if not summary.alarms:
        return "none"
    told = [
        f"step {row.step}: {alarm}" if summary.asked == 1
        else f"mission {row.mission + 1}, step {row.step}: {alarm}"
        for row in record.rows
        for alarm in row.alarms
    ]  # fmt: skip
    hidden = len(told) - _MOST_ALARMS
    more = [f"{hidden} more"] if hidden > 0 else []
    strange = sum(any("disturbance" in alarm for alarm in row.alarms) for row in record.rows)
    if record.settings.backend != "model" and strange > _OFTEN * len(record.rows):
        more.append(
            f"{record.settings.backend} has other noise than the scenario, of which the "
            "certificate speaks: radmpc calibrate learns it"
        )
    return Text("\n".join([*told[:_MOST_ALARMS], *more]), style="yellow")


def _account(mission: FlownMission) -> Table:
    """Return the account, a line per tick."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for name in ("step", "tail", "remaining", "candidate", "unallocated"):
        table.add_column(name, no_wrap=True, justify="right")
    table.add_column("flown", no_wrap=True)
    for row in mission.rows:
        what = "a new leg" if row.leg is not None else f"the tail: {row.reason}"
        shares = (row.value, row.wealth, row.price, row.bank)
        table.add_row(str(row.step), *(probability_text(share) for share in shares), what)
    return table


def probability_text(value: float | None) -> str:
    """Return a probability of the account, as short as it is telling.

    Parameters
    ----------
    value : float or None
        The probability [-]; None where there is none.
    """
    if value is None:
        return ""
    return f"< {NOTHING:.0e}" if 0.0 < value < NOTHING else f"{value:.2e}"
