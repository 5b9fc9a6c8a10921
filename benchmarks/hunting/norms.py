"""Scenes of the hunt with limits of norms in place of limits of axes."""

from __future__ import annotations

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.records import replace

__all__ = ["with_norms"]


def with_norms(scenario: Scenario, seed: int, index: int) -> Scenario:
    """Return a scene whose controls and speeds are limited in all directions alike.

    Parameters
    ----------
    scenario : Scenario
        A scene.
    seed, index : int
        Its names, which decide how large norms are.

    Returns
    -------
    Scenario
        Norms are as large as the limits of axes were, to half as large again.
    """
    rng = np.random.default_rng([seed, index, 1])
    vehicles = []
    for vehicle in scenario.vehicles:
        control, speed = rng.uniform(1.0, 1.5, 2)
        limited = replace(
            vehicle,
            control_limit=None,
            control_norm=float(control * vehicle.control_limit.max()),
        )
        if vehicle.speed_limit is not None:
            fastest = float(speed * vehicle.speed_limit.max())
            limited = replace(limited, speed_limit=None, speed_norm=fastest)
        vehicles.append(limited)
    return replace(scenario, vehicles=tuple(vehicles))
