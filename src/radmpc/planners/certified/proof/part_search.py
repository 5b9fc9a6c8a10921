"""Searching a part of the fleet in the proof, sets of fewer of its vehicles before."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from radmpc.arrays import Tensor
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.fewer import Fewer
from radmpc.planners.certified.proof.grouping import surplus
from radmpc.planners.certified.proof.part import Part, PartAnswer, PartOrder, PartTask
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.tubes import in_empty_space, within_tube
from radmpc.planners.certified.proof.tuning import TUNING
from radmpc.planners.components import components
from radmpc.program.build import SharedBlocks, point_of
from radmpc.program.relaxed.left_out import near_each_other
from radmpc.program.relaxed.shared_rows import SharedCones, SharedRows
from radmpc.records import dataclass, field, replace
from radmpc.solvers.priced.set_bounds import SetBound
from radmpc.solvers.solution import Limits

__all__ = ["search_part", "search_part_elsewhere"]


def search_part(task: PartTask, limits: Limits, cones: SharedCones | None = None) -> PartAnswer:
    """Search a part on.

    Parameters
    ----------
    task : PartTask
        The part, and what is asked.
    limits : Limits
        When to stop early.
    cones : SharedCones or None
        Those of other parts.

    Returns
    -------
    PartAnswer
        What is known then; the same wherever it was searched, unless a limit ended it.
    """
    # Where reach is narrowed, it is another one every time; in space there are too many rows to
    # keep: those of 20 drones among trees took 140 MB.
    cones, part = SharedCones() if cones is None else cones, task.part
    is_made_anew = part.is_narrowed or part.scenario.dimension > 2
    shared = SharedRows(cones) if is_made_anew else cones.rows()
    search = _PartSearch(task.part, task.order, limits, dict(task.proven), shared)
    is_new = search.advance(tuple(range(len(task.part.members))))
    return PartAnswer(search.sets, search.nodes, is_new)


def search_part_elsewhere(task: PartTask, limits: Limits) -> PartAnswer:
    """Search a part on in another process.

    Parameters
    ----------
    task, limits
        As in `search_part`.

    Returns
    -------
    PartAnswer
        As there, without what this process builds again sooner than it receives it.
    """
    answer = search_part(task, limits)
    return replace(answer, sets={m: found.to_be_sent() for m, found in answer.sets.items()})


@dataclass(slots=True, eq=False)
class _PartSearch:
    """The search of a part; sets are named by the vehicles' places in it."""

    part: Part
    order: PartOrder
    limits: Limits
    sets: dict[Members, RelaxedSet]
    shared: SharedRows
    blocks: SharedBlocks = field(default_factory=SharedBlocks)
    nodes: int = 0
    near: NDArray[np.bool_] | None = None
    visited: set[Members] = field(default_factory=set)

    @property
    def _fewer(self) -> Fewer:
        """What is known of sets of fewer vehicles."""
        return Fewer(self.part, self.order, self.sets)

    @property
    def _has_spent(self) -> bool:
        """Whether time is up, or all nodes are spent."""
        return self.nodes >= self.order.most_nodes or self.limits.reached

    def advance(self, blocks: Members) -> bool:
        """Search a set on, smaller ones before; tell whether there was anything to do."""
        blocks = self._fewer.searched_as(blocks)
        order, proven = self.order, self.sets.get(blocks)
        if self._has_spent or blocks in self.visited:
            return False
        self.visited.add(blocks)
        if self._falls_apart(blocks):
            return False
        is_little = proven is None and self.part.paid_for_hazards(blocks) <= order.worth
        if is_little or (proven is not None and order.is_done(proven)):
            return False
        # Fewer vehicles first: their programs are small, and what they cost at least adds up.
        bounds = self._bounds_of_fewer(blocks)
        if self._is_too_large(blocks) or (proven is None and self.limits.reached):
            return True
        proven = self._built(blocks, proven)
        if any(bound.value == float("inf") for bound in bounds):
            # Some of them have no plan by faces at any price, so all together have none.
            self.sets[blocks] = replace(proven, price=order.price, bound=float("inf"))
            return True
        left = max(order.most_nodes - self.nodes, 1)
        self._search_on(blocks, proven, bounds, int(min(order.nodes * len(blocks), left)))
        return True

    def _built(self, blocks: Members, proven: RelaxedSet | None) -> RelaxedSet:
        """Return a set with the program to search on, if it is not at hand."""
        if proven is None:
            most = self._most_value(blocks) if self.part.is_narrowed else float("inf")
            around = None if self.order.is_whole else self._paths(blocks)
            return self._relaxed(blocks, most, around)
        if self.order.is_whole and not proven.is_complete:
            return self._relaxed(blocks, proven.most).continued(proven)
        if proven.built is None:
            return proven.built_anew(self._relaxed(blocks, proven.most, proven.around))
        return proven

    def _bounds_of_fewer(self, blocks: Members) -> tuple[SetBound, ...]:
        """Search sets of fewer vehicles of a set; return what that proves."""
        bounds: dict[Members, float] = {}
        for size in range(1, min(len(blocks), 3)):
            for fewer in combinations(blocks, size):
                value = self._bound_of(fewer)
                if value is not None:
                    bounds[fewer] = value
        most = self._fewer.most_before(blocks)
        if self._is_climbed(blocks):
            self._climb(blocks, min(most, len(blocks) - 1))
            bounds |= self._fewer.largest(blocks)
        if blocks in self.part.below:
            bounds[blocks] = self.part.below[blocks]
        place = {block: number for number, block in enumerate(blocks)}
        return tuple(SetBound(frozenset(place[i] for i in m), v) for m, v in bounds.items())

    def _climb(self, blocks: Members, most: int) -> None:
        """Search sets of three and more of a set's vehicles, as its bound may be made of them."""
        if len(blocks) <= TUNING.most_together:
            for triple in combinations(blocks, 3):
                self.advance(triple)
        for size in range(3, most + 1):
            while not self._has_spent and (chosen := self._fewer.next(blocks, size, self.visited)):
                self.advance(chosen)

    def _falls_apart(self, blocks: Members) -> bool:
        """Whether a set's relaxation is those of fewer of its vehicles, side by side."""
        if self.order.is_whole or len(blocks) in {1, len(self.part.members)}:
            return False
        if self.near is None:
            self.near = self._near_in_plan()
        near = self.near[np.ix_(blocks, blocks)]
        edges = ((int(i), int(j)) for i, j in zip(*np.nonzero(near), strict=True))
        return len(components(len(blocks), edges)) > 1

    def _near_in_plan(self) -> NDArray[np.bool_]:
        """Tell which vehicles of the part come near each other in the plan at hand, (n, n)."""
        models = self.part.models
        paths = self._paths(tuple(range(len(models))))
        variances = [np.trace(m.position_covariances, axis1=1, axis2=2).max() for m in models]
        radii = np.array([model.vehicle.radius for model in models])
        intervals = self.part.scenario.avoidance == "intervals"
        return near_each_other(paths, radii, np.sqrt(variances), intervals=intervals)

    def _is_too_large(self, blocks: Members) -> bool:
        """Whether sets of fewer vehicles of a set are searched, and all together later or never."""
        most, together = self._fewer.most_before(blocks), TUNING.most_together
        if self.part.scenario.dimension > 2 and len(blocks) > TUNING.most_in_space:
            return True
        is_climbed = self._is_climbed(blocks) or len(blocks) > together
        return is_climbed and most < min(len(blocks) - 1, together)

    def _is_climbed(self, blocks: Members) -> bool:
        """Whether sets of three and more of a set's vehicles are searched before it is."""
        is_large = len(blocks) >= TUNING.least_climbed and not self.part.is_narrowed
        return is_large and self._fewer.most_before(blocks) > 2

    def _bound_of(self, blocks: Members) -> float | None:
        """Return what is proven of a part of a set, searched for it where nothing else says so."""
        if blocks in self.part.below and len(self.part.members) <= TUNING.most_together:
            return self.part.below[blocks]
        self.advance(blocks)
        return self._fewer.bound_of(blocks)

    def _search_on(
        self, blocks: Members, proven: RelaxedSet, bounds: tuple[SetBound, ...], share: int
    ) -> None:
        """Search a set for so many nodes, up to one value after the other."""
        order, last = self.order, proven.nodes + share
        models = [self.part.models[block] for block in blocks]
        hint = point_of(models, [self.part.controls[block] for block in blocks])
        is_whole = len(blocks) == len(self.part.members)
        enough = order.enough if is_whole else float("inf")
        is_over = False
        while not is_over:
            most = self._next_most(blocks, proven)
            if most is not None:
                proven = self._relaxed(blocks, most).continued(proven)
            nodes = last - proven.nodes
            first = TUNING.try_nodes * len(blocks) - proven.nodes
            if self.part.is_narrowed and proven.widenings == 0 and first > 0:
                nodes = min(nodes, first)
            limits, price = self.limits, order.price
            found = proven.searched(limits, price, bounds, order.gap, nodes, hint, enough)
            self.nodes += found.nodes - proven.nodes
            self._keep(blocks, found)
            proven = found
            is_done = proven.nodes >= last or proven.bound >= enough or self.limits.reached
            is_over = is_done or self._next_most(blocks, proven) is None

    def _keep(self, blocks: Members, found: RelaxedSet) -> None:
        """Keep what is known of a set, and leave behind what others searched, beyond so many rows.

        Pairs of seven robots among two hundred boxes have 900,000, which take 250 MB.
        """
        self.sets.pop(blocks, None)
        self.sets[blocks] = found
        for members in surplus({m: known.num_rows for m, known in self.sets.items()}):
            self.sets[members] = self.sets[members].left_behind()

    def _paths(self, blocks: Members) -> Tensor:
        """Return the mean positions of a set in the plan at hand, (N, T+1, d) [m]."""
        models, controls = self.part.models, self.part.controls
        return np.stack([models[block].path(controls[block]) for block in blocks])

    def _relaxed(self, blocks: Members, most: float, around: Tensor | None = None) -> RelaxedSet:
        """Build a set's relaxation; among many obstacles with the reach of plans up to a value.

        The other vehicles cost at least what they do in empty space. What a fleet dearer than the
        plan at hand may do is of no interest either: no bound is above its cost.
        """
        part = self.part
        models = [part.models[block] for block in blocks]
        base = sum(part.base[block] for block in blocks)
        if part.is_narrowed:
            most_over = min(most - base, part.most_over)
            models = [
                within_tube(
                    model,
                    in_empty_space(part.scenario, model),
                    part.base[block] + most_over,
                    self.limits,
                )
                for block, model in zip(blocks, models, strict=True)
            ]
        scenario = part.scenario
        if len(blocks) < len(part.members):
            scenario = part.surroundings.scenario_of(blocks)
        if part.tails is None:
            shared = None if part.is_narrowed else self.blocks
            return RelaxedSet.by_faces(scenario, models, base, most, shared)
        asked = part.tails, self.order.num_directions, most, self.shared, around
        return RelaxedSet.of(scenario, models, base, *asked)

    def _next_most(self, blocks: Members, proven: RelaxedSet) -> float | None:
        """Return the value up to which a set is searched next; None to go on as it is.

        A search up to a lower value is over much sooner: reach is narrower. So after a first try
        such values are proven one after the other, each a share of what is left above the last.
        """
        if not self.part.is_narrowed or proven.is_trivial:
            return None
        gap, final = self.order.gap, self._most_value(blocks)
        if proven.widenings == 0:
            is_over = proven.nodes >= TUNING.try_nodes * len(blocks)
        else:
            is_over = proven.most < final and proven.bound >= proven.most * (1.0 - 1.01 * gap)
        left = min(proven.value, final) - proven.bound
        if not is_over or left <= gap * final:
            return None
        step = TUNING.stage * left
        if step > 2.0 * gap * final and left > TUNING.last_stage * (final - proven.base):
            return proven.bound + step
        return final if proven.most < final else None

    def _most_value(self, blocks: Members) -> float:
        """Return what a set's value is at most at any price tried: its plan risks Δ at most."""
        base = sum(self.part.base[block] for block in blocks)
        dearest = self.order.price * TUNING.most_step ** (TUNING.prices - 1)
        paid = self.part.paid_for_hazards(blocks) + base
        return paid + dearest * self.part.scenario.risk_bound
