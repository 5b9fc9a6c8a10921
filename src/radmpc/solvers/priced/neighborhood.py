"""Incumbents of the priced problem, by planning one block or two around the others.

The others are moving obstacles to the free ones, whose paths are planned by a small search over
alternatives and risks together. Heuristics: they prove nothing, but a point they return is a
solution of the whole at its true risk.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.restrict import Restriction, avoidance_blocks, restrict_around
from radmpc.solvers.priced.around import search_around
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.priced.tuning import TUNING
from radmpc.solvers.solution import Limits

__all__ = ["Neighborhood", "Seek"]

Seek = Callable[[Rater, int, bool], Incumbent | None]
"""Looks for a plan of one block around placed others, from its program laid out for rating and its
number; greedily, as early as possible, where the last argument is true."""


@dataclass(eq=False)
class Neighborhood:
    """A program of several blocks, to be planned a few at a time.

    Attributes
    ----------
    program : DisjunctiveProgram
        The whole.
    unit, price : float
        Risk budget, and the cost of risking it: the Lagrange multiplier of the risk bound.
    scale : float
        Values below this count as this in relative gaps.
    limits : Limits
        When to stop early.
    longest_step : float
        The longest move from step to step [m].
    least : sequence of float
        Lower bound on every block's value, alone: a block that attains it is not planned anew.
    seek : callable or None
        Called where the tree finds no path for a block that is to be placed.
    """

    program: DisjunctiveProgram
    unit: float
    price: float
    scale: float
    limits: Limits
    longest_step: float
    least: Sequence[float]
    seek: Seek | None = None

    def __post_init__(self) -> None:
        """Note which avoidances touch which blocks."""
        self.touched: csr_array = avoidance_blocks(self.program)
        self.blocks = list(range(self.touched.shape[1]))

    def place(self, alone: Vector, order: Sequence[int]) -> Vector | None:
        """Plan blocks one after the other, each around those before it.

        Parameters
        ----------
        alone : (n,) array
            Every block's solution without the others.
        order : sequence of int
            The blocks, the first to be placed first.

        Returns
        -------
        (n,) array or None
            A solution of the whole. A block that finds no path is put first and all begins again,
            a few times; then None.
        """
        order, tried = list(order), list[list[int]]()
        for _ in range(TUNING.tries):
            z = alone.copy()
            failed = None
            for place, block in enumerate(order):
                moved = self._freed(z, [block], order[:place], is_new=True)
                if moved is None:
                    failed = block
                    break
                z = moved
            if failed is None:
                return z
            tried.append(order[: order.index(failed) + 1])
            order = [failed, *(b for b in order if b != failed)]
            if self.limits.reached or any(order[: len(t)] == t for t in tried):
                return None
        return None

    def place_greedily(self, alone: Vector, order: Sequence[int]) -> Vector | None:
        """Place blocks greedily, each to arrive as soon as those before it let it pass.

        Parameters
        ----------
        alone, order
            As in `place`.

        Returns
        -------
        (n,) array or None
            As in `place`.
        """
        for sequence in (list(order), list(order)[::-1]):
            tried, following = list[list[int]](), sequence
            for _ in range(TUNING.greedy_tries):
                z, failed = self._placed_greedily(alone, following)
                if failed is None:
                    return self.improve(z, [[block] for block in following])
                tried.append(following[: following.index(failed) + 1])
                following = [failed, *(b for b in following if b != failed)]
                if self.limits.reached or any(following[: len(t)] == t for t in tried):
                    break
        return None

    def _placed_greedily(self, alone: Vector, order: list[int]) -> tuple[Vector, int | None]:
        """Return a point with blocks placed in an order, and the first that found no path."""
        z = alone.copy()
        for place, block in enumerate(order):
            part = self._around(z, [block], order[:place])
            found = None
            if self.seek is not None and not self.limits.reached:
                found = self.seek(Rater(part.program, self.unit), block, True)
            if found is None:
                return z, block
            z[part.columns] = found.z
        return z, None

    def improve(self, z: Vector, groups: Sequence[Sequence[int]]) -> Vector:
        """Free groups of blocks in turn and plan each anew around all others.

        Parameters
        ----------
        z : (n,) array
            A solution.
        groups : sequence of sequence of int
            What to free together.

        Returns
        -------
        (n,) array
            A solution whose value is no greater.
        """
        for group in groups:
            if self.limits.reached:
                break
            others = [b for b in self.blocks if b not in group]
            found = self._freed(z, list(group), others, is_new=False)
            z = z if found is None else found
        return z

    def _freed(
        self, z: Vector, free: list[int], placed: Sequence[int], *, is_new: bool
    ) -> Vector | None:
        """Return the point with some blocks planned anew; None if no path was found."""
        part = self._around(z, free, placed)
        rater = Rater(part.program, self.unit)
        if rater.is_infeasible:
            return None
        tree = RiskTree(
            part.program,
            self.unit,
            self.price,
            gap=TUNING.rough_gap,
            scale=self.scale,
            limits=self.limits,
            rater=rater,
        )
        tree.consider(z[part.columns])
        least = sum(self.least[b] for b in free)
        if tree.value <= least + TUNING.rough_gap * max(least, self.scale):
            return z
        if tree.best is not None:
            self._search_around(tree, tree.best, TUNING.nodes_around * len(free))
        tree.run(TUNING.nodes * len(free))
        if tree.best is None and is_new and self.seek is not None and not self.limits.reached:
            found = self.seek(tree.rater, free[0], False)
            if found is not None:
                tree.consider(found.z)
        if tree.best is None:
            return None
        moved = z.copy()
        moved[part.columns] = tree.best.z
        return moved

    def _search_around(self, tree: RiskTree, best: Incumbent, max_nodes: int) -> None:
        """Offer a tree the best plan near one that it has."""
        near = search_around(
            tree.rater,
            tree.program.slacks(best.z),
            best,
            longest_step=self.longest_step,
            unit=self.unit,
            price=self.price,
            scale=self.scale,
            limits=self.limits,
            max_nodes=max_nodes,
        )
        if near is not None:
            tree.consider(near.z)

    def _around(self, z: Vector, free: Sequence[int], placed: Sequence[int]) -> Restriction:
        """Return the program of some blocks around placed others."""
        return restrict_around(
            self.program, np.array(free), np.array(placed, dtype=np.int64), z, self.touched
        )
