from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from boats import asked, sea

from radmpc.errors import ArgumentError, ArgumentTypeError, ScenarioError
from radmpc.flying.backends import backend_named
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.simulators import boat
from radmpc.simulators.boat import Boat
from radmpc.simulators.otter import OTTER, accelerations, thrust_of

CALM = {"force": 0.0, "current_deviation": 0.0}


def settled(forces: tuple[float, float, float]) -> tuple[float, ...]:
    """Return the velocities through the water that constant forces lead to."""
    speeds = (0.0, 0.0, 0.0)
    for _ in range(600):
        rates = accelerations(OTTER, speeds, forces)
        u, v, r = (old + 0.05 * rate for old, rate in zip(speeds, rates, strict=True))
        speeds = u, v, r
    return speeds


def test_full_thrust_leads_to_the_published_top_speed() -> None:
    u, v, r = settled((2.0 * OTTER.thrust_ahead, 0.0, 0.0))
    assert u == pytest.approx(6.0 * 0.5144, rel=1e-3)
    assert v == pytest.approx(0.0, abs=1e-9)
    assert r == pytest.approx(0.0, abs=1e-9)


def test_a_boat_that_turns_left_slides_outward() -> None:
    _, v, r = settled((100.0, 0.0, 20.0))
    assert r > 0.05
    assert v < -0.01


def test_only_damping_takes_energy_from_a_boat() -> None:
    rng = np.random.default_rng(0)
    surge, sway, yaw = OTTER.inertia
    coupling = OTTER.mass * OTTER.lead
    undamped = replace(OTTER, damping=(0.0, 0.0, 0.0), yaw_damping=0.0, cross_flow=0.0)
    for u, v, r in (rng.normal(size=(50, 3)) * [2.0, 0.5, 0.4]).tolist():
        momentum = surge * u, sway * v + coupling * r, coupling * v + yaw * r
        kept, lost = (
            sum(p * a for p, a in zip(momentum, rates, strict=True))
            for rates in (
                accelerations(kind, (u, v, r), (0.0, 0.0, 0.0)) for kind in (undamped, OTTER)
            )
        )
        assert abs(kept) < 1e-9
        assert lost < 0.0


def test_propellers_give_what_they_can_and_the_moment_first() -> None:
    assert thrust_of(OTTER, 50.0, 10.0) == pytest.approx((25.0 - 5.0 / 0.395, 25.0 + 5.0 / 0.395))
    assert thrust_of(OTTER, 1000.0, 0.0) == pytest.approx([OTTER.thrust_ahead] * 2)
    left, right = thrust_of(OTTER, 1000.0, 60.0)
    assert 0.395 * (right - left) == pytest.approx(60.0)
    assert right == pytest.approx(OTTER.thrust_ahead)


def flown(scenario: Scenario, controls: list[list[float]], **options: object) -> np.ndarray:
    """Return how far the model is off after each step, (steps, N, n)."""
    simulator = Boat(scenario, rng=4, **options)  # type: ignore[arg-type] # of any kind
    states, _ = simulator.reset()
    rest = []
    for control in controls:
        after, _ = simulator.advance(asked(scenario, states, control))
        system = scenario.vehicles[0].system
        pairs = zip(states, after, strict=True)
        rest.append([y - system.A @ x - system.B @ control for x, y in pairs])
        states = after
    return np.array(rest)


SLALOM = [[0.2, 0.0], [0.2, 0.0], [0.0, 0.1], [0.0, -0.1], [0.0, -0.1], [0.0, 0.1], [-0.2, 0.0]]


STRAIGHT = [[0.2, 0.0], [0.2, 0.0], [0.2, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]]


def test_a_calm_sea_is_sailed_as_planned() -> None:
    assert np.abs(flown(sea(), STRAIGHT, **CALM)).max() < 0.04
    # No boat can turn at once: the first step across ends 0.2 m off.
    assert 0.02 < np.abs(flown(sea(), SLALOM, **CALM)).max() < 0.25


def test_a_steady_current_is_found_out_and_sailed_against() -> None:
    rest = flown(sea(), STRAIGHT, current=(0.0, 0.3), **CALM)
    # Without the estimate of the current a step would end 0.6 m off.
    assert np.abs(rest[3:, :, :2]).max() < 0.15


def test_a_finer_simulation_moves_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    coarse = flown(sea(), SLALOM[:5], **CALM)
    monkeypatch.setattr(boat, "_SAMPLE", 0.0125)
    assert np.abs(flown(sea(), SLALOM[:5], **CALM) - coarse).max() < 0.02


def test_the_sea_pushes_as_hard_as_it_is_told_to() -> None:
    still = flown(sea(), STRAIGHT, **CALM)
    light, heavy = (
        (flown(sea(), STRAIGHT, force=force, current_deviation=0.0) - still)[1:].std()
        for force in (5.0, 20.0)
    )
    assert 3.5 < heavy / light < 4.5


def test_options_may_be_given_as_they_are_typed() -> None:
    typed = flown(sea(), STRAIGHT[:1], force="5", current="0.1,-0.2")
    assert np.array_equal(typed, flown(sea(), STRAIGHT[:1], force=5.0, current=[0.1, -0.2]))


def test_the_same_seed_is_the_same_sea_and_another_is_not() -> None:
    def end(seed: int, resets: int) -> np.ndarray:
        simulator = Boat(sea(), rng=seed)
        for _ in range(resets):
            states, _ = simulator.reset()
        return np.array(simulator.advance(asked(sea(), states, [0.1, 0.1]))[0])

    assert np.array_equal(end(1, 1), end(1, 1))
    assert not np.allclose(end(1, 1), end(1, 2))
    assert not np.allclose(end(1, 1), end(2, 1))


def test_a_boat_that_runs_into_a_rock_says_so_at_that_step() -> None:
    scenario = sea(obstacles=(Obstacle.box("rock", [5.0, -1.0], [6.0, 1.0]),))
    simulator = Boat(scenario, rng=0, **CALM)
    states, contacts = simulator.reset()
    assert not contacts
    told = []
    for _ in range(4):
        states, contacts = simulator.advance(asked(scenario, states, [0.2, 0.0]))
        told += [(c.step, c.vehicle, c.other) for c in contacts]
    # With 0.2 m/s² the disc of 1.2 m gets to 3.8 m after 6.2 s.
    assert told[0] == (4, "east", "rock")


@pytest.mark.parametrize(
    ("scenario", "line"),
    [
        (sea(avoidance="steps"), "avoidance: must be 'intervals' to be flown with a boat"),
        (sea(dimension=3), "must have 2 coordinates to be flown with a boat, got 3"),
        (sea(radius=0.5), "radius: must be at least 1.14 m to be flown with a boat"),
    ],
)
def test_a_scenario_for_no_boat_is_refused_in_one_line(scenario: Scenario, line: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        Boat(scenario, rng=0)
    assert line in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("options", "kind", "line"),
    [
        ({"force": -1.0}, ArgumentError, "force must be from 0 to 500 N, got -1"),
        ({"force": "much"}, ArgumentTypeError, "force must be a number, got 'much'"),
        ({"gust_time": 0.0}, ArgumentError, "gust_time must be from 0.01 to 1000 s, got 0"),
        ({"current": (3.0, 0.0)}, ArgumentError, "current must be at most 2 m/s, got [3.0, 0.0]"),
        ({"current": (3.0,)}, ArgumentTypeError, "current must be 2 numbers, got"),
        ({"current": "1,x"}, ArgumentTypeError, "current must be 2 numbers, got '1,x'"),
        ({"current": 3.0}, ArgumentTypeError, "current must be 2 numbers, got 3.0"),
        ({"rng": -1}, ArgumentError, "rng"),
    ],
)
def test_options_out_of_range_are_refused(
    options: dict[str, object], kind: type[Exception], line: str
) -> None:
    with pytest.raises(kind) as caught:
        Boat(sea(), **options)  # type: ignore[arg-type] # of any kind
    assert line in str(caught.value)


def test_a_boat_is_found_by_its_name_with_options_as_typed() -> None:
    made = backend_named("boat").make(sea(), rng=1, force="5", current="0.2,0")
    with pytest.raises(ArgumentError, match=r"takes no option 'sail'"):
        backend_named("boat").make(sea(), rng=1, sail="up")
    states, _ = made.reset()
    assert np.array_equal(states, Boat(sea(), rng=1, force=5.0, current=(0.2, 0.0)).reset()[0])
