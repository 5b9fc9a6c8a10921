"""The account of a mission recomputed from its rows alone: what they state is compared, not used.

Legs, values, risks and controls follow from the plan, the measured states and the controls
of the legs that were adopted. A change of a file requires changing all that follows from it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import RadmpcError, RiskError
from radmpc.flying.account import Account
from radmpc.flying.commanding import let_pass
from radmpc.flying.deciding import opened
from radmpc.flying.knowing import best_of, expected_start, starting
from radmpc.flying.leg import Leg, leg_of
from radmpc.flying.remainder import left_of
from radmpc.flying.sensing.evidence import Evidence
from radmpc.flying.sensing.gaps import flown_by
from radmpc.flying.sensing.measurements import Sensing
from radmpc.flying.tick import Contact, Entry, Segment, Tick, entered, segments
from radmpc.flying.visiting import still_due
from radmpc.io.flight.record import TickRow
from radmpc.model.limits import within_limits
from radmpc.model.plan import Plan
from radmpc.records import dataclass, field

__all__ = ["Recomputation", "recomputed"]

_TOLERANCE = 1e-6
"""Share [-] by which numbers may differ from those stated: other processors round otherwise."""

_LEAST = 1e-9
"""Probability [-] up to which they may differ anyway; of controls as much, or as large a share of
limits below one."""


@dataclass(slots=True, eq=False)
class Recomputation:
    """A mission as its rows leave it.

    Attributes
    ----------
    plan : Plan
        What was flown first.
    leg : Leg
        In the air.
    account : Account
        After the last row.
    sensing : Sensing
        What has been measured.
    expected : tuple of (n,) or (2 n,) array
        What is expected to be known at the next step.
    entries, ticks, contacts : list
        Of the mission so far.
    problems : list of str
        What rows state and does not follow, one sentence each.
    """

    plan: Plan
    leg: Leg
    account: Account
    sensing: Sensing
    expected: tuple[Vector, ...]
    entries: list[Entry] = field(default_factory=list)
    ticks: list[Tick] = field(default_factory=list)
    contacts: list[Contact] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)

    def enter(self, step: int, what: str, price: float | None) -> None:
        """Write a row of the account.

        Parameters
        ----------
        step : int
            Of the mission.
        what : str
            As in `Entry`.
        price : float or None
            What the leg that was adopted cost [-].
        """
        self.entries.append(entered(step, what, self.account, price))


def recomputed(plan: Plan, rows: Sequence[TickRow]) -> Recomputation:
    """Return a mission as its rows leave it, and what in them is not true.

    Parameters
    ----------
    plan : Plan
        What was flown first.
    rows : sequence of TickRow
        Of one mission.

    Returns
    -------
    Recomputation
        Up to the first row that cannot be recomputed.

    Raises
    ------
    RiskError
        If the plan's certificate exceeds Δ.
    """
    leg, account = opened(plan, 0)
    starts = tuple(expected_start(v) for v in plan.scenario.vehicles)
    state = Recomputation(plan, leg, account, Sensing.of(plan.scenario), starts)
    state.enter(0, "opened", account.tail)
    for number, row in enumerate(rows):
        where = f"mission {row.mission + 1}, step {row.step}"
        if row.step != number:
            state.problems.append(f"{where}: stands where step {number} is due")
            break
        try:
            _follow(state, row, where)
        except RadmpcError as error:
            state.problems.append(f"{where}: {error}")
            break
    return state


def _follow(state: Recomputation, row: TickRow, where: str) -> None:
    """Take the next row."""
    value, before = None, state.sensing.evidence
    next_step, alarms = None, 1  # that there is no measurement
    state.contacts += [Contact(t.step, t.cause, t.vehicle, t.other) for t in row.contacts]
    if row.states is None:
        known, _ = flown_by(state.plan.scenario, state.expected, row.partly)
    else:
        is_certain = not state.ticks or state.ticks[-1].value is not None
        seen = row.step, state.expected, row.states, state.leg
        known, told = state.sensing.look(*seen, is_certain=is_certain)
        worth = state.leg.value(row.step, known, state.sensing.evidence.scale)
        value, state.account = worth.total, state.account.kept(worth.least)
        next_step, alarms = worth.next_step, len(told) + (value > state.account.risk_bound)
    wealth = state.account.wealth
    _compare(state, where, {"value": (row.value, value), "wealth": (row.wealth, wealth)})
    if row.leg is None:
        _compare(state, where, {"risk of the next step": (row.next_step, next_step)})
    scale, stated = state.sensing.evidence.scale, row.scale
    if stated is not None or scale.samples is not None:
        number = None if stated is None else stated.samples
        due = None if scale.samples is None else float(scale.factor)
        _compare(state, where, {"number of samples": (number, scale.samples)})
        _compare(state, where, {"factor": (None if stated is None else stated.factor, due)})
    if (row.leg is not None) != (row.choice == "candidate"):
        state.problems.append(
            f"{where}: states {row.choice!r}, and a leg only where one is adopted"
        )
    if row.leg is None:
        state.enter(row.step, "kept", None)
    else:
        _adopt(state, row, (known, before), where)
        known = state.leg.begun(known)
    now = state.account
    _compare(state, where, {"tail": (row.tail, now.tail), "bank": (row.bank, now.bank)})
    flown, saturated = _flown(state, row, known, where)
    _compare(state, where, {"number of alarms": (len(row.alarms), alarms + saturated)})
    path = segments(state.plan.scenario, known, flown) if flown else ()
    state.ticks.append(_tick(row, path))


def _tick(row: TickRow, way: tuple[Segment, ...]) -> Tick:
    """Return the decision that a row tells."""
    return Tick(
        row.step, way, row.choice, row.reason, row.value, row.wealth, row.price, row.next_step,
        row.alarms, row.seconds,
    )  # fmt: skip


def _adopt(
    state: Recomputation, row: TickRow, at: tuple[Sequence[Vector], Evidence], where: str
) -> None:
    """Adopt the leg of a row, if what remains allows it; evidence is that before the row."""
    if row.leg is None:
        return
    known, before = at
    if state.contacts:
        state.problems.append(f"{where}: a leg was adopted after something was hit")
    starts, begins, is_now = [], True, True
    vehicles = state.plan.scenario.vehicles
    for v, start, now, hoped in zip(vehicles, row.leg.starts, known, state.expected, strict=True):
        at_known = np.array_equal(start, best_of(v, now)[: start.size])
        begins, is_now = begins and at_known and start.size == now.size, is_now and at_known
        # What was planned ahead begins with what was expected.
        starts.append(starting(v, now if at_known else hoped, start))
    learned = state.sensing.evidence.scale
    scale = learned if is_now else before.scale
    rest = left_of(state.plan.scenario, row.step, starts, row.leg.risk_bound, scale)
    rest = still_due(rest, state.leg, row.step)
    leg = leg_of(rest, row.leg.controls, row.step, scale)
    _compare_means(state, leg, row, where)
    # Where it begins beside the measured state, the deviation is part of what it costs; and where
    # obstacles' places are not known, what was met before was charged to the leg before.
    begins &= not leg.witnesses.parties.are_hidden.any()
    price = leg.price if begins else leg.value(row.step, leg.begun(known), learned).total
    _compare(state, where, {"price": (row.price, price)})
    try:
        state.account = state.account.adopted(price)
    except RiskError as error:
        state.problems.append(
            f"{where}: the leg that was adopted was not within the remaining risk: {error}"
        )
        state.account = Account(state.account.risk_bound, price, 0.0)
    state.leg = leg
    state.enter(row.step, "adopted", price)


def _flown(
    state: Recomputation, row: TickRow, known: Sequence[Vector], where: str
) -> tuple[tuple[Vector, ...], int]:
    """Return what was flown until the next step, and how many vehicles saturate."""
    scenario = state.plan.scenario
    if row.step == scenario.horizon or not row.controls:
        if bool(row.controls) or row.step < scenario.horizon:
            state.problems.append(f"{where}: controls must end with step {scenario.horizon - 1}")
        _compare(state, where, {"saturation": (row.excess, 0.0)})
        return (), 0
    asked = state.leg.controls(row.step, known)
    held = [within_limits(v, u) for u, v in zip(asked, scenario.vehicles, strict=True)]
    for vehicle, due, stated in zip(scenario.vehicles, held, row.controls, strict=True):
        rounding = _LEAST * min(1.0, float(vehicle.control_limit.min()))
        if float(np.abs(due - stated).max(initial=0.0)) > max(
            rounding, _TOLERANCE * np.abs(due).max()
        ):
            state.problems.append(
                f"{where}: vehicle {vehicle.name!r}: flew {stated.tolist()}, the leg says "
                f"{due.tolist()}"
            )
    excesses = [float(np.abs(u - due).max()) for u, due in zip(asked, held, strict=True)]
    pairs = zip(scenario.vehicles, excesses, strict=True)
    _compare(state, where, {"saturation": (row.excess, max(excesses))})
    state.expected = state.leg.expected(row.step, known, row.controls)
    return row.controls, sum(excess > let_pass([v]) for v, excess in pairs)


def _compare(
    state: Recomputation, where: str, numbers: dict[str, tuple[float | None, float | None]]
) -> None:
    """Note stated numbers that are not those recomputed."""
    for name, (stated, due) in numbers.items():
        if stated is None and due is None:
            continue
        if stated is None or due is None or abs(stated - due) > _LEAST + _TOLERANCE * abs(due):
            told = "nothing" if due is None else f"{due:.6g}"
            state.problems.append(f"{where}: states a {name} of {stated}, recomputed it is {told}")


def _compare_means(state: Recomputation, leg: Leg, row: TickRow, where: str) -> None:
    """Note a stated nominal that does not follow from what was known."""
    if row.leg is None or row.leg.means is None:
        return
    for path, stated in zip(leg.plan.trajectories, row.leg.means, strict=True):
        away = float(np.abs(path.means - stated).max())
        if away > _LEAST + _TOLERANCE * float(np.abs(path.means).max()):
            state.problems.append(
                f"{where}: states a nominal of {path.name} that is {away:.3g} off, recomputed"
            )
