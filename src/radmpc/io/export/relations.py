"""Which vehicles obstacles concern and which ranges are kept, as properties for imports."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.model.obstacle import Obstacle
from radmpc.model.relations.keep import Keep

__all__ = ["ranges_kept", "whom"]


def whom(obstacle: Obstacle) -> dict[str, list[str]]:
    """Return the property that names the vehicles an obstacle concerns; empty if all.

    Parameters
    ----------
    obstacle : Obstacle
        Of a scenario.
    """
    concerns = obstacle.concerns
    if concerns is None:
        return {}
    return {"except" if concerns.are_exempt else "for": list(concerns.names)}


def ranges_kept(keep: Sequence[Keep], vehicle: str) -> dict[str, list[str] | list[float]]:
    """Return the properties that name the ranges a vehicle keeps to others; each pair once.

    Parameters
    ----------
    keep : sequence of Keep
        Of a scenario.
    vehicle : str
        The name of the vehicle that stands first in those that are returned.
    """
    own = [one for one in keep if one.vehicles[0] == vehicle]
    if not own:
        return {}
    return {"keep": [one.vehicles[1] for one in own], "range": [one.within for one in own]}
