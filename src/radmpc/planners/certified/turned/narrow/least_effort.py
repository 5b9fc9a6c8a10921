"""The path of a vehicle alone among obstacles that takes the least effort, on a lattice."""

from __future__ import annotations

from collections.abc import Iterator

from radmpc.arrays import Matrix
from radmpc.planners.certified.lattice.motion import Motion
from radmpc.planners.certified.lattice.search import PathSearch
from radmpc.planners.certified.state.task import Task

__all__ = ["least_effort_paths"]

_MOST_RISKS = (12.0, 1.0)
"""What one window may risk at most, path by path [Δ]: the first one leads through gaps that a
certified plan may be turned to, and that some get stuck in."""


def least_effort_paths(task: Task, vehicle: int, price: float) -> Iterator[Matrix]:
    """Find the paths of least effort at a price of risk, with less and less risk in any window.

    Dynamic programming over positions and displacements knows what a bend costs, which the length
    of a route does not tell. It takes 0.15 s among a hundred boxes.

    Parameters
    ----------
    task : Task
        What is asked.
    vehicle : int
        Number of the vehicle.
    price : float
        Cost of risk, per unit of probability.

    Yields
    ------
    (T+1, 2) array
        Positions at the steps [m]; none in space, and where the lattice has no path.
    """
    model = task.hazards.models[vehicle]
    if task.program_alone is None or not Motion.of(model).is_planar:
        return
    most_risks = [share * task.risk_bound for share in _MOST_RISKS]
    search = PathSearch(task.program_alone(vehicle), model, most_risks[0])
    if search.is_possible:
        yield from search.rough_paths(price, most_risks, task.limits)
