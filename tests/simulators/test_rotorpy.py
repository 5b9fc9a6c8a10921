from __future__ import annotations

import sys
from importlib.util import find_spec

import numpy as np
import pytest
from boats import asked, sea

from radmpc.errors import ArgumentError, ScenarioError
from radmpc.model.scenario import Scenario
from radmpc.simulators.rotorpy import Rotorpy

needs_rotorpy = pytest.mark.skipif(
    find_spec("rotorpy") is None, reason="needs: pip install 'radmpc[rotorpy]'"
)

SPACE = sea(dimension=3, radius=0.3, dt=0.5)
PATH = [[1.0, 0.0, 0.2], [0.0, 0.5, 0.0], [-1.0, -0.5, -0.2]]


def flown(seed: int = 0, **options: object) -> np.ndarray:
    """Return how far the model is off after each step, (steps, N, n)."""
    simulator = Rotorpy(SPACE, rng=seed, **options)  # type: ignore[arg-type] # of any kind
    states, contacts = simulator.reset()
    assert not contacts
    system = SPACE.vehicles[0].system
    rest = []
    for control in PATH:
        after, _ = simulator.advance(asked(SPACE, states, control))
        pairs = zip(states, after, strict=True)
        rest.append([y - system.A @ x - system.B @ control for x, y in pairs])
        states = after
    return np.array(rest)


@needs_rotorpy
@pytest.mark.slow
@pytest.mark.parametrize(("kind", "most"), [("hummingbird", 0.06), ("crazyflie", 0.15)])
def test_in_still_air_a_quadrotor_follows_its_segments(kind: str, most: float) -> None:
    # Gravity left out of the thrust, a step would end 1.2 m lower.
    assert np.abs(flown(kind=kind, gust=0.0)).max() < most


@needs_rotorpy
@pytest.mark.slow
def test_gusts_push_as_hard_as_they_are_told_to() -> None:
    still = flown(gust=0.0)
    light, heavy = ((flown(gust=gust) - still)[1:].std() for gust in (0.2, 0.8))
    assert 3.0 < heavy / light < 5.0


@needs_rotorpy
@pytest.mark.slow
def test_flights_depend_on_their_seed_alone_and_leave_the_source_of_others_as_it_was() -> None:
    twice = []
    for others in (1, 2):
        np.random.seed(others)  # noqa: NPY002 - the source that rotorpy draws from
        twice.append(flown(motor_noise=20.0))
        drawn = np.random.random()  # noqa: NPY002 - the source that rotorpy draws from
        assert drawn == np.random.RandomState(others).random()
    assert np.array_equal(*twice)
    assert not np.allclose(twice[0], flown(1, motor_noise=20.0))


@needs_rotorpy
def test_torch_is_neither_loaded_nor_made_out_to_be_missing() -> None:
    was_loaded = "torch" in sys.modules
    Rotorpy(SPACE, rng=0)
    assert ("torch" in sys.modules) == was_loaded


def test_without_the_extra_it_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("rotorpy")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "rotorpy", None)
    with pytest.raises(ArgumentError, match=r"^rotorpy is not installed: pip install 'radmpc"):
        Rotorpy(SPACE, rng=0)


@pytest.mark.parametrize(
    ("scenario", "line"),
    [
        (sea(), "must have 3 coordinates to be flown with a quadrotor, got 2"),
        (sea(dimension=3, avoidance="steps"), "avoidance: must be 'intervals'"),
        (sea(dimension=3, radius=0.1), "must be at least 0.27 m to be flown with a hummingbird"),
    ],
)
def test_a_scenario_for_no_quadrotor_is_refused_in_one_line(scenario: Scenario, line: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        Rotorpy(scenario, rng=0)
    assert line in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"kind": "albatross"}, "kind must be one of hummingbird, crazyflie, got 'albatross'"),
        ({"gust": -0.1}, "gust must be from 0 to 20 m/s, got -0.1"),
        ({"wind": (30.0, 0.0, 0.0)}, "wind must be at most 20 m/s, got [30.0, 0.0, 0.0]"),
        ({"wind": (1.0, 0.0)}, "wind must be 3 numbers, got (1.0, 0.0)"),
    ],
)
def test_what_no_quadrotor_flies_in_is_refused(options: dict[str, object], line: str) -> None:
    with pytest.raises(ArgumentError) as caught:
        Rotorpy(SPACE, **options)  # type: ignore[arg-type] # of any kind
    assert line in str(caught.value)
