"""How far vehicles of a plan stray from their mean paths, alone and from each other."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.model.noise.positions import (
    PositionResponse,
    position_response,
    side_by_side,
    without_common,
)
from radmpc.model.plan import Plan
from radmpc.records import dataclass

__all__ = ["Deviations", "deviations"]


@dataclass(frozen=True, slots=True, eq=False)
class Deviations:
    """Covariances of the places of a plan's vehicles.

    Attributes
    ----------
    at_steps : (v, T+1, d, d) array
        Of every vehicle's position at the steps [m²].
    between : (v, p, d, d) array
        The same at ``count`` points per step, between steps interpolated [m²].
    responses : tuple of (PositionResponse or None)
        What the disturbances that vehicles share make of their positions.
    count : int
        Points per step.
    """

    at_steps: Tensor
    between: Tensor
    responses: tuple[PositionResponse | None, ...]
    count: int

    @property
    def most(self) -> float:
        """A standard deviation that no vehicle's place exceeds in any direction [m]."""
        return float(np.sqrt(np.trace(self.between, axis1=2, axis2=3).max()))

    @property
    def most_of_pairs(self) -> float:
        """A standard deviation that no place relative to another vehicle's exceeds [m]."""
        # Answers to a shared disturbance may be opposite.
        sharing = sum(response is not None for response in self.responses)
        return (2.0 if sharing > 1 else float(np.sqrt(2.0))) * self.most

    def of_pair(self, i: int, j: int) -> Tensor:
        """Return the covariances of the place of one vehicle relative to another's, (p, d, d) [m²].

        Parameters
        ----------
        i, j : int
            Numbers of the vehicles.
        """
        one, two = self.responses[i], self.responses[j]
        if one is None or two is None:
            return np.asarray(self.between[i] + self.between[j])
        columns, places = [one.columns, two.columns], [one.positions, two.positions]
        total = self.at_steps[i] + self.at_steps[j]
        return _refined(without_common(total, *side_by_side(columns, places)), self.count)


def deviations(plan: Plan, count: int) -> Deviations:
    """Return how far the vehicles of a plan stray.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    count : int
        Points per step.
    """
    horizon = plan.scenario.horizon
    at_steps, responses = [], list[PositionResponse | None]()
    for vehicle, trajectory in zip(plan.scenario.vehicles, plan.trajectories, strict=True):
        axes = list(vehicle.system.position)
        at_steps.append(trajectory.covariances[:, axes][:, :, axes])
        noise = vehicle.noise
        responses.append(position_response(vehicle.system, noise, vehicle.gain, horizon))
    between = np.array([_refined(coarse, count) for coarse in at_steps])
    return Deviations(np.array(at_steps), between, tuple(responses), count)


def _refined(coarse: Tensor, count: int) -> Tensor:
    """Return what is known at the steps, (T+1, ...), at ``count`` points per step, (p, ...)."""
    share = np.linspace(0.0, len(coarse) - 1.0, count * (len(coarse) - 1) + 1)
    low = np.minimum(share.astype(int), len(coarse) - 2)
    part: Matrix = (share - low)[:, None, None]
    return np.asarray((1.0 - part) * coarse[low] + part * coarse[low + 1])
