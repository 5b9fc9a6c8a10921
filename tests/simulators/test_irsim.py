from __future__ import annotations

import sys
from importlib.util import find_spec

import numpy as np
import pytest
from boats import asked, sea

from radmpc.errors import ArgumentError, ScenarioError
from radmpc.model.scenario import Scenario
from radmpc.simulators.irsim import IrSim

needs_irsim = pytest.mark.skipif(
    find_spec("irsim") is None, reason="needs: pip install 'radmpc[irsim]'"
)

ROOM = sea(radius=0.6, dt=1.0)
PATH = [[1.0, 0.0], [1.0, 0.5], [0.0, -0.5], [-1.0, 0.0]]


def flown(simulator: IrSim, path: list[list[float]] = PATH) -> np.ndarray:
    """Return how far the model is off after each step, (steps, N, n)."""
    states, contacts = simulator.reset()
    assert not contacts
    system = ROOM.vehicles[0].system
    rest = []
    for control in path:
        after, _ = simulator.advance(asked(ROOM, states, control))
        pairs = zip(states, after, strict=True)
        rest.append([y - system.A @ x - system.B @ control for x, y in pairs])
        states = after
    return np.array(rest)


@needs_irsim
@pytest.mark.slow
def test_wheels_that_do_not_slip_follow_their_segments_above_the_silent_limit_of_1_m_s() -> None:
    assert np.abs(flown(IrSim(ROOM, rng=0, slip=0.0))[..., :2]).max() < 0.03


@needs_irsim
def test_slipping_wheels_stray_the_more_the_faster_they_turn() -> None:
    simulator = IrSim(ROOM, rng=0)
    still, fast = (flown(simulator, [[x, 0.0]] * 6)[..., :2].std() for x in (0.0, 0.6))
    assert still < 0.002
    assert fast > 0.01


@needs_irsim
def test_the_same_seed_is_the_same_drive_whatever_else_is_driven_meanwhile() -> None:
    one, other, again = IrSim(ROOM, rng=3), IrSim(ROOM, rng=4), IrSim(ROOM, rng=3)
    first = flown(one)
    flown(other, PATH[:1])
    assert np.array_equal(first, flown(again))
    assert not np.allclose(first, flown(one))


@needs_irsim
def test_bodies_touch_where_ir_sim_says_they_do() -> None:
    simulator = IrSim(ROOM, rng=0, slip=0.0)
    states, _ = simulator.reset()
    told, theirs = [], []
    for step in range(1, 9):
        pushes = [asked(ROOM, states, [a, 0.0])[i] for i, a in enumerate((0.4, -0.4))]
        states, contacts = simulator.advance(pushes)
        told += [step for contact in contacts if contact.cause == "pair"]
        theirs += [step] if simulator._world.robot_list[0].collision_flag else []
    # Bodies of 0.4 m about points that meet half-way after 14 m at 0.4 m/s² each.
    assert told[0] == 6
    assert theirs[0] == 6


@needs_irsim
def test_nothing_is_printed(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.split(".")[0] == "irsim"]:
        monkeypatch.delitem(sys.modules, name)
    flown(IrSim(ROOM, rng=0))
    assert capfd.readouterr().out == ""


def test_ir_sim_missing_is_told_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.split(".")[0] == "irsim"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "irsim", None)
    with pytest.raises(ArgumentError, match=r"^irsim is not installed: pip install 'radmpc"):
        IrSim(ROOM, rng=0)


@pytest.mark.parametrize(
    ("scenario", "line"),
    [
        (sea(dimension=3), "must have 2 coordinates to be flown with robots on wheels, got 3"),
        (
            sea(avoidance="steps"),
            "avoidance: must be 'intervals' to be flown with robots on wheels",
        ),
        (sea(radius=0.2), "radius: must be above 0.2 m to be flown with robots on wheels"),
    ],
)
def test_a_scenario_for_no_robot_on_wheels_is_refused(scenario: Scenario, line: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        IrSim(scenario, rng=0)
    assert line in str(caught.value)
    assert "\n" not in str(caught.value)
