"""Which vehicles obstacles concern and which ranges are kept, of the imported vehicles."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.importing.problem import ForeignProblem
from radmpc.model.obstacle import Obstacle
from radmpc.model.relations.concerns import among
from radmpc.model.relations.keep import Keep
from radmpc.records import replace

__all__ = ["among_left", "describe_relations"]


def among_left(problem: ForeignProblem) -> ForeignProblem:
    """Return a problem whose obstacles and ranges name only the remaining vehicles.

    Parameters
    ----------
    problem : ForeignProblem
        Some of its vehicles may have been left out.
    """
    names = {vehicle.name for vehicle in problem.vehicles}
    obstacles = []
    for obstacle in (among(one, names) for one in problem.obstacles):
        whom = obstacle.concerns
        if whom is None or whom.names:
            obstacles.append(obstacle)
        elif whom.are_exempt:
            obstacles.append(replace(obstacle, concerns=None))
    keep = tuple(one for one in problem.keep if names.issuperset(one.vehicles))
    return replace(problem, obstacles=tuple(obstacles), keep=keep)


def describe_relations(
    obstacles: Sequence[Obstacle], keep: Sequence[Keep]
) -> tuple[tuple[str, str], ...]:
    """Return whom obstacles concern, and who keeps which range, in words.

    Parameters
    ----------
    obstacles : sequence of Obstacle
        All of them.
    keep : sequence of Keep
        All ranges.
    """
    some = [
        f"{obstacle.name} {'all but' if obstacle.concerns.are_exempt else 'only'} "
        f"{', '.join(obstacle.concerns.names)}"
        for obstacle in obstacles
        if obstacle.concerns is not None
    ]
    ranges = [f"{' and '.join(one.vehicles)} {one.within:g} m" for one in keep]
    told = (("obstacles for some", "; ".join(some)), ("ranges", "; ".join(ranges)))
    return tuple((name, text) for name, text in told if text)
