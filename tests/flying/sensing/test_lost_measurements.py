"""Whole flights in which vehicles are not heard of for some steps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Vector
from radmpc.flying.flight import fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.tick import Contact, Segment
from radmpc.result import Result


class Interrupted(Model):
    """The model, heard of by names, with steps at which one or no vehicle is."""

    flown = 0

    def advance(self, segments: Sequence[Segment]) -> tuple[object, tuple[Contact, ...]]:
        states, contacts = super().advance(segments)
        self.flown += 1
        given: dict[str, Vector | None] | None = dict(
            zip((s.name for s in segments), states, strict=True)
        )
        if self.flown == 2:
            given = None
        elif self.flown == 4:
            given[segments[0].name] = None
        return given, contacts


def test_a_flight_goes_on_where_a_backend_hears_of_no_vehicle_or_tells_states_by_name(
    result: Result,
) -> None:
    scenario = result.record.scenario
    flight = fly(Mission(result, planner=None), Interrupted(scenario, 1))
    whole = fly(Mission(result, planner=None), Model(scenario, 1))
    assert flight.ticks[2].reason == "nothing was measured"
    assert flight.ticks[4].reason == "not all vehicles were measured"
    assert len(flight.states) == scenario.horizon + 1
    missing = [[bool(np.isnan(x).any()) for x in states] for states in flight.states]
    none = [False] * len(scenario.vehicles)
    assert missing[2] == [True] * len(none)
    assert missing[4] == [True, *none[1:]]
    assert all(missing[k] == none for k in range(len(missing)) if k not in {2, 4})
    # Without feedback the gap changes nothing of the path.
    pairs = zip(flight.states[-1], whole.states[-1], strict=True)
    assert all(np.array_equal(now, then) for now, then in pairs)
