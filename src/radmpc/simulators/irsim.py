"""Robots with two driven wheels, of the simulator ir-sim, that follow a mission's segments."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.flying.tick import Contact, Segment
from radmpc.model.scenario import Scenario
from radmpc.simulators.optional import loaded
from radmpc.simulators.options import number_within
from radmpc.simulators.surroundings import Surroundings
from radmpc.simulators.tracking import (
    Reference,
    States,
    check_simulated,
    random_from,
    started,
    states_of,
)

__all__ = ["IrSim"]

_SAMPLE = 0.1
"""Step of the simulation, at most [s]; ir-sim draws its noise anew at each."""

_PULL = 2.0
"""Speed toward the reference by distance from it [1/s]: a fifth of it is undone in every step."""

_SPARE = 3.0
"""Speed of the wheels above the largest that plans may have [m/s], for what the tracking adds."""


class IrSim:
    """Differential drives, tracked at a point ahead of their axle.

    A point on the axle cannot move across; one ahead of it can, by turning. The scenario's vehicle
    is that point, and its disc must hold the body wherever that is about it: the body is a disc of
    the scenario's radius less the distance. A differential drive has no inertia, its velocity is
    what its wheels were last told.

    Parameters
    ----------
    scenario : Scenario
        What is flown: double integrators in the plane, along intervals, radii above ``lead``.
    rng : Generator, int or None
        Source of all that is random, or its seed.
    lead : float
        From the axle to the point that is tracked [m].
    slip : float
        Variance of the wheels' speed in shares of its square [-], ir-sim's ``alpha``.

    Raises
    ------
    ArgumentTypeError
        If an argument is of another kind.
    ArgumentError
        If a number is out of its range, or ir-sim is not installed.
    ScenarioError
        If the scenario is none for such robots.
    """

    def __init__(
        self,
        scenario: Scenario,
        rng: np.random.Generator | int | None = None,
        *,
        lead: float | str = 0.2,
        slip: float | str = 0.03,
    ) -> None:
        check_simulated(scenario, "robots on wheels", (2,))
        self._lead = number_within(lead, "lead", 0.01, 10.0, "m")
        self._slip = number_within(slip, "slip", 0.0, 1.0, "")
        for i, vehicle in enumerate(scenario.vehicles):
            if vehicle.radius <= self._lead:
                raise ScenarioError(
                    f"must be above {self._lead:g} m to be flown with robots on wheels, which are "
                    f"tracked so far ahead of their axle, got {vehicle.radius:g} m",
                    ("vehicles", i, "radius"),
                )
        self._scenario = scenario
        self._rng = random_from(rng)
        self._num_samples = max(1, math.ceil(scenario.dt / _SAMPLE - 1e-9))
        self._tick = scenario.dt / self._num_samples
        self._surroundings = Surroundings(scenario, margin=-self._lead)
        self._world = self._made()
        self.reset()

    def reset(self) -> tuple[States, tuple[Contact, ...]]:
        """Draw where robots begin; they face their goals.

        Returns
        -------
        states : tuple of (4,) array
            In the scenario's order.
        contacts : tuple of Contact
            What is hit there already.
        """
        self._step = 0
        self._world.set_random_seed(int(self._rng.integers(2**32)))
        points, self._velocities = started(self._scenario, self._rng)
        for robot, point, vehicle in zip(
            self._world.robot_list, points, self._scenario.vehicles, strict=True
        ):
            x, y = 0.5 * (vehicle.goal.lower + vehicle.goal.upper)[:2] - point
            heading = math.atan2(y, x)
            axle = point - self._lead * np.array([math.cos(heading), math.sin(heading)])
            robot.set_state([*axle, heading])
        axles, points = self._places()
        found = self._surroundings.contacts(0, np.zeros(1), axles[None], points[None])
        return states_of(self._scenario, points, self._velocities), found

    def advance(self, segments: Sequence[Segment]) -> tuple[States, tuple[Contact, ...]]:
        """Follow segments for a step.

        Parameters
        ----------
        segments : sequence of Segment
            What every robot is to do, in the scenario's order.

        Returns
        -------
        states : tuple of (4,) array
            Positions of the tracked points, and their velocities, after it.
        contacts : tuple of Contact
            What was hit on the way.
        """
        reference = Reference.of(segments)
        self._step += 1
        places = [self._places()]
        for number in range(self._num_samples):
            self._move(reference, number * self._tick, places[-1][1])
            places.append(self._places())
        axles, points = (np.array(part) for part in zip(*places, strict=True))
        shares = np.linspace(0.0, 1.0, len(places))
        found = self._surroundings.contacts(self._step, shares, axles, points)
        return states_of(self._scenario, points[-1], self._velocities), found

    def _move(self, reference: Reference, time: float, points: Matrix) -> None:
        """Drive all robots for a short time."""
        # The mean velocity over the time, for it is held.
        hoped, velocities = reference.at(time)
        ahead, later = reference.at(time + self._tick)
        wanted = (ahead - hoped) / self._tick + _PULL * (hoped - points)
        self._velocities = wanted + later - 0.5 * (velocities + later)
        headings = [float(robot.state[2, 0]) for robot in self._world.robot_list]
        actions = [
            self._wheels(velocity, heading)
            for velocity, heading in zip(wanted, headings, strict=True)
        ]
        self._world.step(actions, list(range(len(actions))))

    def _wheels(self, velocity: Vector, heading: float) -> Matrix:
        """Return speed ahead and turn that move the tracked point by a velocity, (2, 1)."""
        cosine, sine = math.cos(heading), math.sin(heading)
        x, y = velocity
        return np.array([[cosine * x + sine * y], [(cosine * y - sine * x) / self._lead]])

    def _places(self) -> tuple[Matrix, Matrix]:
        """Return the middles of the axles, and the tracked points, (N, 2) each [m]."""
        poses = np.array([robot.state[:3, 0] for robot in self._world.robot_list])
        headings = np.stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])], axis=1)
        return poses[:, :2], poses[:, :2] + self._lead * headings

    def _made(self) -> Any:
        """Return ir-sim's world, made from a file, as it wants it."""
        limits = [v.speed_limit for v in self._scenario.vehicles]
        known = [float(np.max(limit)) for limit in limits if limit is not None]
        # Speeds above its limit, 1 m/s unless told otherwise, ir-sim clips without a word.
        most = 2.0 * max((speed for speed in known if math.isfinite(speed)), default=30.0) + _SPARE
        robots = [
            {
                "kinematics": {
                    "name": "diff",
                    "noise": self._slip > 0.0,
                    "alpha": [self._slip, 0.0, 0.0, self._slip],
                },
                "shape": {"name": "circle", "radius": float(vehicle.radius - self._lead)},
                "state": [0.0, 0.0, 0.0],
                "vel_max": [most, most / self._lead],
                "vel_min": [-most, -most / self._lead],
            }
            for vehicle in self._scenario.vehicles
        ]
        world = {
            "step_time": self._tick,
            "sample_time": self._tick,
            # A vehicle in contact would stand still for the rest of the flight.
            "collision_mode": "unobstructed",
        }
        irsim = loaded("irsim", "irsim")
        with TemporaryDirectory() as folder:
            path = Path(folder) / "world.yaml"
            path.write_text(json.dumps({"world": world, "robot": robots}), encoding="utf-8")
            return irsim.make(str(path), headless=True, display=False, log_level="ERROR", seed=0)
