"""Where the legs of a flight expect its vehicles, read from its file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from adversary import staking, waiting
from noisy_scenes import gusty, steered
from recorded_flights import beside_the_wall, certified, forged, staked_rows, written

import radmpc
from radmpc.arrays import Matrix
from radmpc.flying.model import Model
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.flying.recording.verifying import flight_problems
from radmpc.io.flight.following import followed
from radmpc.io.flight.record import TickRow
from radmpc.model.plan import Plan


class Watched(RecordedMission):
    """Remembers the nominals of the legs it adopts."""

    def __init__(self, plan: Plan, rows: list[TickRow]) -> None:
        super().__init__(plan, 0, rows.append, planner=staking)
        self.adopted: dict[int, list[Matrix]] = {}

    def _new_leg(self):
        self.adopted[self.step] = [path.means for path in self._leg.plan.trajectories]
        return super()._new_leg()


@pytest.fixture(scope="module")
def in_gusts() -> tuple[Plan, list[TickRow], dict[int, list[Matrix]]]:
    """A flight in gusts that last, and the nominals of the legs that it adopted."""
    plan, rows = certified(waiting(steered(gusty))), []
    mission = Watched(plan, rows)
    radmpc.fly(mission, Model(plan.scenario, 1))
    return plan, rows, mission.adopted


def test_legs_in_gusts_are_read_with_what_was_known_of_the_gusts(in_gusts, tmp_path: Path) -> None:
    plan, rows, adopted = in_gusts
    written(tmp_path / "flight.jsonl", plan, rows)
    record = radmpc.load_flight(tmp_path / "flight.jsonl")
    begun = [one for one in followed(record, record.missions[0]) if one.row.leg is not None]
    assert len(begun) == len(adopted) > 0
    for one, means in zip(begun, adopted.values(), strict=True):
        for read, flown in zip(one.nominals, means, strict=True):
            assert np.array_equal(read, flown)
    assert flight_problems(record) == ()


def test_a_forged_nominal_is_told(in_gusts, tmp_path: Path) -> None:
    plan, rows, _ = in_gusts
    path = tmp_path / "flight.jsonl"
    written(path, plan, rows)
    line = next(number for number, row in enumerate(rows) if row.leg is not None) + 2

    def forge(content: dict[str, object]) -> None:
        content["leg"]["means"][0][-1][0] += 1.0

    forged(path, line, forge)
    problems = flight_problems(radmpc.load_flight(path))
    assert any("states a nominal of" in problem for problem in problems)


def test_legs_without_gusts_state_no_nominal_of_their_own() -> None:
    rows = staked_rows(beside_the_wall())
    legs = [row.leg for row in rows if row.leg is not None]
    assert legs
    assert all(leg.means is None for leg in legs)
