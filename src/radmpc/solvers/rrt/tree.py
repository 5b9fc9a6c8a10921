"""A rapidly-exploring random tree over the controls of one vehicle."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.solvers.rrt.connect import connect
from radmpc.solvers.rrt.course import Course
from radmpc.solvers.rrt.shortcuts import Shortcuts
from radmpc.solvers.solution import Limits

__all__ = ["RandomTree"]

_BATCH = 16
"""Targets drawn at once [-]: one product serves them all."""

_NEAR = 0.5
"""Share of the targets that are drawn around the best path so far [-]."""

_SPREAD = 0.3
"""Largest standard deviation of those, as a share of the reachable box [-]."""

_WORTH = 1.6
"""Cost up to which a course is shortened, as a multiple of the best [-]."""

_FINE_ROUNDS = 10
"""Rounds of the last shortcuts, see `ROUNDS` [-]: many small controls become few large ones."""


class RandomTree:
    """The running state of one search.

    A node is a prefix of controls. It is grown toward random positions at random later steps, and
    from every new node a cheap course to the goal is tried.

    Parameters
    ----------
    course : Course
        The vehicle.
    max_nodes : int
        Nodes at the most.
    rng : Generator
        Draws the targets.
    limits : Limits
        When to stop early.

    Attributes
    ----------
    best : (c,) array or None
        The cheapest controls found.
    cost : float
        Their cost.
    count : int
        Nodes grown.
    """

    def __init__(
        self, course: Course, max_nodes: int, rng: np.random.Generator, limits: Limits
    ) -> None:
        self.course = course
        self.rng = rng
        self.limits = limits
        self.best: Vector | None = None
        self.cost = float("inf")
        self.count = 0
        self.max_nodes = max_nodes
        size = course.steps.size
        self._controls = np.zeros((max_nodes, size))
        self._levels = np.zeros(max_nodes, dtype=np.int64)
        self._costs = np.zeros(max_nodes)
        self._paths = np.zeros((max_nodes, *course.drift.shape))
        self._best_path = course.drift
        self._shortcuts = Shortcuts(course)

    def run(self) -> None:
        """Grow until there are enough nodes or a limit is reached."""
        course = self.course
        root, start = np.zeros((1, course.steps.size)), np.zeros(1, dtype=np.int64)
        if self.limits.reached:
            return
        failure = course.failures(root)[0]
        if failure > course.horizon:
            self._note(root[0])
        if failure in {0, course.horizon + 1}:
            return
        self._best_path = course.paths(course.to_goal(root, root == 0.0))[0]
        self._add(root, start)
        # With one step there is nothing but the goal to grow to.
        for _ in range(0, self.max_nodes if course.horizon > 1 else 0, _BATCH):
            if self.count >= self.max_nodes or self.limits.reached:
                break
            self._grow()
        if self.best is not None:
            self._note(self._shortcuts.shorten(self.best, self.limits, _FINE_ROUNDS))

    def _grow(self) -> None:
        """Draw targets, and grow the nearest nodes toward them as far as nothing is hit."""
        course, T = self.course, self.course.horizon
        is_open = (self._levels[: self.count] < T - 1) & (self._costs[: self.count] < self.cost)
        if not is_open.any():
            return
        levels = self.rng.choice(np.unique(self._levels[: self.count][is_open]), _BATCH)
        ends = self.rng.integers(levels + 1, T)
        targets = self._targets(ends)
        away = self._paths[: self.count, ends] - targets
        distances = np.einsum("nsd,nsd->ns", away, away)
        fits = is_open[:, None] & (self._levels[: self.count, None] == levels)
        nodes = np.where(fits, distances, np.inf).argmin(axis=0)
        needs = targets - self._paths[nodes, ends]
        free = (course.steps >= levels[:, None]) & (course.steps < ends[:, None])
        grown = self._controls[nodes] + connect(
            course.positions[ends], needs, free * course.limits, rounds=1
        )
        reached = np.minimum(course.failures(grown) - 1, ends)
        counts = np.maximum(reached - levels, 0)
        which = np.repeat(np.arange(_BATCH), counts)
        starts = np.cumsum(counts) - counts
        new = levels[which] + 1 + np.arange(which.size) - starts[which]
        self._add(np.where(course.steps < new[:, None], grown[which], 0.0), new)

    def _targets(self, ends: Indices) -> Matrix:
        """Return positions at given steps: anywhere in reach, or around the best path so far."""
        low, high = self.course.lower[ends], self.course.upper[ends]
        anywhere = low + self.rng.random(low.shape) * (high - low)
        scale = _SPREAD * self.rng.random((len(ends), 1)) * (high - low)
        around = self._best_path[ends] + scale * self.rng.standard_normal(low.shape)
        is_near = self.rng.random((len(ends), 1)) < _NEAR
        return np.where(is_near, around, anywhere)

    def _add(self, controls: Matrix, levels: Indices) -> None:
        """Add nodes, and try a course to the goal from each."""
        costs = self.course.costs(controls)
        kept = np.flatnonzero(costs < self.cost)[: self.max_nodes - self.count]
        if kept.size == 0:
            return
        controls, levels = controls[kept], levels[kept]
        new = slice(self.count, self.count + kept.size)
        self._controls[new] = controls
        self._levels[new] = levels
        self._costs[new] = costs[kept]
        self._paths[new] = self.course.paths(controls)
        self.count += kept.size
        ended = self.course.to_goal(controls, self.course.steps >= levels[:, None])
        costs = self.course.costs(ended)
        cheap = np.flatnonzero(costs < _WORTH * self.cost)
        cheap = cheap[self.course.failures(ended[cheap]) > self.course.horizon]
        if cheap.size:
            # Others of the same batch would mostly be shortened to the same course.
            cheapest = ended[cheap[costs[cheap].argmin()]]
            self._note(self._shortcuts.shorten(cheapest, self.limits))

    def _note(self, controls: Vector) -> None:
        """Keep a course if it is the cheapest."""
        cost = float(self.course.costs(controls[None])[0])
        if cost < self.cost:
            self.best, self.cost = controls, cost
            self._best_path = self.course.paths(controls[None])[0]
