"""Quadrotors of the simulator rotorpy that follow a mission's segments in gusts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import ArgumentError, ScenarioError
from radmpc.flying.tick import Contact, Segment
from radmpc.model.scenario import Scenario
from radmpc.simulators.gusts import Gusts
from radmpc.simulators.optional import loaded, without
from radmpc.simulators.options import number_within, vector_within
from radmpc.simulators.surroundings import Surroundings
from radmpc.simulators.tracking import (
    Reference,
    States,
    check_simulated,
    random_from,
    started,
    states_of,
)

__all__ = ["Rotorpy"]

_SAMPLE = 0.01
"""Period of the controller and of looking for contacts, at most [s]: attitude needs 100 Hz."""

_KINDS = {"hummingbird": 0.27, "crazyflie": 0.07}
"""Kinds of quadrotor, with the radius of the ball about them, rotors included [m]."""


class Rotorpy:
    """Quadrotors with drag, motors that lag, and gusts; a controller on SE(3) tracks segments.

    Its own wind is not used, which is too weak by far and depends on the step: gusts are
    Ornstein-Uhlenbeck processes of a deviation that can be measured.

    Parameters
    ----------
    scenario : Scenario
        What is flown: double integrators in space, along intervals.
    rng : Generator, int or None
        Source of all that is random, or its seed.
    kind : {'hummingbird', 'crazyflie'}
        The quadrotor.
    wind : (3,) array_like
        Mean velocity of the air [m/s].
    gust : float
        Standard deviation of its variation along each axis, for each vehicle by itself [m/s].
    gust_time : float
        Time constant of that variation [s].
    motor_noise : float
        Standard deviation of the rotor speeds' noise, every hundredth of a second [rad/s].

    Raises
    ------
    ArgumentTypeError
        If an argument is of another kind.
    ArgumentError
        If a number is out of its range, or rotorpy is not installed.
    ScenarioError
        If the scenario is none for quadrotors.
    """

    def __init__(
        self,
        scenario: Scenario,
        rng: np.random.Generator | int | None = None,
        *,
        kind: str = "hummingbird",
        wind: Sequence[float] | str = (0.0, 0.0, 0.0),
        gust: float | str = 0.5,
        gust_time: float | str = 1.0,
        motor_noise: float | str = 0.0,
    ) -> None:
        check_simulated(scenario, "a quadrotor", (3,))
        if kind not in _KINDS:
            raise ArgumentError(f"kind must be one of {', '.join(_KINDS)}, got {kind!r}")
        _check_radii(scenario, kind)
        spread = number_within(gust, "gust", 0.0, 20.0, "m/s")
        memory = number_within(gust_time, "gust_time", 0.01, 1000.0, "s")
        jitter = number_within(motor_noise, "motor_noise", 0.0, 1000.0, "rad/s")
        self._wind = vector_within(wind, "wind", 3, 20.0, "m/s")
        self._scenario = scenario
        self._rng = random_from(rng)
        self._gusts = Gusts(np.full((scenario.num_vehicles, 3), spread), memory, self._rng)
        with without("torch"):  # which takes seconds to load, and is for batches alone
            vehicles = loaded("rotorpy.vehicles.multirotor", "rotorpy")
            controls = loaded("rotorpy.controllers.quadrotor_control", "rotorpy")
        known = loaded(f"rotorpy.vehicles.{kind}_params", "rotorpy").quad_params
        self._data: dict[str, Any] = {**known, "motor_noise_std": jitter}
        self._body = vehicles.Multirotor(self._data)
        self._controller = controls.SE3Control(self._data)
        self._num_samples = max(1, math.ceil(scenario.dt / _SAMPLE - 1e-9))
        self._surroundings = Surroundings(scenario)
        self.reset()

    def reset(self) -> tuple[States, tuple[Contact, ...]]:
        """Draw where vehicles begin, hovering level, and the gusts.

        Returns
        -------
        states : tuple of (6,) array
            In the scenario's order.
        contacts : tuple of Contact
            What is hit there already.
        """
        self._step = 0
        self._gusts.reset()
        # Rotorpy draws from numpy's global source: it gets one of its own for as long as it moves.
        self._legacy = np.random.RandomState(int(self._rng.integers(2**32))).get_state()
        hover = math.sqrt(self._data["mass"] * 9.81 / (4.0 * self._data["k_eta"]))
        positions, velocities = started(self._scenario, self._rng)
        self._bodies: list[dict[str, Vector]] = [
            {
                "x": place,
                "v": speed,
                "q": np.array([0.0, 0.0, 0.0, 1.0]),
                "w": np.zeros(3),
                "wind": self._wind,
                "rotor_speeds": np.full(4, hover),
            }
            for place, speed in zip(positions, velocities, strict=True)
        ]
        return self._states(), self._surroundings.at_start(positions)

    def advance(self, segments: Sequence[Segment]) -> tuple[States, tuple[Contact, ...]]:
        """Follow segments for a step.

        Parameters
        ----------
        segments : sequence of Segment
            What every vehicle is to do, in the scenario's order.

        Returns
        -------
        states : tuple of (6,) array
            Positions and velocities after it.
        contacts : tuple of Contact
            What was hit on the way.
        """
        reference = Reference.of(segments)
        self._step += 1
        tick = self._scenario.dt / self._num_samples
        visited = [[body["x"] for body in self._bodies]]
        with self._own_randomness():
            for number in range(self._num_samples):
                self._move(reference, number * tick, tick)
                visited.append([body["x"] for body in self._bodies])
        shares = np.linspace(0.0, 1.0, len(visited))
        contacts = self._surroundings.contacts(self._step, shares, np.array(visited))
        return self._states(), contacts

    def _states(self) -> States:
        """Return positions and velocities as states."""
        positions = np.array([body["x"] for body in self._bodies])
        velocities = np.array([body["v"] for body in self._bodies])
        return states_of(self._scenario, positions, velocities)

    def _move(self, reference: Reference, time: float, tick: float) -> None:
        """Move all bodies by a short time."""
        gusts = self._wind + self._gusts.advance(tick)
        places, velocities = reference.at(time)
        none = np.zeros(3)
        for i, body in enumerate(self._bodies):
            wanted = {
                "x": places[i],
                "x_dot": velocities[i],
                "x_ddot": reference.accelerations[i],
                "x_dddot": none,
                "x_ddddot": none,
                "yaw": 0.0,
                "yaw_dot": 0.0,
            }
            body["wind"] = gusts[i]
            command = self._controller.update(time, body, wanted)
            self._bodies[i] = self._body.step(body, command, tick)

    @contextmanager
    def _own_randomness(self) -> Iterator[None]:
        """Lend numpy's global source to rotorpy, and give it back as it was."""
        others = np.random.get_state()  # noqa: NPY002 - rotorpy draws from it
        np.random.set_state(self._legacy)  # noqa: NPY002 - rotorpy draws from it
        try:
            yield
        finally:
            self._legacy = np.random.get_state()  # noqa: NPY002 - rotorpy draws from it
            np.random.set_state(others)  # noqa: NPY002 - rotorpy draws from it


def _check_radii(scenario: Scenario, kind: str) -> None:
    """Refuse balls that the rotors do not fit in."""
    for i, vehicle in enumerate(scenario.vehicles):
        if vehicle.radius < _KINDS[kind]:
            raise ScenarioError(
                f"must be at least {_KINDS[kind]:g} m to be flown with a {kind}, rotors included, "
                f"got {vehicle.radius:g} m",
                ("vehicles", i, "radius"),
            )
