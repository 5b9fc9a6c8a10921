"""Vehicles that are shaken and steered alike: what noise makes of them is propagated once."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from radmpc.arrays import Tensor, frozen

if TYPE_CHECKING:
    from radmpc.model.vehicle import Vehicle

__all__ = ["covariances_of_all"]


def covariances_of_all(vehicles: Iterable[Vehicle], horizon: int) -> list[Tensor]:
    """Return the state covariances of vehicles, as `Vehicle.covariances` does.

    Parameters
    ----------
    vehicles : iterable of Vehicle
        Of a scenario file every vehicle has a system and noise of its own, the same as others'.
    horizon : int
        Number of steps T.

    Returns
    -------
    list of (T+1, n, n) array
        Covariances at k = 0..T, read-only.
    """
    known: dict[tuple[bytes, ...], Tensor] = {}
    found = []
    for vehicle in vehicles:
        if vehicle.has_memory:
            found.append(vehicle.covariances(horizon))
            continue
        gain = b"" if vehicle.gain is None else vehicle.gain.tobytes()
        system, noise = vehicle.system, (vehicle.initial_covariance, vehicle.disturbance_covariance)
        key = system.A.tobytes(), system.B.tobytes(), gain, *(each.tobytes() for each in noise)
        if key not in known:
            known[key] = frozen(vehicle.covariances(horizon))
        found.append(known[key])
    return found
