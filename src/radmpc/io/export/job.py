"""The input of an exporter."""

from __future__ import annotations

from radmpc.errors import ScenarioError
from radmpc.io.export.origin import Placement
from radmpc.io.export.tracks import TimedPath
from radmpc.model.plan import Plan
from radmpc.records import dataclass

__all__ = ["Job"]


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """A plan to be written, and where it lies.

    Attributes
    ----------
    plan : Plan
        With trajectories.
    tracks : tuple of TimedPath
        One per vehicle.
    is_certified : bool
        Whether the plan holds within its bound.
    placement : Placement or None
        Where the local frame lies on earth; None if not stated.
    altitude : float
        Height of a 2-D plan above the origin [m].
    note : str or None
        What is to be said of steps that were left out.
    """

    plan: Plan
    tracks: tuple[TimedPath, ...]
    is_certified: bool
    placement: Placement | None = None
    altitude: float = 0.0
    note: str | None = None

    @property
    def place(self) -> Placement:
        """Where the local frame lies on earth.

        Raises
        ------
        ScenarioError
            If it was not stated.
        """
        if self.placement is None:
            raise ScenarioError(
                "is required: the plan has no place on earth of its own (no 'origin' in its "
                "scenario's source)",
                ("origin",),
            )
        return self.placement
