"""What every simulator asks of scenarios and segments."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arguments import check_rng
from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.flying.tick import Segment
from radmpc.model.given import check_scenario
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass

__all__ = [
    "Reference",
    "States",
    "check_simulated",
    "random_from",
    "started",
    "states_of",
]

States = tuple[Vector, ...]


def check_simulated(scenario: Scenario, what: str, dimensions: Sequence[int] = (2, 3)) -> None:
    """Refuse a scenario that bodies in continuous time cannot fly.

    Parameters
    ----------
    scenario : Scenario
        To be flown.
    what : str
        The simulator, for messages: "a boat".
    dimensions : sequence of int
        Coordinates it moves in.

    Raises
    ------
    ArgumentTypeError
        If it is no scenario.
    ScenarioError
        If collisions count at steps alone, or vehicles are no double integrators of that many axes.
    """
    check_scenario(scenario)
    if scenario.avoidance != "intervals":
        raise ScenarioError(
            f"must be 'intervals' to be flown with {what}, which is also somewhere between steps, "
            f"got {scenario.avoidance!r}: plan the scenario again with it",
            ("avoidance",),
        )
    if scenario.dimension not in dimensions:
        allowed = " or ".join(map(str, dimensions))
        raise ScenarioError(
            f"must have {allowed} coordinates to be flown with {what}, got {scenario.dimension}",
            ("vehicles", 0, "start"),
        )
    for i, vehicle in enumerate(scenario.vehicles):
        if vehicle.system.rates is None:
            raise ScenarioError(
                f"must be those of a double integrator to be flown with {what}, whose controls are "
                "accelerations",
                ("vehicles", i, "dynamics"),
            )


def random_from(rng: np.random.Generator | int | None) -> np.random.Generator:
    """Return a source of randomness from what a caller gives.

    Parameters
    ----------
    rng : Generator, int or None
        A source, its seed, or None for any.

    Raises
    ------
    ArgumentError
        If it is something else, or a seed below 0.
    """
    check_rng(rng)
    return np.random.default_rng(rng)


def started(scenario: Scenario, rng: np.random.Generator) -> tuple[Matrix, Matrix]:
    """Return where vehicles begin, drawn with their initial covariances.

    Parameters
    ----------
    scenario : Scenario
        Of double integrators.
    rng : Generator
        Source of the draw.

    Returns
    -------
    positions : (N, d) array
        [m].
    velocities : (N, d) array
        [m/s].
    """
    drawn = []
    for vehicle in scenario.vehicles:
        values, vectors = np.linalg.eigh(vehicle.initial_covariance)
        normals = rng.standard_normal(len(values))
        drawn.append(vehicle.start + vectors @ (np.sqrt(np.maximum(values, 0.0)) * normals))
    pairs = list(zip(scenario.vehicles, drawn, strict=True))
    positions = np.array([x[list(v.system.position)] for v, x in pairs])
    velocities = np.array([x[_rates(v.system.rates)] for v, x in pairs])
    return positions, velocities


def states_of(scenario: Scenario, positions: Matrix, velocities: Matrix) -> States:
    """Return positions and velocities as states, in the order of each vehicle's.

    Parameters
    ----------
    scenario : Scenario
        Of double integrators.
    positions, velocities : (N, d) array
        Of all vehicles [m], [m/s].
    """
    made = []
    for vehicle, place, speed in zip(scenario.vehicles, positions, velocities, strict=True):
        state = np.zeros(vehicle.system.num_states)
        state[list(vehicle.system.position)] = place
        state[_rates(vehicle.system.rates)] = speed
        made.append(state)
    return tuple(made)


def _rates(rates: tuple[tuple[int, ...], float] | None) -> list[int]:
    """Return the indices of a double integrator's velocities."""
    return [] if rates is None else list(rates[0])


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """Where all vehicles are to be during a step: parabolas of constant acceleration.

    Attributes
    ----------
    positions, velocities, accelerations : (N, d) array
        At its beginning [m], [m/s], and throughout [m/s²].
    """

    positions: Matrix
    velocities: Matrix
    accelerations: Matrix

    @classmethod
    def of(cls, segments: Sequence[Segment]) -> Reference:
        """Return what segments ask for.

        Parameters
        ----------
        segments : sequence of Segment
            Of double integrators, in the scenario's order.
        """
        return cls(
            np.array([one.position for one in segments]),
            np.array([one.velocity for one in segments]),
            np.array([one.control for one in segments]),
        )

    def at(self, time: float) -> tuple[Matrix, Matrix]:
        """Return positions and velocities, (N, d) each [m], [m/s].

        Parameters
        ----------
        time : float
            Since the step began [s].
        """
        moved = self.velocities + time * self.accelerations
        return self.positions + 0.5 * time * (self.velocities + moved), moved
