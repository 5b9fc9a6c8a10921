"""Obstacles so small beside the noise that the referee may certify means within them.

At steps in the plane the referee integrates over obstacles, while programs keep every mean outside
of them: where these leave no plan, there may be one through what is rarely hit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Tensor
from radmpc.geometry import Polytope
from radmpc.model.obstacle import Obstacle
from radmpc.model.relations.concerns import is_for
from radmpc.model.scenario import Scenario
from radmpc.planners.wording import listed
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass, replace

__all__ = ["RarelyHit", "rarely_hit"]


@dataclass(frozen=True, slots=True, eq=False)
class RarelyHit:
    """A scenario without the obstacles that are rarely hit, wherever means are.

    Attributes
    ----------
    scenario : Scenario
        Without them: what bounds the cost of its plans bounds that of the whole scenario's.
    names : tuple of str
        What was left out.
    risk : float
        What hitting them at the horizon risks at most, together [-].
    """

    scenario: Scenario
    names: tuple[str, ...]
    risk: float

    @property
    def text(self) -> str:
        """What is said of a plan that was made so."""
        named = listed([f"obstacle {name!r}" for name in self.names])
        return (
            f"Planned through {named}, small enough beside the noise for a certificate to hold "
            "with means inside."
        )


def rarely_hit(scenario: Scenario, models: Sequence[CondensedModel]) -> RarelyHit | None:
    """Return a scenario without what is rarely hit.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    models : sequence of CondensedModel
        Its vehicles over the whole horizon.

    Returns
    -------
    RarelyHit or None
        None where there is no such obstacle, or the referee charges half-spaces: along intervals,
        in space, and under covariances that are known up to a factor.
    """
    are_integrated = scenario.avoidance == "steps" and scenario.dimension == 2
    if not are_integrated or scenario.covariance_samples is not None:
        return None
    risks = [(_most_at_horizon(one, models), one.name) for one in scenario.obstacles]
    names, total = [], 0.0
    for risk, name in sorted(risks):
        if total + risk < scenario.risk_bound:
            names.append(name)
            total += risk
    if not names:
        return None
    kept = tuple(one for one in scenario.obstacles if one.name not in names)
    return RarelyHit(replace(scenario, obstacles=kept), tuple(names), total)


def _most_at_horizon(obstacle: Obstacle, models: Sequence[CondensedModel]) -> float:
    """Return what all that meet an obstacle risk at the horizon at most, wherever their means."""
    total = 0.0
    for model in models:
        if not is_for(obstacle, model.vehicle.name):
            continue
        covariance = model.position_covariances[-1]
        if obstacle.spread is not None:
            covariance = covariance + obstacle.spread.positions[-1]
        for piece in obstacle.at(model.horizon):
            total += _most(piece, model.vehicle.radius, covariance)
    return total


def _most(piece: Polytope, radius: float, covariance: Tensor) -> float:
    """Return a bound on the probability of hitting a polygon, wherever the mean is.

    The largest density times the area, or that of the strip between two parallel sides.
    """
    after = np.roll(piece.vertices, -1, axis=0)
    x, y = piece.vertices.T
    area = 0.5 * abs(float(x @ after[:, 1] - y @ after[:, 0]))
    outline = float(np.linalg.norm(after - piece.vertices, axis=1).sum())
    grown = area + radius * outline + np.pi * radius**2
    determinant = max(float(np.linalg.det(covariance)), 0.0)
    widths = piece.support(piece.normals) + piece.support(-piece.normals) + 2.0 * radius
    variances = np.sum((piece.normals @ covariance) * piece.normals, axis=1)
    with np.errstate(divide="ignore"):
        strips = widths / np.sqrt(2.0 * np.pi * np.maximum(variances, 0.0))
        within = grown / (2.0 * np.pi * np.sqrt(np.float64(determinant)))
    return float(min(1.0, within, strips.min()))
