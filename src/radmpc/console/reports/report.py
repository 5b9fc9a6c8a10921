"""A plan on one screen: status, cost, certificate, sets, seconds and where the risk goes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from rich.table import Table
from rich.text import Text

from radmpc.console.reports.reasons import (
    advice_text,
    assumed_noise_text,
    cost_text,
    left_over_text,
    limits_text,
    price_text,
    reasons_text,
)
from radmpc.console.reports.saturating import saturation_line, saturation_warning
from radmpc.console.reports.visiting import arrivals_text, visits_text
from radmpc.console.words import scenario_line
from radmpc.model.ledger import CAUSES, bound_texts, risk_by_vehicle
from radmpc.model.plan import LedgerRow, Plan
from radmpc.wording import count_text, short_cost

__all__ = ["facts", "ledger_table", "plan_report", "vehicle_table", "verdict"]

_TOP_ROWS = 8
"""Rows of the ledger that a report lists, largest first; the rest is summed up."""

_MAX_SETS = 12
"""Sets of vehicles that a report names; the rest is counted."""

_LEAST_SHARE = 1e-9
"""Share of the risk bound [-] below which a row of the ledger is only summed up."""


def plan_report(
    plan: Plan, preset: str = "", num_events: int = 0, *, bounds_risk: bool = True
) -> list[Table | Text]:
    """Return a plan's summary as parts to show.

    Parameters
    ----------
    plan : Plan
        What planning ended with.
    preset : str
        The planner as it was asked for.
    num_events : int
        How many subproblems had no solution on the way.
    bounds_risk : bool
        Whether the planner keeps the risk within Δ at all.

    Returns
    -------
    list of Table or Text
        From top to bottom.
    """
    rows: dict[str, Text | str] = {
        "status": f"{plan.status.value}: {plan.status_sentence}",
        "planner": f"{preset}: {plan.planner}" if preset else plan.planner,
    }
    if plan.trajectories:
        rows |= _plan_rows(plan, preset, bounds_risk=bounds_risk)
    elif plan.explanation:
        rows["no plan"] = Text(plan.explanation, style="red")
    noise = assumed_noise_text(plan.scenario)
    if noise:
        rows["noise"] = Text(noise, style="yellow")
    if num_events:
        rows["events"] = f"{count_text(num_events, 'subproblem')} of RADMPC had no solution"
    rows["seconds"] = _seconds(plan.seconds)
    parts: list[Table | Text] = [Text(scenario_line(plan.scenario), style="bold"), facts(rows)]
    if plan.risk.ledger:
        parts += [Text(), ledger_table(plan), Text(), vehicle_table(plan)]
    return parts


def _plan_rows(plan: Plan, preset: str, *, bounds_risk: bool) -> dict[str, Text | str]:
    """Return the rows about trajectories."""
    rows: dict[str, Text | str] = {
        "cost": cost_text(plan),
        **_first(plan),
        "certificate": verdict(plan.risk.certified, plan.risk.bound),
    }
    has_feedback = any(vehicle.gain is not None for vehicle in plan.scenario.vehicles)
    if plan.risk.saturation is not None and has_feedback:
        warning = saturation_warning(plan, plan.risk.saturation)
        rows["saturation"] = saturation_line(plan.risk.saturation, warning=warning)
    if bounds_risk:
        rows["shadow price"] = price_text(plan)
    for name, text in (("visits", visits_text(plan)), ("arrivals", arrivals_text(plan))):
        if text:
            rows[name] = text
    limits = limits_text(plan)
    if limits:
        rows["limited by"] = limits
    left_over = left_over_text(plan) if bounds_risk else None
    if left_over:
        rows["risk left over"] = left_over
    rows["planned together"] = _sets(plan.sets)
    reasons = reasons_text(plan)
    if reasons:
        rows["because"] = reasons
    advice = advice_text(plan, preset, bounds_risk=bounds_risk)
    if advice:
        rows["advice"] = Text(advice, style="yellow")
    if plan.explanation:
        rows["note"] = plan.explanation
    return rows


def facts(rows: Mapping[str, Text | str]) -> Table:
    """Return names and values in two columns."""
    table = Table.grid(padding=(0, 2))
    table.add_column(style="cyan", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in rows.items():
        table.add_row(name, value)
    return table


def verdict(certified: float | None, bound: float) -> Text:
    """Return the certificate against the bound, plainly.

    Parameters
    ----------
    certified : float or None
        Upper bound on the joint collision probability; None without a plan.
    bound : float
        Risk bound Δ.
    """
    if certified is None:
        return Text("none", style="red")
    risk, limit = bound_texts(certified, bound)
    if certified <= bound:
        return Text(f"risk at most {risk}, within the bound {limit}", style="green")
    return Text(
        f"risk at most {risk}, which EXCEEDS the bound {limit}: do not use this plan",
        style="bold red",
    )


def ledger_table(plan: Plan) -> Table:
    """Return where the risk goes: the largest rows, the rest, and what is left."""
    rows = sorted(plan.risk.ledger, key=lambda row: row.risk, reverse=True)
    bound = plan.risk.bound
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for column in ("where the risk goes", "vehicle", "other"):
        table.add_column(column, no_wrap=True)
    for column in ("step", "risk", "of bound"):
        table.add_column(column, justify="right", no_wrap=True)
    num_shown = _num_shown([row.risk for row in rows], bound)
    for row in rows[:num_shown]:
        table.add_row(*_ledger_cells(row, bound))
    hidden = rows[num_shown:]
    if hidden:
        rest = sum(row.risk for row in hidden)
        table.add_row(f"{len(hidden)} more", "", "", "", f"{rest:.2e}", _share(rest, bound))
    left = bound - sum(row.risk for row in rows)
    if left > 0.0:
        table.add_row("left over", "", "", "", f"{left:.2e}", _share(left, bound))
    return table


def vehicle_table(plan: Plan) -> Table:
    """Return the risk by vehicle: each of a pair bears half of theirs."""
    names = [vehicle.name for vehicle in plan.scenario.vehicles]
    parts = risk_by_vehicle(plan.risk.ledger, names)
    totals = {name: sum(causes.values()) for name, causes in parts.items()}
    ordered = sorted(names, key=lambda name: totals[name], reverse=True)
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("who bears it", no_wrap=True)
    causes = CAUSES if plan.scenario.keep else CAUSES[:-1]
    heads = ("half of pairs", "obstacles", "workspace", "half of ranges")
    for column in (*heads[: len(causes)], "risk", "of bound"):
        table.add_column(column, justify="right", no_wrap=True)
    num_shown = _num_shown([totals[name] for name in ordered], plan.risk.bound)
    for name in ordered[:num_shown]:
        risks = [*(parts[name][cause] for cause in causes), totals[name]]
        share = _share(totals[name], plan.risk.bound)
        table.add_row(name, *(f"{risk:.2e}" for risk in risks), share)
    hidden = ordered[num_shown:]
    if hidden:
        rest = sum(totals[name] for name in hidden)
        share = _share(rest, plan.risk.bound)
        table.add_row(f"{len(hidden)} more", *("" for _ in causes), f"{rest:.2e}", share)
    return table


def _ledger_cells(row: LedgerRow, bound: float) -> Iterable[str]:
    """Return one row of the ledger as text."""
    other = "" if row.other is None else row.other
    return (
        row.cause, row.vehicle, other, str(row.step), f"{row.risk:.2e}", _share(row.risk, bound)
    )  # fmt: skip


def _sets(sets: tuple[tuple[str, ...], ...]) -> str:
    """Return which vehicles were planned together, the largest sets first."""
    ordered = sorted(sets, key=len, reverse=True)
    shown = ", ".join("{" + ", ".join(group) + "}" for group in ordered[:_MAX_SETS])
    hidden = len(ordered) - _MAX_SETS
    return shown if hidden <= 0 else f"{shown} and {count_text(hidden, 'more set')}"


def _first(plan: Plan) -> dict[str, Text | str]:
    """Return when the first certified plan was there, if it is known."""
    if plan.first is None:
        return {}
    return {
        "first plan": f"after {plan.first.seconds:.2f} s, at cost {short_cost(plan.first.cost)}"
    }


def _seconds(seconds: Mapping[str, float]) -> str:
    """Return the total and its stages."""
    stages = [f"{name} {value:.2f}" for name, value in seconds.items() if name != "total"]
    total = f"{seconds.get('total', 0.0):.2f}"
    return f"{total} ({', '.join(stages)})" if stages else total


def _num_shown(risks: list[float], bound: float) -> int:
    """Return how many of some risks, largest first, deserve a line of their own."""
    return sum(risk >= _LEAST_SHARE * bound for risk in risks[:_TOP_ROWS])


def _share(risk: float, bound: float) -> str:
    """Return a risk in percent of the bound, to three digits."""
    percent = float(f"{100.0 * risk / bound:.3g}")
    if 0.0 < percent < 0.1:
        return "< 0.1 %"
    decimals = 2 - math.floor(math.log10(percent)) if percent else 0
    return f"{percent:.{max(decimals, 0)}f} %"
