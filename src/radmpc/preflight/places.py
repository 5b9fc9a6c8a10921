"""What is known of the narrowest place that a vehicle must pass."""

from __future__ import annotations

from enum import Enum

from radmpc.records import dataclass

__all__ = ["Narrowest", "Passage"]


class Passage(Enum):
    """Why there is no narrowest place to name."""

    WIDE = "wide"
    UNKNOWN = "unknown"
    TOO_LARGE = "too large"
    """What the vehicle can reach has too many cells as small as its hull, soon so in space."""


@dataclass(frozen=True, slots=True)
class Narrowest:
    """Where a vehicle has the least clearance, on the path that leaves it the most.

    Attributes
    ----------
    clearance : float
        Of the hull from what is nearest, negative where it does not fit [m].
    deviation : float
        Standard deviation of the position toward it, then [m].
    position : tuple of float
        Where [m].
    step : int
        The step at or before.
    beside : tuple of (str or None)
        What is there, the nearest first; None is the workspace's border.
    """

    clearance: float
    deviation: float
    position: tuple[float, ...]
    step: int
    beside: tuple[str | None, ...]

    @property
    def deviations(self) -> float | None:
        """The clearance in standard deviations; None without noise."""
        return self.clearance / self.deviation if self.deviation > 0.0 else None
