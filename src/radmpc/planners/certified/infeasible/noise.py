"""The same scenario under less noise."""

from __future__ import annotations

from dataclasses import replace

from radmpc.model.obstacle import Obstacle, TrackShape
from radmpc.model.scenario import Scenario

__all__ = ["with_noise"]


def with_noise(scenario: Scenario, factor: float) -> Scenario:
    """Return a scenario with all variances multiplied, those of obstacles' tracks included.

    Parameters
    ----------
    scenario : Scenario
        The scenario.
    factor : float
        Of variances, above 0 [-].
    """
    vehicles = tuple(
        replace(
            vehicle,
            initial_covariance=factor * vehicle.initial_covariance,
            disturbance_covariance=factor * vehicle.disturbance_covariance,
        )
        for vehicle in scenario.vehicles
    )
    obstacles = tuple(_known_better(obstacle, factor) for obstacle in scenario.obstacles)
    return replace(scenario, vehicles=vehicles, obstacles=obstacles)


def _known_better(obstacle: Obstacle, factor: float) -> Obstacle:
    """Return an obstacle whose track is known as much better."""
    if not isinstance(obstacle.shape, TrackShape) or obstacle.spread is None:
        return obstacle
    shape = replace(
        obstacle.shape,
        covariance=factor * obstacle.shape.covariance,
        disturbance_covariance=factor * obstacle.shape.disturbance_covariance,
    )
    # Without a step it is laid out anew.
    return replace(obstacle, shape=shape, dt=None)
