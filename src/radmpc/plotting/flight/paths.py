"""What was flown and what was still to come at each step, as trajectories. No matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.io.flight.following import Followed
from radmpc.io.flight.record import FlightRecord, FlownMission
from radmpc.model.plan import Trajectory
from radmpc.model.vehicle import Vehicle
from radmpc.plotting.curves import mean_path

__all__ = ["ahead", "chosen", "flown", "flown_extent"]


def chosen(record: FlightRecord) -> FlownMission | None:
    """Return the mission that is shown: the first that hit something, or else the first.

    Parameters
    ----------
    record : FlightRecord
        The flight; None where nothing was flown.
    """
    missions = record.missions
    return next((m for m in missions if m.contacts), missions[0] if missions else None)


def flown(record: FlightRecord, mission: FlownMission) -> tuple[Trajectory, ...]:
    """Return what was flown: measured states, each with the noise that came in since the last.

    Parameters
    ----------
    record : FlightRecord
        The flight.
    mission : FlownMission
        One of its missions; where nothing was measured it is drawn straight.
    """
    rows = [row for row in mission.rows if row.states is not None]
    found = []
    for i, vehicle in enumerate(record.plan.scenario.vehicles):
        states = np.array([row.states[i] for row in rows if row.states is not None])
        held = [row.controls[i] for row in rows[: len(rows) - 1] if row.controls]
        controls = np.array(held).reshape(len(rows) - 1, vehicle.system.num_controls)
        noise = np.repeat(vehicle.disturbance_covariance[None], len(rows), axis=0)
        noise[0] = vehicle.initial_covariance
        found.append(Trajectory(vehicle.name, controls, states, noise, vehicle.gain))
    return tuple(found)


def ahead(vehicle: Vehicle, number: int, followed: Followed) -> Trajectory | None:
    """Return what is still to come of a vehicle, as its measured state says.

    Parameters
    ----------
    vehicle : Vehicle
        Which.
    number : int
        Its place in the scenario.
    followed : Followed
        What was measured and decided.

    Returns
    -------
    Trajectory or None
        From the next step on; None at the end.
    """
    nominal = followed.nominals[number]
    if len(nominal) < 2:
        return None
    loop = vehicle.system.A
    if vehicle.gain is not None:
        loop = loop + vehicle.system.B @ vehicle.gain
    deviation: Vector = np.zeros(len(loop))
    if followed.row.states is not None:
        deviation = followed.row.states[number] - nominal[0]
    means = []
    for mean in nominal[1:]:
        deviation = loop @ deviation
        means.append(mean + deviation)
    at_rest = replace(vehicle, initial_covariance=0.0 * vehicle.initial_covariance)
    noise = at_rest.covariances(len(means))[1:]
    controls = np.zeros((len(means) - 1, vehicle.system.num_controls))
    return Trajectory(vehicle.name, controls, np.array(means), noise)


def flown_extent(
    extent: Matrix, vehicles: Sequence[Vehicle], paths: Sequence[Sequence[Trajectory]]
) -> Matrix:
    """Return the corners of a picture, wide enough for what was flown, (2, d) [m].

    Parameters
    ----------
    extent : (2, d) array
        Of the plan.
    vehicles : sequence of Vehicle
        Of the scenario.
    paths : sequence of sequence of Trajectory
        Of every mission, in the scenario's order.
    """
    clouds = [extent]
    for trajectories in paths:
        for vehicle, trajectory in zip(vehicles, trajectories, strict=True):
            path = mean_path(vehicle, trajectory)
            clouds += [path - vehicle.radius, path + vehicle.radius]
    points = np.vstack(clouds)
    return np.stack([points.min(axis=0), points.max(axis=0)])
