"""The account of a mission recomputed from its rows alone: what they state is compared, not used.

Legs, values, prices, wealth and controls follow from the plan, the measured states and the controls
of the legs that were adopted. Who changes a file must change all that follows from it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import RadmpcError, RiskError
from radmpc.flying.account import Account
from radmpc.flying.deciding import opened
from radmpc.flying.knowing import best_of, expected_start, starting
from radmpc.flying.leg import Leg, leg_of
from radmpc.flying.remainder import left_of
from radmpc.flying.sensing.evidence import Evidence
from radmpc.flying.sensing.measurements import Sensing
from radmpc.flying.tick import Contact, Entry, Segment, Tick, entered, segments
from radmpc.flying.visiting import still_due
from radmpc.io.flight.record import TickRow
from radmpc.model.limits import within_limits
from radmpc.model.plan import Plan
from radmpc.records import dataclass, field

__all__ = ["Booking", "recomputed"]

_TOLERANCE = 1e-6
"""Share [-] by which numbers may differ from those stated: other processors round otherwise."""

_LEAST = 1e-9
"""Probability [-], and difference of controls, up to which they may differ anyway."""


@dataclass(slots=True, eq=False)
class Booking:
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


def recomputed(plan: Plan, rows: Sequence[TickRow]) -> Booking:
    """Return a mission as its rows leave it, and what in them is not true.

    Parameters
    ----------
    plan : Plan
        What was flown first.
    rows : sequence of TickRow
        Of one mission.

    Returns
    -------
    Booking
        Up to the first row that cannot be recomputed.

    Raises
    ------
    RiskError
        If the plan's certificate exceeds Δ.
    """
    leg, account = opened(plan, 0)
    starts = tuple(expected_start(v) for v in plan.scenario.vehicles)
    book = Booking(plan, leg, account, Sensing.of(plan.scenario), starts)
    book.enter(0, "opened", account.tail)
    for number, row in enumerate(rows):
        where = f"mission {row.mission}, step {row.step}"
        if row.step != number:
            book.problems.append(f"{where}: stands where step {number} is due")
            break
        try:
            _book(book, row, where)
        except RadmpcError as error:
            book.problems.append(f"{where}: {error}")
            break
    return book


def _book(book: Booking, row: TickRow, where: str) -> None:
    """Take the next row."""
    known, value, before = book.expected, None, book.sensing.evidence
    book.contacts += [Contact(t.step, t.cause, t.vehicle, t.other) for t in row.contacts]
    if row.states is not None:
        is_certain = not book.ticks or book.ticks[-1].value is not None
        seen = row.step, book.expected, row.states, book.leg
        known, _ = book.sensing.look(*seen, is_certain=is_certain)
        worth = book.leg.value(row.step, known, book.sensing.evidence.scale)
        value, book.account = worth.total, book.account.kept(worth.least)
    wealth = book.account.wealth
    _compare(book, where, {"value": (row.value, value), "wealth": (row.wealth, wealth)})
    scale, stated = book.sensing.evidence.scale, row.scale
    if stated is not None or scale.samples is not None:
        number = None if stated is None else stated.samples
        due = None if scale.samples is None else float(scale.factor)
        _compare(book, where, {"number of samples": (number, scale.samples)})
        _compare(book, where, {"factor": (None if stated is None else stated.factor, due)})
    if (row.leg is not None) != (row.choice == "candidate"):
        book.problems.append(f"{where}: states {row.choice!r}, and a leg only where one is adopted")
    if row.leg is None:
        book.enter(row.step, "kept", None)
    else:
        _adopt(book, row, (known, before), where)
        known = book.leg.begun(known)
    now = book.account
    _compare(book, where, {"tail": (row.tail, now.tail), "bank": (row.bank, now.bank)})
    flown = _flown(book, row, known, where)
    way = segments(book.plan.scenario, known, flown) if flown else ()
    book.ticks.append(_tick(row, way))


def _tick(row: TickRow, way: tuple[Segment, ...]) -> Tick:
    """Return the decision that a row tells."""
    return Tick(
        row.step, way, row.choice, row.reason, row.value, row.wealth, row.price, row.next_step,
        row.alarms, row.seconds,
    )  # fmt: skip


def _adopt(book: Booking, row: TickRow, at: tuple[Sequence[Vector], Evidence], where: str) -> None:
    """Buy the leg of a row, if its price is within the wealth; evidence is that before the row."""
    if row.leg is None:
        return
    known, before = at
    if book.contacts:
        book.problems.append(f"{where}: a leg was adopted after something was hit")
    starts, begins, is_now = [], True, True
    vehicles = book.plan.scenario.vehicles
    for v, start, now, hoped in zip(vehicles, row.leg.starts, known, book.expected, strict=True):
        at_known = np.array_equal(start, best_of(v, now)[: start.size])
        begins, is_now = begins and at_known and start.size == now.size, is_now and at_known
        # What was planned ahead begins with what was expected.
        starts.append(starting(v, now if at_known else hoped, start))
    learned = book.sensing.evidence.scale
    scale = learned if is_now else before.scale
    rest = left_of(book.plan.scenario, row.step, starts, row.leg.risk_bound, scale)
    rest = still_due(rest, book.leg, row.step)
    leg = leg_of(rest, row.leg.controls, row.step, scale)
    # Where it begins beside the measured state, the deviation is part of what it costs; and where
    # obstacles' places are not known, what was met before was paid for by the leg before.
    begins &= not leg.witnesses.parties.are_hidden.any()
    price = leg.price if begins else leg.value(row.step, leg.begun(known), learned).total
    _compare(book, where, {"price": (row.price, price)})
    try:
        book.account = book.account.adopted(price)
    except RiskError as error:
        book.problems.append(f"{where}: the leg that was adopted was not affordable: {error}")
        book.account = Account(book.account.risk_bound, price, 0.0)
    book.leg = leg
    book.enter(row.step, "adopted", price)


def _flown(book: Booking, row: TickRow, known: Sequence[Vector], where: str) -> tuple[Vector, ...]:
    """Return what was flown until the next step; expect what comes of it."""
    scenario = book.plan.scenario
    if row.step == scenario.horizon or not row.controls:
        if bool(row.controls) or row.step < scenario.horizon:
            book.problems.append(f"{where}: controls must end with step {scenario.horizon - 1}")
        return ()
    asked = book.leg.controls(row.step, known)
    held = [within_limits(v, u) for u, v in zip(asked, scenario.vehicles, strict=True)]
    for vehicle, due, stated in zip(scenario.vehicles, held, row.controls, strict=True):
        if float(np.abs(due - stated).max(initial=0.0)) > max(
            _LEAST, _TOLERANCE * np.abs(due).max()
        ):
            book.problems.append(
                f"{where}: vehicle {vehicle.name!r}: flew {stated.tolist()}, the leg says "
                f"{due.tolist()}"
            )
    book.expected = book.leg.expected(row.step, known, row.controls)
    return row.controls


def _compare(
    book: Booking, where: str, numbers: dict[str, tuple[float | None, float | None]]
) -> None:
    """Note stated numbers that are not those recomputed."""
    for name, (stated, due) in numbers.items():
        if stated is None and due is None:
            continue
        if stated is None or due is None or abs(stated - due) > _LEAST + _TOLERANCE * abs(due):
            told = "nothing" if due is None else f"{due:.6g}"
            book.problems.append(f"{where}: states a {name} of {stated}, recomputed it is {told}")
