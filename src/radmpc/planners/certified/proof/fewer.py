"""Sets of fewer vehicles of a set: what is proven of them, and which promises most."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.packing import expected_gains, gains_of, packed
from radmpc.planners.certified.proof.part import Part, PartOrder
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.symmetry import bound_of_image, images_of, with_images
from radmpc.records import dataclass

__all__ = ["Fewer"]


@dataclass(frozen=True, slots=True, eq=False)
class Fewer:
    """What is known of sets of some vehicles of a part, at the price that is asked for.

    Attributes
    ----------
    part : Part
        The part.
    order : PartOrder
        What is asked.
    sets : mapping of tuple of int to RelaxedSet
        What is known, by the vehicles' places in the part.
    """

    part: Part
    order: PartOrder
    sets: Mapping[Members, RelaxedSet]

    def bounds(self, blocks: Members) -> dict[Members, float]:
        """Return what is proven of sets of fewer vehicles than a set.

        Parameters
        ----------
        blocks : tuple of int
            The set, by places in the part.
        """
        found = {m: one.bound for m, one in self.sets.items() if one.price == self.order.price}
        found = with_images(found, self.part.symmetries)
        found |= {m: max(bound, found.get(m, 0.0)) for m, bound in self.part.below.items()}
        return {members: bound for members, bound in found.items() if set(members) < set(blocks)}

    def largest(self, blocks: Members) -> dict[Members, float]:
        """Return what is proven of the largest of these: those of fewer say little beside.

        Parameters
        ----------
        blocks : tuple of int
            As in `bounds`.
        """
        bounds = self.bounds(blocks)
        largest = max(map(len, bounds), default=0)
        return {members: bound for members, bound in bounds.items() if len(members) >= largest - 1}

    def together(self, blocks: Members) -> float:
        """Return what sets of fewer vehicles than a set prove of it together.

        Parameters
        ----------
        blocks : tuple of int
            The set, by places in the part.
        """
        alone, gains = gains_of(self.bounds(blocks), {i: self.part.base[i] for i in blocks})
        return alone + packed(gains)[0]

    def most_before(self, blocks: Members) -> int:
        """Return how many vehicles the largest sets have that are searched before a set is.

        One more where its own search has proven less than sets of fewer do.

        Parameters
        ----------
        blocks : tuple of int
            The set, by places in the part.
        """
        most, known = self.order.most_fewer, self.sets.get(blocks)
        if known is None or known.price != self.order.price or known.nodes == 0:
            return most
        return most + (known.bound < self.together(blocks))

    def next(self, blocks: Members, size: int, visited: Collection[Members]) -> Members:
        """Return the set of a size that promises most for the bound of a larger one.

        Parameters
        ----------
        blocks : tuple of int
            The larger one, by places in the part.
        size : int
            Vehicles of the set [-].
        visited : collection of tuple of int
            Sets that are not to be searched on.

        Returns
        -------
        tuple of int
            Empty where none does.
        """
        base = {block: self.part.base[block] for block in blocks}
        alone, gains = gains_of(self.bounds(blocks), base)
        proven = packed(gains)[0]
        if alone + proven >= self.order.enough:
            return ()
        hopes = expected_gains(gains, blocks, size)
        hopes = {m: gain for m, gain in hopes.items() if m not in visited and self._is_new(m)}
        total, members = packed(gains | hopes)
        if total <= proven + self.order.worth:
            hopes = {}
        open_ = (m for m in members if len(m) == size and self.searched_as(m) not in visited)
        promising = (m for m in open_ if m in hopes or self._is_open(m))
        return max(promising, key=lambda m: hopes.get(m, 0.0), default=())

    def bound_of(self, members: Members) -> float | None:
        """Return what is proven of a set by its own search, or by that of an image of it.

        Parameters
        ----------
        members : tuple of int
            The set, by places in the part.
        """
        image = self.searched_as(members)
        known = self.sets.get(image)
        if known is None or known.price != self.order.price:
            return None
        return known.bound if image == members else bound_of_image(known.bound)

    def _is_new(self, members: Members) -> bool:
        """Whether a set was not searched at this price."""
        known = self.sets.get(self.searched_as(members))
        return known is None or known.price != self.order.price

    def _is_open(self, members: Members) -> bool:
        """Whether a set that was searched may be searched on."""
        known = self.sets.get(self.searched_as(members))
        return known is not None and not self.order.is_done(known)

    def searched_as(self, members: Members) -> Members:
        """Return the set that was searched in place of a set: itself, if none was.

        Parameters
        ----------
        members : tuple of int
            The set, by places in the part.
        """
        if not self.part.symmetries:
            return members
        images = images_of(members, self.part.symmetries)
        return next((image for image in images if image in self.sets), members)
