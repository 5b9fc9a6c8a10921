"""Missions whose every tick is written down before it is flown, and which go on from their rows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Vector
from radmpc.errors import ArgumentError, FileFormatError
from radmpc.flying.locking import one_at_a_time
from radmpc.flying.measuring import States, heard, measured
from radmpc.flying.mission import Mission
from radmpc.flying.recording.recomputing import recomputed
from radmpc.flying.tick import Contact, Tick
from radmpc.io.flight.record import NewLeg, ScaleRow, TickRow, Touch
from radmpc.model.plan import Plan
from radmpc.result import Result

__all__ = ["RecordedMission"]


class RecordedMission(Mission):
    """A mission that reports every tick before its controls are flown.

    Parameters
    ----------
    plan : Plan
        What is flown first.
    number : int
        Of the mission, in its rows.
    tell : callable
        Takes a row; what it raises, `step` raises.
    rows : sequence of TickRow
        Of the mission so far, where it goes on.
    planner : str or None
        A preset's name; None never plans anew.
    seed : int
        Of every plan.

    Raises
    ------
    FileFormatError
        If the rows cannot be recomputed.
    RadmpcError
        As in `Mission`.
    """

    def __init__(
        self,
        plan: Plan,
        number: int,
        tell: Callable[[TickRow], None],
        rows: Sequence[TickRow] = (),
        *,
        planner: str | None = "certified",
        seed: int = 0,
    ) -> None:
        super().__init__(plan, planner=planner, seed=seed)
        self._number, self._tell = number, tell
        if rows:
            self._take_up(plan, rows)

    @one_at_a_time
    def step(
        self,
        states: Mapping[str, npt.ArrayLike | None] | Sequence[npt.ArrayLike | None] | None,
        *,
        deadline: float | None = None,
        contacts: Sequence[Contact] = (),
    ) -> Tick:
        """Decide what to do until the next step, and tell it.

        Parameters
        ----------
        states, deadline, contacts
            As in `Mission.step`.
        """
        tick = super().step(states, deadline=deadline, contacts=contacts)
        given = measured(self._scenario, states)
        excess = 0.0
        if tick.segments:
            asked = self._leg.controls(tick.step, self._known)
            pairs = zip(asked, tick.controls, strict=True)
            excess = max(float(np.abs(u - flown).max(initial=0.0)) for u, flown in pairs)
        account = self.balance
        self._tell(
            TickRow(
                mission=self._number,
                step=tick.step,
                states=given,
                contacts=tuple(Touch(int(c.step), c.cause, c.vehicle, c.other) for c in contacts),
                choice=tick.choice,
                reason=tick.reason,
                value=tick.value,
                wealth=tick.wealth,
                price=tick.price,
                next_step=tick.next_step,
                tail=account.tail,
                bank=account.bank,
                controls=tick.controls,
                excess=excess,
                leg=self._new_leg() if tick.choice == "candidate" else None,
                alarms=tick.alarms,
                seconds=tick.seconds,
                scale=self._known_scale(),
                partly=self._partly(states) if given is None else None,
            )
        )
        return tick

    def set_risk_bound(self, risk_bound: float) -> None:
        """Refuse: rows are of one risk bound.

        Parameters
        ----------
        risk_bound : float
            As in `Mission.set_risk_bound`.

        Raises
        ------
        ArgumentError
            Always.
        """
        raise ArgumentError(
            f"a recorded mission keeps its risk bound of {self.balance.risk_bound:g}, "
            f"got {risk_bound:g}: fly a Mission"
        )

    def start_again(self, result: Result | Plan) -> None:
        """Refuse: rows are of one account.

        Parameters
        ----------
        result : Result or Plan
            As in `Mission.start_again`.

        Raises
        ------
        ArgumentError
            Always.
        """
        raise ArgumentError(f"a recorded mission keeps its account, got {result!r}: fly a Mission")

    def _partly(self, states: States) -> tuple[Vector | None, ...] | None:
        """Return what was measured where something was, and not all."""
        found = heard(self._scenario, states)
        return None if all(state is None for state in found) else found

    def _known_scale(self) -> ScaleRow | None:
        """Return what is known by now of the factor of covariances."""
        now = self._sensing.evidence.scale
        return None if now.samples is None else ScaleRow(now.samples, float(now.factor))

    def _new_leg(self) -> NewLeg:
        """Return what distinguishes the leg in the air from any other."""
        plan = self._leg.plan
        vehicles, paths = plan.scenario.vehicles, plan.trajectories
        knows_more = any(vehicle.belief is not None for vehicle in vehicles)
        return NewLeg(
            plan.scenario.risk_bound,
            tuple(v.start for v in vehicles),
            tuple(path.controls for path in paths),
            tuple(path.means for path in paths) if knows_more else None,
        )

    def _take_up(self, plan: Plan, rows: Sequence[TickRow]) -> None:
        """Be where the rows end."""
        book = recomputed(plan, rows)
        if book.problems:
            raise FileFormatError(f"cannot go on: {book.problems[0]}")
        self._leg, self._account, self._sensing = book.leg, book.account, book.sensing
        self._entries, self._ticks, self._contacts = book.entries, book.ticks, book.contacts
        self._step, self._expected = rows[-1].step + 1, book.expected
