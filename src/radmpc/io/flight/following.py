"""Where the legs of a mission expect its vehicles: follows from the plan and the rows."""

from __future__ import annotations

from radmpc.arrays import Matrix, Vector
from radmpc.io.flight.record import FlightRecord, FlownMission, TickRow
from radmpc.model.dynamics import rollout
from radmpc.records import dataclass

__all__ = ["Followed", "followed"]


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """A row, and the nominal of the leg that is flown from it on.

    Attributes
    ----------
    row : TickRow
        The decision.
    nominals : tuple of (T − k + 1, n) array
        Nominal states of every vehicle from the row's step to the end.
    """

    row: TickRow
    nominals: tuple[Matrix, ...]

    @property
    def expected(self) -> tuple[Vector, ...]:
        """Where the nominal is at the row's step."""
        return tuple(nominal[0] for nominal in self.nominals)


def followed(record: FlightRecord, mission: FlownMission) -> tuple[Followed, ...]:
    """Return a mission's rows with the nominals that are flown.

    Parameters
    ----------
    record : FlightRecord
        The flight.
    mission : FlownMission
        One of its missions.
    """
    vehicles = record.plan.scenario.vehicles
    paths = [trajectory.means for trajectory in record.plan.trajectories]
    begun, found = 0, []
    for row in mission.rows:
        if row.leg is not None:
            legs = zip(vehicles, row.leg.starts, row.leg.controls, strict=True)
            without = (rollout(v.system, x, u, v.drift) for v, x, u in legs)
            paths = list(without if row.leg.means is None else row.leg.means)
            begun = row.step
        found.append(Followed(row, tuple(path[row.step - begun :] for path in paths)))
    return tuple(found)
