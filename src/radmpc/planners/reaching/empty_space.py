"""One vehicle of a scenario by itself, with nothing in the way."""

from __future__ import annotations

from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

__all__ = ["in_empty_space"]


def in_empty_space(scenario: Scenario, vehicle: Vehicle, horizon: int | None = None) -> Scenario:
    """Return the scenario of one vehicle in empty space.

    Parameters
    ----------
    scenario : Scenario
        Whose step, risk bound and kind of avoidance count.
    vehicle : Vehicle
        Its own, or one with other limits, visits or feedback.
    horizon : int or None
        Number of steps; None is the scenario's.

    Returns
    -------
    Scenario
        Without obstacles, workspace and other vehicles.
    """
    return Scenario(
        name=scenario.name,
        dt=scenario.dt,
        horizon=scenario.horizon if horizon is None else horizon,
        risk_bound=scenario.risk_bound,
        vehicles=(vehicle,),
        avoidance=scenario.avoidance,
    )
