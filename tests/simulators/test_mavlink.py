from __future__ import annotations

import socket
import sys
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
from boats import asked, sea

pytest.importorskip("pymavlink", reason="needs: pip install 'radmpc[mavlink]'")

from px4 import HOLD, Px4, free_port, in_the_air
from pymavlink.dialects.v20 import common

from radmpc.errors import ArgumentError, ArgumentTypeError, ScenarioError
from radmpc.simulators import mavlink
from radmpc.simulators.link import LinkError
from radmpc.simulators.mavlink import Mavlink

pytestmark = pytest.mark.waits

AIR = sea(dt=0.4, horizon=4)
ARM, MODE = common.MAV_CMD_COMPONENT_ARM_DISARM, common.MAV_CMD_DO_SET_MODE
STAYS = "accepts offboard mode, and does not enter it"
STARTS = tuple(vehicle.start for vehicle in AIR.vehicles)


@pytest.fixture(autouse=True)
def nothing_left(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(mavlink, "_BEFORE", 0.15)
    yield
    assert not [thread for thread in threading.enumerate() if thread.name == "mavlink"]


def pair(**wrong: object) -> tuple[Px4, Px4]:
    """Return the vehicles of `AIR` at a height of 5 m; what is wrong is so with the first."""
    port = free_port(2)
    east = Px4(port, (0.0, 0.0, -5.0), **wrong)  # type: ignore[arg-type] # of any kind
    return east, Px4(port + 1, (0.0, 14.0, -5.0))


def over(vehicles: tuple[Px4, Px4], patience: float = 5.0) -> Mavlink:
    """Return the backend for vehicles."""
    address = f"127.0.0.1:{vehicles[0].port}"
    return Mavlink(AIR, address=address, altitude=5.0, rate=50.0, patience=patience)


def hover(backend: Mavlink, steps: int) -> list[list[bool]]:
    """Stay for some steps, and return which vehicles' states are known after each."""
    known = []
    for _ in range(steps):
        states, _ = backend.advance(asked(AIR, STARTS, [0.0, 0.0]))
        known.append([bool(np.isfinite(state).all()) for state in states])
    return known


@pytest.mark.slow
def test_vehicles_follow_their_segments_and_hold_at_the_end() -> None:
    vehicles = pair(garbage=True)
    vehicles[0].start = (0.0, -3.0, -5.0)
    system = AIR.vehicles[0].system
    controls = [[1.0, 0.5], [0.0, 0.5], [-1.0, -1.0], [0.0, 0.0]]
    with in_the_air(*vehicles):
        backend = over(vehicles)
        states, contacts = backend.reset()
        # From 3 m beside its start it was brought there.
        assert np.abs(states[0][:2]).max() < 0.6
        # There it has come to rest: it does not only fly by.
        assert np.abs(states[0][2:]).max() < 0.6
        for control in controls:
            after, more = backend.advance(asked(AIR, states, control))
            contacts = (*contacts, *more)
            hoped = [system.A @ x + system.B @ control for x in states]
            assert np.abs(np.array(after) - hoped)[:, :2].max() < 0.3
            states = after
    assert not contacts
    for vehicle in vehicles:
        assert vehicle.modes == [(6, 0), HOLD, HOLD, HOLD]
    # North is y, east is x, down is not up.
    place, speed, push = next(s for s in reversed(vehicles[1].setpoints) if s[2, 1] == -1.0)
    assert push == pytest.approx([-1.0, -1.0, 0.0])
    assert place[1] > 13.0
    assert place[2] == pytest.approx(-5.0)
    assert speed[2] == 0.0


@pytest.mark.slow
def test_setpoints_are_streamed_while_a_decision_takes_its_time() -> None:
    vehicles = pair()
    with in_the_air(*vehicles):
        backend = over(vehicles)
        backend.reset()
        hover(backend, 1)
        # Half a second without any, and the vehicle would leave the mode.
        time.sleep(0.7)
        assert hover(backend, 1) == [[True, True]]
        backend.close()
    assert not any(vehicle.lost_setpoints for vehicle in vehicles)


@pytest.mark.slow
def test_the_first_step_is_flown_whole_however_long_its_decision_takes() -> None:
    vehicles = pair()
    system = AIR.vehicles[0].system
    with in_the_air(*vehicles):
        backend = over(vehicles)
        states, _ = backend.reset()
        time.sleep(2.0 * AIR.dt)
        after, _ = backend.advance(asked(AIR, states, [2.0, 1.0]))
        backend.close()
    hoped = [system.A @ x + system.B @ [2.0, 1.0] for x in states]
    # A step that is not flown would leave 0.8 m/s.
    assert np.abs(np.array(after) - hoped)[:, 2:].max() < 0.5


@pytest.mark.sampled(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("wrong", "line"),
    [
        ({"refuses": (ARM,)}, "vehicle 'east': arming was refused (denied)"),
        ({"refuses": (MODE,)}, "vehicle 'east': offboard was refused (denied)"),
        ({"ignores": (ARM,)}, "vehicle 'east': does not answer to arming, waited 0.8 s"),
        ({"blind": (-2.0, 0.0)}, "vehicle 'east': says nothing of where it is, waited 0.8 s"),
        ({"silent_after": -2.0}, "vehicle 'east': nothing is heard at {address}, waited 0.8 s"),
        ({"autopilot": 3}, "vehicle 'east': must be flown by PX4 (autopilot 12), got autopilot 3"),
        (
            {"stays": True},
            "vehicle 'east': accepts offboard mode, and does not enter it, waited 0.8 s",
        ),
        ({"start": (9.0, 99.0, -5.0)}, "vehicle 'east': does not get to its start, waited 0.8 s"),
    ],
)
def test_a_vehicle_that_cannot_be_taken_command_of_ends_the_flight(
    wrong: dict[str, object], line: str
) -> None:
    port = free_port(2)
    east = Px4(port, **{"start": (0.0, 0.0, -5.0), **wrong})  # type: ignore[arg-type] # of any kind
    west = Px4(port + 1, (0.0, 14.0, -5.0))
    with in_the_air(east, west), pytest.raises(LinkError) as caught:
        over((east, west), patience=0.8).reset()
    assert str(caught.value) == line.replace("{address}", f"127.0.0.1:{port}")


@pytest.mark.slow
def test_a_command_without_an_answer_is_sent_again_and_an_answered_one_is_not() -> None:
    vehicles = pair(loses=(MODE, ARM))
    with in_the_air(*vehicles):
        backend = over(vehicles)
        backend.reset()
        taken = [list(vehicle.heard) for vehicle in vehicles]
        backend.close()
    assert taken == [[(MODE, 0), (MODE, 1), (ARM, 0), (ARM, 1)], [(MODE, 0), (ARM, 0)]]


@pytest.mark.slow
def test_a_link_that_is_lost_ends_the_flight_and_the_others_hold() -> None:
    vehicles = pair(silent_after=0.5)
    with in_the_air(*vehicles):
        backend = over(vehicles, patience=0.6)
        backend.reset()
        with pytest.raises(LinkError, match=r"^vehicle 'east': not heard for 0.6 s$"):
            hover(backend, 4)
    assert vehicles[1].modes[-1] == HOLD


@pytest.mark.slow
def test_a_pilot_who_takes_over_ends_the_flight_and_is_left_alone() -> None:
    vehicles = pair(pilot_after=0.5)
    with in_the_air(*vehicles):
        backend = over(vehicles)
        backend.reset()
        line = r"^vehicle 'east': left offboard mode \(position control\): a pilot or a failsafe"
        with pytest.raises(LinkError, match=line):
            hover(backend, 4)
    assert HOLD not in vehicles[0].modes
    assert vehicles[1].modes[-1] == HOLD


@pytest.mark.slow
def test_motors_that_stop_end_the_flight() -> None:
    vehicles = pair(fails_after=0.5)
    with in_the_air(*vehicles):
        backend = over(vehicles)
        backend.reset()
        with pytest.raises(LinkError, match=r"^vehicle 'east': was disarmed$"):
            hover(backend, 4)
    assert vehicles[1].modes[-1] == HOLD


@pytest.mark.slow
def test_who_was_never_commanded_is_not_told_to_hold() -> None:
    vehicles = pair(refuses=(MODE,))
    with in_the_air(*vehicles), pytest.raises(LinkError, match="offboard was refused"):
        over(vehicles).reset()
    assert HOLD not in vehicles[0].modes


@pytest.mark.slow
def test_a_state_that_comes_late_is_no_measurement_and_the_next_one_is() -> None:
    vehicles = pair(blind=(0.1, 1.1))
    with in_the_air(*vehicles):
        backend = over(vehicles)
        backend.reset()
        known = hover(backend, 4)
    assert [False, True] in known
    assert known[-1] == [True, True]


def test_two_cannot_listen_at_one_port() -> None:
    port = free_port(2)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", port + 1))
        with pytest.raises(LinkError, match=r"^vehicle 'west': cannot listen at 127"):
            Mavlink(AIR, address=f"127.0.0.1:{port}").reset()


def test_nobody_is_steered_who_was_not_taken_command_of() -> None:
    told = r"^not in command of the vehicles: call reset before advance$"
    with pytest.raises(LinkError, match=told):
        Mavlink(AIR).advance(asked(AIR, STARTS, [0.0, 0.0]))


def test_without_pymavlink_its_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pymavlink.dialects.v20.common", None)
    with pytest.raises(ArgumentError, match=r"^pymavlink is not installed: pip install 'radmpc"):
        Mavlink(AIR)


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"address": "14540"}, "address must be HOST:PORT, and have ports for 2 vehicles, got"),
        ({"address": "a:65535"}, "address must be HOST:PORT, and have ports for 2 vehicles, got"),
        ({"homes": "here"}, "homes must be 'origin' or 'starts', got 'here'"),
        ({"rate": "1"}, "rate must be from 5 to 200 1/s, got 1"),
        ({"patience": "long"}, "patience must be a number, got 'long'"),
        ({"clock": "1"}, "clock must be a function, got '1'"),
        ({"sleep": "1"}, "sleep must be a function, got '1'"),
    ],
)
def test_what_is_no_way_to_speak_is_refused(options: dict[str, object], line: str) -> None:
    with pytest.raises((ArgumentError, ArgumentTypeError)) as caught:
        Mavlink(AIR, **options)  # type: ignore[arg-type] # of any kind
    assert line in str(caught.value)


def test_steps_are_refused_for_vehicles_that_are_somewhere_between() -> None:
    with pytest.raises(ScenarioError, match=r"^avoidance: must be 'intervals' to be flown with"):
        Mavlink(sea(avoidance="steps"))
