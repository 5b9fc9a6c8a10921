"""A flight judged from its record alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.errors import RadmpcError
from radmpc.flying.model import Model
from radmpc.flying.recording.recomputing import recomputed
from radmpc.flying.tick import Contact
from radmpc.io.flight.record import FlightRecord, FlownMission, TickRow
from radmpc.model.scenario import Scenario
from radmpc.referee import certify

__all__ = ["flight_problems"]

_MOST_PROBLEMS = 20
"""Most problems of a flight that are reported."""


def flight_problems(record: FlightRecord) -> tuple[str, ...]:
    """Return what in a flight is not true, one sentence each; empty where it holds.

    The plan is certified anew, the account of every mission recomputed, and in the model's own
    dynamics what was hit is found again.

    Parameters
    ----------
    record : FlightRecord
        As read from a file.

    Returns
    -------
    tuple of str
        Twenty at most, and how many more there are.
    """
    problems = [f"line {line} of the file is not as it was written" for line in record.changed]
    certificate = certify(record.plan)
    problems += certificate.problems
    if not certificate.problems:
        for due, mission in enumerate(record.missions):
            # States that are made up may be too large to be squared: what follows is infinite.
            with np.errstate(over="ignore", invalid="ignore"):
                problems += _mission_problems(record, mission, due)
    if len(record.missions) > record.settings.missions:
        problems.append(
            f"{len(record.missions)} missions were flown, {record.settings.missions} asked for"
        )
    hidden = len(problems) - _MOST_PROBLEMS
    if hidden > 0:
        return (*problems[:_MOST_PROBLEMS], f"{hidden} more like these")
    return tuple(problems)


def _mission_problems(record: FlightRecord, mission: FlownMission, due: int) -> list[str]:
    """Return what in one mission is not true."""
    if mission.number != due:
        return [f"mission {mission.number + 1} stands where mission {due + 1} is due"]
    if not mission.is_over and due < len(record.missions) - 1:
        return [f"mission {mission.number + 1} ends with step {mission.rows[-1].step}"]
    try:
        book = recomputed(record.plan, mission.rows)
    except RadmpcError as error:
        return [f"mission {mission.number + 1}: {error}"]
    problems = book.problems
    if record.settings.backend == "model":
        # Beyond the rows that could be recomputed nothing is known to follow on anything.
        problems += _contact_problems(record.plan.scenario, mission.rows[: len(book.ticks)])
    return problems


class _Geometry(Model):
    """The model's own geometry, of steps that have been flown."""

    def hit(self, before: TickRow | None, now: TickRow) -> tuple[Contact, ...]:
        """Return what was hit on the way to a row."""
        self._step = now.step
        states = now.states or ()
        if self._scenario.avoidance == "steps":
            return self._contacts(states, states, None)
        if before is None:
            return ()
        return self._contacts(before.states or (), states, before.controls)


def _contact_problems(scenario: Scenario, rows: Sequence[TickRow]) -> list[str]:
    """Return where what was hit is not what states and controls say."""
    geometry = _Geometry(scenario)
    # Estimates do not tell where vehicles were, and nothing where obstacles were that stray.
    hidden: set[str | None] = {v.name for v in scenario.vehicles if v.measurement is not None}
    hidden |= {o.name for o in scenario.obstacles if o.spread is not None}
    problems = []
    before = None
    for row in rows:
        if row.states is None or (before and (before.states is None or not before.controls)):
            before = row
            continue
        found, stated = (
            {(c.cause, c.vehicle, c.other) for c in contacts if not hidden & {c.vehicle, c.other}}
            for contacts in (geometry.hit(before, row), row.contacts)
        )
        before = row
        where = f"mission {row.mission + 1}, step {row.step}"
        both = (("{}, and not stated", found - stated), ("stated, and not {}", stated - found))
        for words, which in both:
            for cause, vehicle, other in sorted(which, key=str):
                what, how = ("a range", "lost") if cause == "range" else ("a contact", "hit")
                whom = f"{vehicle!r} and {other or 'the border of the workspace'!r}"
                problems.append(f"{where}: {whom}: {what} that is {words.format(how)}")
    return problems
