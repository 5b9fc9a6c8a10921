"""Whether what names vehicles names those that there are."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.model.obstacle import Obstacle
from radmpc.model.relations.concerns import check_concerns
from radmpc.model.relations.keep import Keep, check_keep

__all__ = ["check_relations"]


def check_relations(
    keep: Sequence[Keep], obstacles: Sequence[Obstacle], vehicles: Sequence[str]
) -> None:
    """Check ranges and obstacles against the vehicles that they name.

    Parameters
    ----------
    keep : sequence of Keep
        Of a scenario.
    obstacles : sequence of Obstacle
        Of it, too.
    vehicles : sequence of str
        Names of its vehicles.

    Raises
    ------
    ScenarioError
        With the first name of no vehicle.
    """
    check_concerns(obstacles, vehicles)
    check_keep(keep, vehicles)
